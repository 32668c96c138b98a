# Generated from the definitions of rmw_dds_common by roslet.gen.stubs. Do not edit.

from collections import abc as _abc

from roslet.wire import message as _message

class Gid(_message.Message):
    data: _message.Bytes
    def __init__(
        self,
        data: _message.Bytes | _abc.Sequence[int] = ...,
    ) -> None: ...

class NodeEntitiesInfo(_message.Message):
    node_namespace: str
    node_name: str
    reader_gid_seq: list[Gid]
    writer_gid_seq: list[Gid]
    def __init__(
        self,
        node_namespace: str = ...,
        node_name: str = ...,
        reader_gid_seq: list[Gid] | None = ...,
        writer_gid_seq: list[Gid] | None = ...,
    ) -> None: ...

class ParticipantEntitiesInfo(_message.Message):
    gid: Gid
    node_entities_info_seq: list[NodeEntitiesInfo]
    def __init__(
        self,
        gid: Gid | None = ...,
        node_entities_info_seq: list[NodeEntitiesInfo] | None = ...,
    ) -> None: ...
