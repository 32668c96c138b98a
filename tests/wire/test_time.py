"""ROS 1 time values. Runs on MicroPython too."""

import pytest

from roslet.wire.time import Duration, Time

pytestmark = pytest.mark.micropython


def test_nanoseconds_are_carried_into_seconds() -> None:
    assert (Time(1, 2500000000).secs, Time(1, 2500000000).nsecs) == (3, 500000000)
    assert (Duration(0, -1).secs, Duration(0, -1).nsecs) == (-1, 999999999)
    assert (Duration(-1.5).secs, Duration(-1.5).nsecs) == (-2, 500000000)


def test_a_float_is_rounded_to_a_nanosecond() -> None:
    assert Time(1.5) == Time(1, 500000000)
    assert Time.from_sec(0.25).to_nsec() == 250000000
    assert Duration.from_sec(2.0).to_sec() == 2.0


def test_a_time_is_never_negative() -> None:
    with pytest.raises(TypeError):
        Time(-1)
    with pytest.raises(TypeError):
        Time(1) - Duration(2)


def test_nanoseconds_need_whole_seconds() -> None:
    with pytest.raises(ValueError):
        Time(1.5, 1)


def test_times_and_durations_add_up() -> None:
    assert Time(10, 1) + Duration(1, 2) == Time(11, 3)
    assert Duration(1, 2) + Time(10, 1) == Time(11, 3)
    assert Time(10) - Time(12) == Duration(-2)
    assert Time(10) - Duration(2) == Time(8)
    assert Duration(1) - Duration(0, 1) == Duration(0, 999999999)
    assert -Duration(1, 1) == Duration(-2, 999999999)
    assert abs(Duration(-3)) == Duration(3)


def test_durations_scale() -> None:
    assert Duration(1, 500000000) * 2 == Duration(3)
    assert 2 * Duration(1) == Duration(2)
    assert Duration(3) / 2 == Duration(1, 500000000)
    assert Duration(3) / Duration(2) == 1.5
    assert Duration(7) // Duration(2) == 3
    assert Duration(7) % Duration(2) == Duration(1)
    assert divmod(Duration(7), Duration(2)) == (3, Duration(1))


def test_comparison_is_by_value_within_a_class() -> None:
    assert Time(1) < Time(1, 1) <= Time(2)
    assert Duration(2) > Duration(1) >= Duration(1)
    assert Time(1) != Duration(1)
    assert hash(Time(1, 2)) == hash(Time(1, 2))


def test_adding_what_is_no_span_is_a_type_error() -> None:
    with pytest.raises(TypeError):
        Time(1) + Time(1)  # type: ignore[operator]
    with pytest.raises(TypeError):
        Duration(1) + 1


def test_zero_is_false_and_prints_its_parts() -> None:
    assert not Time()
    assert Time().is_zero()
    assert repr(Time(1, 2)) == "Time(secs=1, nsecs=2)"
    assert str(Duration(1, 2)) == "1000000002"


def test_both_parts_have_their_names_of_ros_2_too() -> None:
    stamp = Time(3, 4)
    assert (stamp.sec, stamp.nanosec) == (3, 4)
    stamp.sec, stamp.nanosec = 5, 6
    assert (stamp.secs, stamp.nsecs) == (5, 6)
    span = Duration(-0.5)
    assert (span.sec, span.nanosec) == (-1, 500000000)
