"""Fixtures for tests with ROS 2 nodes in one process, on a domain of their own that does not leave this host."""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import Any

import pytest

import roslet

# Other test runs on this machine are unlikely to have the same; 0 is everybody's.
DOMAIN = 10 + os.getpid() % 150


class Ros2Nodes:
    """Makes nodes; all are closed after the test."""

    def __init__(self) -> None:
        self.network = f"ros2://{DOMAIN}?range=localhost"
        self.made: list[roslet.Node] = []

    def __call__(self, name: str, *arguments: str, **options: Any) -> roslet.Node:
        options.setdefault("network", self.network)
        node = roslet.Node(name, arguments=["--ros-args", *arguments] if arguments else [], **options)
        node.log.quiet = True
        self.made.append(node)
        return node


@pytest.fixture
def make2() -> Iterator[Ros2Nodes]:
    nodes = Ros2Nodes()
    yield nodes
    for node in nodes.made:
        node.close()
