"""A robot in rclpy for the command to look at. rclpy_robot.py: prints `ready`, and `drove X` for each /cmd; runs until it is
ended.

/robot publishes /chatter (reliable), /map (once, transient_local), /imu (best_effort, stamped now) and listens to /cmd; it
serves /enable and has parameters. /robot_listener wants more of /imu than is offered. Two nodes are called /twin.
"""

import contextlib

import rclpy
from geometry_msgs.msg import Point, Twist
from rcl_interfaces.msg import IntegerRange, ParameterDescriptor
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Imu
from std_msgs.msg import String
from std_srvs.srv import SetBool


def main():
    rclpy.init()
    robot = rclpy.create_node("robot")
    chatter = robot.create_publisher(String, "chatter", 10)
    kept = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    chart = robot.create_publisher(Point, "map", kept)
    loose = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
    imu = robot.create_publisher(Imu, "imu", loose)
    robot.create_subscription(Twist, "cmd", lambda twist: print("drove", twist.linear.x, flush=True), 10)

    def enable(request, response):
        response.success = request.data
        response.message = "on" if request.data else "off"
        return response

    robot.create_service(SetBool, "enable", enable)
    rate = ParameterDescriptor(
        description="turns a second", integer_range=[IntegerRange(from_value=1, to_value=100, step=1)]
    )
    robot.declare_parameter("rate", 20, rate)
    robot.declare_parameter("arm.speed", 0.5)
    robot.declare_parameter("arm.joints", ["a", "b"])
    robot.declare_parameter("serial", "0042", ParameterDescriptor(read_only=True))
    robot.declare_parameter("spare", None, ParameterDescriptor(dynamic_typing=True))

    def turn():
        chatter.publish(String(data="hello"))
        message = Imu()
        message.header.stamp = robot.get_clock().now().to_msg()
        imu.publish(message)

    robot.create_timer(0.05, turn)
    chart.publish(Point(x=1.0, y=2.0, z=3.0))
    listener = rclpy.create_node("robot_listener")
    listener.create_subscription(Imu, "imu", print, 10)
    others = [rclpy.create_node("twin"), rclpy.create_node("twin")]
    executor = SingleThreadedExecutor()
    for node in (robot, listener, *others):
        executor.add_node(node)
    print("ready", flush=True)
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        executor.spin()


main()
