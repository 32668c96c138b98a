"""A node takes a class of either dialect and uses that of its own network."""

from __future__ import annotations

import pytest

from roslet import RawMessage, Unsupported
from roslet.gen.runtime import message_class, service_class
from roslet.node.network import own_classes


def test_a_class_of_ros_2_stands_for_that_of_ros_1() -> None:
    there = message_class("ros1", "geometry_msgs/Pose")
    assert own_classes("ros1", message_class("ros2", "geometry_msgs/msg/Pose")) is there
    assert own_classes("ros1", there) is there
    assert own_classes("ros1", "geometry_msgs/msg/Pose") is there


def test_a_service_of_ros_2_stands_for_that_of_ros_1() -> None:
    there = service_class("ros1", "std_srvs/SetBool")
    assert own_classes("ros1", service_class("ros2", "std_srvs/srv/SetBool"), "service") is there
    assert own_classes("ros1", "std_srvs/SetBool", "service") is there


@pytest.mark.parametrize("kind", [str, RawMessage, 3, message_class("ros1", "std_msgs/String")()])
def test_what_is_no_class_of_messages_is_refused(kind: object) -> None:
    with pytest.raises(Unsupported, match="is no service class"):
        own_classes("ros1", kind, "service")
    if not hasattr(kind, "_spec"):
        with pytest.raises(Unsupported, match="is no message class"):
            own_classes("ros1", kind)
