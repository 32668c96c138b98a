"""A user's QoS in the policies of DDS, as rmw maps it."""

from __future__ import annotations

from roslet.node.qos import LIVELINESS, QoS
from roslet.wire.rtps import qos as policies
from roslet.wire.rtps.times import INFINITE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from roslet.wire.rtps.qos import Qos

_LIVELINESS = {"automatic": policies.AUTOMATIC, "manual_by_topic": policies.MANUAL_BY_TOPIC}

# What ROS 2's own topics and services have, as rmw defines it.
ROSOUT = QoS(1000, durability="transient_local", lifespan=10.0)
PARAMETER_EVENTS = QoS(1000)
PARAMETERS = QoS(1000)
SERVICES = QoS(10)
CLOCK = QoS(1, reliability="best_effort")


def to_dds(qos: QoS) -> Qos:
    """The policies that a writer or reader announces."""
    return policies.Qos(
        reliability=(
            policies.RELIABLE if qos.reliability == "reliable" else policies.BEST_EFFORT,
            policies.DEFAULT_BLOCKING,
        ),
        durability=policies.TRANSIENT_LOCAL if qos.durability == "transient_local" else policies.VOLATILE,
        history=(policies.KEEP_LAST if qos.history == "keep_last" else policies.KEEP_ALL, qos.depth),
        deadline=_nanoseconds(qos.deadline),
        lifespan=_nanoseconds(qos.lifespan),
        liveliness=(_LIVELINESS[qos.liveliness], _nanoseconds(qos.liveliness_lease)),
    )


def from_dds(qos: Qos) -> QoS:
    """What a user calls the policies that an endpoint announced. Kinds that ROS 2 lacks become the nearest it has; depth
    and history are not always announced."""
    lease = qos.liveliness[1]
    return QoS(
        max(qos.history[1], 1),
        "reliable" if qos.reliable else "best_effort",
        "transient_local" if qos.durability >= policies.TRANSIENT_LOCAL else "volatile",
        "keep_all" if qos.history[0] == policies.KEEP_ALL else "keep_last",
        deadline=_seconds(qos.deadline),
        lifespan=_seconds(qos.lifespan),
        liveliness=LIVELINESS[qos.liveliness[0] == policies.MANUAL_BY_TOPIC],
        liveliness_lease=_seconds(lease),
    )


def _nanoseconds(seconds: float | None) -> int:
    return INFINITE if seconds is None else min(round(seconds * 1e9), INFINITE)


def _seconds(nanoseconds: int) -> float | None:
    return None if not 0 < nanoseconds < INFINITE else nanoseconds / 1e9
