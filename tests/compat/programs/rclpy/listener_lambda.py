#!/usr/bin/env python3
# A subscription whose callback is a lambda; with message info; raw.
import rclpy
from rclpy.serialization import deserialize_message
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("listener")
heard = {"plain": [], "info": [], "raw": []}
node.create_subscription(String, "chatter", lambda msg: heard["plain"].append(msg.data), 10)
node.create_subscription(String, "chatter", lambda msg, info: heard["info"].append((msg.data, info)), 10)
node.create_subscription(String, "chatter", lambda data: heard["raw"].append(data), 10, raw=True)
while min(map(len, heard.values())) < 5:
    rclpy.spin_once(node)
print(heard["plain"])
print([data for data, _ in heard["info"]])
info = heard["info"][0][1]
print(sorted(info))
print(info["source_timestamp"] > 10**18, info["received_timestamp"] >= info["source_timestamp"])
print([number["publication_sequence_number"] for _, number in heard["info"]])
print([(type(data).__name__, deserialize_message(data, String).data) for data in heard["raw"]])
rclpy.shutdown()
