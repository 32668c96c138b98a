"""A node's class is put together of several: none takes a name from another."""

from __future__ import annotations

from roslet.compat.rclpy.lifecycle.node import LifecycleNode, LifecycleNodeMixin
from roslet.compat.rclpy.node import Node


def names(kind: type) -> set[str]:
    return {name for name in vars(kind) if not name.startswith("__")}


def test_a_lifecycle_node_takes_no_name_from_the_node_that_it_is() -> None:
    of_nodes = set().union(*(names(kind) for kind in Node.__mro__ if kind is not object))
    assert names(LifecycleNodeMixin) & of_nodes == set()
    assert names(LifecycleNode) & of_nodes == set()
