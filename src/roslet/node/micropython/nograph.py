"""Stands for `roslet.engine.ros2.graph` on MicroPython: a node there has no questions about the graph, so none of it
is kept."""

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class Graph:
    """Knows nothing."""

    def participant_discovered(self, data: "Any") -> None:
        """A participant is there."""

    participant_lost = endpoint_discovered = endpoint_lost = participant_discovered

    def nodes_told(self, prefix: bytes, info: "Any") -> bool:
        """A participant says what nodes it has."""
        return True
