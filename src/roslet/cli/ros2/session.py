"""A node of ROS 2 for a command."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from roslet.cli.output import note
from roslet.cli.ros2.graph import Ros2Graph
from roslet.cli.ros2.reader import Ros2Reader
from roslet.cli.session import Session, qos_fields
from roslet.engine.rtps.qos import incompatible
from roslet.names import TOPIC, check_full_name
from roslet.node.qos import QoS
from roslet.node.ros2.qos import to_dds

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from roslet.cli.reader import Reader
    from roslet.node.topics import Publisher, Subscription

# Seconds between two looks for a topic that is not there yet.
LOOK = 0.1


class Ros2Tap:
    """A subscription of any type, from when the type is known."""

    def __init__(
        self,
        graph: Ros2Graph,
        topic: str,
        callback: Callable[[Any], object],
        depth: int,
        fields: dict[str, Any],
    ) -> None:
        self._graph = graph
        self._topic = topic
        self._callback = callback
        self._depth = depth
        self._fields = fields
        self._subscription: Subscription | None = None
        self._look()

    def _look(self) -> None:
        graph = self._graph
        if graph.types.get(self._topic) is None:
            graph.node.timer(LOOK, self._look, once=True)
            return
        fields = {"depth": self._depth, **suited(graph, self._topic), **self._fields}
        self._subscription = graph.node.subscribe(self._topic, "*", self._callback, qos=QoS(**fields))

    @property
    def publisher_count(self) -> int:
        return 0 if self._subscription is None else self._subscription.publisher_count


def suited(graph: Ros2Graph, topic: str) -> dict[str, str]:
    """The policies with which a subscription hears all the publishers of a topic: it requests no more than the one that
    offers least. Where they differ, a note says so."""
    offers = [one.qos for one in graph.of(TOPIC, True).get(topic, ())]
    found = {}
    for name, many, few, all_offer, some_offer in (
        (
            "reliability",
            "reliable",
            "best_effort",
            all(qos.reliable for qos in offers),
            any(qos.reliable for qos in offers),
        ),
        (
            "durability",
            "transient_local",
            "volatile",
            all(qos.durability for qos in offers),
            any(qos.durability for qos in offers),
        ),
    ):
        found[name] = many if all_offer and offers else few
        if some_offer and not all_offer:
            note(f"{topic}: only some publishers are {many}; subscribing {few}, to hear all")
    return found if offers else {}


class Ros2Session(Session):
    """The node is the graph's."""

    graph: Ros2Graph

    def __init__(self, network: str, name: str) -> None:
        self.graph = Ros2Graph(network, name)
        self.node = self.graph.node

    def close(self) -> None:
        self.graph.close()

    def pause(self, seconds: float) -> None:
        self.graph.pause(seconds)

    def listen(
        self, topic: str, callback: Callable[[Any], object], depth: int, qos: Sequence[str], kept: bool = True
    ) -> Ros2Tap:
        fields = ({} if kept else {"durability": "volatile"}) | qos_fields(qos)
        return Ros2Tap(self.graph, check_full_name(topic), callback, depth, fields)

    def reader(self) -> Reader:
        return Ros2Reader(self.graph)

    def expected(self, publisher: Publisher) -> int:
        offered = to_dds(publisher.qos)
        there = self.graph.of(TOPIC, False).get(publisher.topic, ())
        return len(
            [
                one
                for one in there
                if one.type_name == publisher.type._type and not incompatible(offered, one.qos)
            ]
        )
