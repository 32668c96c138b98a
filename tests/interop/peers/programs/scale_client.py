#!/usr/bin/env python3
"""Calls the scaler in every way that rospy knows."""

import rospy
from mros_comm_measure.msg import Coordinate
from peer_msgs.srv import Scale, ScaleRequest

rospy.init_node("scale_client")
rospy.wait_for_service("scale", timeout=10)
scale = rospy.ServiceProxy("scale", Scale)
print(scale([Coordinate(x=2.0)], 0.5))
print(scale(points=[Coordinate(x=2.0), Coordinate(x=4.0)], factor=2.0).text)
print(scale.call(ScaleRequest(points=[], factor=1.0)).text)
request = ScaleRequest()
request.factor = 3.0
print(scale(request).text)
for factor in (0.0, -1.0):
    try:
        scale([], factor)
    except rospy.ServiceException as error:
        print("refused", "factor is zero" in str(error))
persistent = rospy.ServiceProxy("scale", Scale, persistent=True)
print([persistent([], 1.0).text for _ in range(3)])
persistent.close()
try:
    rospy.wait_for_service("nobody", timeout=0.2)
except rospy.ROSException as error:
    print(type(error).__name__, error)
try:
    scale(1, 2, 3)
except TypeError:
    print("TypeError")
