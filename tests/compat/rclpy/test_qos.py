"""rclpy's profiles as a roslet node's, and back."""

from __future__ import annotations

import pytest

from roslet.compat.rclpy.duration import Duration, Infinite
from roslet.compat.rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSPresetProfiles,
    QoSProfile,
    ReliabilityPolicy,
)
from roslet.node.qos import QoS


@pytest.mark.parametrize(
    "qos",
    [
        QoS(),
        QoS(3, reliability="best_effort", durability="transient_local", history="keep_all"),
        QoS(deadline=1.5, lifespan=0.25, liveliness="manual_by_topic", liveliness_lease=2.0),
    ],
)
def test_a_node_s_qos_comes_back_as_it_was(qos: QoS) -> None:
    assert QoSProfile.from_roslet(qos).to_roslet() == qos


def test_no_bound_is_zero_or_infinite_for_rclpy_and_none_for_roslet() -> None:
    for duration in (Duration(), Infinite):
        assert QoSProfile(depth=1, deadline=duration).to_roslet().deadline is None
    assert QoSProfile.from_roslet(QoS()).deadline == Infinite


def test_what_is_left_open_becomes_the_default_and_best_available_too_where_nobody_is_asked() -> None:
    assert QoSPresetProfiles.SYSTEM_DEFAULT.value.to_roslet() == QoS(1)
    best = QoSPresetProfiles.BEST_AVAILABLE.value.to_roslet()
    assert (best.reliability, best.durability, best.deadline) == ("reliable", "volatile", None)


def test_from_roslet_names_every_policy() -> None:
    found = QoSProfile.from_roslet(QoS(4))
    assert (found.history, found.depth) == (HistoryPolicy.KEEP_LAST, 4)
    assert (found.reliability, found.durability) == (ReliabilityPolicy.RELIABLE, DurabilityPolicy.VOLATILE)
    assert found.liveliness == LivelinessPolicy.AUTOMATIC
