#!/usr/bin/env python3
# What a handler may return, and what its caller then sees.
import rospy
from beginner_tutorials.srv import AddTwoInts, AddTwoIntsResponse
from std_srvs.srv import Empty, EmptyResponse, SetBool, SetBoolResponse, Trigger, TriggerResponse


def call(name, kind, *arguments, **keywords):
    try:
        print(name, "=", rospy.ServiceProxy(name, kind)(*arguments, **keywords))
    except Exception as error:
        print(name, "raised", type(error).__name__, error)


def refuse(request):
    raise rospy.ServiceException("refused")


rospy.init_node("services")
returned = {
    "message": SetBoolResponse(True, "ok"),
    "tuple": (True, "a"),
    "list": [False, "b"],
    "dict": {"message": "c"},
    "nothing": None,
    "one_of_two": "x",
    "unknown": {"zz": 1},
    "too_few": [1],
    "other": TriggerResponse(True, "m"),
}
for name, value in returned.items():
    rospy.Service("r_" + name, SetBool, lambda request, value=value: value)
    call("r_" + name, SetBool, True)
for name, value in {
    "nothing": None,
    "list": [],
    "dict": {},
    "message": EmptyResponse(),
    "true": True,
}.items():
    rospy.Service("e_" + name, Empty, lambda request, value=value: value)
    call("e_" + name, Empty)
rospy.Service("sum", AddTwoInts, lambda request: request.a + request.b)
call("sum", AddTwoInts, 2, 3)
call("sum", AddTwoInts, a=2)
call("sum", AddTwoInts, 1, 2, 3)
call("sum", AddTwoInts, c=1)
call("sum", AddTwoInts, 1, b=2)
call("sum", AddTwoInts, AddTwoInts._request_class(4, 5))
rospy.Service("refuse", Trigger, refuse)
call("refuse", Trigger)
try:
    rospy.Service("refuse", Trigger, refuse)
except rospy.ServiceException as error:
    print("twice:", error)
call("nobody", Trigger)
try:
    rospy.wait_for_service("nobody", timeout=0.2)
except rospy.ROSException as error:
    print(type(error).__name__, error)
rospy.wait_for_service("sum", timeout=rospy.Duration(5))
proxy = rospy.ServiceProxy("/sum", AddTwoInts, persistent=True)
proxy.wait_for_service(5)
print([proxy(number, 1).sum for number in range(5)])
proxy.close()
server = rospy.Service(
    "short", Trigger, lambda request: TriggerResponse(True, request._connection_header["callerid"])
)
call("short", Trigger)
server.shutdown("enough")
call("short", Trigger)
