"""`roslib.names`."""

from roslet.compat.rospy.names import (
    GLOBALNS,
    PRIV_NAME,
    REMAP,
    SEP,
    get_ros_namespace,
    is_global,
    is_private,
    load_mappings,
    make_global_ns,
    namespace,
    ns_join,
)

__all__ = [
    "GLOBALNS",
    "PRIV_NAME",
    "REMAP",
    "SEP",
    "get_ros_namespace",
    "is_global",
    "is_private",
    "load_mappings",
    "make_global_ns",
    "namespace",
    "ns_join",
]
