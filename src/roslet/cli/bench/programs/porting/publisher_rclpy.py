#!/usr/bin/env python3
import rclpy
from mros_comm_measure.msg import Coordinate

rclpy.init()
node = rclpy.create_node("mros_node")
chatter = node.create_publisher(Coordinate, "ping", 1)
msg = Coordinate()


def step():
    msg.x += 0.1
    msg.y += 10.03
    msg.z += 3.003
    msg.time = node.get_clock().now().to_msg()
    chatter.publish(msg)


node.create_timer(0.05, step)
rclpy.spin(node)
