#!/usr/bin/python3
"""Started by roslaunch: repeats what it hears, louder, as often as its private parameter says."""

import rospy
from std_msgs.msg import String


def main():
    rospy.init_node("shout")
    times = rospy.get_param("~times")
    publisher = rospy.Publisher("loud", String, queue_size=10)
    rospy.Subscriber("quiet", String, lambda message: publisher.publish(message.data.upper() * times))
    rospy.spin()


main()
