#!/usr/bin/env python3
# Timers: periods, cancelling, resetting, several at once.
import itertools
import time

import rclpy
from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from rclpy.exceptions import InvalidHandle
from rclpy.timer import TimerInfo


def spin_for(node, seconds):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=max(0.0, end - time.monotonic()))


rclpy.init()
node = rclpy.create_node("timers")
ticks = []
timer = node.create_timer(0.05, lambda: ticks.append(time.monotonic()))
print("period", timer.timer_period_ns, timer.is_canceled(), timer.is_ready())
print("next in", 0 < timer.time_until_next_call() <= 50_000_000)
begin = time.monotonic()
while len(ticks) < 10:
    rclpy.spin_once(node)
print("ten periods", 0.45 < time.monotonic() - begin < 0.75)
print("not before time", min(later - tick for tick, later in itertools.pairwise(ticks)) > 0.03)

timer.cancel()
count = len(ticks)
spin_for(node, 0.15)
print("cancelled", timer.is_canceled(), len(ticks) == count, timer.time_until_next_call())
timer.reset()
spin_for(node, 0.13)
print("reset", timer.is_canceled(), len(ticks) - count in (1, 2, 3))

timer.timer_period_ns = 20_000_000
count = len(ticks)
spin_for(node, 0.3)
print("quicker", timer.timer_period_ns, 8 < len(ticks) - count < 20)
print("since last", 0 <= timer.time_since_last_call() < 100_000_000)

# One that ends itself.
once = node.create_timer(0.01, lambda: (print("once"), once.cancel()))
spin_for(node, 0.1)

# One that starts by hand.
late = node.create_timer(0.01, lambda: print("late"), autostart=False)
spin_for(node, 0.05)
print("not started", late.is_canceled())
late.reset()
while late.is_canceled():
    rclpy.spin_once(node, timeout_sec=0.1)
rclpy.spin_once(node, timeout_sec=1.0)
node.destroy_timer(late)
print("left", len(list(node.timers)))
try:
    late.cancel()
except InvalidHandle as error:
    print("destroyed", type(error).__name__)

# A timer of steady time, and a callback that is told when it was due.
told = []


def with_info(info: TimerInfo):
    told.append(info)


steady = node.create_timer(0.02, with_info, clock=Clock(clock_type=ClockType.STEADY_TIME))
while len(told) < 2:
    rclpy.spin_once(node)
info = told[1]
print(type(info.expected_call_time).__name__, info.actual_call_time >= info.expected_call_time)
print(
    info.actual_call_time - info.expected_call_time < Duration(seconds=0.2),
    info.expected_call_time.clock_type.name,
)

# A callback that takes longer than the period: calls are not made up for.
timer.cancel()
steady.cancel()
slow = []


def slow_callback():
    slow.append(time.monotonic())
    time.sleep(0.05)


node.create_timer(0.02, slow_callback)
spin_for(node, 0.4)
print("slow", 5 <= len(slow) <= 8)
rclpy.shutdown()
