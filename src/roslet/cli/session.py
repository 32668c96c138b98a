"""A node for a command, where asking the master is not enough."""

from __future__ import annotations

from typing import TYPE_CHECKING

from roslet.cli.graph import Graph

if TYPE_CHECKING:
    import argparse

    from roslet.node.node import Node


def open_node(arguments: argparse.Namespace, name: str) -> Node:
    """A node of a name of its own, on the network that the command was given.

    Raises CommandError (nobody reachable) where there is no master now: a command should say so rather than wait.
    """
    with Graph(arguments.network) as graph:
        graph.master("getUri")
    from roslet.node.node import Node

    return Node("roslet_" + name, network=arguments.network, anonymous=True)
