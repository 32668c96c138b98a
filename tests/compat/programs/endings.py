#!/usr/bin/env python3
# What runs at the end, and in what order; how it ends is the first argument.
import os
import signal
import sys
import threading

import rospy
from std_msgs.msg import String

rospy.init_node("endings")
how = sys.argv[1]
pub = rospy.Publisher("last_words", String, queue_size=1)


def hook(name):
    return lambda: print("hook", name, rospy.is_shutdown(), flush=True)


def broken():
    raise RuntimeError("broken hook")


rospy.on_shutdown(hook("one"))
rospy.on_shutdown(hook("two"))
if how != "waiting":
    rospy.core.add_preshutdown_hook(lambda reason: print("preshutdown", reason.split()[0], flush=True))
print("ready", flush=True)
if how == "SIGINT" or how == "SIGTERM":
    threading.Timer(0.2, lambda: os.kill(os.getpid(), getattr(signal, how))).start()
    rospy.spin()
elif how == "loop":
    threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    rate = rospy.Rate(20)
    while not rospy.is_shutdown():
        pub.publish("still here")
        try:
            rate.sleep()
        except rospy.ROSInterruptException:
            print("interrupted", flush=True)
elif how == "signal_shutdown":
    threading.Timer(0.2, lambda: rospy.signal_shutdown("because")).start()
    rospy.spin()
elif how == "exit":
    sys.exit(3)
elif how == "exception":
    raise ValueError("not caught")
elif how == "waiting":
    threading.Timer(0.2, lambda: rospy.signal_shutdown("because")).start()
    for wait in (lambda: rospy.wait_for_service("nobody"), lambda: rospy.wait_for_message("nothing", String)):
        try:
            wait()
        except rospy.ROSInterruptException as error:
            print(type(error).__name__, error, flush=True)
print("after", rospy.is_shutdown(), flush=True)
