#!/usr/bin/env python3
import re

import rospy
from std_msgs.msg import String


class Watch:
    def __init__(self):
        self.seen = 0
        self.subscriber = rospy.Subscriber("chatter", String, self.on_lamp)

    def on_lamp(self, lamp):
        self.seen += 1
        who = re.match("[a-z/]+", rospy.get_name()).group()  # what follows the name is random
        rospy.loginfo("%s saw <%s>", who, lamp.data)
        if " 0 to come" in lamp.data:
            rospy.signal_shutdown("all lamps are lit")


rospy.init_node("listener", anonymous=True)
watch = Watch()
rospy.spin()
print("lamps:", watch.seen, watch.subscriber.resolved_name)
