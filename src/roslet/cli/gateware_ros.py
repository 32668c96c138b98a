"""A software participant on a simulated wire, and what `roslet gateware sim topic-pub-sub` has it do."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

from roslet.cli.gateware_sim import HOST, HOST_MAC, PREFIX, Session
from roslet.engine.net.host import Host
from roslet.engine.rtps import events
from roslet.engine.rtps.participant import Participant
from roslet.sim.wire import HostStation, Station
from roslet.wire.rtps import guid, locator, qos
from roslet.wire.rtps.qos import Qos

if TYPE_CHECKING:
    from roslet.sim.link import Link

PUBLISHED, SUBSCRIBED, TYPE = "rt/bbb", "rt/aaa", "std_msgs::msg::dds_::String_"
QOS = Qos((qos.RELIABLE, qos.DEFAULT_BLOCKING), history=(qos.KEEP_LAST, 10))  # as rclpy has it
DOMAIN, NUMBER = 0, 0


class ParticipantStation(Station):
    """An RTPS participant on a software host: what a shell of sockets is elsewhere."""

    def __init__(self, link: Link) -> None:
        self.station = HostStation(Host(HOST_MAC, f"{HOST}/{PREFIX}"), link)
        self.link = link
        ports = locator.metatraffic_unicast_port(DOMAIN, NUMBER), locator.user_unicast_port(DOMAIN, NUMBER)
        group = ".".join(map(str, locator.SPDP_MULTICAST_ADDRESS)), locator.metatraffic_multicast_port(DOMAIN)
        self._endpoints = [self.station.host.open(port) for port in (*ports, group[1])]
        self._endpoints[2].join(group[0], 0.0)
        prefix = guid.VENDORID_ROSLET + bytes.fromhex(HOST_MAC.replace(":", "")) + bytes(4)
        here = [(locator.udp4(HOST, port),) for port in ports]
        self.participant = Participant(prefix, DOMAIN, here[0], here[1], (group,))
        self.participant.start(0.0)

    def exchange(self, now: float) -> None:
        self.station.exchange(now)
        for endpoint in self._endpoints:
            while (found := endpoint.receive()) is not None:
                self.participant.receive_datagram(found[0], found[1], now)
        self.participant.handle_deadline(now)
        for parts, addresses in self.participant.datagrams_to_send(now):
            for address in addresses:
                self._endpoints[0].send(b"".join(parts), address, now)
        self.station.exchange(now)

    def deadline(self) -> float | None:
        times = (self.participant.deadline(), self.station.deadline())
        return min((at for at in times if at is not None), default=None)


class RosSession(Session):
    """The node has a software participant for company, which prints what it publishes on /bbb, and publishes on /aaa."""

    def _add_host(self) -> None:
        self.counts = {"messages": 0, "frames": 0}
        station = ParticipantStation(self.wire.hub.port())
        self.wire.add(station)
        self._participant = station.participant
        self._participant.create_reader(PUBLISHED, TYPE, QOS, self.wire.now)
        self._writer: Any = self._participant.create_writer(SUBSCRIBED, TYPE, QOS, self.wire.now)
        self._texts = itertools.cycle(("", "a", "short", "ten octets", "fifteen octets!"))
        self._matched = False

    def _hear(self) -> None:
        if self._tap:
            return
        while (event := self._participant.next_event()) is not None:
            if isinstance(event, events.ParticipantDiscovered):
                self._tell(
                    f"found a participant, {event.data.guid[:12].hex('.')}", found=event.data.guid.hex()
                )
            elif isinstance(event, events.EndpointMatched):
                self._matched = True
                self._tell(
                    f"{event.data.topic[2:]} matches, of type {event.data.type_name}",
                    matched=event.data.topic,
                )
            elif isinstance(event, events.SampleReceived):
                payload = bytes(event.payload)
                text = payload[8 : 8 + int.from_bytes(payload[4:8], "little") - 1].decode("utf-8", "replace")
                self.counts["messages"] += 1
                self._tell(f"/bbb  {text!r}", received=text)

    def _ask(self) -> None:
        if self._tap or not self._matched:
            return
        text = next(self._texts)
        octets = text.encode() + b"\0"
        padding = -len(octets) % 4
        payload = bytes((0, 1, 0, padding)) + len(octets).to_bytes(4, "little") + octets + bytes(padding)
        self._writer.write(payload, self.wire.now)
        self._tell(f"/aaa  {text!r} published", sent=text)
