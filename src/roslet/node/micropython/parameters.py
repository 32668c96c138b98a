"""Parameters of a ROS 2 node on MicroPython: those of `roslet.node.ros2.parameters`, by the names that the node uses."""

from roslet.node.ros2.parameters import NodeParameters

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class BoardParameters(NodeParameters):
    """What `Node` of MicroPython asks for. The base needs of a network `publisher service resolve own_service follow_clock
    node name`, which that of MicroPython has."""

    def __init__(self, network: "Any", overrides: "dict[str, Any]") -> None:
        NodeParameters.__init__(self, network, overrides)

    def has(self, name: str) -> bool:
        return self.store.has(name)

    def names(self) -> "list[str]":
        return self.store.names()
