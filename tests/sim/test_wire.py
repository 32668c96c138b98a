"""Hosts and gateware on one wire, in simulated time and in that of the wall clock."""

from __future__ import annotations

import pathlib
import subprocess
import time

import pytest

import peers
from engine.rtps.network import GROUP, RELIABLE
from roslet.engine.net.endpoint import Endpoint
from roslet.engine.net.events import EchoReplied
from roslet.engine.net.host import Host
from roslet.engine.rtps import events
from roslet.engine.rtps.participant import Participant
from roslet.sim.link import Faults, Link
from roslet.sim.wire import HostStation, Station, Wire
from roslet.wire.rtps import locator
from sim.echo import plugged


def host(number: int) -> Host:
    return Host(f"02:00:00:00:00:{number:02x}", f"192.168.1.{number}/24", seed=number)


def test_hosts_ping_each_other_at_once_in_simulated_seconds() -> None:
    wire = Wire()
    one = wire.host(host(1)).host
    wire.host(host(2))
    sequence = one.ping("192.168.1.2", wire.now)
    began = time.monotonic()
    assert not wire.run(3600.0, until=lambda: wire.now < 0)
    assert time.monotonic() - began < 5.0 and wire.now == 3600.0
    event = one.next_event()
    assert isinstance(event, EchoReplied) and event.sequence == sequence
    assert event.seconds == pytest.approx(3e-6), "an announcement that serves as ARP's reply, and the echo"


def test_a_run_ends_when_what_is_waited_for_is_there() -> None:
    wire = Wire()
    one, other = wire.host(host(1)).host, wire.host(host(2)).host
    here, there = one.open(5), other.open(6)
    here.send(b"x", ("192.168.1.2", 6), wire.now)
    got: list[object] = []

    def arrived() -> bool:
        found = there.receive()
        if found is not None:
            got.append(found)
        return bool(got)

    assert wire.run(1.0, arrived)
    assert got == [(b"x", ("192.168.1.1", 5))] and wire.now < 1e-4


def test_pings_come_through_a_bad_cable_now_and_then() -> None:
    wire = Wire()
    bad = Faults(wire.hub.port(), seed=3, loss=0.1, bit_error=0.1, duplicate=0.1, reorder=0.1)
    one, other = wire.host(host(1), bad), wire.host(host(2))
    replies = 0
    for _ in range(100):
        one.host.ping("192.168.1.2", wire.now)
        wire.run(0.5)
        while (event := one.host.next_event()) is not None:
            replies += isinstance(event, EchoReplied)
    assert 40 < replies < 95
    assert one.damaged + other.damaged > 10 and not any("checksum" in reason for reason in one.host.counters)


def test_gateware_hears_and_is_heard_by_hosts() -> None:
    model, mii = plugged()
    with model:
        wire = Wire()
        gates = wire.gateware(model, mii)
        station = wire.host(host(1))
        station.host.open(5).send(b"x" * 100, ("192.168.1.255", 6), wire.now)
        assert wire.run(1e-3, until=lambda: model.get("frames") == 2)
        wire.run(1e-4)
        # The echo sends back the announcement and the datagram.
        assert station.host.counters == {"arp-from-ourselves": 1, "udp-port-closed": 1}
        assert gates.faults == {} and gates.dropped == 0
        assert model.now == pytest.approx(wire.now + 2e-7), "it ran for 200 ns before it was plugged in"


def test_damaged_frames_reach_pins_with_a_wrong_fcs() -> None:
    model, mii = plugged()
    with model:
        wire = Wire()
        bad = Faults(wire.hub.port(), seed=1, bit_error=1.0)
        gates = wire.gateware(model, mii, bad)
        wire.host(host(1))
        wire.run(1e-3, until=lambda: bool(gates.faults))
        assert gates.faults == {"fcs-wrong": 1}


def test_the_factor_maps_a_designs_time_to_that_of_the_wire() -> None:
    model, mii = plugged()
    with model:
        before = model.cycles("clk")
        wire = Wire(factor=250.0)
        wire.gateware(model, mii)
        wire.run(0.1)
        assert model.cycles("clk") - before == 0.1 * 50e6 / 250


def test_a_pace_keeps_to_the_wall_clock_without_work() -> None:
    wire = Wire(pace=2.0)
    wire.host(host(1))
    began, worked = time.monotonic(), time.process_time()
    wire.run(0.4)
    assert 0.2 <= time.monotonic() - began < 1.0
    assert time.process_time() - worked < 0.1
    assert wire.now == pytest.approx(0.4) and wire.lag < 0.1


