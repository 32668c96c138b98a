#!/usr/bin/env python3
# Quality of service: profiles, policies, presets, compatibility.
import warnings

from rclpy import qos
from rclpy.duration import Duration
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    InvalidQoSProfileException,
    LivelinessPolicy,
    QoSDurabilityPolicy,
    QoSPolicyKind,
    QoSPresetProfiles,
    QoSProfile,
    QoSReliabilityPolicy,
    ReliabilityPolicy,
    qos_check_compatible,
    qos_policy_name_from_kind,
    qos_profile_sensor_data,
    qos_profile_services_default,
    qos_profile_system_default,
)

warnings.simplefilter("ignore")


def show(name, function):
    try:
        print(name, function())
    except Exception as error:
        print(name, "raised", type(error).__name__, *([] if isinstance(error, AssertionError) else [error]))


show("depth", lambda: QoSProfile(depth=7))
show(
    "full",
    lambda: QoSProfile(
        history=HistoryPolicy.KEEP_ALL,
        reliability=ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL,
        lifespan=Duration(seconds=1),
        deadline=Duration(seconds=2),
        liveliness=LivelinessPolicy.MANUAL_BY_TOPIC,
        liveliness_lease_duration=Duration(seconds=3),
        avoid_ros_namespace_conventions=True,
    ),
)
show("by number", lambda: QoSProfile(depth=1, reliability=2, durability=1).reliability)
show("nothing", lambda: QoSProfile())
show("no depth", lambda: QoSProfile(history=HistoryPolicy.KEEP_LAST))
show("keep all", lambda: QoSProfile(history=HistoryPolicy.KEEP_ALL).depth)
show("zero", lambda: QoSProfile(depth=0).depth)
show("negative", lambda: QoSProfile(depth=-1))
show("text", lambda: QoSProfile(depth="3"))
show("wrong", lambda: QoSProfile(depth=1, reliability=99))
show("wrong", lambda: QoSProfile(depth=1, lifespan=3))
show("unknown", lambda: QoSProfile(depth=1, colour="red"))

profile = QoSProfile(depth=10)
profile.reliability = QoSReliabilityPolicy.BEST_EFFORT
profile.depth = 3
profile.deadline = Duration(nanoseconds=1_500_000_000)
print(profile)
print(profile.reliability.name, profile.durability.short_key, profile.history.value, int(profile.liveliness))
print(
    profile == QoSProfile(depth=3, reliability=ReliabilityPolicy.BEST_EFFORT, deadline=Duration(seconds=1.5))
)
print(profile == QoSProfile(depth=3), profile == 3, profile != QoSProfile(depth=3))
show("wrong", lambda: setattr(profile, "durability", 77))
show("wrong", lambda: setattr(profile, "deadline", 1.0))

for name in sorted(QoSPresetProfiles.short_keys()):
    print("preset", name, QoSPresetProfiles.get_from_short_key(name))
for preset in QoSPresetProfiles:
    print(preset.name, preset.value.depth, preset.value.reliability.name, preset.value.durability.name)
print(qos_profile_sensor_data == QoSPresetProfiles.SENSOR_DATA.value, qos_profile_services_default.depth)
print(
    qos_profile_system_default.history.name,
    qos.qos_profile_parameters.depth,
    qos.qos_profile_parameter_events.depth,
)
print(qos.qos_profile_action_status_default.durability.name)
for policy in (HistoryPolicy, ReliabilityPolicy, DurabilityPolicy, LivelinessPolicy):
    print(policy.__name__, sorted(policy.short_keys()), [(member.name, member.value) for member in policy])
print(ReliabilityPolicy.get_from_short_key("best_effort") == 2, ReliabilityPolicy.RELIABLE.short_key)
show("no such", lambda: ReliabilityPolicy.get_from_short_key("perhaps"))
show("no such", lambda: QoSPresetProfiles.get_from_short_key("perhaps"))
print(
    DurabilityPolicy is QoSDurabilityPolicy, DurabilityPolicy.VOLATILE == 2, repr(DurabilityPolicy.VOLATILE)
)
print(ReliabilityPolicy.RELIABLE, f"{ReliabilityPolicy.RELIABLE}", str(HistoryPolicy.KEEP_LAST))

for kind in QoSPolicyKind:
    if kind.name != "INVALID":
        show(kind.name, lambda: (kind.value, qos_policy_name_from_kind(kind)))


def compatible(name, publisher, subscription):
    found, reason = qos_check_compatible(
        QoSProfile(depth=1, **publisher), QoSProfile(depth=1, **subscription)
    )
    print(name, found.name, reason)


best = {"reliability": ReliabilityPolicy.BEST_EFFORT}
local = {"durability": DurabilityPolicy.TRANSIENT_LOCAL}
compatible("the same", {}, {})
compatible("reliability", best, {})
compatible("reliability", {}, best)
compatible("durability", {}, local)
compatible("durability", local, {})
compatible("both", best, local)
compatible("deadline", {"deadline": Duration(seconds=2)}, {"deadline": Duration(seconds=1)})
compatible("deadline", {}, {"deadline": Duration(seconds=1)})
compatible("deadline", {"deadline": Duration(seconds=1)}, {"deadline": Duration(seconds=2)})
compatible("liveliness", {}, {"liveliness": LivelinessPolicy.MANUAL_BY_TOPIC})
compatible(
    "lease",
    {"liveliness_lease_duration": Duration(seconds=2)},
    {"liveliness_lease_duration": Duration(seconds=1)},
)
compatible("default", {"reliability": ReliabilityPolicy.SYSTEM_DEFAULT}, {})
compatible("default", {}, {"durability": DurabilityPolicy.SYSTEM_DEFAULT})
compatible("best", {"reliability": ReliabilityPolicy.BEST_AVAILABLE}, {})
