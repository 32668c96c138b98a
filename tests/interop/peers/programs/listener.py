#!/usr/bin/env python3
"""Prints what it hears, five times."""

import rospy
from std_msgs.msg import String

heard = []


def callback(message, arguments):
    rospy.loginfo("%s: I heard %s", rospy.get_caller_id(), message.data)
    heard.append(message.data)
    print(arguments[0], message.data, flush=True)
    if len(heard) == 5:
        rospy.signal_shutdown("enough")


def listener():
    rospy.init_node("listener", anonymous=True)
    rospy.Subscriber("chatter", String, callback, ("heard",), queue_size=10)
    rospy.spin()
    numbers = [int(text.split()[1]) for text in heard[:5]]
    print("in order", numbers == list(range(numbers[0], numbers[0] + 5)), flush=True)


if __name__ == "__main__":
    listener()
