#!/usr/bin/env python3
# A client that sends requests and waits for each answer.
import rclpy
from rclpy.node import Node
from std_srvs.srv import SetBool


class ClientAsync(Node):
    def __init__(self):
        super().__init__("client_async")
        self.cli = self.create_client(SetBool, "switch")
        while not self.cli.wait_for_service(timeout_sec=1.0):
            self.get_logger().debug("service not available, waiting again...")
        self.req = SetBool.Request()

    def send_request(self, data):
        self.req.data = data
        return self.cli.call_async(self.req)


def main():
    rclpy.init()
    client = ClientAsync()
    for data in (True, False, True):
        future = client.send_request(data)
        rclpy.spin_until_future_complete(client, future)
        response = future.result()
        client.get_logger().debug(f"{response}")
        print("answered", response.success, response.message)
    client.destroy_node()
    rclpy.shutdown()


main()
