"""`rclpy.action.graph`: which actions there are."""

from __future__ import annotations

from typing import Any

from roslet.engine.ros2.actions import actions_among


def get_action_names_and_types(node: Any) -> list[tuple[str, list[str]]]:
    """(action, types) of all actions that somebody serves or calls."""
    return list(actions_among(dict(node.get_topic_names_and_types())).items())


def get_action_server_names_and_types_by_node(
    node: Any, remote_node_name: str, remote_node_namespace: str
) -> list[tuple[str, list[str]]]:
    """(action, types) that a node serves. Raises NodeNameNonExistentError."""
    told = node.get_publisher_names_and_types_by_node(remote_node_name, remote_node_namespace)
    return list(actions_among(dict(told)).items())


def get_action_client_names_and_types_by_node(
    node: Any, remote_node_name: str, remote_node_namespace: str
) -> list[tuple[str, list[str]]]:
    """(action, types) that a node calls. Raises NodeNameNonExistentError."""
    told = node.get_subscriber_names_and_types_by_node(remote_node_name, remote_node_namespace)
    return list(actions_among(dict(told)).items())


__all__ = [
    "get_action_client_names_and_types_by_node",
    "get_action_names_and_types",
    "get_action_server_names_and_types_by_node",
]
