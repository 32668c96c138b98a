#!/usr/bin/env python3
# A subscriber of any type, which finds the class by what the publisher says of itself.
import threading

import roslib.message
import rospy
from beginner_tutorials.msg import Person

rospy.init_node("generic")
heard = threading.Event()


def callback(message):
    header = message._connection_header
    print(
        type(message).__name__,
        len(message._buff),
        header["type"],
        header["md5sum"] == Person._md5sum,
        header["callerid"],
        header["topic"],
        header["extra"],
    )
    kind = roslib.message.get_message_class(header["type"])
    filled = kind().deserialize(message._buff)
    print(filled, isinstance(filled, Person))
    heard.set()


rospy.Subscriber("anything", rospy.AnyMsg, callback)
pub = rospy.Publisher("anything", Person, queue_size=1, headers={"extra": "yes"}, tcp_nodelay=True)
while not pub.get_num_connections():
    rospy.sleep(0.01)
pub.publish(Person("Alan", "Turing", 41, 1))
heard.wait(5)
