"""What a message makes of its submessages: source, destination, time, where replies go. RTPS 2.3, 8.3.4.

The datagram that nearly all are, INFO_TS and DATA of a known writer in little endian, is taken apart by one `struct` call;
everything else, and whatever follows, goes the general way. Where memory is short that call makes too much garbage: there
what is like an earlier datagram is told by comparing (`receive_again`).
"""

from struct import unpack_from

from roslet.engine.rtps.reach import addresses_of
from roslet.wire.primitives import unpacker
from roslet.wire.rtps import (
    ack_nack,
    data,
    data_frag,
    gap,
    header,
    heartbeat,
    heartbeat_frag,
    info_dst,
    info_reply,
    info_src,
    info_ts,
    nack_frag,
    submessage,
)
from roslet.wire.rtps.data import FLAG_D, Data
from roslet.wire.rtps.guid import (
    ENTITYID_SPDP_BUILTIN_PARTICIPANT_WRITER,
    ENTITYID_UNKNOWN,
    ENTITYKIND_BUILTIN,
    GUIDPREFIX_UNKNOWN,
)

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from roslet.engine.rtps.liveliness import Liveliness
    from roslet.engine.rtps.outbox import Address
    from roslet.engine.rtps.reader import Reader, WriterProxy
    from roslet.engine.rtps.spdp import Spdp
    from roslet.engine.rtps.writer import Writer
    from roslet.wire.rtps.info_reply import InfoReply

# header: protocol, version, vendorId, guidPrefix; INFO_TS: id and flags, length, seconds, fraction;
# DATA: id and flags, length, extraFlags, octetsToInlineQos, readerId, writerId, writerSN
_COMMON = unpacker("<4sB3x12sHHIIHHHH4s4siI")
_COMMON_SIZE = 56
_COMMON_END = 36  # where the length of DATA counts from
_INFO_TS = submessage.INFO_TS | submessage.FLAG_E << 8
_DATA = submessage.DATA | (submessage.FLAG_E | FLAG_D) << 8
_TO_INLINE_QOS = 16
# What differs from one datagram of a writer to the next of the same size: seconds and fraction, the sequence number.
_DIFFERS = "<II16xiI"
_FRONT_END, _MIDDLE, _MIDDLE_END = 24, 32, 48
# Writers, or sizes of their samples, that are told by comparing. What is beyond makes garbage.
MAX_SEEN = 8
# Where a datagram comes from of which the shell cannot say it. Nobody is there: discovery is not believed from it.
NOBODY = ("", 0)
GUIDPREFIX_SIZE = 12
# What changes the receiver's state does so whomever the message is for.
_STATE = (
    submessage.INFO_DST,
    submessage.INFO_TS,
    submessage.INFO_SRC,
    submessage.INFO_REPLY,
    submessage.INFO_REPLY_IP4,
)


class Seen:
    """What is the same in the datagrams of one writer, and windows on the buffer that they come in. `value`: the Data that
    they are handed over in; None meanwhile."""

    __slots__ = ("end", "front", "middle", "value", "view", "writer", "x_front", "x_middle")

    def __init__(self, view: memoryview, writer: bytes, value: Data, end: int) -> None:
        self.view = view
        self.writer = writer
        self.value: Data | None = value
        self.end = end
        self.front = view[:_FRONT_END]
        self.middle = view[_MIDDLE:_MIDDLE_END]
        self.x_front = bytes(self.front)
        self.x_middle = bytes(self.middle)


