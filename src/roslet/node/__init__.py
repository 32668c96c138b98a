"""What a user holds: a node and its publishers, subscriptions, services, clients, timers.

Imports io, engine, wire; the generator only when a type is given by name. Each name is imported when it is first used.
"""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from roslet.node.clock import Rate, Timer
    from roslet.node.future import Future
    from roslet.node.node import Node
    from roslet.node.qos import QoS
    from roslet.node.services import Client, Service
    from roslet.node.topics import Publisher, RawMessage, Subscription

__all__ = [
    "Client",
    "Future",
    "Node",
    "Publisher",
    "QoS",
    "Rate",
    "RawMessage",
    "Service",
    "Subscription",
    "Timer",
]

_HOMES = {
    "Client": "services",
    "Future": "future",
    "Node": "node",
    "Publisher": "topics",
    "QoS": "qos",
    "Rate": "clock",
    "RawMessage": "topics",
    "Service": "services",
    "Subscription": "topics",
    "Timer": "clock",
}


def __getattr__(name: str) -> object:
    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module 'roslet.node' has no attribute {name!r}")
    from importlib import import_module

    value: object = getattr(import_module("roslet.node." + home), name)
    globals()[name] = value
    return value
