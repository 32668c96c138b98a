"""Time_t and Duration_t: seconds and a fraction in units of 2**-32 s. RTPS 2.3, 9.3.2.

Here both are int nanoseconds; converting to the wire and back loses nothing.
"""

from roslet.wire.primitives import packer, unpacker

INFINITE = 0x7FFFFFFF * 1000000000 + 999999999
"""DURATION_INFINITE, and every longer duration."""

_PARSE = (unpacker(">II"), unpacker("<II"))
_PARSE_DURATION = (unpacker(">iI"), unpacker("<iI"))
_EMIT = (packer(">II"), packer("<II"))


def split(nanoseconds: int) -> "tuple[int, int]":
    """(seconds modulo 2**32, fraction) of a time."""
    seconds = nanoseconds // 1000000000
    # Rounded up, so that the way back, rounded down, is exact.
    return seconds & 0xFFFFFFFF, (((nanoseconds - seconds * 1000000000) << 32) + 999999999) // 1000000000


def fraction_of(nanoseconds: int) -> int:
    """The second of the two that `split` gives."""
    return ((nanoseconds % 1000000000 << 32) + 999999999) // 1000000000


def join(seconds: int, fraction: int) -> int:
    """Nanoseconds of both parts."""
    return seconds * 1000000000 + (fraction * 1000000000 >> 32)


def parse_duration(data: "bytes | bytearray | memoryview", at: int, flags: int) -> int:
    """Nanoseconds of a Duration_t; DURATION_INFINITE is INFINITE."""
    seconds, fraction = _PARSE_DURATION[flags & 1](data, at)
    return INFINITE if seconds == 0x7FFFFFFF else join(seconds, fraction)


def emit_duration(nanoseconds: int, little: bool = True) -> bytes:
    """Eight octets."""
    seconds, fraction = (0x7FFFFFFF, 0xFFFFFFFF) if nanoseconds >= INFINITE else split(nanoseconds)
    data = bytearray(8)
    _EMIT[1 if little else 0](data, 0, seconds, fraction)
    return bytes(data)
