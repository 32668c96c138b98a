"""`rosgraph.names`."""

from roslet.compat.rospy.names import (
    GLOBALNS,
    PRIV_NAME,
    REMAP,
    SEP,
    canonicalize_name,
    get_ros_namespace,
    is_global,
    is_private,
    load_mappings,
    make_global_ns,
    namespace,
    ns_join,
    resolve_name,
    scoped_name,
)

__all__ = [
    "GLOBALNS",
    "PRIV_NAME",
    "REMAP",
    "SEP",
    "canonicalize_name",
    "get_ros_namespace",
    "is_global",
    "is_private",
    "load_mappings",
    "make_global_ns",
    "namespace",
    "ns_join",
    "resolve_name",
    "scoped_name",
]
