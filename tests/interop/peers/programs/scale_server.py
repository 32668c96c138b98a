#!/usr/bin/env python3
"""Scales points; refuses the factor zero."""

import rospy
from peer_msgs.srv import Scale, ScaleRequest, ScaleResponse


def handle(request):
    assert isinstance(request, ScaleRequest)
    if request.factor == 0:
        raise rospy.ServiceException("factor is zero")
    if request.factor < 0:
        return None
    for point in request.points:
        point.x *= request.factor
    if len(request.points) == 1:
        return {"points": request.points, "text": "one"}
    return ScaleResponse(request.points, "scaled %d" % len(request.points))


rospy.init_node("scale_server")
service = rospy.Service("scale", Scale, handle)
print("ready", service.resolved_name, flush=True)
rospy.spin()
