#!/usr/bin/env python3
# A publisher that exists before its node does; init_node gives it the network.
import rospy
from std_msgs.msg import String

BEACON = rospy.Publisher("chatter", String, queue_size=10)


def main():
    rospy.init_node("talker", anonymous=True)
    beat = rospy.Rate(50)
    while not rospy.is_shutdown() and not BEACON.get_num_connections():
        beat.sleep()
    for left in range(4, -1, -1):
        text = "lamp %d of 5, %d to come" % (5 - left, left)
        BEACON.publish(text)
        rospy.loginfo("lit: " + text)
        beat.sleep()


try:
    main()
except rospy.ROSInterruptException:
    print("interrupted")
