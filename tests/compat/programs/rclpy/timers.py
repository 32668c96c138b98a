#!/usr/bin/env python3
# Timers: periods, cancelling, resetting, several at once.
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
made = time.monotonic()
timer = node.create_timer(0.05, lambda: ticks.append(time.monotonic()))
print("period", timer.timer_period_ns, timer.is_canceled(), timer.is_ready())
print("next in", 0 < timer.time_until_next_call() <= 50_000_000)
begin = time.monotonic()
while len(ticks) < 10:
    rclpy.spin_once(node)
print("ten periods", 0.45 < time.monotonic() - begin < 5)
print("not before time", all(tick - made > 0.05 * number - 0.01 for number, tick in enumerate(ticks, 1)))

timer.cancel()
count = len(ticks)
spin_for(node, 0.15)
print("cancelled", timer.is_canceled(), len(ticks) == count, timer.time_until_next_call())
timer.reset()
begin = time.monotonic()
while len(ticks) == count:
    rclpy.spin_once(node)
print("reset", timer.is_canceled(), len(ticks) - count, time.monotonic() - begin > 0.04)

timer.timer_period_ns = 20_000_000
count = len(ticks)
begin = time.monotonic()
while len(ticks) < count + 10:
    rclpy.spin_once(node)
print("quicker", timer.timer_period_ns, 0.17 < time.monotonic() - begin < 5)
print("since last", 0 <= timer.time_since_last_call() < 5_000_000_000)

# One that ends itself.
once = node.create_timer(0.01, lambda: (print("once"), once.cancel()))
while not once.is_canceled():
    rclpy.spin_once(node)
spin_for(node, 0.05)

# One that starts by hand.
lates = []
late = node.create_timer(0.01, lambda: lates.append(print("late")), autostart=False)
spin_for(node, 0.05)
print("not started", late.is_canceled())
late.reset()
while not lates:
    rclpy.spin_once(node)
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
    info.actual_call_time - info.expected_call_time < Duration(seconds=5),
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
print("slow", 1 <= len(slow) <= 8)
rclpy.shutdown()
