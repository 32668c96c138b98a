#!/usr/bin/env python3
# The publisher is made before the node, as the first tutorial does.
import rospy
from std_msgs.msg import String


def talker():
    pub = rospy.Publisher("chatter", String, queue_size=10)
    rospy.init_node("talker", anonymous=True)
    rate = rospy.Rate(50)
    while pub.get_num_connections() == 0 and not rospy.is_shutdown():
        rate.sleep()
    for number in range(5):
        hello_str = "hello world %d" % number
        rospy.loginfo(hello_str)
        pub.publish(hello_str)
        rate.sleep()


if __name__ == "__main__":
    try:
        talker()
    except rospy.ROSInterruptException:
        pass
