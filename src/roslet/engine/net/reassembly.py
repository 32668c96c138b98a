"""Datagrams from their fragments, within bounds. RFC 791, 3.2; RFC 815; RFC 1122, 3.3.2.

Fragments may come in any order, and again. Fragments that overlap are of no honest sender: they end their datagram.
"""

from roslet.wire.net.ipv4 import SIZE, Packet

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable

    from roslet.engine.net.limits import Limits

    Key = tuple[bytes, bytes, int, int]

# Seconds for the whole of a datagram. RFC 1122 asks for 60 to 120, for a slower world; Linux takes 30.
TIMEOUT = 30.0


class Assembly:
    """One datagram in the making. `parts`: offset -> octets; `size`: of the whole, where the last one was there."""

    __slots__ = ("bytes", "parts", "size", "until")

    def __init__(self, until: float) -> None:
        self.parts: dict[int, bytes] = {}
        self.bytes = 0
        self.size: int | None = None
        self.until = until


class Reassembly:
    """`count` counts a reason. A call looks at no more than `limits.fragments` parts, or `limits.assemblies` datagrams."""

    def __init__(self, limits: "Limits", count: "Callable[[str], None]") -> None:
        self._limits = limits
        self._count = count
        self._bytes = 0
        self.pending: dict[Key, Assembly] = {}

    def add(self, packet: Packet, now: float) -> "Packet | None":
        """Take a fragment; the datagram where that was the last that was missing."""
        key = (packet.source, packet.destination, packet.protocol, packet.identification)
        found = self.pending.get(key)
        if found is None:
            if len(self.pending) >= self._limits.assemblies:
                self._count("assemblies-full")
                self._drop(min(self.pending, key=lambda one: self.pending[one].until))
            found = self.pending[key] = Assembly(now + TIMEOUT)
        start, end = packet.offset, packet.offset + len(packet.payload)
        part = found.parts.get(start)
        if part is not None and len(part) == end - start:
            self._count("fragment-repeated")
            return None
        reason = self._refused(found, start, end, packet.more)
        if reason:
            self._count(reason)
            self._drop(key)
            return None
        found.parts[start] = bytes(packet.payload)
        found.bytes += end - start
        self._bytes += end - start
        if not packet.more:
            found.size = end
        if found.bytes != found.size:
            return None
        self._drop(key)
        payload = b"".join([found.parts[at] for at in sorted(found.parts)])
        return packet.replace(payload=payload, offset=0, more=False)

    def _refused(self, found: Assembly, start: int, end: int, more: bool) -> str:
        """Why a fragment ends its datagram; empty where it does not."""
        for at, part in found.parts.items():
            if start < at + len(part) and at < end:
                return "fragment-overlaps"
        if found.size is not None and (not more or end > found.size):
            return "fragment-beyond-last"
        if not more and found.parts and max(found.parts) > start:
            return "fragment-beyond-last"
        if end > 0xFFFF - SIZE:
            return "datagram-too-long"
        if len(found.parts) >= self._limits.fragments:
            return "fragments-full"
        if self._bytes + end - start > self._limits.assembly_bytes:
            return "assembly-bytes-full"
        return ""

    def _drop(self, key: "Key") -> None:
        self._bytes -= self.pending.pop(key).bytes

    def deadline(self) -> "float | None":
        """When the oldest datagram is given up."""
        return min([found.until for found in self.pending.values()]) if self.pending else None

    def handle_deadline(self, now: float) -> None:
        """Give up what did not come in time."""
        for key in [key for key, found in self.pending.items() if found.until <= now]:
            self._count("assembly-expired")
            self._drop(key)
