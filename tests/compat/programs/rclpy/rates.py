#!/usr/bin/env python3
# Rates and sleeping clocks, with an executor in another thread.
import threading
import time

import rclpy
from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from rclpy.exceptions import ROSInterruptException

rclpy.init()
node = rclpy.create_node("rates")
thread = threading.Thread(target=rclpy.spin, args=(node,), daemon=True)
thread.start()
rate = node.create_rate(20)
begin = time.monotonic()
for _ in range(6):
    rate.sleep()
took = time.monotonic() - begin
print("six turns of 50 ms", 0.24 < took < 0.5)
print(node.destroy_rate(rate))
for wrong in (0, -1.0):
    try:
        node.create_rate(wrong)
    except Exception as error:
        print(type(error).__name__)

clock = node.get_clock()
begin = time.monotonic()
print(clock.sleep_for(Duration(seconds=0.1)), 0.09 < time.monotonic() - begin < 0.4)
begin = time.monotonic()
print(clock.sleep_until(clock.now() + Duration(seconds=0.1)), 0.09 < time.monotonic() - begin < 0.4)
print(clock.sleep_until(clock.now() - Duration(seconds=1)))
steady = Clock(clock_type=ClockType.STEADY_TIME)
begin = time.monotonic()
print(steady.sleep_for(Duration(seconds=0.1)), 0.09 < time.monotonic() - begin < 0.4)
try:
    steady.sleep_until(clock.now())
except ValueError as error:
    print(error)

# The end of the context wakes sleepers.
rate = node.create_rate(0.1)
woken = []


def sleeper():
    try:
        rate.sleep()
        woken.append("slept")
    except ROSInterruptException:
        woken.append("interrupted")


others = [
    threading.Thread(target=sleeper),
    threading.Thread(target=lambda: woken.append(steady.sleep_for(Duration(seconds=10)))),
]
for other in others:
    other.start()
    time.sleep(0.1)
rclpy.shutdown()
for other in others:
    other.join(8)
print(sorted(map(str, woken)))
