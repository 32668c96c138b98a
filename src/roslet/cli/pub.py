"""`roslet topic pub`."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from roslet.cli.graph import Graph
from roslet.cli.options import USAGE, CommandError, full_name, load_types
from roslet.cli.output import note
from roslet.cli.session import open_node
from roslet.cli.topic import topic_type
from roslet.cli.values import build

if TYPE_CHECKING:
    import argparse

    from roslet.node.node import Node
    from roslet.node.topics import Publisher

# Seconds for a message to leave after it was published: a socket's send buffer needs the process to live on.
DRAIN = 2.0
# Seconds between two looks at who subscribes.
LOOK = 0.05


def publish(arguments: argparse.Namespace) -> int:
    """Publish once and end, at a rate, or once and stay."""
    if arguments.count is not None and arguments.rate is None:
        raise CommandError("-n needs -r; -1 publishes once", USAGE)
    if arguments.once and arguments.rate is not None:
        raise CommandError("-1 and -r exclude each other", USAGE)
    load_types(arguments)
    topic = full_name(arguments.topic)
    kind = arguments.type
    if kind == "-":
        with Graph(arguments.network) as graph:
            kind = topic_type(graph, topic)
    from roslet.gen.runtime import message_class

    message_type = message_class("ros1", kind)
    build(message_type, arguments.values, _now)  # what is wrong with the values is said before a node appears
    latch = arguments.latch or (arguments.rate is None and not arguments.once)
    from roslet.node.qos import QoS

    qos = QoS(depth=100, durability="transient_local" if latch else "volatile")
    with open_node(arguments, "pub") as node:
        publisher = node.publisher(topic, message_type, qos=qos)
        end = None if arguments.limit is None else time.monotonic() + arguments.limit
        if arguments.once:
            _once(arguments, node, publisher)
        elif arguments.rate is not None:
            _repeat(arguments, node, publisher, end)
        else:
            publisher.publish(build(message_type, arguments.values, node.now))
            note(f"publishing and latching {topic} until Ctrl-C")
            node.spin(arguments.limit)
    return 0


def _now() -> object:
    from roslet.wire.time import Time

    return Time()


def _once(arguments: argparse.Namespace, node: Node, publisher: Publisher) -> None:
    """Wait until every subscriber that the master knows is connected, or the time is up; then publish."""
    end = time.monotonic() + max(0.0, arguments.wait)

    def complete() -> bool:
        wanted = len(set(node.system_state()[1].get(publisher.topic, ())))
        return publisher.subscriber_count >= max(1, wanted)

    while time.monotonic() < end and not complete() and not node.is_shutdown:
        node.sleep(LOOK)
    publisher.publish(build(publisher.type, arguments.values, node.now))
    if not publisher.subscriber_count:
        note(f"nobody subscribed {publisher.topic} within {arguments.wait:g} s")
    _drain(node, publisher)


def _repeat(arguments: argparse.Namespace, node: Node, publisher: Publisher, end: float | None) -> None:
    rate = node.rate(arguments.rate)
    sent = 0
    while not node.is_shutdown and (end is None or time.monotonic() < end):
        # Made anew each time, because `now` is another now.
        publisher.publish(build(publisher.type, arguments.values, node.now))
        sent += 1
        if sent == arguments.count:
            break
        rate.sleep()
    _drain(node, publisher)


def _drain(node: Node, publisher: Publisher) -> None:
    """Serve until every subscriber has what was published."""
    publisher.flush(DRAIN)
