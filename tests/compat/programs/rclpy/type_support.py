#!/usr/bin/env python3
# Whether something is an interface class, and how its hash is written.
from rcl_interfaces.msg import Log
from rclpy.type_hash import TypeHash
from rclpy.type_support import check_for_type_support, check_is_valid_msg_type, check_is_valid_srv_type
from std_msgs.msg import String
from std_srvs.srv import Trigger


def show(name, function):
    try:
        print(name, function())
    except Exception as error:
        print(name, "raised", type(error).__name__)


show("message", lambda: check_is_valid_msg_type(String))
show("service", lambda: check_is_valid_srv_type(Trigger))
show("service as message", lambda: check_is_valid_msg_type(Trigger))
show("message as service", lambda: check_is_valid_srv_type(String))
show("any", lambda: check_for_type_support(Log))
show("int", lambda: check_for_type_support(int))
print(TypeHash(), TypeHash(version=1, value=bytes(range(32))))
show("short", lambda: TypeHash(version=1, value=b"short"))
print(TypeHash() == TypeHash(), TypeHash().version, len(TypeHash().value))
