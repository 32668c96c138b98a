#!/usr/bin/env python3
# Figure 10 of the mROS paper in rospy.
import rospy
from beginner_tutorials.msg import Coordinate

heard = []


def callback(msg):
    rospy.loginfo("I heard[x: %f, y: %f, z: %f]", msg.x, msg.y, msg.z)
    age = rospy.Time.now() - msg.time
    heard.append(rospy.Duration(0) <= age < rospy.Duration(5))
    if len(heard) == 10:
        rospy.signal_shutdown("ten")


rospy.init_node("mros_pub_node")
rospy.Subscriber("ping", Coordinate, callback, queue_size=10)
rospy.spin()
print("fresh", all(heard))
