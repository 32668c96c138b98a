#!/usr/bin/env python3
import rospy
from mros_comm_measure.msg import Coordinate


def callback(msg):
    print("I heard [x:%d, y:%d, z:%d]" % (msg.x * 1000, msg.y * 1000, msg.z * 1000), flush=True)


rospy.init_node("mros_sub_node")
rospy.Subscriber("ping", Coordinate, callback, queue_size=1)
rospy.spin()
