"""A software participant on a simulated wire, and what `roslet gateware sim` has it do with each example that is a ROS 2
node."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any, ClassVar

from roslet.cli.gateware_sim import CLOCK, HOST, HOST_MAC, PREFIX, Session
from roslet.engine.net.host import Host
from roslet.engine.net.slip_host import SlipHost
from roslet.engine.rtps import events
from roslet.engine.rtps.participant import Participant
from roslet.gen.runtime import message_class
from roslet.names.ros2 import TOPIC, dds_topic, dds_type
from roslet.sim.uart import Uart
from roslet.sim.wire import HostStation, SlipStation, Station
from roslet.wire.rtps import guid, locator, qos
from roslet.wire.rtps.qos import Qos

if TYPE_CHECKING:
    import argparse

    from roslet.sim.link import Link
    from roslet.sim.wire import DesignStation
    from roslet.wire.message import Message

QOS = Qos((qos.RELIABLE, qos.DEFAULT_BLOCKING), history=(qos.KEEP_LAST, 10))  # as rclpy has it
DOMAIN, NUMBER = 0, 0


class ParticipantStation(Station):
    """An RTPS participant on a software host: what a shell of sockets is elsewhere. `serial`: on a serial line."""

    def __init__(self, link: Link, serial: bool = False) -> None:
        address = f"{HOST}/{PREFIX}"
        self.station = (
            SlipStation(SlipHost(address), link) if serial else HostStation(Host(HOST_MAC, address), link)
        )
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
    """The node has a software participant for company, which tells what the node publishes, and publishes itself."""

    PUBLISHED: ClassVar[tuple[str, str]]
    """The node's topic, and its type."""
    SUBSCRIBED: ClassVar[tuple[str, str]]

    def _add_host(self) -> None:
        self.counts = {"sent": 0, "received": 0, "frames": 0}
        station = ParticipantStation(self.wire.hub.port(), self.SERIAL)
        self.wire.add(station)
        self._participant = station.participant
        self._heard, self._said = (
            message_class("ros2", kind) for _, kind in (self.PUBLISHED, self.SUBSCRIBED)
        )
        for endpoint, (topic, kind) in (("reader", self.PUBLISHED), ("writer", self.SUBSCRIBED)):
            create = getattr(self._participant, f"create_{endpoint}")
            made: Any = create(dds_topic(TOPIC, topic), dds_type(kind), QOS, self.wire.now)
        self._writer = made
        self._matched = False

    def _hear(self) -> None:
        if self._outside:
            return
        while (event := self._participant.next_event()) is not None:
            if isinstance(event, events.ParticipantDiscovered):
                self._tell(
                    f"found a participant, {event.data.guid[:12].hex('.')}", found=event.data.guid.hex()
                )
            elif isinstance(event, events.EndpointMatched):
                self._matched |= event.data.topic == dds_topic(TOPIC, self.SUBSCRIBED[0])
                self._tell(
                    f"{event.data.topic[2:]} matches, of type {event.data.type_name}",
                    matched=event.data.topic,
                )
            elif isinstance(event, events.SampleReceived):
                self.counts["received"] += 1
                self._show(self._heard.deserialize(event.payload))

    def _ask(self) -> None:
        if self._outside or not self._matched:
            return
        message = self._next()
        self._writer.write(message.serialize(), self.wire.now)
        self.counts["sent"] += 1

    def _show(self, message: Any) -> None:
        """Tell of a message that the node published."""
        raise NotImplementedError

    def _next(self) -> Message:
        """What is published now, of which this tells."""
        raise NotImplementedError


class TextSession(RosSession):
    """Texts both ways."""

    PUBLISHED = ("/bbb", "std_msgs/msg/String")
    SUBSCRIBED = ("/aaa", "std_msgs/msg/String")
    _texts = itertools.cycle(("", "a", "short", "ten octets", "fifteen octets!"))

    def _show(self, message: Any) -> None:
        self._tell(f"/bbb  {message.data!r}", received=message.data)

    def _next(self) -> Message:
        text = next(self._texts)
        self._tell(f"/aaa  {text!r} published", sent=text)
        return self._said(data=text)  # type: ignore[call-arg]


