#!/usr/bin/env python3
# A service whose node ends after three requests.
import rclpy
from rclpy.node import Node
from std_srvs.srv import SetBool


class Server(Node):
    def __init__(self):
        super().__init__("server")
        self.srv = self.create_service(SetBool, "switch", self.switch)
        self.left = 3

    def switch(self, request, response):
        print("asked", request.data)
        response.success = not request.data
        response.message = f"was {request.data}"
        self.left -= 1
        return response


def main():
    rclpy.init()
    server = Server()
    while server.left:
        rclpy.spin_once(server)
    for _ in range(10):
        rclpy.spin_once(server, timeout_sec=0.05)
    rclpy.shutdown()


main()
