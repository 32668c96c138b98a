"""A node for a command, where asking about the network is not enough."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any, Protocol

from roslet.cli.graph import Graph, is_ros1
from roslet.cli.options import USAGE, CommandError
from roslet.node.qos import QoS

if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable, Sequence
    from types import TracebackType

    from typing_extensions import Self

    from roslet.cli.reader import Reader
    from roslet.node.node import Node
    from roslet.node.topics import Publisher


class Tap(Protocol):
    """What listens to a topic of any type."""

    @property
    def publisher_count(self) -> int:
        """Publishers connected now."""


class Session(ABC):
    """A context manager: `node` is a node of a name of its own, `graph` what there is besides."""

    node: Node
    graph: Graph

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @abstractmethod
    def close(self) -> None:
        """The node goes."""

    @abstractmethod
    def listen(
        self, topic: str, callback: Callable[[Any], object], depth: int, qos: Sequence[str], kept: bool = True
    ) -> Tap:
        """Call `callback(RawMessage)` for each message of a topic, whatever its type. `qos` is what --qos said; without
        `kept` messages of before are not wanted. On ROS 2 nobody can subscribe before the type is known: that waits until
        the topic is there. Raises InvalidName where no topic can have such a name."""

    @abstractmethod
    def reader(self) -> Reader:
        """What makes messages of raw ones."""

    @abstractmethod
    def expected(self, publisher: Publisher) -> int:
        """How many subscribers the publisher should have, by what the network knows."""

    def pause(self, seconds: float) -> None:
        """Let things happen for a time."""
        time.sleep(seconds)


def open_session(arguments: argparse.Namespace, name: str) -> Session:
    """A node on the network that the command was given; on ROS 2, after discovery had its time.

    Raises CommandError (nobody reachable) where there is no master now: a command should say so rather than wait.
    """
    if is_ros1(arguments.network):
        from roslet.cli.ros1.session import Ros1Session

        return Ros1Session(arguments.network, name)
    from roslet.cli.ros2.session import Ros2Session

    return Ros2Session(arguments.network, name)


_WORDS = ("reliability", "durability", "history", "liveliness")
_SECONDS = ("deadline", "lifespan", "liveliness_lease")


def _number(kind: type[float], part: str, what: str) -> float:
    name, _, text = part.strip().partition("=")
    try:
        return kind(text)
    except ValueError:
        raise ValueError(f"{name} takes {what}, not {text!r}") from None


def qos_fields(words: Sequence[str]) -> dict[str, Any]:
    """What --qos says, as fields of a QoS. Raises CommandError (wrong usage)."""
    fields: dict[str, Any] = {}
    for word in words:
        for part in word.split(","):
            name, found, text = part.strip().partition("=")
            try:
                if name == "depth":
                    fields[name] = _number(int, part, "a whole number")
                elif name in _SECONDS:
                    fields[name] = _number(float, part, "seconds")
                elif name in _WORDS and found:
                    fields[name] = text
                else:
                    raise ValueError(
                        f"{part!r} is no policy with a value; there are {', '.join(('depth', *_WORDS, *_SECONDS))}"
                    )
                QoS(**fields)
            except ValueError as error:
                raise CommandError(f"--qos: {error}", USAGE) from None
    return fields
