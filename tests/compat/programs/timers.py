#!/usr/bin/env python3
import rospy

rospy.init_node("timers")
events = []


def callback(event):
    events.append(event)


timer = rospy.Timer(rospy.Duration(0.05), callback)
rospy.sleep(0.28)
timer.shutdown()
timer.join()
count = len(events)
print("five or so", 4 <= count <= 6)
first, second = events[0], events[1]
print(first.last_expected, first.last_real, first.last_duration, type(first.current_real).__name__)
print(
    second.last_expected == first.current_expected,
    second.last_real == first.current_real,
    type(second.last_duration).__name__,
)
step = (second.current_expected - first.current_expected).to_sec()
print(
    "expected step",
    round(step, 6),
    "late by less than a second",
    abs((second.current_real - second.current_expected).to_sec()) < 1,
)
rospy.sleep(0.2)
print("none after shutdown", len(events) == count)
once = []
rospy.Timer(rospy.Duration(0.02), once.append, oneshot=True)
rospy.sleep(rospy.Duration(0, 200000000))
print("once", len(once))
rate = rospy.Rate(20)
start = rospy.Time.now()
for _ in range(6):
    rate.sleep()
took = rospy.Time.now() - start
print(
    "six turns of 50 ms", 0.25 < took.to_sec() < 0.4, rate.sleep_dur, rate.remaining() <= rospy.Duration(0.05)
)
print(type(took).__name__, type(start).__name__, rospy.get_time() - rospy.get_rostime().to_sec() < 1)
