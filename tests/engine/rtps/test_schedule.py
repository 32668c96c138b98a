"""One heap of alarms."""

import pytest

from roslet.engine.rtps.schedule import SLACK, Alarm, Schedule

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

pytestmark = pytest.mark.micropython


def test_alarms_ring_once_and_in_order() -> None:
    schedule = Schedule()
    rung: Any = []
    alarms = [Alarm(schedule, lambda now, number=number: rung.append((number, now))) for number in range(3)]  # type: ignore[misc]
    alarms[0].set(3.0)
    alarms[1].set(1.0)
    alarms[2].set(2.0)
    assert schedule.deadline() == 1.0
    schedule.ring(0.9)
    assert rung == []
    schedule.ring(2.5)
    assert rung == [(1, 2.5), (2, 2.5)]
    assert schedule.deadline() == 3.0
    schedule.ring(9.0)
    schedule.ring(10.0)
    assert rung == [(1, 2.5), (2, 2.5), (0, 9.0)]
    assert schedule.deadline() is None
    assert schedule.live == 0


def test_an_alarm_moves_forward_but_not_back() -> None:
    schedule = Schedule()
    alarm = Alarm(schedule, lambda now: None)
    alarm.set(5.0)
    alarm.set(7.0)
    assert schedule.deadline() == 5.0
    alarm.set(2.0)
    assert schedule.deadline() == 2.0
    alarm.cancel()
    assert schedule.deadline() is None
    alarm.set(8.0)
    assert schedule.deadline() == 8.0


def test_an_alarm_that_is_set_while_it_rings_waits_for_the_next_call() -> None:
    schedule = Schedule()
    rung: Any = []

    def again(now: float) -> None:
        rung.append(now)
        alarm.set(now)

    alarm = Alarm(schedule, again)
    alarm.set(1.0)
    schedule.ring(1.0)
    assert rung == [1.0]
    schedule.ring(1.5)
    assert rung == [1.0, 1.5]


def test_what_was_taken_back_does_not_pile_up() -> None:
    schedule = Schedule()
    alarm = Alarm(schedule, lambda now: None)
    keep = Alarm(schedule, lambda now: None)
    keep.set(1e6)
    for number in range(10000):
        alarm.set(1000.0 + number)
        alarm.cancel()
    assert len(schedule._heap) <= SLACK + 4
    assert schedule.deadline() == 1e6
