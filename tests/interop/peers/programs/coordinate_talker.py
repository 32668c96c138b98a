#!/usr/bin/env python3
"""Moves a point and publishes where it is: the publisher of the mROS paper in rospy."""

import rospy
from mros_comm_measure.msg import Coordinate


def main():
    rospy.init_node("mros_node")
    chatter = rospy.Publisher("pong", Coordinate, queue_size=1)
    message = Coordinate()
    rate = rospy.Rate(20)
    while not rospy.is_shutdown():
        message.x += 0.5
        message.y += 10.25
        message.z += 3.125
        message.time = rospy.Time.now()
        try:
            chatter.publish(message)
            rate.sleep()
        except rospy.ROSException:
            break  # shut down since the loop looked


main()
