#!/usr/bin/env python3
import sys

import rospy


def show(text):
    try:
        print(text, "=", repr(eval(text)))
    except Exception as error:
        print(text, "raised", type(error).__name__)


def everything():
    for text in """
rospy.get_name()
rospy.get_namespace()
rospy.get_caller_id()
rospy.resolve_name('a')
rospy.resolve_name('a/b/')
rospy.resolve_name('/a//b')
rospy.resolve_name('~a')
rospy.resolve_name('')
rospy.resolve_name('old')
rospy.resolve_name('/abs')
rospy.resolve_name('a', '/other/node')
rospy.resolve_name('~a', '/other/node')
rospy.remap_name('old'), rospy.remap_name('unknown')
rospy.myargv(['x', 'a:=b', '_c:=d', '--e'])
rospy.names.canonicalize_name('/a//b/'), rospy.names.canonicalize_name('')
rospy.names.ns_join('/a', 'b'), rospy.names.ns_join('/a/', '/b'), rospy.names.ns_join('', 'b'), rospy.names.ns_join('~', 'b')
rospy.names.is_global('/a'), rospy.names.is_private('~a'), rospy.names.is_global('a')
rospy.names.namespace('/a/b'), rospy.names.namespace('/a'), rospy.names.namespace('/')
rospy.names.make_global_ns('a'), rospy.names.make_global_ns('/a/')
rospy.names.get_ros_namespace()
rospy.names.load_mappings(['a:=b', '_c:=d', '__name:=e', 'f'])
sorted(rospy.names.get_mappings().items())
rospy.names.scoped_name('/a/b', '/a/c')
rospy.is_shutdown()
rospy.core.is_initialized()
""".strip().splitlines():
        show(text)


everything()
rospy.init_node("original", anonymous=True)
everything()
print(rospy.get_node_uri().startswith("http://"), sys.argv[1:])
print(sorted(topic for topic, kind in rospy.get_published_topics() if kind == "rosgraph_msgs/Log"))
