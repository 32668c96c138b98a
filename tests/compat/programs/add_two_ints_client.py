#!/usr/bin/env python3
import sys

import rospy
from beginner_tutorials.srv import *

if len(sys.argv) != 3:
    sys.exit("two numbers, please")
numbers = [int(word) for word in sys.argv[1:]]
rospy.init_node("adder", anonymous=True)
rospy.wait_for_service("add_two_ints")
once = rospy.ServiceProxy("add_two_ints", AddTwoInts)
try:
    total = once(*numbers).sum
except rospy.ServiceException as failure:
    sys.exit("no total: %s" % failure)
print("the total of", numbers, "is", total)

kept = rospy.ServiceProxy("add_two_ints", AddTwoInts, persistent=True)
print(kept(a=1, b=2), kept(AddTwoIntsRequest(5, 6)).sum, kept.call(AddTwoIntsRequest(b=8)).sum)
kept.close()
print(type(kept.request_class).__name__, kept.resolved_name, kept.service_class._type)
once(0, 99)  # the server ends at this
