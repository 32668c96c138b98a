"""An rclpy peer. rclpy_rtps.py ROLE COUNT: talker, listener, server or client of plain messages on /chatter and /ask.

Prints one line a fact: `ready`, `heard TEXT`, `answer TEXT`. Ends by itself after COUNT facts, or a minute.
"""

import sys
import time

import rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String
from std_srvs.srv import SetBool


def say(*words):
    print(*words, flush=True)


def qos(words):
    profile = QoSProfile(depth=10)
    if "best_effort" in words:
        profile.reliability = ReliabilityPolicy.BEST_EFFORT
    if "transient_local" in words:
        profile.durability = DurabilityPolicy.TRANSIENT_LOCAL
    return profile


def main():
    role, count = sys.argv[1], int(sys.argv[2])
    size = next((int(word) for word in sys.argv[3:] if word.isdigit()), 0)
    rclpy.init()
    node = rclpy.create_node("rclpy_" + role)
    done = []
    ends = time.monotonic() + 60.0
    if role == "talker":
        publisher = node.create_publisher(String, "chatter", qos(sys.argv))
        say("ready")
        while publisher.get_subscription_count() == 0 and time.monotonic() < ends:
            rclpy.spin_once(node, timeout_sec=0.02)
        for number in range(count):
            publisher.publish(String(data=("hello %d" % number) + "x" * size))
            rclpy.spin_once(node, timeout_sec=0.05)
        publisher.wait_for_all_acked(rclpy.duration.Duration(seconds=30))
    elif role == "listener":

        def heard(message):
            done.append(1)
            say("heard", len(message.data) if size else message.data)

        node.create_subscription(String, "chatter", heard, qos(sys.argv))
        say("ready")
        while len(done) < count and time.monotonic() < ends:
            rclpy.spin_once(node, timeout_sec=0.1)
    elif role == "server":

        def answer(request, response):
            done.append(1)
            response.success = request.data
            response.message = "yes" if request.data else "no"
            return response

        node.create_service(SetBool, "ask", answer)
        say("ready")
        while len(done) < count and time.monotonic() < ends:
            rclpy.spin_once(node, timeout_sec=0.1)
        rclpy.spin_once(node, timeout_sec=0.2)
    elif role == "client":
        client = node.create_client(SetBool, "ask")
        client.wait_for_service(60.0)
        for number in range(count):
            future = client.call_async(SetBool.Request(data=number % 2 == 0))
            rclpy.spin_until_future_complete(node, future, timeout_sec=10.0)
            say("answer", future.result().message)
    node.destroy_node()
    rclpy.shutdown()


main()
