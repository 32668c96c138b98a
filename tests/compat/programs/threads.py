#!/usr/bin/env python3
# A service handler waits for what a topic's callback brings; a callback calls a service; a slow callback holds up nobody.
import threading

import rospy
from std_msgs.msg import Int32, String
from std_srvs.srv import Trigger, TriggerResponse

rospy.init_node("threads")
arrived = threading.Event()
slow_done = threading.Event()
answers = []
finished = threading.Event()


def on_number(message):
    arrived.set()


def on_slow(message):
    rospy.sleep(0.5)
    slow_done.set()


def handle(request):
    return TriggerResponse(arrived.wait(5), "the number has arrived")


def on_text(message):
    answers.append(rospy.ServiceProxy("wait_for_number", Trigger)())
    finished.set()


rospy.Service("wait_for_number", Trigger, handle)
rospy.Subscriber("slow", Int32, on_slow)
rospy.Subscriber("number", Int32, on_number)
rospy.Subscriber("text", String, on_text)
pubs = [
    rospy.Publisher("slow", Int32, queue_size=1),
    rospy.Publisher("text", String, queue_size=1),
    rospy.Publisher("number", Int32, queue_size=1),
]
while not all(pub.get_num_connections() for pub in pubs):
    rospy.sleep(0.01)
pubs[0].publish(1)
pubs[1].publish("go")
rospy.sleep(0.1)
pubs[2].publish(2)
print(finished.wait(5), answers, "before the slow one", not slow_done.is_set())
print(slow_done.wait(5))
