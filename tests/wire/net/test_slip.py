"""SLIP, with octets from RFC 1055."""

import pytest

from roslet.wire.net.slip import Decoder, emit

pytestmark = pytest.mark.micropython

# RFC 1055: "END is octal 300 (decimal 192) and ESC is octal 333 (decimal 219)"; what follows ESC is "octal 334 (decimal
# 220)" for END and "octal 335 (decimal 221)" for ESC.
BY_HAND = [
    (b"\x01\x02", bytes([192, 1, 2, 192])),
    (bytes([192]), bytes([192, 219, 220, 192])),
    (bytes([219]), bytes([192, 219, 221, 192])),
    (bytes([219, 220, 192, 221]), bytes([192, 219, 221, 220, 219, 220, 221, 192])),
]


class Line:
    """A decoder and what it counted."""

    def __init__(self, max_size: int = 1500) -> None:
        self.counted: list[str] = []
        self.decoder = Decoder(max_size, self.counted.append)

    def take(self, data: bytes) -> "list[bytes]":
        return self.decoder.receive_data(data)


def noise(count: int, seed: int) -> bytes:
    """The same on every interpreter."""
    found = bytearray()
    for _ in range(count):
        seed = (seed * 1664525 + 1013904223) % (1 << 32)
        found.append(seed >> 24)
    return bytes(found)


def test_octets_are_those_of_the_rfc() -> None:
    for packet, octets in BY_HAND:
        assert emit(packet) == octets
        assert Line().take(octets) == [packet]


def test_pieces_of_any_size_give_the_same_packets() -> None:
    packets = [packet for packet, _ in BY_HAND] + [bytes(range(256)) * 5]
    stream = b"".join([emit(packet) for packet in packets])
    for size in (1, 2, 3, 7, len(stream)):
        line = Line()
        got = []
        for at in range(0, len(stream), size):
            got += line.take(stream[at : at + size])
        assert got == packets and line.counted == []


def test_a_packet_without_the_first_end_is_taken_and_empty_ones_are_not() -> None:
    line = Line()
    assert line.take(b"\xc0\xc0\xc0a\xc0b\xc0\xc0") == [b"a", b"b"]
    assert line.counted == []


def test_noise_before_a_packet_is_ended_by_its_first_end() -> None:
    line = Line()
    assert line.take(b"noise" + emit(b"packet")) == [b"noise", b"packet"]


def test_a_wrong_escape_drops_its_packet_and_no_other() -> None:
    for wrong in (b"a\xdbb", b"\xdb", b"a\xdb", b"\xdb\xdb\xdc", b"\xdb" * 700, b"\xdb\xdc\xdb\xff"):
        line = Line()
        assert line.take(emit(b"one") + wrong + emit(b"two")) == [b"one", b"two"]
        assert line.counted == ["slip-escape"], wrong


def test_the_longest_packet_passes_and_one_octet_more_does_not() -> None:
    for octet in (b"x", b"\xc0", b"\xdb"):
        line = Line(100)
        assert line.take(emit(octet * 100)) == [octet * 100]
        assert line.take(emit(octet * 101)) == []
        assert line.take(emit(b"next")) == [b"next"]
        assert line.counted == ["slip-too-long"]


def test_an_endless_packet_is_dropped_once_and_held_within_bounds() -> None:
    line = Line(100)
    for octet in (b"x", b"\xdb"):
        for _ in range(1000):
            assert line.take(octet * 33) == []
            assert len(line.decoder._held) <= 200
        assert line.take(emit(b"alive")) == [b"alive"]
    assert line.counted == ["slip-too-long", "slip-too-long"]


def test_after_ten_thousand_octets_of_noise_packets_pass() -> None:
    for seed in range(5):
        line = Line(64)
        for packet in line.take(noise(10000, seed)):
            assert 0 < len(packet) <= 64
        assert "slip-escape" in line.counted and "slip-too-long" in line.counted
        assert line.take(emit(b"alive"))[-1:] == [b"alive"]


def test_a_limit_below_one_is_refused() -> None:
    with pytest.raises(ValueError):
        Decoder(0, print)
