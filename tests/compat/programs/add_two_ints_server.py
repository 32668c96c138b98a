#!/usr/bin/env python3
import rospy
from beginner_tutorials.srv import AddTwoInts, AddTwoIntsResponse


def handle_add_two_ints(req):
    print("Returning [%s + %s = %s]" % (req.a, req.b, (req.a + req.b)), flush=True)
    if req.b == 99:
        rospy.Timer(rospy.Duration(0.1), lambda event: rospy.signal_shutdown("told so"), oneshot=True)
    return AddTwoIntsResponse(req.a + req.b)


def add_two_ints_server():
    rospy.init_node("add_two_ints_server")
    s = rospy.Service("add_two_ints", AddTwoInts, handle_add_two_ints)
    print("Ready to add two ints.", s.resolved_name, flush=True)
    rospy.spin()


if __name__ == "__main__":
    add_two_ints_server()
