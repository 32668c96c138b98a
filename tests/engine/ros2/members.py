"""Hosts of the simulated network that have a Context."""

from engine.rtps.network import Host, Network
from roslet.engine.ros2 import graph
from roslet.engine.ros2.context import Context
from roslet.names import dds_topic
from roslet.wire.rtps import qos
from roslet.wire.rtps.qos import Qos

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

HASH = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
RELIABLE = Qos((qos.RELIABLE, 100000000), history=(qos.KEEP_LAST, 1000))
STRING = "std_msgs::msg::dds_::String_"


class Member:
    """A host of the network with a context; events that the context leaves are in `left`."""

    def __init__(self, network: Network, **fields: "Any") -> None:
        self.network = network
        self.host: Host = network.host(**fields)
        self.participant = self.host.participant
        self.context = Context(self.participant)
        self.context.start(network.now)
        self.left: list[Any] = []

    @property
    def graph(self) -> graph.Graph:
        return self.context.graph

    def step(self) -> None:
        while self.host.events:
            event = self.host.events.pop(0)
            if not self.context.handle_event(event, self.network.now):
                self.left.append(event)
        at = self.context.deadline()
        if at is not None and at <= self.network.now:
            self.context.handle_deadline(self.network.now)

    def publisher(self, node: int, topic: str, policies: Qos = RELIABLE) -> "Any":
        return self.context.create_writer(
            node, dds_topic("rt", topic), STRING, policies, HASH, self.network.now
        )

    def subscription(self, node: int, topic: str, **fields: "Any") -> "Any":
        return self.context.create_reader(
            node, dds_topic("rt", topic), STRING, RELIABLE, HASH, self.network.now, **fields
        )


def run(network: Network, members: "list[Member]", seconds: float, until: "Any" = None) -> bool:
    """Let time pass for participants and contexts."""
    end = network.now + seconds
    while network.now < end:
        for member in members:
            member.step()
        if until is not None and until():
            return True
        network.run(0.005)
    return until is not None and bool(until())
