"""A node in gates on a serial line: software at the other end of a pseudo-terminal, and whatever else the line may bring."""

from __future__ import annotations

import random
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pytest
from scapy.layers.inet import ICMP, IP, UDP, fragment
from scapy.packet import Raw

import roslet
from gateware.tops.serial_node import ADDRESS, HOST, SerialNode
from roslet.cli.gateware_ros import QOS, ParticipantStation
from roslet.engine.rtps import events
from roslet.sim.link import Link
from roslet.sim.pty import Pty
from roslet.sim.wire import Wire
from roslet.wire.net.slip import Decoder, emit

TYPE = "std_msgs/msg/UInt32"
PATIENCE = 40.0
"""Seconds of the line: announcements come every three, and 2,500 octets take one."""

pytestmark = pytest.mark.timeout(300)


def network(pty: Pty) -> str:
    return f"ros2://0?slip={pty.path}&address={HOST}/24"


class Peer:
    """A software node on the line, whose callbacks run in a thread of its own."""

    def __init__(self, name: str, pty: Pty) -> None:
        self.node = roslet.Node(name, network=network(pty))
        self.counted: list[int] = []
        self.node.subscribe("count", TYPE, lambda message: self.counted.append(message.data))
        self.preset = self.node.publisher("preset", TYPE)
        self.node.start()

    def knows_it(self) -> bool:
        return "/serial_count" in self.node.nodes() and self.preset.subscriber_count == 1

    def close(self) -> None:
        self.node.close()


@contextmanager
def peer(name: str, pty: Pty, wire: Wire) -> Iterator[Peer]:
    found = Peer(name, pty)
    try:
        yield found
    finally:
        # Its last words need a line that lives.
        closing = threading.Thread(target=found.close)
        closing.start()
        wire.run(PATIENCE, lambda: not closing.is_alive())
        closing.join()


def talk(there: Peer, gates: SerialNode, preset: int) -> None:
    """All that two nodes that have found each other do."""
    run, counted = gates.wire.run, there.counted
    assert run(PATIENCE, there.knows_it), gates.drops()
    assert run(PATIENCE, lambda: len(counted) >= 3), gates.drops()
    assert there.node.nodes() == sorted((there.node.name, "/serial_count"))
    assert there.node.topics()["/count"] == TYPE
    assert counted == list(range(counted[0], counted[0] + len(counted))) and counted[-1] < preset
    there.preset.publish(data=preset)
    assert run(PATIENCE, lambda: counted[-1] >= preset + 2), gates.drops()
    assert [number for number in counted if number >= preset] == list(range(preset, counted[-1] + 1))


def test_a_node_of_software_finds_it_hears_it_tells_it_leaves_and_comes_back() -> None:
    pty, wire = Pty(), Wire(250.0, 1.0)
    with SerialNode(wire, pty) as gates:
        for turn, name in enumerate(("first", "second")):
            with peer(name, pty, wire) as there:
                talk(there, gates, 1_000_000 * (turn + 1))
            assert wire.run(PATIENCE, lambda: gates.model.get("node core alive") == 0), "it heard the goodbye"
        assert gates.station.faults == {}
        assert gates.drops() == {}


class Line:
    """The node and the test at the two ends of a line."""

    def __init__(self) -> None:
        self.wire = Wire(250.0)
        self.gates = SerialNode(self.wire)
        self.end: Link = self.wire.hub.port()
        self.octets = bytearray()

    def give(self, octets: bytes) -> None:
        self.end.send(octets, self.wire.now)

    def _hear(self) -> None:
        for octets in self.end.receive(self.wire.now):
            self.octets += octets

    def run(self, seconds: float, until: Callable[[], bool] = lambda: False) -> bool:
        def look() -> bool:
            self._hear()
            return until()

        return self.wire.run(seconds, look)

    def packets(self) -> list[bytes]:
        """What it sent since the start, taken apart."""
        return Decoder(1500, lambda reason: pytest.fail(reason)).receive_data(bytes(self.octets))

    def quiet(self) -> None:
        """Until all that was given has gone through the pin."""
        assert self.run(100.0, lambda: self.gates.uart.waiting == 0)
        self.run(1.0)


@pytest.fixture
def line() -> Iterator[Line]:
    found = Line()
    with found.gates:
        yield found


def ping(number: int, size: int = 56) -> bytes:
    return bytes(IP(src=HOST, dst=ADDRESS) / ICMP(id=7, seq=number) / Raw(bytes(size)))


def pongs(line: Line) -> list[int]:
    return [IP(packet)[ICMP].seq for packet in line.packets() if IP(packet).proto == 1]


def test_pings_of_the_size_that_ping_sends_are_answered_and_longer_ones_dropped(line: Line) -> None:
    line.give(emit(ping(1)) + emit(ping(2, 57)) + emit(ping(3)))
    assert line.run(5.0, lambda: pongs(line) == [1, 3])
    assert line.gates.drops() == {"icmp_size": 1}


