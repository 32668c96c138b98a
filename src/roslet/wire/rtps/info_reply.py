"""INFO_REPLY and INFO_REPLY_IP4. RTPS 2.3, 8.3.7.8 (meaning), 9.4.5.9, 9.4.5.14 (bytes).

    INFO_REPLY       unicast locator list, with FLAG_M also a multicast one: count (4), then 24 octets each
    INFO_REPLY_IP4   unicast address (4), port (4), with FLAG_M also a multicast pair; the address is a number,
                     so its octets follow the endianness flag

Replies to what follows go there instead of to the locators from discovery.
"""

from roslet.record import Record
from roslet.wire.fields import SUBMESSAGE_HEADER, Fixed
from roslet.wire.primitives import packer, unpacker
from roslet.wire.rtps import locator
from roslet.wire.rtps.locator import Locator
from roslet.wire.rtps.submessage import FLAG_E, INFO_REPLY, INFO_REPLY_IP4, truncated

FLAG_M = 0x02

_HEADER = Fixed(SUBMESSAGE_HEADER, submessage=False)
_PAIR = (unpacker(">II"), unpacker("<II"))
_EMIT_PAIR = (packer(">II"), packer("<II"))


class InfoReply(Record):
    """Unicast and multicast locators; an empty multicast tuple is not emitted."""

    _fields = ("unicast", "multicast")
    __slots__ = _fields

    def __init__(self, unicast: "tuple[Locator, ...]", multicast: "tuple[Locator, ...]" = ()) -> None:
        self.unicast = unicast
        self.multicast = multicast

    def emit(self, little: bool = True) -> bytes:
        """An INFO_REPLY."""
        body = locator.emit_list(self.unicast, little)
        flags = FLAG_E if little else 0
        if self.multicast:
            flags |= FLAG_M
            body += locator.emit_list(self.multicast, little)
        return bytes(_HEADER.emit(little, INFO_REPLY, flags, len(body))) + body

    def emit_ip4(self, little: bool = True) -> bytes:
        """An INFO_REPLY_IP4 of the first unicast and the first multicast locator."""
        flags = (FLAG_M if self.multicast else 0) | (FLAG_E if little else 0)
        pairs = self.unicast[:1] + self.multicast[:1]
        data = _HEADER.emit(little, INFO_REPLY_IP4, flags, 8 * len(pairs))
        for one in pairs:
            pair = bytearray(8)
            _EMIT_PAIR[1 if little else 0](pair, 0, int.from_bytes(one.address[12:], "big"), one.port)
            data.extend(pair)
        return bytes(data)


def parse(data: memoryview, at: int, end: int, flags: int) -> InfoReply:
    """The INFO_REPLY in data[at:end]. Raises ProtocolError: locator-list-truncated, too-many-locators."""
    unicast, at = locator.parse_list(data, at, end, flags)
    multicast: tuple[Locator, ...] = ()
    if flags & FLAG_M:
        multicast, at = locator.parse_list(data, at, end, flags)
    return InfoReply(unicast, multicast)


def parse_ip4(data: memoryview, at: int, end: int, flags: int) -> InfoReply:
    """The INFO_REPLY_IP4 in data[at:end]. Raises ProtocolError info-reply-ip4-truncated."""
    count = 2 if flags & FLAG_M else 1
    if end - at < 8 * count:
        raise truncated(INFO_REPLY_IP4, end - at, 8 * count)
    found = []
    for index in range(count):
        address, port = _PAIR[flags & 1](data, at + 8 * index)
        found.append(locator.udp4(address.to_bytes(4, "big"), port))
    return InfoReply((found[0],), tuple(found[1:]))
