"""roslet in the side-by-side measurements of ROS stacks, on either network: what the adapters beside this file share."""

import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.environ.get("PEERS_ROOT", ""), os.path.join(HERE, "..", "..", "src")]

PYTHON = os.environ.get("ROSLET_PYTHON", os.path.join(HERE, "..", "..", ".venv", "bin", "python"))
NAMES = {
    "String": "std_msgs/String",
    "Image": "sensor_msgs/Image",
    "PointStamped": "geometry_msgs/PointStamped",
    "Coordinate": "peers_msgs/Coordinate",
}


def build():
    """As pip does when it installs: the harness forbids its children to write byte code."""
    import subprocess

    subprocess.check_call([PYTHON, "-m", "compileall", "-q", os.path.join(HERE, "..", "..", "src", "roslet")])


def version():
    from adapters import run_out

    return "roslet " + run_out(
        PYTHON, "-c", "import sys; sys.path.insert(0, 'src'); import roslet; print(roslet.__version__)"
    )


def make_peer(args, dialect, network):
    from peerlib import Peer, ser_messages

    import roslet

    class Roslet(Peer):
        def open(self):
            self.node = roslet.Node("peer_" + self.args.role, network=network, anonymous=True)
            self.types = {}

        def kind(self, typ):
            if typ == "Coordinate" and typ not in self.types:
                load_own(dialect)
            if typ not in self.types:
                from roslet.gen.runtime import message_class

                self.types[typ] = message_class(dialect, NAMES[typ])
            return self.types[typ]

        def qos(self, keep_all):
            return roslet.QoS(depth=10, history="keep_all" if keep_all else "keep_last")

        def publisher(self, typ, topic, keep_all=False):
            return self.node.publisher(topic, self.kind(typ), qos=self.qos(keep_all)).publish

        def subscriber(self, typ, topic, callback, keep_all=False):
            self.node.subscribe(topic, self.kind(typ), callback, qos=self.qos(keep_all))

        def make(self, typ, size):
            kind = self.kind(typ)
            if typ == "String":
                return kind(data="x" * size)
            if typ == "Image":
                return kind(data=bytes(size), encoding="mono8", height=1, width=size, step=size)
            if typ == "PointStamped":
                message = kind()
                message.header.frame_id = "map"
                setattr(message.header.stamp, "secs" if dialect == "ros1" else "sec", 1700000000)
                message.point.x, message.point.y, message.point.z = 1.5, -2.5, 3.25
                return message
            message = kind(x=1.5, y=-2.5, z=3.25)
            setattr(message.time, "secs" if dialect == "ros1" else "sec", 1700000000)
            return message

        def spin(self, pred, timeout):
            return self.node.spin_until(pred, timeout)

        def wake(self):
            self.node.reactor.wake()

        def close(self):
            self.node.close()

        def ser_cases(self):
            from roslet.gen.runtime import message_class

            load_own(dialect)
            for name, (typ, value) in ser_messages().items():
                message = build_message(message_class, dialect, typ, value)
                kind = type(message)
                raw = message.serialize()
                buffer = bytearray(len(raw))

                def ser(message=message, buffer=buffer):
                    message.serialize_into(buffer)
                    return buffer

                def deser(kind=kind, raw=raw):
                    return kind.deserialize(raw)

                assert deser().serialize() == raw, name
                yield name, ser, deser, len(raw)

    return Roslet(args)


ELEMENTS = {"fields": "sensor_msgs/PointField", "transforms": "geometry_msgs/TransformStamped"}
TIME = {"sec": "secs", "nanosec": "nsecs"}


def build_message(message_class, dialect, typ, value):
    """A message from the neutral form: nested dicts with ROS 2's names of time fields."""

    def fill(target, value):
        for name, item in value.items():
            own = TIME.get(name, name) if dialect == "ros1" else name
            if isinstance(item, dict):
                fill(getattr(target, own), item)
            elif isinstance(item, list) and item and isinstance(item[0], dict):
                setattr(target, own, [fill(message_class(dialect, ELEMENTS[name])(), each) for each in item])
            else:
                setattr(target, own, item)
        return target

    return fill(message_class(dialect, typ)(), value)


def load_own(dialect):
    """The harness's own type: its definition is that of ROS 1, ours beside it that of ROS 2."""
    import roslet

    root = os.environ["PEERS_ROOT"] if dialect == "ros1" else HERE
    roslet.load(os.path.join(root, "msgs", "peers_msgs"))
