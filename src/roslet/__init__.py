"""A ROS node where ROS itself cannot go.

    with roslet.Node("talker", network="ros1://") as node:
        node.publisher("chatter", "std_msgs/String").publish(data="hello")

`Node` makes everything else; `load` reads your own definitions; message classes are in `roslet.msgs`.
"""

from roslet.errors import (
    CallTimeout,
    DefinitionError,
    Fault,
    HandshakeRefused,
    InvalidMessage,
    InvalidName,
    MalformedMessage,
    NodeClosed,
    ParameterAlreadyDeclared,
    ParameterNotDeclared,
    ParameterNotSet,
    ParameterReadOnly,
    ParameterRefused,
    ParameterUninitialized,
    ProtocolError,
    RecursiveType,
    RemoteError,
    RosletError,
    ServiceFailed,
    UnknownType,
    Unreachable,
    Unsupported,
)

TYPE_CHECKING = False  # MicroPython, which imports this too, has neither typing nor __future__
if TYPE_CHECKING:
    from typing import Any

    from roslet.gen.runtime import load
    from roslet.node.clock import Rate, Timer
    from roslet.node.node import Node
    from roslet.node.qos import QoS
    from roslet.node.services import Client, Service
    from roslet.node.topics import Publisher, RawMessage, Subscription
    from roslet.wire.time import Duration, Time

__version__ = "0.1.0.dev0"

__all__ = [
    "CallTimeout",
    "Client",
    "DefinitionError",
    "Duration",
    "Fault",
    "HandshakeRefused",
    "InvalidMessage",
    "InvalidName",
    "MalformedMessage",
    "Node",
    "NodeClosed",
    "ParameterAlreadyDeclared",
    "ParameterNotDeclared",
    "ParameterNotSet",
    "ParameterReadOnly",
    "ParameterRefused",
    "ParameterUninitialized",
    "ProtocolError",
    "Publisher",
    "QoS",
    "Rate",
    "RawMessage",
    "RecursiveType",
    "RemoteError",
    "RosletError",
    "Service",
    "ServiceFailed",
    "Subscription",
    "Time",
    "Timer",
    "UnknownType",
    "Unreachable",
    "Unsupported",
    "load",
]

_HOMES = {
    "Client": "roslet.node.services",
    "Duration": "roslet.wire.time",
    "Node": "roslet.node.node",
    "Publisher": "roslet.node.topics",
    "QoS": "roslet.node.qos",
    "Rate": "roslet.node.clock",
    "RawMessage": "roslet.node.topics",
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


def __dir__() -> list[str]:
    """What there is, imported or not."""
    return sorted(set(globals()) | set(_HOMES))  # MicroPython knows no [*a, *b]
