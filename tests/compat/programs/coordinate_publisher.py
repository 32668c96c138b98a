#!/usr/bin/env python3
# Figure 9 of the mROS paper in rospy.
import rospy
from beginner_tutorials.msg import Coordinate

rospy.init_node("mros_node")
chatter = rospy.Publisher("ping", Coordinate, queue_size=1)
msg = Coordinate()
while chatter.get_num_connections() == 0:
    rospy.sleep(0.01)
for _ in range(10):
    msg.x += 0.1
    msg.y += 10.03
    msg.z += 3.003
    msg.time.secs = int(rospy.Time.now().to_sec())
    chatter.publish(msg)
    rospy.sleep(0.02)
