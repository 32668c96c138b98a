"""A node's class is put together of several: none takes a name from another."""

from __future__ import annotations

from types import CodeType

import pytest

from roslet.compat.rclpy.lifecycle.node import LifecycleNode, LifecycleNodeMixin
from roslet.compat.rclpy.node import Node


def names(kind: type) -> set[str]:
    return {name for name in vars(kind) if not name.startswith("__")}


def test_a_lifecycle_node_takes_no_name_from_the_node_that_it_is() -> None:
    of_nodes = set().union(*(names(kind) for kind in Node.__mro__ if kind is not object))
    assert names(LifecycleNodeMixin) & of_nodes == set()
    assert names(LifecycleNode) & of_nodes == set()


@pytest.mark.parametrize("name", ["executor", "check", "resolve", "store", "rates", "ask", "declare", "sink"])
def test_a_program_s_node_may_call_its_own_attributes_by_plain_names(name: str) -> None:
    """Subclasses are the idiom of rclpy, whose own attributes have mangled names."""
    kinds = [kind for kind in Node.__mro__ if kind is not object]
    assert not any(hasattr(kind, "_" + name) for kind in kinds)
    used = {used for kind in kinds for method in vars(kind).values() for used in _attributes(method)}
    assert "_node_" + name in used
    assert "_" + name not in used


def _attributes(method: object) -> set[str]:
    """Every attribute that a method or property, or a function within it, reads or writes, of whatever."""
    function = getattr(method, "fget", method)
    function = getattr(function, "__func__", function)
    codes = [getattr(function, "__code__", None)]
    found: set[str] = set()
    for code in codes:
        if isinstance(code, CodeType):
            found.update(code.co_names)
            codes += code.co_consts
    return found
