#!/usr/bin/env python3
import rospy
from std_msgs.msg import String


def callback(data):
    rospy.loginfo(rospy.get_name().rstrip("0123456789_") + " I heard %s", data.data)
    if data.data.endswith("4"):
        rospy.signal_shutdown("heard enough")


def listener():
    rospy.init_node("listener", anonymous=True)
    rospy.Subscriber("chatter", String, callback)
    rospy.spin()
    print("listener ends")


if __name__ == "__main__":
    listener()
