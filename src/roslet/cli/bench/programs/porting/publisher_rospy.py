#!/usr/bin/env python3
import rospy
from mros_comm_measure.msg import Coordinate

rospy.init_node("mros_node")
chatter = rospy.Publisher("ping", Coordinate, queue_size=1)
msg = Coordinate()
rate = rospy.Rate(20)
while not rospy.is_shutdown():
    msg.x += 0.1
    msg.y += 10.03
    msg.z += 3.003
    msg.time = rospy.Time.now()
    chatter.publish(msg)
    rate.sleep()
