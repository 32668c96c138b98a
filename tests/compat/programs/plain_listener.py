#!/usr/bin/env python3
import rospy
from beginner_tutorials.msg import Floats


def callback(data):
    print("plain", type(data.data).__name__, data.data, data.data == (9.0,), flush=True)
    if data.data[0] == 9.0:
        rospy.signal_shutdown("done")


rospy.init_node("plain_listener")
rospy.Subscriber("floats", Floats, callback)
rospy.spin()
