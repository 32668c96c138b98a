"""`rclpy.qos_overriding_options`: quality of service that parameters may change."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from roslet.compat.interfaces import message_class
from roslet.compat.rclpy.duration import Duration
from roslet.compat.rclpy.qos import QoSPolicyKind, QoSProfile

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from typing_extensions import Self


class InvalidQosOverridesError(Exception):
    """A callback refused the profile that the parameters gave."""


class QoSOverridingOptions:
    """Which policies parameters may change, `qos_overrides.TOPIC.publisher.POLICY` and `.subscription.`; `callback(profile)`
    gives a result with `successful` and `reason`; `entity_id` tells several endpoints of one topic apart."""

    def __init__(
        self,
        policy_kinds: Iterable[QoSPolicyKind | int],
        *,
        callback: Callable[[QoSProfile], Any] | None = None,
        entity_id: str | None = None,
    ) -> None:
        self._kinds = [QoSPolicyKind(one) for one in policy_kinds]
        self._callback = callback
        self._entity_id = entity_id

    @property
    def policy_kinds(self) -> list[QoSPolicyKind]:
        return self._kinds

    @property
    def callback(self) -> Callable[[QoSProfile], Any] | None:
        return self._callback

    @property
    def entity_id(self) -> str | None:
        return self._entity_id

    @classmethod
    def with_default_policies(
        cls, *, callback: Callable[[QoSProfile], Any] | None = None, entity_id: str | None = None
    ) -> Self:
        """History, depth and reliability."""
        kinds = (QoSPolicyKind.HISTORY, QoSPolicyKind.DEPTH, QoSPolicyKind.RELIABILITY)
        return cls(kinds, callback=callback, entity_id=entity_id)


_DURATIONS = (QoSPolicyKind.DEADLINE, QoSPolicyKind.LIFESPAN, QoSPolicyKind.LIVELINESS_LEASE_DURATION)
# A publisher's alone: how long what is published is good for.
_OF_PUBLISHERS = (QoSPolicyKind.LIFESPAN,)


def declare_qos_parameters(
    kind: str, node: Any, topic: str, qos: QoSProfile, options: QoSOverridingOptions | None
) -> QoSProfile:
    """The profile of an endpoint of this topic: what its parameters say, which are declared here. Raises
    InvalidQosOverridesError."""
    if options is None:
        return qos
    found = _copy(qos)
    suffix = f"_{options.entity_id}" if options.entity_id else ""
    for policy in options.policy_kinds:
        if policy in _OF_PUBLISHERS and kind != "publisher":
            continue
        name = policy.name.lower()
        describe = message_class("rcl_interfaces/msg/ParameterDescriptor")(read_only=True)
        full = f"qos_overrides.{topic}.{kind}{suffix}.{name}"
        value = node.declare_parameter(full, _plain(getattr(qos, name)), describe).value
        setattr(found, name, _policy(policy, getattr(qos, name), value))
    if options.callback is not None:
        result = options.callback(found)
        if not result.successful:
            raise InvalidQosOverridesError(
                f"{result.reason}, {kind} of topic {topic}, id {options.entity_id}"
            )
    return found


def _copy(qos: QoSProfile) -> QoSProfile:
    made = QoSProfile(depth=1)
    for name, value in qos._values():
        setattr(made, "_" + name, value)
    return made


def _plain(value: Any) -> Any:
    if isinstance(value, Duration):
        return value.nanoseconds
    return value.short_key if hasattr(value, "short_key") else value


def _policy(policy: QoSPolicyKind, before: Any, value: Any) -> Any:
    if policy in _DURATIONS:
        return Duration(nanoseconds=value)
    return type(before).get_from_short_key(value) if hasattr(before, "short_key") else value


def __getattr__(name: str) -> Any:
    """What a callback returns, and the type of callbacks. Made when asked for: making the message's class takes time."""
    from collections.abc import Callable

    if name not in ("QosCallbackResult", "QosCallbackType"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    result = message_class("rcl_interfaces/msg/SetParametersResult")
    return result if name == "QosCallbackResult" else Callable[[QoSProfile], result]


__all__ = ["InvalidQosOverridesError", "QoSOverridingOptions", "declare_qos_parameters"]