class Receiver:
    """The receiver of one participant. `writers` are all of ours, builtin ones too; `routes` as in Matching."""

    def __init__(
        self,
        guid_prefix: bytes,
        hear_own: bool,
        spdp: "Spdp",
        writers: "dict[bytes, Writer]",
        routes: "dict[bytes, list[tuple[Reader, WriterProxy]]]",
        liveliness: "Liveliness",
        count: "Callable[[str], None]",
    ) -> None:
        self.now = 0.0
        self._guid_prefix = guid_prefix
        self._hear_own = hear_own
        self._spdp = spdp
        self._remotes = spdp.remotes
        self._writers = writers
        self._routes = routes
        self._liveliness = liveliness
        self._count = count
        # 8.3.4, the state of a receiver; replies go to what discovery says unless an INFO_REPLY says otherwise.
        self._source = GUIDPREFIX_UNKNOWN
        self._host = ""
        self._for_us = True
        self._time: int | None = None
        self._reply: tuple[Address, ...] = ()
        # The header of the last message that went the general way, at first of none, and the prefix in it.
        self._head = bytes(header.SIZE + 1)
        self._sender = GUIDPREFIX_UNKNOWN
        self._seen: list[Seen] = []
        self._handlers = {
            submessage.DATA: self._data,
            submessage.DATA_FRAG: self._data_frag,
            submessage.HEARTBEAT: self._heartbeat,
            submessage.HEARTBEAT_FRAG: self._heartbeat_frag,
            submessage.GAP: self._gap,
            submessage.ACKNACK: self._acknack,
            submessage.NACK_FRAG: self._nack_frag,
            submessage.INFO_TS: self._info_ts,
            submessage.INFO_DST: self._info_dst,
            submessage.INFO_SRC: self._info_src,
            submessage.INFO_REPLY: self._info_reply,
            submessage.INFO_REPLY_IP4: self._info_reply_ip4,
        }

    def receive_datagram(self, view: memoryview, source: "Address", now: float) -> None:
        """Take one datagram. Raises ProtocolError at the first fault; what came before it was valid (8.3.4.1)."""
        self.now = now
        size = len(view)
        at = header.SIZE
        time: int | None = None
        if size >= _COMMON_SIZE:
            (
                protocol,
                major,
                prefix,
                stamp,
                stamp_size,
                seconds,
                fraction,
                kind,
                length,
                _,
                to_qos,
                reader_id,
                writer_id,
                high,
                low,
            ) = _COMMON(view, 0)
            if (
                kind == _DATA
                and stamp == _INFO_TS
                and protocol == header.PROTOCOL_RTPS
                and stamp_size == 8
                and major == 2
                and to_qos == _TO_INLINE_QOS
            ):
                routes = self._routes.get(prefix + writer_id)
                end = _COMMON_END + length if length else size
                if (
                    routes is not None
                    and writer_id[3] < ENTITYKIND_BUILTIN
                    and _COMMON_SIZE <= end <= size
                    and high >= 0
                    and (low or high)
                ):
                    remote = self._remotes.get(prefix)
                    if remote is not None and source[0] in remote.hosts:
                        remote.heard = now
                    time = seconds * 1000000000 + (fraction * 1000000000 >> 32)
                    if self._liveliness.manual:
                        self._liveliness.writer_asserted(prefix + writer_id, now)
                    value = Data(reader_id, writer_id, high << 32 | low, view[_COMMON_SIZE:end])
                    for reader, proxy in routes:
                        if reader_id == ENTITYID_UNKNOWN or reader_id == reader.entity_id:
                            reader.handle_data(proxy, value, time, now)
                    if end == size:
                        return
                    at = end
        self._walk(view, source[0], at, time)

    def receive_again(self, view: memoryview, size: int, now: float) -> None:
        """The same of view[:size], where `view` is all of a buffer that is used again, and nobody knows the source."""
        seconds, fraction, high, low = (
            unpack_from(_DIFFERS, view, _FRONT_END) if size >= _COMMON_SIZE else (0, 0, 0, 0)
        )
        if high >= 0 and (low or high):
            for one in self._seen:
                value = one.value
                if (
                    value is not None
                    and one.view is view
                    and one.front == one.x_front
                    and one.middle == one.x_middle
                    and one.end <= size
                ):
                    routes = self._routes.get(one.writer)
                    if routes is None:
                        break
                    self.now = now
                    time = seconds * 1000000000 + (fraction * 1000000000 >> 32)
                    if self._liveliness.manual:
                        self._liveliness.writer_asserted(one.writer, now)
                    value.sequence = high << 32 | low
                    one.value = None
                    for reader, proxy in routes:
                        if value.reader_id == ENTITYID_UNKNOWN or value.reader_id == reader.entity_id:
                            reader.handle_data(proxy, value, time, now)
                    one.value = value
                    if one.end < size:
                        self._walk(view[:size], "", one.end, time)
                    return
            else:
                if view[_MIDDLE] == submessage.DATA:
                    self._learn(view, size)
        self.receive_datagram(view[:size], NOBODY, now)

    def _learn(self, view: memoryview, size: int) -> None:
        """Remember what this datagram is like, if it is of the kind that nearly all are."""
        if len(self._seen) >= MAX_SEEN:
            self._seen = [one for one in self._seen if one.view is view and one.writer in self._routes]
            if len(self._seen) >= MAX_SEEN:
                return
        common = _COMMON(view, 0)
        kind, length, _, to_qos, reader_id, writer_id = common[7:13]
        writer = common[2] + writer_id
        end = _COMMON_END + length
        if (
            kind == _DATA
            and common[3] == _INFO_TS
            and common[0] == header.PROTOCOL_RTPS
            and common[4] == 8
            and common[1] == 2
            and to_qos == _TO_INLINE_QOS
            and writer in self._routes
            and writer_id[3] < ENTITYKIND_BUILTIN
            and _COMMON_SIZE <= end <= size
        ):
            value = Data(reader_id, writer_id, 0, view[_COMMON_SIZE:end])
            self._seen.append(Seen(view, writer, value, end))

    def _walk(self, view: memoryview, host: str, at: int, time: "int | None") -> None:
        """Take the submessages from `at` on; `time` is what an INFO_TS before them said."""
        if view[: header.SIZE] != self._head:  # nearly always it is the last one's again
            prefix = header.parse(view).guid_prefix
            self._head, self._sender = bytes(view[: header.SIZE]), prefix
        prefix = self._sender
        if prefix == self._guid_prefix and not self._hear_own:
            return
        now = self.now
        self._source = prefix
        self._host = host
        self._for_us = True
        self._time = time
        self._reply = ()
        remote = self._remotes.get(prefix)
        if remote is not None and self._host in remote.hosts:
            remote.heard = now
        handlers = self._handlers
        size = len(view)
        count = 0
        while at < size:
            end = submessage.end_of(view, at, count)
            count += 1
            kind = view[at]
            handler = handlers.get(kind)
            if handler is not None and (self._for_us or kind in _STATE):
                handler(view, at + 4, end, view[at + 1])
            at = end

    # -- of writers

    def _data(self, view: memoryview, at: int, end: int, flags: int) -> None:
        value = data.parse(view, at, end, flags)
        if value.writer_id[3] >= ENTITYKIND_BUILTIN and not self._believed():
            return
        writer = self._source + value.writer_id
        routes = self._routes.get(writer)
        if routes is not None:
            if self._liveliness.manual:
                self._liveliness.writer_asserted(writer, self.now)
            reader_id = value.reader_id
            for reader, proxy in routes:
                if reader_id == ENTITYID_UNKNOWN or reader_id == reader.entity_id:
                    reader.handle_data(proxy, value, self._time, self.now)
        elif self._source == self._guid_prefix:
            return  # our own announcement, come back from the group
        elif value.writer_id == ENTITYID_SPDP_BUILTIN_PARTICIPANT_WRITER:
            self._spdp.handle_data(value, self._source, self._host, self.now)
        else:
            self._count("data-of-unmatched-writer")

    def _believed(self) -> bool:
        """Whether discovery from this source may come from where it came: else anybody could redirect or end a peer."""
        remote = self._remotes.get(self._source)
        if not self._host:
            pass
        elif remote is None or remote.believes(self._host, self.now):
            return True
        self._count("discovery-from-another-address")
        return False

    def _targets(self, value: "Any") -> "list[tuple[Reader, WriterProxy]]":
        if value.writer_id[3] >= ENTITYKIND_BUILTIN and not self._believed():
            return []
        routes = self._routes.get(self._source + value.writer_id)
        if routes is None:
            self._count("submessage-of-unmatched-writer")
            return []
        if value.reader_id == ENTITYID_UNKNOWN:
            return routes
        return [one for one in routes if value.reader_id == one[0].entity_id]

    def _data_frag(self, view: memoryview, at: int, end: int, flags: int) -> None:
        value = data_frag.parse(view, at, end, flags)
        targets = self._targets(value)
        if targets and self._liveliness.manual:
            self._liveliness.writer_asserted(self._source + value.writer_id, self.now)
        for reader, proxy in targets:
            reader.handle_data_frag(proxy, value, self._time, self.now)

    def _heartbeat(self, view: memoryview, at: int, end: int, flags: int) -> None:
        value = heartbeat.parse(view, at, end, flags)
        if value.liveliness:
            self._liveliness.writer_asserted(self._source + value.writer_id, self.now)
        for reader, proxy in self._targets(value):
            reader.handle_heartbeat(proxy, value, self.now, self._reply)

    def _heartbeat_frag(self, view: memoryview, at: int, end: int, flags: int) -> None:
        value = heartbeat_frag.parse(view, at, end, flags)
        for reader, proxy in self._targets(value):
            reader.handle_heartbeat_frag(proxy, value, self.now, self._reply)

    def _gap(self, view: memoryview, at: int, end: int, flags: int) -> None:
        value = gap.parse(view, at, end, flags)
        for reader, proxy in self._targets(value):
            reader.handle_gap(proxy, value, self.now)

    # -- of readers

    def _acknack(self, view: memoryview, at: int, end: int, flags: int) -> None:
        value = ack_nack.parse(view, at, end, flags)
        if value.writer_id[3] >= ENTITYKIND_BUILTIN and not self._believed():
            return
        writer = self._writers.get(value.writer_id)
        if writer is None:
            self._count("acknack-of-unknown-writer")
        else:
            writer.handle_acknack(value, self._source + value.reader_id, self.now, self._reply)

    def _nack_frag(self, view: memoryview, at: int, end: int, flags: int) -> None:
        value = nack_frag.parse(view, at, end, flags)
        writer = self._writers.get(value.writer_id)
        if writer is None:
            self._count("nack-frag-of-unknown-writer")
        else:
            writer.handle_nack_frag(value, self._source + value.reader_id, self.now, self._reply)

    # -- of the message

    def _info_ts(self, view: memoryview, at: int, end: int, flags: int) -> None:
        self._time = info_ts.parse(view, at, end, flags).time

    def _info_dst(self, view: memoryview, at: int, end: int, flags: int) -> None:
        if end - at >= GUIDPREFIX_SIZE and view[at : at + GUIDPREFIX_SIZE] == self._guid_prefix:
            self._for_us = True
            return
        prefix = info_dst.parse(view, at, end, flags).guid_prefix
        self._for_us = prefix == self._guid_prefix or prefix == GUIDPREFIX_UNKNOWN

    def _info_src(self, view: memoryview, at: int, end: int, flags: int) -> None:
        self._source = info_src.parse(view, at, end, flags).guid_prefix
        self._time = None
        self._reply = ()

    def _info_reply(self, view: memoryview, at: int, end: int, flags: int) -> None:
        self._reply_to(info_reply.parse(view, at, end, flags))

    def _info_reply_ip4(self, view: memoryview, at: int, end: int, flags: int) -> None:
        self._reply_to(info_reply.parse_ip4(view, at, end, flags))

    def _reply_to(self, value: "InfoReply") -> None:
        """8.3.7.8. Where nothing usable is named, discovery counts."""
        self._reply = addresses_of(value.unicast or value.multicast, self._host)