def test_it_announces_itself_to_the_group_and_sends_nothing_else_alone(line: Line) -> None:
    line.run(10.0)
    sent = [IP(packet) for packet in line.packets()]
    assert 7 <= len(sent) <= 9, "after a second of silence five at once, then one every three seconds"
    assert {(one.src, one.dst, one[UDP].dport) for one in sent} == {(ADDRESS, "239.255.0.1", 7400)}
    assert {one[Raw].load[:4] for one in sent} == {b"RTPS"}


def test_what_is_wrong_is_dropped_by_name_and_what_comes_next_is_taken(line: Line) -> None:
    parts = fragment(IP(src=HOST, dst=ADDRESS) / UDP() / Raw(bytes(900)), fragsize=480)  # type: ignore[no-untyped-call]
    wrong = {
        "line_rx_escape": b"\xc0\x45\xdb\x01\xc0",
        "line_rx_too_long": b"\xc0" + b"\x45" * 1501 + b"\xc0",
        "groups_group": emit(bytes(IP(src=HOST, dst="239.255.0.2") / UDP() / Raw(b"x"))),
        "ipv4_version": emit(b"\x65" + ping(1)[1:]),
        "ipv4_checksum": emit(ping(1)[:10] + b"\xff" + ping(1)[11:]),
        "ipv4_address": emit(bytes(IP(src=HOST, dst="192.168.1.101") / ICMP())),
        "reassembly_none": emit(bytes(parts[0])),
        "protocol_protocol": emit(bytes(IP(src=HOST, dst=ADDRESS, proto=6) / Raw(bytes(20)))),
        "udp_port": emit(bytes(IP(src=HOST, dst=ADDRESS) / UDP(sport=1, dport=9) / Raw(b"x"))),
    }
    for number, octets in enumerate(wrong.values()):
        line.give(octets + emit(ping(number)))
        line.quiet()
    assert pongs(line) == list(range(len(wrong)))
    assert line.gates.drops() == dict.fromkeys(wrong, 1)


def test_a_peer_that_it_has_loses_nothing_by_noise_between_its_packets(line: Line) -> None:
    """Octets of any kind, RTPS that is not, and single bits turned, while a participant of software publishes and hears."""
    dice = random.Random(5)
    station = ParticipantStation(line.end, serial=True)
    line.wire.add(station)
    heard: list[int] = []
    matched: list[str] = []

    def look() -> bool:
        while (event := station.participant.next_event()) is not None:
            if isinstance(event, events.EndpointMatched):
                matched.append(event.data.topic)
            elif isinstance(event, events.SampleReceived):
                heard.append(int.from_bytes(event.payload[4:8], "little"))
        return len(matched) == 2

    def hears(least: int) -> bool:
        return line.wire.run(PATIENCE, lambda: look() and heard[-1:] >= [least])

    kind = "std_msgs::msg::dds_::UInt32_"
    station.participant.create_reader("rt/count", kind, QOS, 0.0)
    writer = station.participant.create_writer("rt/preset", kind, QOS, 0.0)
    assert line.wire.run(PATIENCE, look)
    udp = IP(src=HOST, dst=ADDRESS) / UDP(sport=7410, dport=7412)
    for turn in range(1, 11):
        damaged = bytearray(emit(ping(1)))
        damaged[dice.randrange(1, len(damaged) - 1)] ^= 1 << dice.randrange(8)
        rtps = emit(bytes(udp / Raw(b"RTPS\2\3" + dice.randbytes(80))))
        for noise in (dice.randbytes(200), bytes(damaged), rtps, b"\xdb" * 9):
            line.end.send(b"\xc0" + noise + b"\xc0", line.wire.now)
        line.wire.run(0.5, lambda: look() and False)
        writer.write(b"\0\1\0\0" + (1000 * turn).to_bytes(4, "little"), line.wire.now)
        assert hears(1000 * turn), turn
    drops = line.gates.drops()
    assert {"line_rx_escape", "ipv4_version"} <= set(drops), drops
    assert hears(heard[-1] + 3)
    assert sorted(heard) == heard and len(set(heard)) == len(heard)


def test_octets_of_any_kind_without_end_leave_it_alive(line: Line) -> None:
    dice = random.Random(7)
    for hostile in (dice.randbytes(3000), b"\xdb" * 1000, b"\xc0" * 3000, b"\xc0E" * 1000, bytes(3000)):
        line.give(hostile + b"\xc0")
        line.quiet()
    line.give(emit(ping(9)))
    assert line.run(5.0, lambda: pongs(line) == [9])
    assert {"line_rx_escape", "line_rx_too_long"} <= set(line.gates.drops())
    assert line.gates.station.faults == {}
