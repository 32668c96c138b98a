#!/usr/bin/env python3
# The level set when the node is made, and /rosout as others see it.
import rospy
from rosgraph_msgs.msg import Log

rospy.init_node("debugging", log_level=rospy.WARN)
seen = []
rospy.Subscriber("/rosout", Log, seen.append)
while not any(topic.get_num_connections() for topic in [rospy.Publisher("/rosout", Log, queue_size=1)]):
    rospy.sleep(0.01)


def say():
    rospy.loginfo("not shown")
    rospy.logwarn("shown %d", 1)
    rospy.logerr("shown %d", 2)


say()
rospy.sleep(0.3)
for log in seen:
    print(
        log.level,
        log.name,
        log.msg,
        log.file.endswith("debugging.py"),
        log.function,
        log.line,
        "/rosout" in log.topics,
    )
