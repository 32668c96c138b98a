"""rospy in `roslet bench`; see pinger.py. Publishes with queue_size=10 and receives with tcp_nodelay."""

import os
import sys
import warnings

import pinger

warnings.simplefilter("ignore", SyntaxWarning)


class Rospy(pinger.Stack):
    def __init__(self):
        super().__init__()
        import rospy

        self.rospy = rospy
        rospy.init_node("bench_%d" % os.getpid(), disable_signals=True)

    def kind(self, name):
        import roslib.message

        known = {pinger.TEXT: "std_msgs/String", pinger.COORDINATE: "mros_comm_measure/Coordinate"}
        found = roslib.message.get_message_class(known.get(name, name))
        if found is None:
            raise KeyError(name)
        return found

    def publisher(self, name, topic):
        return self.rospy.Publisher(topic, self.kind(name), queue_size=10).publish

    def subscriber(self, name, topic, callback):
        self.rospy.Subscriber(topic, self.kind(name), callback, tcp_nodelay=True)

    def text(self, text):
        return self.kind(pinger.TEXT)(text)

    def coordinate(self):
        return self.kind(pinger.COORDINATE)(x=1.5, y=-2.5, z=3.25)

    def close(self):
        self.rospy.signal_shutdown("done")


if __name__ == "__main__":
    sys.path.insert(1, os.environ["BENCH_GENPY"])
    pinger.main(Rospy)
