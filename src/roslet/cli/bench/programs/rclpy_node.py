"""rclpy in `roslet bench`; see pinger.py. Its wheels hold no generator: a Coordinate it has where rclpy_coordinate.cpp could
be compiled, in the folder $BENCH_COORDINATE."""

import importlib
import os
import sys
import threading

import pinger

COORDINATE_FOLDER = os.environ.get("BENCH_COORDINATE")


def coordinate_class():
    """What the generator would write, as far as rclpy asks for it."""
    sys.path.append(COORDINATE_FOLDER)
    import rclpy_coordinate as support
    from builtin_interfaces.msg import Time

    class Meta(type):
        _TYPE_SUPPORT = support.TYPE_SUPPORT
        _CREATE_ROS_MESSAGE = support.CREATE_ROS_MESSAGE
        _CONVERT_FROM_PY = support.CONVERT_FROM_PY
        _CONVERT_TO_PY = support.CONVERT_TO_PY
        _DESTROY_ROS_MESSAGE = support.DESTROY_ROS_MESSAGE

    class Coordinate(metaclass=Meta):
        __slots__ = ("time", "x", "y", "z")

        def __init__(self, x=0.0, y=0.0, z=0.0, time=None):
            self.x, self.y, self.z = x, y, z
            self.time = Time() if time is None else time

        @classmethod
        def get_fields_and_field_types(cls):
            return {"x": "float", "y": "float", "z": "float", "time": "builtin_interfaces/Time"}

    support.use(Coordinate, Time)
    return Coordinate


class Rclpy(pinger.Stack):
    kinds = (pinger.TEXT, pinger.COORDINATE) if COORDINATE_FOLDER else (pinger.TEXT,)

    def __init__(self):
        super().__init__()
        self.coordinate_class = coordinate_class() if COORDINATE_FOLDER else None
        import rclpy
        from rclpy.executors import SingleThreadedExecutor

        self.rclpy = rclpy
        rclpy.init()
        self.node = rclpy.create_node("bench_%d" % os.getpid())
        self.executor = SingleThreadedExecutor()
        self.executor.add_node(self.node)
        self.spinning = False

    def kind(self, name):
        if name in (pinger.COORDINATE, "mros_comm_measure/Coordinate"):
            if self.coordinate_class is None:
                raise ImportError(name)
            return self.coordinate_class
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

    def coordinate(self):
        return self.coordinate_class(x=1.5, y=-2.5, z=3.25)

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
