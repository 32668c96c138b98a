#!/usr/bin/env python3
# Names: what is valid, how they expand; arguments that are not ROS's.
import rclpy
from rclpy.expand_topic_name import expand_topic_name
from rclpy.topic_or_service_is_hidden import topic_or_service_is_hidden
from rclpy.utilities import remove_ros_args, timeout_sec_to_nsec
from rclpy.validate_full_topic_name import validate_full_topic_name
from rclpy.validate_namespace import validate_namespace
from rclpy.validate_node_name import validate_node_name
from rclpy.validate_parameter_name import validate_parameter_name
from rclpy.validate_topic_name import validate_topic_name


def show(function, *args, **kwargs):
    try:
        print(function.__name__, args, kwargs, "->", function(*args, **kwargs))
    except Exception as error:
        print(function.__name__, args, kwargs, "raised", type(error).__name__, error)


for name in ("node", "node_1", "", "1node", "no-de", "no/de", "nö", "a" * 256, "_hidden"):
    show(validate_node_name, name)
for name in ("/", "/a/b", "", "a", "/a/", "/1a", "/a//b", "/a b", "/a_", "/a__b", "/" + "n" * 300):
    show(validate_namespace, name)
for name in (
    "chatter",
    "/chatter",
    "~/chatter",
    "~",
    "",
    "a/",
    "/",
    "1a",
    "a b",
    "a//b",
    "{node}/a",
    "{ns",
    "a}b",
    "{1a}",
    "a~b",
    "a__b",
    "ä",
    "_a",
):
    show(validate_topic_name, name)
show(validate_topic_name, "a b", is_service=True)
for name in (
    "/chatter",
    "chatter",
    "/a/b",
    "/a/",
    "/",
    "",
    "/1a",
    "/a__b",
    "/a//b",
    "/a{b}",
    "/~",
    "/" + "t" * 300,
):
    show(validate_full_topic_name, name)
show(validate_full_topic_name, "a", is_service=True)
for name in ("", "a", "a.b", "a b"):
    show(validate_parameter_name, name)
for name, node, namespace in (
    ("chatter", "node", "/"),
    ("chatter", "node", "/ns"),
    ("~/chatter", "node", "/ns"),
    ("~", "node", "/ns"),
    ("/chatter", "node", "/ns"),
    ("{node}/x", "node", "/ns"),
    ("{ns}/x", "node", "/ns"),
    ("{namespace}/x", "node", "/"),
    ("{other}/x", "node", "/"),
    ("white space", "node", "/ns"),
    ("chatter", "no de", "/ns"),
    ("chatter", "node", "ns"),
):
    show(expand_topic_name, name, node, namespace)
for name in ("/a/_b", "/_a/b", "/a/b", "_a", "/a_/b"):
    show(topic_or_service_is_hidden, name)
for seconds in (None, -1, 0, 1.5, 1e-10):
    show(timeout_sec_to_nsec, seconds)
for args in (
    ["program", "--ros-args", "-r", "a:=b"],
    ["program", "x", "--ros-args", "-r", "a:=b", "--", "y", "-z"],
    ["program", "a:=b", "--ros-args", "-p", "n:=1", "--", "--ros-args", "--log-level", "info"],
    ["program", "--ros-args"],
    [],
):
    show(remove_ros_args, args)
show(remove_ros_args, ["program", "--ros-args", "--unknown", "-r", "a:=b"])
