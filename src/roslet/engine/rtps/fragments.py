"""Samples larger than a datagram: put together within bounds. RTPS 2.3, 8.4.14.1."""

from roslet.wire.rtps import number_set

TYPE_CHECKING = False
if TYPE_CHECKING:
    from roslet.wire.rtps.data_frag import DataFrag
    from roslet.wire.rtps.number_set import NumberSet


class Budget:
    """Octets that all peers share; no participant takes more than `share` of them."""

    def __init__(self, size: int, share: int) -> None:
        self.left = size
        self.share = share
        self._taken: dict[bytes, int] = {}

    def take(self, prefix: bytes, size: int) -> bool:
        """For this participant; false where that is too much."""
        taken = self._taken.get(prefix, 0) + size
        if size > self.left or taken > self.share:
            return False
        self.left -= size
        if taken:
            self._taken[prefix] = taken
        return True

    def give(self, prefix: bytes, size: int) -> None:
        """Back."""
        self.left += size
        taken = self._taken.get(prefix, 0) - size
        if taken:
            self._taken[prefix] = taken
        else:
            # Samples of no octets may have left nothing here.
            self._taken.pop(prefix, None)


def cost(size: int, fragment_size: int) -> int:
    """Octets that an Assembly of such a sample takes: the sample, and one for each fragment."""
    return size + (size + fragment_size - 1) // fragment_size


class Assembly:
    """One sample in the making. Fragments may come in any order, again, and several a submessage."""

    def __init__(self, fragment: "DataFrag", time: "int | None") -> None:
        self.size = fragment.sample_size
        self.fragment_size = fragment.fragment_size
        self.count = (self.size + self.fragment_size - 1) // self.fragment_size
        self.data = bytearray(self.size)
        self.have = bytearray(self.count)
        self.left = self.count
        self.asked = False  # whether the writer wants to hear how far we are
        self.told = 0  # the writer said to have sent the fragments up to this one
        self.lowest = 0  # no fragment below this is missing
        self.inline_qos = bytes(fragment.inline_qos)
        self.little = fragment.little
        self.flags = fragment.flags
        self.time = time

    def add(self, fragment: "DataFrag") -> bool:
        """Take what is new; False where the fragment belongs to another division of the sample."""
        if fragment.sample_size != self.size or fragment.fragment_size != self.fragment_size:
            return False
        size = self.fragment_size
        payload = fragment.payload
        for index in range(fragment.count):
            number = fragment.first - 1 + index
            if not self.have[number]:
                self.have[number] = 1
                self.left -= 1
                part = payload[index * size : (index + 1) * size]
                self.data[number * size : number * size + len(part)] = part
        return True

    def missing(self, last: int) -> "NumberSet":
        """Up to 256 missing fragments, from the first on, of those up to `last` (counted from 1)."""
        last = min(last, self.count)
        while self.lowest < self.count and self.have[self.lowest]:
            self.lowest += 1
        wanted = []
        for number in range(self.lowest, min(last, self.lowest + number_set.MAX_BITS)):
            if not self.have[number]:
                wanted.append(number + 1)
        return number_set.of(self.lowest + 1, wanted)
