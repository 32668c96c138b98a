"""`roslet topic pub`."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from roslet.cli.graph import is_ros1, only_type
from roslet.cli.options import USAGE, CommandError, full_name, load_types
from roslet.cli.output import note
from roslet.cli.session import open_session, qos_fields
from roslet.cli.topic import topic_type
from roslet.cli.values import build
from roslet.node.qos import QoS

if TYPE_CHECKING:
    import argparse

    from roslet.cli.session import Session
    from roslet.node.node import Node
    from roslet.node.topics import Publisher
    from roslet.wire.message import Message

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
    latch = arguments.latch or (arguments.rate is None and not arguments.once)
    fields = {
        "depth": 100,
        "durability": "transient_local" if latch else "volatile",
        **qos_fields(arguments.qos),
    }
    # What is wrong with the values is said before a node appears, where the type is known without one.
    message_type = None if arguments.type == "-" else _checked(arguments, arguments.type)
    with open_session(arguments, "pub") as session:
        node = session.node
        if message_type is None:
            message_type = _checked(
                arguments, only_type(topic, topic_type(session.graph, topic), "name one instead of -")
            )
        publisher = node.publisher(topic, message_type, qos=QoS(**fields))
        end = None if arguments.limit is None else time.monotonic() + arguments.limit
        if arguments.once:
            _once(arguments, session, publisher)
        elif arguments.rate is not None:
            _repeat(arguments, node, publisher, end)
        else:
            publisher.publish(build(message_type, arguments.values, node.now))
            note(f"publishing and latching {topic} until Ctrl-C")
            node.spin(arguments.limit)
    return 0


def _checked(arguments: argparse.Namespace, kind: str) -> type[Message]:
    """The class of a type, for which the values given are right."""
    from roslet.gen.runtime import message_class

    found = message_class("ros1" if is_ros1(arguments.network) else "ros2", kind)
    build(found, arguments.values, _now)
    return found


def _now() -> object:
    from roslet.wire.time import Time

    return Time()


def _once(arguments: argparse.Namespace, session: Session, publisher: Publisher) -> None:
    """Wait until every subscriber that is known is connected, or the time is up; then publish."""
    node = session.node
    end = time.monotonic() + max(0.0, arguments.wait)

    def complete() -> bool:
        return publisher.subscriber_count >= max(1, session.expected(publisher))

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
