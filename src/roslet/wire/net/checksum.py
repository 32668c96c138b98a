"""The checksum of the Internet protocols. RFC 1071.

The ones' complement sum of 16-bit words is a sum modulo 65535, in which a multiple of it stays 65535 unless all is zero.
"""

_MODULUS = 0xFFFF


def total(data: "bytes | bytearray | memoryview", start: int = 0) -> int:
    """The ones' complement sum of `start` and the words of `data`; an odd last octet is the upper half of its word.

    It is 0xFFFF over data with a right checksum in it.
    """
    number = int.from_bytes(data, "big")
    if len(data) & 1:
        number <<= 8
    number += start
    return number % _MODULUS or (_MODULUS if number else 0)


def checksum(data: "bytes | bytearray | memoryview", start: int = 0) -> int:
    """What a checksum field gets: the complement of the sum over everything else."""
    return total(data, start) ^ _MODULUS
