#!/usr/bin/env python3
import sys

import rospy
from beginner_tutorials.srv import *


def add_two_ints_client(x, y):
    rospy.wait_for_service("add_two_ints")
    try:
        add_two_ints = rospy.ServiceProxy("add_two_ints", AddTwoInts)
        resp1 = add_two_ints(x, y)
        return resp1.sum
    except rospy.ServiceException as e:
        print("Service call failed: %s" % e)


def usage():
    return "%s [x y]" % sys.argv[0].rsplit("/")[-1]


if __name__ == "__main__":
    if len(sys.argv) == 3:
        x = int(sys.argv[1])
        y = int(sys.argv[2])
    else:
        print(usage())
        sys.exit(1)
    rospy.init_node("client", anonymous=True)
    print("Requesting %s+%s" % (x, y))
    print("%s + %s = %s" % (x, y, add_two_ints_client(x, y)))
    proxy = rospy.ServiceProxy("add_two_ints", AddTwoInts, persistent=True)
    print(proxy(a=1, b=2), proxy(AddTwoIntsRequest(5, 6)).sum, proxy.call(AddTwoIntsRequest(b=8)).sum)
    proxy.close()
    print(type(proxy.request_class).__name__, proxy.resolved_name, proxy.service_class._type)
    rospy.ServiceProxy("add_two_ints", AddTwoInts)(0, 99)
