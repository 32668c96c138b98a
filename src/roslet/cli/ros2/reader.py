"""Raw messages of ROS 2 to message objects."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from roslet.cli.options import CommandError
from roslet.cli.reader import Reader
from roslet.cli.render import plain
from roslet.cli.ros2.graph import full_name
from roslet.errors import DefinitionError, InvalidName, RosletError
from roslet.names import TOPIC

if TYPE_CHECKING:
    from roslet.cli.ros2.graph import Ros2Graph
    from roslet.node.topics import RawMessage
    from roslet.wire.message import Message

# Seconds that a node has to describe a type: it may be busy, and others may know the type too.
TIMEOUT = 3.0


class Ros2Reader(Reader):
    """By the definition installed here where its hash is the publisher's; else by what a node of the publishers says of the
    type, whose hash must be right as well."""

    def __init__(self, graph: Ros2Graph) -> None:
        super().__init__()
        self._graph = graph

    def _find(self, raw: RawMessage) -> type[Message]:
        from roslet.gen.runtime import message_class

        try:
            kind = message_class("ros2", raw.type)
            if raw.md5sum in ("", kind._type_hash):
                return kind
            problem = f"the definition installed here has another hash than the publisher's ({raw.md5sum})"
        except (DefinitionError, InvalidName) as error:
            problem = str(error)
        if not raw.md5sum:
            raise CommandError(f"cannot show {raw.type}: {problem}; load it with --types DIR")
        return self._described(raw, problem)

    def _described(self, raw: RawMessage, problem: str) -> type[Message]:
        graph = self._graph
        asked = []
        for node in self._nodes(raw):
            service = f"{node}/get_type_description"
            if not graph.has_service(service):
                continue
            asked.append(node)
            try:
                answer = graph.call(
                    service,
                    "type_description_interfaces/srv/GetTypeDescription",
                    TIMEOUT,
                    type_name=raw.type,
                    type_hash=raw.md5sum,
                    include_type_sources=False,
                )
                if not answer.successful:
                    problem = f"{node} does not describe it: {answer.failure_reason}"
                    continue
                return self._class(raw, plain(answer.type_description))
            except RosletError as error:
                problem = f"what {node} says of it is no use: {error}"
        if not asked:
            problem += "; no node of its publishers describes types"
        raise CommandError(f"cannot show {raw.type}: {problem}; load it with --types DIR")

    def _nodes(self, raw: RawMessage) -> list[str]:
        return sorted(
            {
                full_name(one)
                for part in self._graph.of(TOPIC, True).values()
                for one in part
                if (one.type_name, one.type_hash) == (raw.type, raw.md5sum)
            }
        )

    @staticmethod
    def _class(raw: RawMessage, description: dict[str, Any]) -> type[Message]:
        from roslet.gen.runtime import described_class

        kind = described_class(raw.type, description)
        if kind._type_hash != raw.md5sum:
            raise DefinitionError(f"its hash is {kind._type_hash}, the publisher's {raw.md5sum}")
        return kind
