"""A rospy node that talks with the board's. Lines: `param NAME`, `set NAME NUMBER`, `topics`; anything else goes to /ask.

Run by /usr/bin/python3.
"""

import sys

import rospy
from rosgraph_msgs.msg import Log
from std_msgs.msg import String


def heard(message):
    print("said", message.data, flush=True)


def logged(entry):
    if entry.name == "/board":
        print("logged", entry.name, entry.level, entry.msg, flush=True)


rospy.init_node("looker", disable_signals=True)
rospy.Subscriber("/said", String, heard)
rospy.Subscriber("/rosout", Log, logged)
ask = rospy.Publisher("/ask", String, queue_size=10)
while ask.get_num_connections() < 1:
    rospy.sleep(0.02)
rospy.sleep(0.3)  # the board's answers and log have been connected by then
print("ready", flush=True)
for line in sys.stdin:
    word, _, rest = line.rstrip("\n").partition(" ")
    if word == "param":
        print("param", rospy.get_param(rest), flush=True)
    elif word == "set":
        name, _, number = rest.partition(" ")
        rospy.set_param(name, int(number))
        print("set", flush=True)
    elif word == "topics":
        print("topics", [tuple(one) for one in rospy.get_published_topics()], flush=True)
    else:
        ask.publish(line.rstrip("\n"))
