"""roslet in `roslet bench`; see pinger.py. The network is $ROSLET_NETWORK, the folder of Coordinate $BENCH_TYPES."""

import os

import pinger

import roslet
from roslet.gen.runtime import message_class

roslet.load(os.environ["BENCH_TYPES"])


class Roslet(pinger.Stack):
    def __init__(self):
        super().__init__()
        network = os.environ["ROSLET_NETWORK"]
        self.dialect = "ros1" if network.startswith("ros1") else "ros2"
        self.node = roslet.Node("bench_%d" % os.getpid(), network=network)

    def kind(self, name):
        known = {pinger.TEXT: "std_msgs/String", pinger.COORDINATE: "mros_comm_measure/Coordinate"}
        return message_class(self.dialect, known.get(name, name))

    def publisher(self, name, topic):
        return self.node.publisher(topic, self.kind(name), qos=roslet.QoS(depth=10)).publish

    def subscriber(self, name, topic, callback):
        self.node.subscribe(topic, self.kind(name), callback, qos=roslet.QoS(depth=10))

    def text(self, text):
        return self.kind(pinger.TEXT)(data=text)

    def coordinate(self):
        return self.kind(pinger.COORDINATE)(x=1.5, y=-2.5, z=3.25)

    def spin(self, predicate, seconds):
        return self.node.spin_until(predicate, seconds)

    def wake(self):
        pass

    def close(self):
        self.node.close()


if __name__ == "__main__":
    pinger.main(Roslet)
