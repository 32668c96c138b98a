#!/usr/bin/env python3
# The ways in which programs end.
import os
import signal
import sys
import threading
import time

import rclpy
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions

how = sys.argv[1]


ended = threading.Event()


def kill(number):
    """Again and again: a busy machine may not have begun to spin when the first one comes."""

    def repeat():
        while not ended.wait(0.3 if first else 3.0):
            first.clear()
            os.kill(os.getpid(), number)

    first = [True]
    threading.Thread(target=repeat, daemon=True).start()


if how == "own handlers":
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
else:
    rclpy.init()
rclpy.get_default_context().on_shutdown(lambda: print("on_shutdown"))
node = rclpy.create_node("endings")
try:
    if how == "SIGINT":
        kill(signal.SIGINT)
        rclpy.spin(node)
    elif how == "SIGTERM":
        kill(signal.SIGTERM)
        rclpy.spin(node)
    elif how == "SIGINT of threads":
        kill(signal.SIGINT)
        executor = MultiThreadedExecutor()
        executor.add_node(node)
        executor.spin()
    elif how == "SIGINT in a callback":
        node.create_timer(0.01, lambda: time.sleep(2))
        kill(signal.SIGINT)
        rclpy.spin(node)
    elif how == "loop":
        kill(signal.SIGTERM)
        try:
            while rclpy.ok():
                rclpy.spin_once(node, timeout_sec=0.1)
        except ExternalShutdownException:
            pass  # the signal came within a turn; between two, the loop just ends
    elif how == "own handlers":
        kill(signal.SIGINT)
        while rclpy.ok():  # a spin without an end would not notice: its wait is not Python's
            rclpy.spin_once(node, timeout_sec=0.1)
    elif how == "elsewhere":
        threading.Timer(0.3, rclpy.shutdown).start()
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        executor.spin()
    elif how == "uncaught":
        kill(signal.SIGTERM)
        rclpy.spin(node)
    elif how == "exit":
        node.create_timer(0.05, lambda: sys.exit(5))
        rclpy.spin(node)
    elif how == "exception":
        node.create_timer(0.05, lambda: {}["missing"])
        rclpy.spin(node)
    elif how == "return":
        print("left as it is")
        sys.exit(0)
except KeyboardInterrupt:
    ended.set()
    end = time.monotonic() + 5
    while how in ("SIGINT in a callback", "SIGINT of threads") and rclpy.ok() and time.monotonic() < end:
        time.sleep(0.01)  # the handler has another thread shut down
    print("KeyboardInterrupt", rclpy.ok())
except ExternalShutdownException:
    ended.set()
    print("ExternalShutdownException", rclpy.ok())
    if how == "uncaught":
        raise
except KeyError as error:
    print("KeyError", error)
ended.set()
print("last", rclpy.ok())
node.destroy_node()
rclpy.try_shutdown()
print("end")
