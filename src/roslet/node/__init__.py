"""What a user holds: a node and its publishers, subscriptions, services, clients, timers.

Imports io, engine, wire; the generator only when a type is given by name.
"""

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
