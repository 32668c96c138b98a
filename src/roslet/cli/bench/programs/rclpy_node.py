"""rclpy in `roslet bench`; see pinger.py. Its wheels hold no generator, so that it has no Coordinate."""

import importlib
import os
import threading

import pinger


class Rclpy(pinger.Stack):
    kinds = (pinger.TEXT,)

    def __init__(self):
        super().__init__()
        import rclpy
        from rclpy.executors import SingleThreadedExecutor

        self.rclpy = rclpy
        rclpy.init()
        self.node = rclpy.create_node("bench_%d" % os.getpid())
        self.executor = SingleThreadedExecutor()
        self.executor.add_node(self.node)
        self.spinning = False

    def kind(self, name):
        package, kind = {pinger.TEXT: "std_msgs/String"}.get(name, name).split("/")
        return getattr(importlib.import_module(package + ".msg"), kind)

    def fields(self, message):
        known = getattr(message, "get_fields_and_field_types", None)
        return None if known is None else list(known())

    def publisher(self, name, topic):
        return self.node.create_publisher(self.kind(name), topic, 10).publish

    def subscriber(self, name, topic, callback):
        self.node.create_subscription(self.kind(name), topic, callback, 10)

    def text(self, text):
        return self.kind(pinger.TEXT)(data=text)

    def spin(self, predicate, seconds):
        if not self.spinning:
            self.spinning = True
            threading.Thread(target=self.executor.spin, daemon=True).start()
        return super().spin(predicate, seconds)

    def close(self):
        self.executor.shutdown(timeout_sec=1)
        self.node.destroy_node()
        self.rclpy.shutdown()


if __name__ == "__main__":
    pinger.main(Rclpy)
