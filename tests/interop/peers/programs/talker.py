#!/usr/bin/env python3
"""Says hello ten times a second until it is interrupted."""

import rospy
from std_msgs.msg import String


def talker():
    publisher = rospy.Publisher("chatter", String, queue_size=10)
    rospy.init_node("talker", anonymous=True)
    rospy.on_shutdown(lambda: print("talker ends", flush=True))
    rate = rospy.Rate(20)
    count = 0
    while not rospy.is_shutdown():
        publisher.publish("hello %d" % count)
        count += 1
        rate.sleep()


if __name__ == "__main__":
    try:
        talker()
    except rospy.ROSException:
        print("talker was interrupted in its sleep or while it published", flush=True)
