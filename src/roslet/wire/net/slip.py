"""IP packets on a serial line: SLIP. RFC 1055.

A packet is its octets and then END. END and ESC within it are two octets each. END before a packet as well ends what noise
may have begun; the empty packet that this makes where there was none is no packet.
"""

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable

# RFC 1055, "Protocol", where they are octal: 300, 333, 334, 335.
END = 0xC0
ESC = 0xDB
ESC_END = 0xDC
ESC_ESC = 0xDD

_END, _ESC = b"\xc0", b"\xdb"
_ESCAPED_END, _ESCAPED_ESC = b"\xdb\xdc", b"\xdb\xdd"


def emit(packet: "bytes | bytearray | memoryview") -> bytes:
    """A packet as it goes over the line, with END on both sides."""
    return _END + bytes(packet).replace(_ESC, _ESCAPED_ESC).replace(_END, _ESCAPED_END) + _END


class Decoder:
    """Packets out of octets that come in pieces of any size. Nothing that comes makes it raise.

    `max_size`: octets of a packet that is taken. `count(reason)` hears once of each packet that is dropped: "slip-escape",
    one with an ESC that neither ESC_END nor ESC_ESC follows, as noise has it; "slip-too-long". After either the next END
    begins anew. Holds at most twice `max_size` octets.
    """

    def __init__(self, max_size: int, count: "Callable[[str], None]") -> None:
        if max_size < 1:
            raise ValueError("a packet has at least one octet, so no limit is %d" % max_size)
        self._max_size = max_size
        self._count = count
        self._held = bytearray()  # of the packet at hand, as it came
        self._dropping = False

    def receive_data(self, data: "bytes | bytearray | memoryview") -> "list[bytes]":
        """The packets that are whole now."""
        found = []
        pieces = bytes(data).split(_END)
        for number, piece in enumerate(pieces):
            if not self._dropping:
                self._take(piece)
            if number < len(pieces) - 1:
                packet = self._end()
                if packet:
                    found.append(packet)
        return found

    def _take(self, piece: bytes) -> None:
        if len(self._held) + len(piece) > 2 * self._max_size:
            self._drop("slip-too-long")
        else:
            self._held.extend(piece)

    def _end(self) -> bytes:
        """The packet at hand; empty where it was dropped, or there is none."""
        if self._dropping:
            self._dropping = False
            return b""
        parts = bytes(self._held).split(_ESC)
        self._held = bytearray()
        found = bytearray(parts[0])
        for part in parts[1:]:
            if not part or part[0] not in (ESC_END, ESC_ESC):
                self._count("slip-escape")
                return b""
            found.append(END if part[0] == ESC_END else ESC)
            found.extend(part[1:])
        if len(found) > self._max_size:
            self._count("slip-too-long")
            return b""
        return bytes(found)

    def _drop(self, reason: str) -> None:
        self._held = bytearray()
        self._dropping = True
        self._count(reason)
