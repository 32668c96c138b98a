"""SequenceNumberSet and FragmentNumberSet. RTPS 2.3, 8.3.5.5, 8.3.5.7 (meaning), 9.4.2.6, 9.4.2.8 (bytes).

base (8 octets, or 4 of a fragment number), numBits (4), then numBits / 32 rounded up words;
bit i, the highest of a word first, stands for the number base + i
"""

from roslet.errors import ProtocolError
from roslet.record import Record
from roslet.wire.primitives import packer, unpacker

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence

MAX_BITS = 256
MAX_NUMBER = (1 << 63) - 1
"""The last sequence number."""

_PARSE_LONG = (unpacker(">iII"), unpacker("<iII"))
_PARSE_SHORT = (unpacker(">II"), unpacker("<II"))
_PARSE_WORD = (unpacker(">I"), unpacker("<I"))
_EMIT_LONG = (packer(">iII"), packer("<iII"))
_EMIT_SHORT = (packer(">II"), packer("<II"))
_EMIT_WORD = (packer(">I"), packer("<I"))


class NumberSet(Record):
    """Numbers from `base` on: `words[i // 32]` has bit `31 - i % 32` set where `base + i` is in the set, i < `bits`."""

    _fields = ("base", "bits", "words")
    __slots__ = _fields

    def __init__(self, base: int, bits: int = 0, words: "tuple[int, ...]" = ()) -> None:
        self.base = base
        self.bits = bits
        self.words = words

    def numbers(self) -> "list[int]":
        """The members, in order; at most 256."""
        found = []
        for at in range(self.bits):
            if self.words[at >> 5] >> (31 - (at & 31)) & 1:
                found.append(self.base + at)
        return found

    def size(self, short: bool = False) -> int:
        """Octets of `emit`."""
        return (8 if short else 12) + 4 * len(self.words)

    def emit(self, little: bool = True, short: bool = False) -> bytearray:
        """The octets; `short` for a FragmentNumberSet."""
        order = 1 if little else 0
        data = bytearray(self.size(short))
        if short:
            _EMIT_SHORT[order](data, 0, self.base, self.bits)
            at = 8
        else:
            _EMIT_LONG[order](data, 0, self.base >> 32, self.base & 0xFFFFFFFF, self.bits)
            at = 12
        for word in self.words:
            _EMIT_WORD[order](data, at, word)
            at += 4
        return data


def of(base: int, numbers: "Sequence[int]") -> NumberSet:
    """The set of those numbers that lie in base .. base + 255; the others are left out."""
    if not numbers:
        return NumberSet(base)
    words = [0] * 8
    bits = 0
    for number in numbers:
        at = number - base
        if 0 <= at < MAX_BITS:
            words[at >> 5] |= 1 << (31 - (at & 31))
            bits = max(bits, at + 1)
    return NumberSet(base, bits, tuple(words[: (bits + 31) >> 5]))


def parse(
    data: "bytes | bytearray | memoryview", at: int, end: int, flags: int, short: bool = False
) -> "tuple[NumberSet, int]":
    """The set at `at` and the offset behind it. Bits beyond numBits are not looked at.

    A base below 1 is accepted only of an empty set: that is how peers ask a writer to make itself known.
    Raises ProtocolError: number-set-truncated, number-set-too-large, number-set-base-invalid.
    """
    order = flags & 1
    fixed = 8 if short else 12
    if end - at < fixed:
        raise ProtocolError("number-set-truncated", "%d bytes, needs %d" % (end - at, fixed))
    if short:
        base, bits = _PARSE_SHORT[order](data, at)
    else:
        high, low, bits = _PARSE_LONG[order](data, at)
        base = (high << 32) | low
    if bits > MAX_BITS:
        raise ProtocolError("number-set-too-large", "%d bits, at most %d are allowed" % (bits, MAX_BITS))
    if base < (1 if bits else 0):
        raise ProtocolError("number-set-base-invalid", "%d" % base)
    at += fixed
    count = (bits + 31) >> 5
    if not count:
        return NumberSet(base), at
    if end - at < 4 * count:
        raise ProtocolError("number-set-truncated", "%d bytes of bitmap, needs %d" % (end - at, 4 * count))
    word = _PARSE_WORD[order]
    words = tuple([word(data, at + 4 * index)[0] for index in range(count)])
    return NumberSet(base, bits, words), at + 4 * count
