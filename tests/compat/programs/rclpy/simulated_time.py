#!/usr/bin/env python3
# Time from /clock.
import time

import rclpy
from rclpy.clock import ClockType
from rclpy.duration import Duration
from rclpy.parameter import Parameter
from rclpy.qos import qos_profile_sensor_data
from rosgraph_msgs.msg import Clock

rclpy.init()
node = rclpy.create_node("simulated", parameter_overrides=[Parameter("use_sim_time", value=True)])
source = rclpy.create_node("source")
publisher = source.create_publisher(Clock, "/clock", 10)
clock = node.get_clock()
print(clock.now().nanoseconds, clock.ros_time_is_active, clock.clock_type.name)
while publisher.get_subscription_count() == 0:
    rclpy.spin_once(node, timeout_sec=0.05)


def tell(seconds):
    message = Clock()
    message.clock.sec = int(seconds)
    message.clock.nanosec = round(seconds % 1 * 1e9)
    publisher.publish(message)
    end = time.monotonic() + 5
    while abs(clock.now().nanoseconds - seconds * 1e9) > 1 and time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=0.05)


tell(100)
print(clock.now())
ticks = []
timer = node.create_timer(1.0, lambda: ticks.append(clock.now().nanoseconds))
for seconds in (100.5, 101.0, 101.2, 102.5, 102.6):
    tell(seconds)
    for _ in range(3):
        rclpy.spin_once(node, timeout_sec=0.02)
    print(seconds, len(ticks), timer.time_until_next_call())
begin = clock.now()
tell(110)
print(clock.now() - begin)
print(source.get_clock().now().nanoseconds > 10**18, source.get_clock().ros_time_is_active)
node.set_parameters([Parameter("use_sim_time", value=False)])
print(clock.ros_time_is_active, clock.now().nanoseconds > 10**18)
node.set_parameters([Parameter("use_sim_time", value=True)])
print(clock.ros_time_is_active, clock.now().nanoseconds)
print([result.successful for result in node.set_parameters([Parameter("use_sim_time", value=3)])])
rclpy.shutdown()
