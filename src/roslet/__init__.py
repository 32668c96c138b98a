"""A ROS node where ROS itself cannot go."""

from roslet.errors import RosletError

TYPE_CHECKING = False  # MicroPython, which imports this too, has neither typing nor __future__
if TYPE_CHECKING:
    from typing import Any

    from roslet.gen.runtime import load
    from roslet.node.clock import Rate, Timer
    from roslet.node.node import Node
    from roslet.node.qos import QoS
    from roslet.node.services import Client, Service
    from roslet.node.topics import Publisher, Subscription
    from roslet.wire.time import Duration, Time

__version__ = "0.1.0.dev0"

__all__ = [
    "Client",
    "Duration",
    "Node",
    "Publisher",
    "QoS",
    "Rate",
    "RosletError",
    "Service",
    "Subscription",
    "Time",
    "Timer",
    "load",
]

_HOMES = {
    "Client": "roslet.node.services",
    "Duration": "roslet.wire.time",
    "Node": "roslet.node.node",
    "Publisher": "roslet.node.topics",
    "QoS": "roslet.node.qos",
    "Rate": "roslet.node.clock",
    "Service": "roslet.node.services",
    "Subscription": "roslet.node.topics",
    "Time": "roslet.wire.time",
    "Timer": "roslet.node.clock",
    "load": "roslet.gen.runtime",
}


def __getattr__(name: str) -> "Any":
    """Import a public name when it is first used: a program that needs one pays for one."""
    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module 'roslet' has no attribute {name!r}")
    from importlib import import_module

    value = getattr(import_module(home), name)
    globals()[name] = value
    return value
