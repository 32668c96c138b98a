"""The quality of service of an action's channels."""

from __future__ import annotations

from roslet.compat.rclpy.qos import QoSProfile
from roslet.node.ros2.actions import ActionQoS

FEEDBACK = QoSProfile(depth=10)


def action_qos(
    goal: QoSProfile, cancel: QoSProfile, result: QoSProfile, feedback: QoSProfile, status: QoSProfile
) -> ActionQoS:
    """The same for a roslet node."""
    made = ActionQoS()
    made.send_goal, made.cancel_goal, made.get_result = (
        goal.to_roslet(),
        cancel.to_roslet(),
        result.to_roslet(),
    )
    made.feedback, made.status = feedback.to_roslet(), status.to_roslet()
    return made


__all__ = ["FEEDBACK", "action_qos"]
