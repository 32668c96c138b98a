"""What a node is on the ROS 2 network."""

from __future__ import annotations

from roslet.node.network import Network

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from typing import Any

    from roslet.engine.ros2.graph import EndpointInfo
    from roslet.node.node import Node


class Ros2Network(Network):
    """`url` is "ros2://" and what `names.parse_ros2_network` reads."""

    title = "ROS 2"
    dialect = "ros2"

    def __init__(
        self,
        node: Node,
        name: str,
        url: str | None,
        namespace: str,
        arguments: Sequence[str],
        anonymous: bool,
        environment: Mapping[str, str],
    ) -> None:
        super().__init__(node)
        self.lacks("node", 'it is not there yet; use network="ros1://host:port" or "ros1://"')

    def endpoints(self, topic: str | None, node: str | None) -> list[EndpointInfo]:
        raise NotImplementedError

    def declare_parameter(self, name: str, default: Any, **description: Any) -> Any:
        raise NotImplementedError
