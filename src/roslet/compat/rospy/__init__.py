"""rospy's public names, on a roslet node. Found as `rospy` under `roslet run`.

Written from rospy's API documentation; FEATURES.md says what is not there and where behaviour differs.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from roslet.compat.genpy import Message
from roslet.compat.rospy import (
    client,
    core,
    exceptions,
    impl,
    msg,
    msproxy,
    names,
    rostime,
    service,
    timer,
    topics,
)
from roslet.compat.rospy.client import (
    delete_param,
    get_master,
    get_param,
    get_param_cached,
    get_param_names,
    get_published_topics,
    has_param,
    init_node,
    myargv,
    on_shutdown,
    search_param,
    set_param,
    spin,
    wait_for_message,
)
from roslet.compat.rospy.core import (
    get_node_uri,
    is_shutdown,
    logdebug,
    logdebug_once,
    logdebug_throttle,
    logdebug_throttle_identical,
    logerr,
    logerr_once,
    logerr_throttle,
    logerr_throttle_identical,
    logfatal,
    logfatal_once,
    logfatal_throttle,
    logfatal_throttle_identical,
    loginfo,
    loginfo_once,
    loginfo_throttle,
    loginfo_throttle_identical,
    logout,
    logwarn,
    logwarn_once,
    logwarn_throttle,
    logwarn_throttle_identical,
    parse_rosrpc_uri,
    signal_shutdown,
)
from roslet.compat.rospy.exceptions import (
    ROSException,
    ROSInitException,
    ROSInternalException,
    ROSInterruptException,
    ROSSerializationException,
    ROSTimeMovedBackwardsException,
    TransportException,
    TransportInitError,
    TransportTerminated,
)
from roslet.compat.rospy.impl.tcpros_service import Service, ServiceProxy, wait_for_service
from roslet.compat.rospy.msg import AnyMsg
from roslet.compat.rospy.msproxy import MasterProxy
from roslet.compat.rospy.names import (
    get_caller_id,
    get_name,
    get_namespace,
    remap_name,
    resolve_name,
)
from roslet.compat.rospy.rostime import Duration, Time, get_rostime, get_time
from roslet.compat.rospy.service import ServiceException
from roslet.compat.rospy.timer import Rate, Timer, sleep
from roslet.compat.rospy.topics import Publisher, SubscribeListener, Subscriber
from roslet.node.log import DEBUG, ERROR, FATAL, INFO, WARN

if TYPE_CHECKING:
    from collections.abc import Mapping


def get_ros_root(required: bool = False, env: Mapping[str, str] | None = None) -> str | None:
    """$ROS_ROOT. Raises ROSException where it is not set and `required`."""
    root = (os.environ if env is None else env).get("ROS_ROOT")
    if root is None and required:
        raise ROSException("ROS_ROOT is not set")
    return root


def __getattr__(name: str) -> Any:
    """`rospy.Header`, made when it is used."""
    if name == "Header":
        from roslet.compat.messages import adapt
        from roslet.gen.runtime import message_class

        return adapt(message_class("ros1", "std_msgs/Header"))
    raise AttributeError(f"module 'rospy' has no attribute {name!r}")


__all__ = [
    "DEBUG",
    "ERROR",
    "FATAL",
    "INFO",
    "WARN",
    "AnyMsg",
    "Duration",
    "MasterProxy",
    "Message",
    "Publisher",
    "ROSException",
    "ROSInitException",
    "ROSInternalException",
    "ROSInterruptException",
    "ROSSerializationException",
    "ROSTimeMovedBackwardsException",
    "Rate",
    "Service",
    "ServiceException",
    "ServiceProxy",
    "SubscribeListener",
    "Subscriber",
    "Time",
    "Timer",
    "TransportException",
    "TransportInitError",
    "TransportTerminated",
    "client",
    "core",
    "delete_param",
    "exceptions",
    "get_caller_id",
    "get_master",
    "get_name",
    "get_namespace",
    "get_node_uri",
    "get_param",
    "get_param_cached",
    "get_param_names",
    "get_published_topics",
    "get_ros_root",
    "get_rostime",
    "get_time",
    "has_param",
    "impl",
    "init_node",
    "is_shutdown",
    "logdebug",
    "logdebug_once",
    "logdebug_throttle",
    "logdebug_throttle_identical",
    "logerr",
    "logerr_once",
    "logerr_throttle",
    "logerr_throttle_identical",
    "logfatal",
    "logfatal_once",
    "logfatal_throttle",
    "logfatal_throttle_identical",
    "loginfo",
    "loginfo_once",
    "loginfo_throttle",
    "loginfo_throttle_identical",
    "logout",
    "logwarn",
    "logwarn_once",
    "logwarn_throttle",
    "logwarn_throttle_identical",
    "msg",
    "msproxy",
    "myargv",
    "names",
    "on_shutdown",
    "parse_rosrpc_uri",
    "remap_name",
    "resolve_name",
    "rostime",
    "search_param",
    "service",
    "set_param",
    "signal_shutdown",
    "sleep",
    "spin",
    "timer",
    "topics",
    "wait_for_message",
    "wait_for_service",
]