class EchoSession(RosSession):
    """Coordinates, each of which comes back, and how long that took."""

    PUBLISHED = ("/pong", "mros_comm_measure/msg/Coordinate")
    SUBSCRIBED = ("/ping", "mros_comm_measure/msg/Coordinate")

    def _add_host(self) -> None:
        super()._add_host()
        self.counts["altered"] = 0
        self._pending: dict[float, tuple[Message, float]] = {}

    def _show(self, message: Any) -> None:
        sent, since = self._pending.pop(message.x, (None, self.wire.now))
        self.counts["altered"] += sent != message
        own = (self.wire.now - since) / self.wire.factor
        self._tell(
            f"/pong  {message.x:g} {message.y:g} {message.z:g}, after {own * 1e6:.1f} us of the design's time",
            received=[message.x, message.y, message.z],
            seconds=own,
        )

    def _next(self) -> Message:
        number = float(self.counts["sent"] + 1)
        message = self._said(x=number, y=number / 4, z=-number)  # type: ignore[call-arg]
        self._pending[number] = (message, self.wire.now)
        self._tell(
            f"/ping  {number:g} {number / 4:g} {-number:g} published", sent=[number, number / 4, -number]
        )
        return message


class ImuSession(RosSession):
    """Measurements of a sensor that counts, and a velocity that is zero every other time."""

    RATE = 1000.0
    PUBLISHED = ("/imu", "sensor_msgs/msg/Imu")
    SUBSCRIBED = ("/cmd_vel", "geometry_msgs/msg/Twist")

    def _show(self, message: Any) -> None:
        turn, force = message.angular_velocity.z, message.linear_acceleration.z
        self._tell(
            f"/imu  {message.header.frame_id}  turns at {turn:.9f} rad/s, accelerates by {force:.9f} m/s2",
            received=[message.header.frame_id, turn, force],
        )

    def _next(self) -> Message:
        message: Any = self._said()
        message.linear.x = 0.5 * (self.counts["sent"] % 2 == 0)
        self._tell(f"/cmd_vel  {message.linear.x:g} m/s published", sent=message.linear.x)
        return message  # type: ignore[no-any-return]


class CountSession(RosSession):
    """Over a serial line: numbers that count, and now and then one to go on from. A bit takes 8 cycles, the fewest."""

    SERIAL = True
    DIVISOR = 8
    PUBLISHED = ("/count", "std_msgs/msg/UInt32")
    SUBSCRIBED = ("/preset", "std_msgs/msg/UInt32")
    _turns = itertools.cycle((True, False, False, False))

    @classmethod
    def options(cls, factor: float) -> dict[str, float]:
        return {"baud": CLOCK / factor / cls.DIVISOR}

    def _add_host(self) -> None:
        super()._add_host()
        del self.counts["frames"]

    def _plug(self, arguments: argparse.Namespace) -> DesignStation:
        self.counts = {}
        uart = Uart(self._model, CLOCK / self.DIVISOR)
        if not arguments.pty:
            return self.wire.serial(self._model, uart)
        from roslet.sim.pty import Pty

        pty = Pty()
        station = self.wire.serial(self._model, uart, pty)
        network = f"ros2://{DOMAIN}?slip={pty.path}&address={HOST}/{PREFIX}"
        self._tell(f"the line is {pty.path}: --network '{network}'", pty=pty.path, network=network)
        return station

    def _ask(self) -> None:
        if next(self._turns):
            super()._ask()

    def _show(self, message: Any) -> None:
        self._tell(f"/count  {message.data}", received=message.data)

    def _next(self) -> Message:
        number = 1000 * (self.counts["sent"] + 1)
        self._tell(f"/preset  {number} published", sent=number)
        return self._said(data=number)  # type: ignore[call-arg]


SESSIONS: dict[str, type[RosSession]] = {
    "topic-pub-sub": TextSession,
    "typed-echo": EchoSession,
    "imu-node": ImuSession,
    "serial-count": CountSession,
}
