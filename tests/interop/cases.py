"""The messages that every ROS 1 peer is put through."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Case:
    type: str
    size: int  # what it means depends on the type: bytes, elements; -1 is the non-ASCII string
    count: int = 5

    def __str__(self) -> str:
        return f"{self.type.split('/')[1]}-{self.size}"


CASES = [
    *(Case("std_msgs/String", size) for size in (-1, 0, 1, 16, 256, 4096, 65536)),
    Case("std_msgs/String", 1 << 20, 3),
    Case("mros_comm_measure/Coordinate", 0, 20),
    Case("peer_msgs/UserTypeTest", 0, 20),
    Case("peer_msgs/Crowd", 0),
    Case("peer_msgs/Crowd", 30),
    Case("peer_msgs/Stamps", 0),
    Case("peer_msgs/Stamps", 9),
    Case("peer_msgs/Primitives", 0),
    Case("peer_msgs/Primitives", 130),
    Case("sensor_msgs/Image", 1),
    Case("sensor_msgs/Image", 640 * 480 * 3, 3),
    Case("sensor_msgs/PointCloud2", 0),
    Case("sensor_msgs/PointCloud2", 20_000, 3),
]