def test_what_is_too_slow_for_its_pace_says_how_far_it_is_behind() -> None:
    model, mii = plugged()
    with model:
        wire = Wire(pace=1000.0)
        wire.gateware(model, mii)
        wire.run(0.02)
        assert wire.lag > 0.001


def test_factors_are_checked() -> None:
    for fields in ({"factor": 0.0}, {"pace": 0.0}, {"quantum": 0.0}):
        with pytest.raises(ValueError, match="factor, pace and quantum are above 0"):
            Wire(**fields)


def test_a_capture_of_a_wire_holds_nothing_malformed(tmp_path: pathlib.Path) -> None:
    wire = Wire()
    file = tmp_path / "wire.pcap"
    one, other = wire.host(host(1)).host, wire.host(host(2)).host
    with wire.capture(file) as capture:
        one.start(wire.now)
        other.open(6).join("239.255.0.1", wire.now)
        for size in (0, 1, 1472, 4000):
            one.ping("192.168.1.2", wire.now, bytes(size))
            one.open().send(bytes(size), ("192.168.1.2", 6), wire.now)
            wire.run(0.1)
        wire.run(10.0)
        other.endpoints[6].close()
        wire.run(0.1)
    assert capture.frames > 20
    program = str(peers.require("tshark"))
    checks = ["-o", "ip.check_checksum:TRUE", "-o", "udp.check_checksum:TRUE"]
    wanted = ("frame.protocols", "_ws.malformed", "_ws.expert.message")
    fields = ["-T", "fields", "-E", "separator=|", *(part for name in wanted for part in ("-e", name))]
    done = subprocess.run(
        [program, "-r", str(file), *checks, *fields], capture_output=True, text=True, timeout=60, check=True
    )
    lines = [line.split("|") for line in done.stdout.splitlines()]
    assert len(lines) == capture.frames
    protocols = {line[0] for line in lines}
    for protocol in ("arp", "ip:icmp", "ip:igmp", "ip:udp"):
        assert any(f"eth:ethertype:{protocol}" in one for one in protocols), protocol
    assert [line for line in lines if line[1]] == []
    told = {line[2] for line in lines if line[2]}
    assert not [one for one in told if "hecksum" in one or "alformed" in one], told


class ParticipantStation(Station):
    """An RTPS participant on the endpoints of a software host: what a shell of sockets is elsewhere."""

    def __init__(self, number: int, link: Link) -> None:
        self.station = HostStation(host(number), link)
        self.link = link
        address = self.station.host.address
        self.meta, self.user = self.station.host.open(7410), self.station.host.open(7411)
        self.group = self.station.host.open(GROUP[1])
        self.group.join(GROUP[0], 0.0)
        prefix = b"\x01\x52" + bytes(6) + number.to_bytes(4, "big")
        own = (locator.udp4(address, 7410),), (locator.udp4(address, 7411),)
        self.participant = Participant(prefix, 0, *own, (GROUP,))
        self.events: list[object] = []
        self.participant.start(0.0)

    def exchange(self, now: float) -> None:
        self.station.exchange(now)
        endpoint: Endpoint
        for endpoint in (self.meta, self.user, self.group):
            while (found := endpoint.receive()) is not None:
                self.participant.receive_datagram(found[0], found[1], now)
        self.participant.handle_deadline(now)
        for parts, addresses in self.participant.datagrams_to_send(now):
            for address in addresses:
                self.meta.send(b"".join(parts), address, now)
        while (event := self.participant.next_event()) is not None:
            self.events.append(event)
        self.station.exchange(now)

    def has(self, kind: type) -> bool:
        return any(isinstance(event, kind) for event in self.events)

    def deadline(self) -> float | None:
        times = (self.participant.deadline(), self.station.deadline())
        return min((at for at in times if at is not None), default=None)


def test_rtps_participants_find_each_other_and_exchange_samples_over_software_hosts() -> None:
    wire = Wire()
    one, other = (ParticipantStation(number, wire.hub.port()) for number in (1, 2))
    wire.add(one)
    wire.add(other)
    writer = one.participant.create_writer("rt/chatter", "std_msgs::msg::dds_::String_", RELIABLE, 0.0)
    other.participant.create_reader("rt/chatter", "std_msgs::msg::dds_::String_", RELIABLE, 0.0)
    assert wire.run(10.0, until=lambda: one.has(events.EndpointMatched))
    sample = b"\0\1\0\0\6\0\0\0hello\0" + bytes(20000)
    writer.write(sample, wire.now)
    assert wire.run(10.0, until=lambda: other.has(events.SampleReceived))
