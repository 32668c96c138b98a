#!/usr/bin/env python3
import rospy
from beginner_tutorials.srv import AddTwoInts, AddTwoIntsResponse

LAST = 99


def add(request):
    total = request.a + request.b
    print("asked for", request.a, "and", request.b, "so", total, flush=True)
    if request.b == LAST:
        rospy.Timer(rospy.Duration(0.1), lambda event: rospy.signal_shutdown("the last one"), oneshot=True)
    return AddTwoIntsResponse(total)


rospy.init_node("add_two_ints_server")
service = rospy.Service("add_two_ints", AddTwoInts, add)
print("serving", service.resolved_name, flush=True)
rospy.spin()
