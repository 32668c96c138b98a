"""A node's class is put together of several: none takes a name from another, or from the program's subclass."""

from __future__ import annotations

import ast
import inspect
import textwrap

import pytest

from roslet.compat.rclpy.lifecycle.node import LifecycleNode, LifecycleNodeMixin
from roslet.compat.rclpy.node import Node

KINDS = [kind for kind in LifecycleNode.__mro__ if kind is not object]
# Attributes of a node in rclpy too, whose other private names are mangled: a program that sets these breaks there as well.
OF_RCLPY = {
    "_clock",
    "_context",
    "_default_callback_group",
    "_publishers",
    "_rate_group",
    "_time_source",
    "_wake_executor",
}


def names(kind: type) -> set[str]:
    return {name for name in vars(kind) if not name.startswith("__")}


def test_a_lifecycle_node_takes_no_name_from_the_node_that_it_is() -> None:
    of_nodes = set().union(*(names(kind) for kind in Node.__mro__ if kind is not object))
    assert names(LifecycleNodeMixin) & of_nodes == set()
    assert names(LifecycleNode) & of_nodes == set()


@pytest.mark.parametrize("kind", KINDS)
def test_a_program_s_node_may_give_its_own_attributes_any_name(kind: type) -> None:
    """Subclasses are the idiom of rclpy: ours have a beginning that no program uses."""
    private = {name for name in names(kind) | _of_self(kind) if name[0] == "_" and name[:2] != "__"}
    assert {name for name in private - OF_RCLPY if not name.startswith("_node_")} == set()


def _of_self(kind: type) -> set[str]:
    """What the methods of a class read or write of `self`."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(kind)))
    return {
        node.attr
        for node in ast.walk(tree)
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "self"
    }
