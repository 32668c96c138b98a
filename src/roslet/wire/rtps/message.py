"""A whole message: header and submessages. RTPS 2.3, 8.3.3, 8.3.4."""

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
    pad,
    submessage,
)
from roslet.wire.rtps.header import Header

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from typing import Any

PARSERS: "dict[int, Callable[[memoryview, int, int, int], Any]]" = {
    submessage.PAD: pad.parse,
    submessage.ACKNACK: ack_nack.parse,
    submessage.HEARTBEAT: heartbeat.parse,
    submessage.GAP: gap.parse,
    submessage.INFO_TS: info_ts.parse,
    submessage.INFO_SRC: info_src.parse,
    submessage.INFO_REPLY_IP4: info_reply.parse_ip4,
    submessage.INFO_DST: info_dst.parse,
    submessage.INFO_REPLY: info_reply.parse,
    submessage.NACK_FRAG: nack_frag.parse,
    submessage.HEARTBEAT_FRAG: heartbeat_frag.parse,
    submessage.DATA: data.parse,
    submessage.DATA_FRAG: data_frag.parse,
}
"""PARSERS[kind](view, start, end, flags) is the submessage's value."""


def submessages(view: memoryview) -> "Iterator[Any]":
    """The values of a message's submessages in order; those of unknown kinds are skipped by their length.

    What came before a fault stays valid, so the fault is raised where it is reached. Raises ProtocolError.
    """
    for kind, flags, at, end in submessage.walk(view):
        parser = PARSERS.get(kind)
        if parser is not None:
            yield parser(view, at, end, flags)


def parse(datagram: "bytes | bytearray | memoryview") -> "tuple[Header, list[Any]]":
    """Header and submessages of a datagram without any fault. Raises ProtocolError; see the parsers for reasons."""
    view = memoryview(datagram)
    return header.parse(view), list(submessages(view))
