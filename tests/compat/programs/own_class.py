#!/usr/bin/env python3
# Classes of one's own, made of a message class.
import threading

import rospy
from beginner_tutorials.msg import Person


class Named(Person):
    def __str__(self):
        return f"{self.first_name} {self.last_name}"


class Older(Named):
    def __init__(self, *args, **kwds):
        super().__init__(*args, **kwds)
        self.age += 1


rospy.init_node("own_class")
heard = threading.Event()


def callback(message):
    print(type(message).__name__, message, message.age)
    if message.first_name == "last":
        heard.set()


print(Named(first_name="Ada", last_name="Lovelace"), Older("Alan", "Turing", 41, 1).age, Named() == Named())
rospy.Subscriber("people", Named, callback)
pub = rospy.Publisher("people", Named, queue_size=10)
while not pub.get_num_connections():
    rospy.sleep(0.01)
pub.publish(Named("Grace", "Hopper", 85, 1))
pub.publish("Alan", "Turing", 41, 1)
pub.publish(Older(first_name="last", age=1))
heard.wait(5)
