"""Hosts at the two ends of a serial line: what is on it, what is taken, and noise."""

import pytest

from roslet.engine.net.events import EchoReplied
from roslet.engine.net.limits import Limits
from roslet.engine.net.slip_host import SlipHost
from roslet.wire.net import ipv4, slip
from roslet.wire.net.ipv4 import Packet
from roslet.wire.net.udp import Datagram

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

pytestmark = pytest.mark.micropython

A, B = bytes([10, 0, 0, 1]), bytes([10, 0, 0, 2])
GROUP = "239.255.0.1"


def two(**fields: "Any") -> "tuple[SlipHost, SlipHost]":
    return SlipHost("10.0.0.1/24", seed=1, **fields), SlipHost("10.0.0.2/24", seed=2, **fields)


def carry(one: SlipHost, other: SlipHost, size: int = 7) -> None:
    """Octets in pieces, until both have nothing more to say."""
    for _ in range(10):
        for here, there in ((one, other), (other, one)):
            data = here.data_to_send(0.0)
            for at in range(0, len(data), size):
                there.receive_data(data[at : at + size], 0.0)


def to_a(text: bytes, destination: bytes = A) -> bytes:
    """A datagram for port 5, on the line."""
    return slip.emit(Packet(B, destination, ipv4.UDP, Datagram(6, 5, text).emit(B, destination)).emit())


def test_a_datagram_is_an_ip_packet_between_two_ends() -> None:
    one, _ = two()
    assert one.open(5).send(b"\xc0", ("10.0.0.2", 6), 0.0)
    line = one.data_to_send(0.0)
    assert line[:2] == b"\xc0\x45" and line[-3:] == b"\xdb\xdc\xc0" and line.count(b"\xc0") == 2
    assert line[13:21] == A + B
    assert one.data_to_send(0.0) == b""


def test_hosts_ping_each_other_and_exchange_datagrams_of_all_sizes() -> None:
    one, other = two()
    sequence = one.ping("10.0.0.2", 0.0, bytes(5000))
    here, there = one.open(5), other.open(6)
    texts = [bytes(size) for size in (0, 1, 1472, 1473, 9000)]
    for text in texts:
        here.send(text, ("10.0.0.2", 6), 0.0)
    carry(one, other, 100)
    event = one.next_event()
    assert isinstance(event, EchoReplied) and event.sequence == sequence
    for text in texts:
        assert there.receive() == (text, ("10.0.0.1", 5))
    assert one.counters == other.counters == {}


def test_everything_goes_over_the_line_another_network_and_broadcast_too() -> None:
    one, other = two()
    here = one.open(5)
    assert here.send(b"far", ("8.8.8.8", 6), 0.0) and here.send(b"all", ("10.0.0.255", 6), 0.0)
    there = other.open(6)
    carry(one, other)
    assert there.receive() == (b"all", ("10.0.0.1", 5)) and there.receive() is None
    assert other.counters == {"ipv4-not-for-us": 1}


def test_a_group_is_heard_by_who_has_joined_it_and_nobody_speaks_igmp() -> None:
    one, other = two()
    there = other.open(6)
    here = one.open(5)
    here.send(b"early", (GROUP, 6), 0.0)
    carry(one, other)
    there.join(GROUP, 0.0)
    assert other.data_to_send(0.0) == b""
    here.send(b"late", (GROUP, 6), 0.0)
    carry(one, other)
    assert there.receive() == (b"late", ("10.0.0.1", 5)) and there.receive() is None
    there.leave(GROUP)
    assert other.data_to_send(0.0) == b"" and other.counters == {"ipv4-not-for-us": 1}


def test_noise_and_endless_packets_are_counted_and_what_follows_is_taken() -> None:
    one, _ = two()
    here = one.open(5)
    damaged = bytearray(to_a(b"damaged"))
    damaged[13] ^= 1
    for line, reason in (
        (b"\xdb\xff\xc0", "slip-escape"),
        (bytes(2000) + b"\xc0", "slip-too-long"),
        (b"\xc0abc\xc0", "ipv4-truncated"),
        (bytes(damaged), "ipv4-checksum"),
        (to_a(b"other", bytes([10, 0, 0, 9])), "ipv4-not-for-us"),
    ):
        one.counters.clear()
        one.receive_data(line, 0.0)
        assert one.counters == {reason: 1}
        one.receive_data(to_a(b"alive"), 0.0)
        assert here.receive() == (b"alive", ("10.0.0.2", 6))


def test_what_waits_for_a_slow_line_is_bounded() -> None:
    one, _ = two(limits=Limits(frames=3))
    here = one.open(5)
    for _ in range(5):
        here.send(b"x", ("10.0.0.2", 6), 0.0)
    assert one.counters == {"frames-full": 2} and len(one.frames_to_send(0.0)) == 3
