#!/usr/bin/env python3
# Time, Duration and clocks without a network.
import time

from builtin_interfaces.msg import Duration as DurationMsg
from builtin_interfaces.msg import Time as TimeMsg
from rclpy.clock import Clock, ClockChange, ClockType, JumpThreshold, ROSClock, TimeJump
from rclpy.constants import S_TO_NS
from rclpy.duration import Duration, Infinite
from rclpy.time import Time


def show(name, function):
    try:
        print(name, function())
    except Exception as error:
        print(name, "raised", type(error).__name__, error)


show("time", lambda: Time(seconds=1, nanoseconds=500))
show("of float", lambda: Time(seconds=1.5, nanoseconds=0.9))
show("default", lambda: Time())
show("negative", lambda: Time(seconds=-1))
show("negative", lambda: Time(nanoseconds=-1))
show("large", lambda: Time(nanoseconds=2**63))
show("largest", lambda: Time(nanoseconds=2**63 - 1))
show("clock type", lambda: Time(clock_type="ROS"))
show("parts", lambda: Time(nanoseconds=1_500_000_002).seconds_nanoseconds())
show("duration", lambda: Duration(seconds=1, nanoseconds=5))
show("negative", lambda: Duration(seconds=-1.5))
show("nanoseconds", lambda: Duration(nanoseconds=-7).nanoseconds)
show("large", lambda: Duration(nanoseconds=2**63))
show("small", lambda: Duration(nanoseconds=-(2**63)))
show("smaller", lambda: Duration(nanoseconds=-(2**63) - 1))
show("infinite", lambda: Infinite)

ros = Time(seconds=10, clock_type=ClockType.ROS_TIME)
system = Time(seconds=10)
second = Duration(seconds=1)
show("plus", lambda: ros + second)
show("plus", lambda: second + ros)
show("minus", lambda: ros - second)
show("between", lambda: (ros + second) - ros)
show("negative", lambda: ros - (ros + second))
show("other clock", lambda: ros - system)
show("below zero", lambda: ros - Duration(seconds=11))
show("beyond", lambda: Time(nanoseconds=2**63 - 1) + second)
show("wrong", lambda: ros + 1)
show("wrong", lambda: ros - 1)
show("wrong", lambda: ros + ros)
show("durations", lambda: second + second)
show("durations", lambda: second - Duration(seconds=3))
show("durations", lambda: second * 2)
show("durations", lambda: second * 0.5)
show("durations", lambda: Infinite + second)
show("durations", lambda: Infinite - second)
show("equal", lambda: (ros == Time(seconds=10, clock_type=ClockType.ROS_TIME), ros != ros + second))
show("equal", lambda: ros == system)
show("equal", lambda: ros == 10)
show("less", lambda: (ros < ros + second, ros <= ros, ros > ros, ros >= ros))
show("less", lambda: ros < system)
show("less", lambda: ros < 10)
show(
    "durations",
    lambda: (second == Duration(nanoseconds=S_TO_NS), second != second, second < Infinite, second >= second),
)
show("durations", lambda: second == 1)
show("durations", lambda: second < 1)
show("hash", lambda: hash(second) == hash(Duration(seconds=1)))
show("hash", lambda: hash(ros) == hash(Time(seconds=10, clock_type=ClockType.ROS_TIME)))

show("to message", lambda: Time(seconds=3, nanoseconds=4).to_msg())
show("to message", lambda: Duration(seconds=-3, nanoseconds=-4).to_msg())
show("from message", lambda: Time.from_msg(TimeMsg(sec=5, nanosec=6)))
show("from message", lambda: Time.from_msg(TimeMsg(sec=5), clock_type=ClockType.STEADY_TIME))
show("from message", lambda: Duration.from_msg(DurationMsg(sec=-5, nanosec=6)))
show("from another", lambda: Time.from_msg(DurationMsg()))
show("from another", lambda: Duration.from_msg(TimeMsg()))

for kind in (ClockType.SYSTEM_TIME, ClockType.STEADY_TIME, ClockType.ROS_TIME):
    clock = Clock(clock_type=kind)
    first = clock.now()
    print(
        kind.name,
        type(clock).__name__,
        first.clock_type == kind,
        clock.clock_type == kind,
        clock.now() >= first,
    )
show("a clock", lambda: Clock().clock_type.name)
show("a clock", lambda: Clock(clock_type=1))
now = Clock().now()
print("since the epoch", abs(now.nanoseconds * 1e-9 - time.time()) < 1.0)

clock = ROSClock()
print(clock.ros_time_is_active, clock.clock_type == ClockType.ROS_TIME)
clock._set_ros_time_is_active(True)
clock.set_ros_time_override(Time(seconds=100, clock_type=ClockType.ROS_TIME))
print(clock.ros_time_is_active, clock.now())
jumps = []
handle = clock.create_jump_callback(
    JumpThreshold(min_forward=Duration(seconds=1), min_backward=Duration(seconds=-1), on_clock_change=True),
    pre_callback=lambda: jumps.append("before"),
    post_callback=lambda jump: jumps.append((type(jump).__name__, jump.clock_change.name, jump.delta)),
)
clock.set_ros_time_override(Time(seconds=100.5, clock_type=ClockType.ROS_TIME))
print(jumps)
clock.set_ros_time_override(Time(seconds=103, clock_type=ClockType.ROS_TIME))
print(jumps)
jumps.clear()
clock.set_ros_time_override(Time(seconds=90, clock_type=ClockType.ROS_TIME))
print(jumps)
jumps.clear()
clock._set_ros_time_is_active(False)
print([jump if isinstance(jump, str) else jump[:2] for jump in jumps])
jumps.clear()
handle.unregister()
clock._set_ros_time_is_active(True)
print(jumps)
show("threshold", lambda: JumpThreshold(min_forward=Duration(seconds=-1), min_backward=None))
show("threshold", lambda: JumpThreshold(min_forward=None, min_backward=Duration(seconds=1)))
show("threshold", lambda: JumpThreshold(min_forward=None, min_backward=None, on_clock_change=False))
show(
    "jump",
    lambda: clock.create_jump_callback(JumpThreshold(min_forward=None, min_backward=None), pre_callback="no"),
)
