"""A ROS 2 node in gates whose user gives and takes messages field by field."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from amaranth.hdl import ClockDomain, ClockSignal, DomainRenamer, Module
from amaranth.lib import stream, wiring
from amaranth.lib.cdc import ResetSynchronizer
from amaranth.lib.wiring import In, Out, connect, flipped

from roslet.gateware.rtps.tables import Local
from roslet.gateware.tops.ros_core import Identity, RosCore
from roslet.gateware.typed.deserializer import Deserializer
from roslet.gateware.typed.flat import Flat
from roslet.gateware.typed.serializer import Serializer
from roslet.gateware.wires import expose
from roslet.gen import runtime
from roslet.gen.gateware import Bounds, Plan, plan
from roslet.idl import Registry, type_hash
from roslet.names.ros2 import TOPIC, dds_topic, dds_type, expand

MAX_MESSAGE = 1400
"""Octets: what fits a datagram that needs no fragments, with RTPS around it."""


@dataclass(frozen=True)
class _Topic:
    """A topic of the node's, `topic`, with its type, by name.

    `bound` is for every string and sequence of it, `bounds` says more. `reliable` as rclpy has it by default.
    """

    topic: str
    type: str
    bound: int | None = None
    bounds: Bounds | None = None
    reliable: bool = True
    port: str = ""
    """The name of the port: that of the topic, if nothing is said, with _ for what is no letter or digit."""

    @property
    def port_name(self) -> str:
        return self.port or "".join(c if c.isalnum() else "_" for c in self.topic).strip("_")

    def plan(self, registry: Registry | None) -> Plan:
        """How its messages lie in bytes. Raises ValueError where they may be longer than MAX_MESSAGE."""
        made = plan(self.type, self.bounds or Bounds(self.bound, self.bound), registry)
        if made.maximum > MAX_MESSAGE:
            raise ValueError(
                f"{self.topic}: a {self.type} has up to {made.maximum} octets, and a message in gates {MAX_MESSAGE}"
            )
        return made


@dataclass(frozen=True)
class Publish(_Topic):
    """A topic that the node publishes. It keeps `depth` messages, a power of two, for readers that miss some."""

    depth: int = 1


@dataclass(frozen=True)
class Subscribe(_Topic):
    """A topic that the node subscribes to. One message waits until the user has taken it; a reliable publisher repeats what
    comes meanwhile, of another it is dropped and counted."""


class RosNode(wiring.Component):
    """The node `name` with these topics.

    `domain`, `mac`, `address` with its prefix length, and so on as `Identity` has them; what else `RosCore` takes may
    follow.

    Ports: those of `RosCore`'s pins, and for each topic one with its name: a stream of `message_layout`, in for those that
    are published, out for the others. With `flat` it is a port for each field (`Flat`; `texts` documents them), for Verilog.
    All is in the domain of `clk`.
    """

    def __init__(
        self,
        name: str,
        domain: int = 0,
        mac: str = "02:00:00:00:00:01",
        address: str = "192.168.1.100/24",
        topics: Sequence[Publish | Subscribe] = (),
        *,
        namespace: str = "/",
        gateway: str = "0.0.0.0",
        participant: int = 1,
        registry: Registry | None = None,
        flat: bool = False,
        **core: Any,
    ) -> None:
        self.topics = list(topics)
        names = [topic.port_name for topic in topics]
        for one in names:
            if names.count(one) > 1 or not one.isidentifier():
                raise ValueError(f"the ports of topics have names of their own, not {one!r}")
        identity = Identity(name, namespace, domain, participant, mac, address, gateway)
        self._plans = {topic.port_name: topic.plan(registry) for topic in topics}
        self._publishers = [topic for topic in topics if isinstance(topic, Publish)]
        self._subscribers = [topic for topic in topics if isinstance(topic, Subscribe)]

        def local(topic: Publish | Subscribe) -> Local:
            return Local(
                dds_topic(TOPIC, expand(topic.topic, name, namespace)),
                dds_type(topic.type),
                reliable=topic.reliable,
                words=(self._plans[topic.port_name].maximum + 3) // 4,
                depth=topic.depth if isinstance(topic, Publish) else 1,
                type_hash=type_hash(registry or runtime.registry("ros2"), topic.type),
            )

        self.core = RosCore(
            identity,
            [local(one) for one in self._publishers],
            [local(one) for one in self._subscribers],
            **core,
        )
        self._codecs: dict[str, Any] = {
            **{one.port_name: Serializer(self._plans[one.port_name]) for one in self._publishers},
            **{one.port_name: Deserializer(self._plans[one.port_name]) for one in self._subscribers},
        }
        self._flat: dict[str, Flat] = {}
        inner = self.core.signature.members
        self._pins = [
            name for name in inner if not name.startswith(("publish", "receive")) and name != "room"
        ]
        members: dict[str, Any] = {name: inner[name] for name in self._pins}
        for topic in topics:
            port = topic.port_name
            gives = isinstance(topic, Subscribe)
            if flat:
                self._flat[port] = block = Flat(port, self._plans[port], gives=gives)
                members |= {one: member for one, member in block.signature.members.items() if one not in "io"}
            else:
                shape = stream.Signature(self._codecs[port].layout)
                members[port] = Out(shape) if gives else In(shape)
        super().__init__(members)

    @property
    def texts(self) -> list[str]:
        """What the flat ports mean, topic by topic, as Verilog comments."""
        return [block.text for block in self._flat.values()]

    @property
    def reasons(self) -> dict[str, int]:
        """The numbers of what is dropped; empty without counters."""
        return self.core.reasons

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.domains.user = ClockDomain(local=True)
        m.d.comb += ClockSignal("user").eq(self.clk)
        m.submodules.reset = ResetSynchronizer(~self.rst_n, domain="user")
        m.submodules.core = core = self.core
        expose(m, core, self, self._pins)
        m.submodules.typed = DomainRenamer("user")(self._typed())
        return m

    def _typed(self) -> Module:
        m = Module()
        core = self.core
        for n, topic in enumerate(self._publishers):
            port = topic.port_name
            m.submodules[port] = codec = self._codecs[port]
            connect(m, codec.o, getattr(core, f"publish{n}"))
            self._outside(m, port, codec.i, gives=False)
        for n, subscriber in enumerate(self._subscribers):
            port = subscriber.port_name
            m.submodules[port] = codec = self._codecs[port]
            receive = getattr(core, f"receive{n}")
            # CDR in either byte order; what is in another representation has a bad end.
            other = receive.meta.representation[1:] != 0
            m.d.comb += [
                codec.i.stream.payload.eq(receive.stream.payload),
                codec.i.stream.payload.bad.eq(
                    receive.stream.payload.bad | (receive.stream.payload.end & other)
                ),
                codec.i.stream.valid.eq(receive.stream.valid),
                receive.stream.ready.eq(codec.i.stream.ready),
                codec.i.meta.big.eq(~receive.meta.representation[0]),
                core.room[n].eq(codec.i.stream.ready),
            ]
            self._outside(m, port, codec.o, gives=True)
        return m

    def _outside(self, m: Module, port: str, typed: Any, *, gives: bool) -> None:
        """Connect a stream of messages with the port, or the ports, of its topic."""
        if port not in self._flat:
            if gives:
                connect(m, typed, flipped(getattr(self, port)))
            else:
                connect(m, flipped(getattr(self, port)), typed)
            return
        m.submodules[f"{port}_flat"] = block = self._flat[port]
        if gives:
            connect(m, typed, block.i)
        else:
            connect(m, block.o, typed)
        expose(m, block, self, (name for name in block.signature.members if name not in "io"))
