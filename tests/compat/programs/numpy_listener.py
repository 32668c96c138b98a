#!/usr/bin/env python3
import rospy
from beginner_tutorials.msg import Floats
from rospy.numpy_msg import numpy_msg


def callback(data):
    print(
        "numpy",
        type(data.data).__name__,
        data.data.dtype,
        data.data,
        float(data.data.sum()),
        isinstance(data, Floats),
        flush=True,
    )
    if data.data[0] == 9.0:
        rospy.signal_shutdown("done")


rospy.init_node("listener", anonymous=True)
rospy.Subscriber("floats", numpy_msg(Floats), callback)
rospy.spin()
