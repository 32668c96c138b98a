#!/usr/bin/env python3
# Time as /clock tells it.
import threading
import time

import rospy
from rosgraph_msgs.msg import Clock

rospy.set_param("/use_sim_time", True)
rospy.init_node("simulated_time")
print("simulated", not rospy.rostime.is_wallclock(), rospy.Time.now(), rospy.get_time())
pub = rospy.Publisher("/clock", Clock, queue_size=100)
while not pub.get_num_connections():
    time.sleep(0.01)
stop = threading.Event()


def tick():
    now = rospy.Time(100)
    while not stop.is_set():
        pub.publish(now)
        now += rospy.Duration(0.1)
        time.sleep(0.005)


thread = threading.Thread(target=tick)
thread.start()
while rospy.Time.now().is_zero():
    time.sleep(0.01)
start = rospy.Time.now()
wall = time.time()
rospy.sleep(5)
print(
    "slept five seconds of it",
    4.9 < (rospy.Time.now() - start).to_sec() < 7,
    "in less than one",
    time.time() - wall < 1,
)
rate = rospy.Rate(1)
start = rospy.Time.now()
for _ in range(3):
    rate.sleep()
print("three turns", 1.9 < (rospy.Time.now() - start).to_sec() < 4.5)
events = []
timer = rospy.Timer(rospy.Duration(2), events.append)
rospy.sleep(9)
timer.shutdown()
timer.join()
print("timer", 3 <= len(events) <= 5, (events[1].current_expected - events[0].current_expected).to_sec())
rospy.loginfo("with both times")
stop.set()
thread.join()
threading.Timer(0.2, lambda: pub.publish(rospy.Time(1))).start()
try:
    rospy.sleep(50)
except rospy.exceptions.ROSTimeMovedBackwardsException as error:
    print(type(error).__name__, error, error.time < 0)
threading.Timer(0.2, lambda: rospy.signal_shutdown("end")).start()
try:
    rospy.sleep(50)
except rospy.ROSInterruptException as error:
    print(type(error).__name__, error)
rospy.delete_param("/use_sim_time")
