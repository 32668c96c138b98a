#!/usr/bin/env python3
"""Prints where the point is, three times: the subscriber of the mROS paper in rospy."""

import rospy
from mros_comm_measure.msg import Coordinate

count = 0


def callback(message):
    global count
    steps = message.x / 0.5
    whole = steps == int(steps) and message.y == steps * 10.25 and message.z == steps * 3.125
    age = rospy.Time.now() - message.time
    fresh = rospy.Duration(-1) < age < rospy.Duration(10)
    print("I heard", whole, fresh, isinstance(message, Coordinate), flush=True)
    count += 1
    if count == 3:
        rospy.signal_shutdown("enough")


rospy.init_node("mros_pub_node")
rospy.Subscriber("pong", Coordinate, callback, queue_size=1)
rospy.spin()
