"""A node of ROS 1 for a command."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from roslet.cli.reader import Ros1Reader
from roslet.cli.ros1.graph import Ros1Graph
from roslet.cli.session import Session, qos_fields
from roslet.node.node import Node
from roslet.node.qos import QoS

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from roslet.cli.reader import Reader
    from roslet.node.topics import Publisher, Subscription


class Ros1Session(Session):
    """Raises CommandError where there is no master."""

    def __init__(self, network: str, name: str) -> None:
        self.graph: Ros1Graph = Ros1Graph(network)
        self.graph.master("getUri")
        self.node = Node("roslet_" + name, network=network, anonymous=True)

    def close(self) -> None:
        self.graph.close()
        self.node.close()

    def listen(
        self, topic: str, callback: Callable[[Any], object], depth: int, qos: Sequence[str], kept: bool = True
    ) -> Subscription:
        fields = {"depth": depth, **qos_fields(qos)}
        return self.node.subscribe(topic, "*", callback, qos=QoS(**fields))

    def reader(self) -> Reader:
        return Ros1Reader()

    def expected(self, publisher: Publisher) -> int:
        return len(set(self.node.system_state()[1].get(publisher.topic, ())))
