"""Executors, timers, guard conditions and callback groups, without a network."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from typing import Any

import pytest

from roslet.compat.rclpy._entity import Entity
from roslet.compat.rclpy.callback_groups import (
    CallbackGroup,
    MutuallyExclusiveCallbackGroup,
    ReentrantCallbackGroup,
)
from roslet.compat.rclpy.clock import Clock, ROSClock
from roslet.compat.rclpy.clock_type import ClockType
from roslet.compat.rclpy.context import Context, end_all
from roslet.compat.rclpy.exceptions import InvalidHandle, RCLError, ROSInterruptException
from roslet.compat.rclpy.executors import (
    Executor,
    ExternalShutdownException,
    MultiThreadedExecutor,
    SingleThreadedExecutor,
)
from roslet.compat.rclpy.guard_condition import GuardCondition
from roslet.compat.rclpy.task import Future
from roslet.compat.rclpy.time import Time
from roslet.compat.rclpy.timer import Rate, Timer, TimerInfo

PERIOD = 20_000_000


class Node:
    """As much of a node as an executor knows."""

    def __init__(self) -> None:
        self.executor: Executor | None = None
        self.entities: list[Entity] = []
        self._node_polled = self.entities  # all are looked at in every turn
        self._node_active: set[Entity] = set()

    def add(self, entity: Any) -> Any:
        entity._belongs_to(self)
        self.entities.append(entity)
        return entity

    def _node_entities(self) -> list[Entity]:
        return self.entities


@pytest.fixture
def context() -> Iterator[Context]:
    made = Context()
    made.init([])
    yield made
    made.try_shutdown()


@pytest.fixture
def node() -> Node:
    return Node()


@pytest.fixture(params=[SingleThreadedExecutor, MultiThreadedExecutor])
def executor(request: pytest.FixtureRequest, context: Context, node: Node) -> Iterator[Executor]:
    made: Executor = request.param(context=context)
    made.add_node(node)
    yield made
    made.shutdown(5)


def guard(node: Node, callback: Any, group: CallbackGroup | None = None) -> GuardCondition:
    made: GuardCondition = node.add(GuardCondition(callback, group))
    return made


def turn(executor: Executor, done: Any, seconds: float = 5.0) -> None:
    end = time.monotonic() + seconds
    while not done():
        assert time.monotonic() < end
        executor.spin_once(0.05)


def test_a_guard_condition_triggered_often_calls_once(executor: Executor, node: Node) -> None:
    calls: list[int] = []
    one = guard(node, lambda: calls.append(1))
    one.trigger()
    one.trigger()
    turn(executor, lambda: calls)
    executor.spin_once(0.05)
    assert calls == [1]


def test_a_trigger_from_another_thread_wakes_a_turn(executor: Executor, node: Node) -> None:
    one = guard(node, lambda: None)
    threading.Timer(0.05, one.trigger).start()
    begin = time.monotonic()
    executor.spin_once(10)
    assert time.monotonic() - begin < 5


def test_no_entity_starves_another(context: Context, node: Node) -> None:
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    calls: list[str] = []

    def again(name: str, own: list[GuardCondition]) -> None:
        calls.append(name)
        own[0].trigger()

    for name in "abc":
        own: list[GuardCondition] = []
        own.append(guard(node, lambda name=name, own=own: again(name, own)))
        own[0].trigger()
    for _ in range(30):
        executor.spin_once(1)
    assert [calls.count(name) for name in "abc"] == [10, 10, 10]


def test_what_a_callback_raises_comes_out_of_a_turn(executor: Executor, node: Node) -> None:
    guard(node, lambda: 1 / 0).trigger()
    with pytest.raises(ZeroDivisionError):
        turn(executor, lambda: False)


def test_an_exclusive_group_is_taken_until_the_coroutine_ends(executor: Executor, node: Node) -> None:
    group = MutuallyExclusiveCallbackGroup()
    gate: Future[None] = Future()
    calls: list[str] = []

    async def slow() -> None:
        calls.append("begun")
        await gate
        calls.append("ended")

    guard(node, slow, group).trigger()
    turn(executor, lambda: calls)
    guard(node, lambda: calls.append("other"), group).trigger()
    executor.spin_once(0.05)
    executor.spin_once(0.05)
    assert calls == ["begun"]
    gate.set_result(None)
    turn(executor, lambda: len(calls) == 3)
    assert calls == ["begun", "ended", "other"]


def test_an_exclusive_group_is_free_again_after_an_exception(executor: Executor, node: Node) -> None:
    group = MutuallyExclusiveCallbackGroup()
    guard(node, lambda: 1 / 0, group).trigger()
    with pytest.raises(ZeroDivisionError):
        turn(executor, lambda: False)
    calls: list[int] = []
    guard(node, lambda: calls.append(1), group).trigger()
    turn(executor, lambda: calls)


def test_threads_run_a_reentrant_group_at_the_same_time(context: Context, node: Node) -> None:
    executor = MultiThreadedExecutor(3, context=context)
    executor.add_node(node)
    meeting = threading.Barrier(3, timeout=5)
    group = ReentrantCallbackGroup()
    met: list[int] = []
    for _ in range(3):
        guard(node, lambda: met.append(meeting.wait()), group).trigger()
    turn(executor, lambda: len(met) == 3)
    executor.shutdown()


def test_a_coroutine_goes_on_as_soon_as_what_it_awaits_is_set_elsewhere(executor: Executor) -> None:
    gate: Future[int] = Future()

    async def waits() -> int:
        return await gate  # type: ignore[return-value]

    task = executor.create_task(waits)
    threading.Timer(0.05, gate.set_result, (7,)).start()
    begin = time.monotonic()
    executor.spin_until_future_complete(task, 10)
    assert task.result() == 7
    assert time.monotonic() - begin < 5


def test_a_waiting_executor_turns_no_wheels(executor: Executor, monkeypatch: pytest.MonkeyPatch) -> None:
    looks: list[bool] = []
    look = executor._look

    def counted() -> bool:
        looks.append(look())
        return looks[-1]

    monkeypatch.setattr(executor, "_look", counted)

    async def waits() -> None:
        await Future()

    executor.create_task(waits)
    end = time.monotonic() + 0.3
    while time.monotonic() < end:
        executor.spin_once(0.1)
    assert len(looks) < 30


def test_the_end_of_the_context_ends_spinning(executor: Executor, context: Context) -> None:
    threading.Timer(0.05, context.shutdown).start()
    with pytest.raises(ExternalShutdownException):
        executor.spin()


def test_a_signal_ends_spinning_without_destroying(executor: Executor, context: Context) -> None:
    called: list[int] = []
    context.on_shutdown(lambda: called.append(1))
    threading.Timer(0.05, end_all).start()
    with pytest.raises(ExternalShutdownException):
        executor.spin()
    assert not called


def test_shutdown_waits_for_what_runs(context: Context, node: Node) -> None:
    executor = MultiThreadedExecutor(2, context=context)
    executor.add_node(node)
    begun, gate = threading.Event(), threading.Event()

    def slow() -> None:
        begun.set()
        gate.wait(10)

    guard(node, slow).trigger()
    executor.spin_once(1)
    assert begun.wait(5)
    assert not executor.shutdown(0.05)
    gate.set()
    assert executor.shutdown(5)


# -- timers, by a clock that the test moves


@pytest.fixture
def clock() -> ROSClock:
    made = ROSClock()
    made.set_ros_time_override(Time(seconds=100, clock_type=ClockType.ROS_TIME))
    made._set_ros_time_is_active(True)
    return made


def move(clock: ROSClock, seconds: float) -> None:
    clock.set_ros_time_override(Time(seconds=seconds, clock_type=ClockType.ROS_TIME))


def due(timer: Timer) -> int | None:
    """Nanoseconds after which a call is expected, taking the call that is due."""
    assert timer._take() is not Entity._nothing
    return timer.time_until_next_call()


def test_a_late_call_is_not_made_up_for(clock: ROSClock) -> None:
    timer = Timer(None, None, 1_000_000_000, clock)
    move(clock, 101)
    assert due(timer) == 1_000_000_000
    move(clock, 105.25)
    assert due(timer) == 750_000_000
    assert timer._take() is Entity._nothing


def test_a_call_exactly_due_is_called_and_the_next_one_is_a_period_later(clock: ROSClock) -> None:
    timer = Timer(None, None, 1_000_000_000, clock)
    move(clock, 102)
    assert due(timer) == 0
    assert due(timer) == 1_000_000_000


def test_time_that_jumps_back_begins_the_period_anew(clock: ROSClock) -> None:
    timer = Timer(None, None, 1_000_000_000, clock)
    move(clock, 101)
    due(timer)
    move(clock, 50)
    assert timer.time_until_next_call() == 1_000_000_000


def test_a_period_goes_on_where_the_source_of_time_changes(clock: ROSClock) -> None:
    timer = Timer(None, None, 10_000_000_000, clock)
    move(clock, 104)
    clock._set_ros_time_is_active(False)
    left = timer.time_until_next_call()
    assert left is not None
    assert 5_000_000_000 < left <= 6_000_000_000


def test_cancelled_reset_and_destroyed_timers(clock: ROSClock) -> None:
    timer = Timer(None, None, 1_000_000_000, clock, autostart=False)
    move(clock, 200)
    assert (timer.is_canceled(), timer.is_ready(), timer.time_until_next_call()) == (True, False, None)
    timer.reset()
    assert (timer.is_canceled(), timer.time_until_next_call()) == (False, 1_000_000_000)
    timer.destroy()
    with pytest.raises(InvalidHandle):
        timer.cancel()
    with pytest.raises(RCLError, match="non-negative"):
        Timer(None, None, -1, clock)


def test_a_timer_tells_who_asks_when_the_call_was_due(clock: ROSClock) -> None:
    told: list[TimerInfo] = []

    def callback(info: TimerInfo) -> None:
        told.append(info)

    timer = Timer(callback, None, 1_000_000_000, clock)
    move(clock, 101.5)
    timer._run(timer._take())
    assert told[0].expected_call_time.nanoseconds == 101_000_000_000
    assert told[0].actual_call_time.nanoseconds == 101_500_000_000


def test_a_timer_of_the_system_s_time_is_called_in_time(executor: Executor, node: Node) -> None:
    calls: list[float] = []
    begin = time.monotonic()
    node.add(Timer(lambda: calls.append(time.monotonic() - begin), None, PERIOD, Clock()))
    turn(executor, lambda: len(calls) >= 5)
    assert 0.09 < calls[4] < 1.0


def test_a_rate_is_woken_by_the_end_of_its_context(context: Context) -> None:
    rate = Rate(Timer(None, None, 10**12, Clock()), context=context)
    threading.Timer(0.05, context.shutdown).start()
    begin = time.monotonic()
    with pytest.raises(ROSInterruptException):
        rate.sleep()
    assert time.monotonic() - begin < 5
