#!/usr/bin/env python3
import rclpy
from mros_comm_measure.msg import Coordinate


def callback(msg):
    print("I heard [x:%d, y:%d, z:%d]" % (msg.x * 1000, msg.y * 1000, msg.z * 1000), flush=True)


rclpy.init()
node = rclpy.create_node("mros_sub_node")
node.create_subscription(Coordinate, "ping", callback, 1)
rclpy.spin(node)
