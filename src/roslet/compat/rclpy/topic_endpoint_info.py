"""`rclpy.topic_endpoint_info`: what the graph says of a publisher or subscription."""

from __future__ import annotations

from enum import IntEnum
from typing import TYPE_CHECKING

from roslet.compat.rclpy.qos import QoSProfile
from roslet.compat.rclpy.type_hash import TypeHash

if TYPE_CHECKING:
    from roslet.engine.ros2.graph import EndpointInfo


class TopicEndpointTypeEnum(IntEnum):
    """Which of the two it is."""

    INVALID = 0
    PUBLISHER = 1
    SUBSCRIPTION = 2


class TopicEndpointInfo:
    """One endpoint of a topic; `endpoint_gid` are 16 numbers."""

    def __init__(self, info: EndpointInfo) -> None:
        from roslet.node.ros2.qos import from_dds

        self.node_name = info.node_name
        self.node_namespace = info.node_namespace
        self.topic_type = info.type_name
        self.topic_type_hash = TypeHash.from_text(info.type_hash)
        self.endpoint_type = TopicEndpointTypeEnum(info.kind)
        self.endpoint_gid = list(info.gid)
        self.qos_profile = QoSProfile.from_roslet(from_dds(info.qos))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, TopicEndpointInfo) and vars(self) == vars(other)

    __hash__ = None  # type: ignore[assignment]

    def __str__(self) -> str:
        return "\n".join(
            (
                f"Node name: {self.node_name}",
                f"Node namespace: {self.node_namespace}",
                f"Topic type: {self.topic_type}",
                f"Topic type hash: {self.topic_type_hash}",
                f"Endpoint type: {self.endpoint_type.name}",
                f"GID: {'.'.join(f'{one:02x}' for one in self.endpoint_gid)}",
                f"QoS profile: {self.qos_profile}",
            )
        )


__all__ = ["TopicEndpointInfo", "TopicEndpointTypeEnum"]
