"""Timers, rates, sleeping; simulated time through /clock."""

from __future__ import annotations

import time
from typing import Any

import pytest

import roslet
from nodes import Nodes, entry_of, serve, wait_until
from roslet.master.server import MasterServer


def test_a_timer_calls_at_its_period_without_drift(make: Nodes) -> None:
    node = make("a")
    times: list[float] = []
    timer = node.timer(0.02, lambda: times.append(time.monotonic()))
    begin = time.monotonic()
    node.spin(0.5)
    timer.cancel()
    assert 20 <= len(times) <= 25 and timer.calls == len(times)
    assert abs((times[-1] - begin) - 0.02 * len(times)) < 0.015
    node.spin(0.05)
    assert timer.calls == len(times)
    timer.cancel()


def test_a_timer_that_is_late_does_not_run_to_catch_up(make: Nodes) -> None:
    node = make("a")
    calls: list[int] = []
    node.timer(0.01, lambda: calls.append(1))
    time.sleep(0.3)  # nobody spins
    node.spin(0.005)
    assert 1 <= len(calls) <= 3


def test_a_timer_may_run_once_and_may_cancel_itself(make: Nodes) -> None:
    node = make("a")
    once: list[int] = []
    node.timer(0.01, lambda: once.append(1), once=True)
    calls: list[int] = []

    def cancelling() -> None:
        calls.append(1)
        if len(calls) == 3:
            timer.cancel()

    timer = node.timer(0.01, cancelling)
    node.spin(0.2)
    assert once == [1] and calls == [1, 1, 1]


@pytest.mark.parametrize("value", [0, -1, float("nan")])
def test_a_period_or_rate_must_be_positive(make: Nodes, value: float) -> None:
    node = make("a")
    with pytest.raises(ValueError, match="must be positive"):
        node.timer(value, lambda: None)
    with pytest.raises(ValueError, match="must be positive"):
        node.rate(value)


def test_no_timer_calls_after_its_node_is_closed(make: Nodes) -> None:
    a, b = make("a"), make("b")
    calls: list[int] = []
    a.timer(0.01, lambda: calls.append(1))
    a.close()
    b.spin(0.1)
    assert calls == []
    with pytest.raises(roslet.NodeClosed):
        a.timer(1, lambda: None)


def test_a_rate_keeps_its_hertz_and_serves_meanwhile(make: Nodes) -> None:
    node = make("a")
    calls: list[int] = []
    node.timer(0.01, lambda: calls.append(1))
    rate = node.rate(50)
    begin = time.monotonic()
    for _ in range(10):
        rate.sleep()
    assert 0.18 < time.monotonic() - begin < 0.3
    assert 15 <= len(calls) <= 25
    time.sleep(0.1)
    begin = time.monotonic()
    rate.sleep()
    assert time.monotonic() - begin < 0.01, "a turn that took too long is not followed by a wait"
    rate.sleep()
    assert 0.0 <= rate.remaining() <= 0.02


def test_sleep_ends_when_the_node_shuts_down(make: Nodes) -> None:
    node = make("a")
    node.timer(0.05, node.close, once=True)
    begin = time.monotonic()
    node.sleep(5)
    assert time.monotonic() - begin < 1


class SimulatedTime:
    """Publishes /clock by hand."""

    def __init__(self, make: Nodes, master: MasterServer) -> None:
        master.call("setParam", "/test", "/use_sim_time", True)
        self.source = make("clock_source")
        self.publisher = self.source.publisher("/clock", "rosgraph_msgs/Clock")

    def set(self, seconds: float) -> None:
        message: Any = self.publisher.type()
        message.clock.secs, message.clock.nsecs = int(seconds), int(seconds % 1 * 1e9)
        self.publisher.publish(message)


@pytest.fixture
def simulated(make: Nodes, master: MasterServer) -> SimulatedTime:
    return SimulatedTime(make, master)


def test_with_use_sim_time_a_node_follows_the_clock_from_its_beginning(
    make: Nodes, simulated: SimulatedTime
) -> None:
    node = make("a")
    assert node.clock.simulated, "known when the node is made"
    assert node.now().to_sec() == 0
    assert simulated.publisher.wait_for_subscribers(2, 3)
    simulated.set(12.5)
    wait_until(lambda: node.now().to_sec() == 12.5, "the time is told")


def test_the_node_that_publishes_the_clock_follows_it_too(make: Nodes, simulated: SimulatedTime) -> None:
    calls: list[float] = []
    simulated.source.timer(1.0, lambda: calls.append(simulated.source.now().to_sec()))
    assert simulated.publisher.wait_for_subscribers(1, 3)
    for seconds in (100.0, 100.5, 101.0):
        simulated.set(seconds)
        wait_until(lambda seconds=seconds: simulated.source.now().to_sec() == seconds, "it is told")  # type: ignore[misc]
        serve(0.03)
    assert calls == [101.0]


def test_simulated_timers_and_sleeps_go_by_the_clock(make: Nodes, simulated: SimulatedTime) -> None:
    node = make("a")
    calls: list[float] = []
    node.timer(1.0, lambda: calls.append(node.now().to_sec()))
    assert simulated.publisher.wait_for_subscribers(2, 3)
    for seconds in (1000.0, 1000.5, 1001.0, 1001.4, 1002.1, 1002.9, 1003.0):
        simulated.set(seconds)
        serve(0.03)
    assert calls == [1001.0, 1002.1, 1003.0]
    serve(0.1)
    assert len(calls) == 3, "wall time moves nothing"
    ticks = iter([1003.2, 1003.6, 1004.1])
    node.reactor.call_at(node.reactor.now() + 0.02, lambda: simulated.set(next(ticks)), user=True)
    node.reactor.call_at(node.reactor.now() + 0.04, lambda: simulated.set(next(ticks)), user=True)
    node.reactor.call_at(node.reactor.now() + 0.06, lambda: simulated.set(next(ticks)), user=True)
    begin = time.monotonic()
    node.sleep(1.0)
    assert node.now().to_sec() == 1004.1 and time.monotonic() - begin < 2


def test_simulated_time_may_jump_back(make: Nodes, simulated: SimulatedTime) -> None:
    node = make("a")
    calls: list[float] = []
    node.timer(1.0, lambda: calls.append(node.now().to_sec()))
    assert simulated.publisher.wait_for_subscribers(2, 3)
    for seconds in (500.0, 501.0, 10.0, 10.5, 11.0):
        simulated.set(seconds)
        serve(0.03)
    assert calls == [501.0, 11.0]


def test_a_broken_clock_message_is_counted_and_dropped(make: Nodes, simulated: SimulatedTime) -> None:
    node = make("a")
    assert simulated.publisher.wait_for_subscribers(2, 3)
    link = entry_of(simulated.publisher).links[0]
    for one in entry_of(simulated.publisher).links:
        one.channel.sock.send(b"\x03\0\0\0abc")
    assert link is not None
    wait_until(lambda: node.counters.get("malformed-message") == 1, "it is counted")
    simulated.set(7)
    wait_until(lambda: node.now().to_sec() == 7, "the clock goes on")
