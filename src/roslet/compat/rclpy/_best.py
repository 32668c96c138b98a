"""What BEST_AVAILABLE means when an endpoint is made: as strict as fits the endpoints of the topic that are known by then.

               a publisher offers                  a subscription requests
reliability    reliable                            reliable, where every publisher is
durability     transient local                     transient local, where every publisher is
liveliness     by topic, where any subscription    by topic, where every publisher does
               requests it
durations      the shortest that is requested      the longest that is offered; none, where one has none
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from roslet.compat.rclpy.qos import (
    DeadlineBestAvailable,
    DurabilityPolicy,
    LivelinessPolicy,
    QoSProfile,
    ReliabilityPolicy,
)
from roslet.node.ros2.qos import from_dds

if TYPE_CHECKING:
    from roslet.node.qos import QoS

_POLICIES = (
    ("reliability", ReliabilityPolicy.BEST_AVAILABLE, ("best_effort", "reliable")),
    ("durability", DurabilityPolicy.BEST_AVAILABLE, ("volatile", "transient_local")),
    ("liveliness", LivelinessPolicy.BEST_AVAILABLE, ("automatic", "manual_by_topic")),
)
# Fields of QoSProfile and of QoS.
_DURATIONS = (("deadline", "deadline"), ("liveliness_lease_duration", "liveliness_lease"))


def fitting(profile: QoSProfile, network: Any, topic: str, publishes: bool) -> QoS:
    """The QoS of a publisher or subscription of `topic`, a full name, that is about to be made."""
    made = profile.to_roslet()
    policies = [(name, kinds) for name, best, kinds in _POLICIES if getattr(profile, name) == best]
    durations = [ours for name, ours in _DURATIONS if getattr(profile, name) == DeadlineBestAvailable]
    if not policies and not durations:
        return made
    with network.reactor.lock:
        others = [from_dds(one.qos) for one in network.graph.endpoints(topic, writers=not publishes)]
    for name, (weak, strict) in policies:
        found = [getattr(one, name) == strict for one in others]
        wanted = (name != "liveliness" or any(found)) if publishes else all(found)
        setattr(made, name, strict if wanted else weak)
    for name in durations:
        given = [getattr(one, name) for one in others]
        bounds = [seconds for seconds in given if seconds is not None]
        if publishes:
            setattr(made, name, min(bounds, default=None))
        else:
            setattr(made, name, max(bounds, default=None) if len(bounds) == len(given) else None)
    return made
