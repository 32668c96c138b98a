"""CycloneDDS's Python binding in `roslet bench`; see pinger.py. The types are written by hand, named as ROS 2 does."""

import os

import pinger

# Loopback only, and without multicast, which loopback often has not.
CONFIGURATION = """<CycloneDDS><Domain>
<General><Interfaces><NetworkInterface name="lo"/></Interfaces><AllowMulticast>false</AllowMulticast></General>
<Discovery><ParticipantIndex>auto</ParticipantIndex><Peers><Peer address="127.0.0.1"/></Peers></Discovery>
</Domain></CycloneDDS>"""


def idl():
    """The types by their names in ROS."""
    from cyclonedds.idl import make_idl_struct, types

    def struct(name, **fields):
        package, kind = name.split("/")
        made[name] = make_idl_struct(kind, "%s.msg.dds_.%s_" % (package, kind), fields)
        return made[name]

    made = {}
    t = types
    stamp = struct("builtin_interfaces/Time", sec=t.int32, nanosec=t.uint32)
    header = struct("std_msgs/Header", stamp=stamp, frame_id=str)
    dimension = struct("std_msgs/MultiArrayDimension", label=str, size=t.uint32, stride=t.uint32)
    layout = struct("std_msgs/MultiArrayLayout", dim=t.sequence[dimension], data_offset=t.uint32)
    point = struct("geometry_msgs/Point", x=t.float64, y=t.float64, z=t.float64)
    turn = struct("geometry_msgs/Quaternion", x=t.float64, y=t.float64, z=t.float64, w=t.float64)
    pose = struct("geometry_msgs/Pose", position=point, orientation=turn)
    covered = struct("geometry_msgs/PoseWithCovariance", pose=pose, covariance=t.array[t.float64, 36])
    numbers = {
        **{"Int%d" % bits: getattr(t, "int%d" % bits) for bits in (8, 16, 32, 64)},
        **{"UInt%d" % bits: getattr(t, "uint%d" % bits) for bits in (8, 16, 32, 64)},
        **{"Float%d" % bits: getattr(t, "float%d" % bits) for bits in (32, 64)},
    }
    for name, kind in numbers.items():
        struct("std_msgs/" + name, data=kind)
        struct("std_msgs/%sMultiArray" % name, layout=layout, data=t.sequence[kind])
    for name, kind in {"Bool": bool, "Byte": t.byte, "Char": t.uint8, "String": str}.items():
        struct("std_msgs/" + name, data=kind)
    struct("geometry_msgs/PointStamped", header=header, point=point)
    struct("geometry_msgs/PoseWithCovarianceStamped", header=header, pose=covered)
    struct("mros_comm_measure/Coordinate", x=t.float32, y=t.float32, z=t.float32, time=stamp)
    struct(
        "sensor_msgs/Image",
        header=header,
        height=t.uint32,
        width=t.uint32,
        encoding=str,
        is_bigendian=t.uint8,
        step=t.uint32,
        data=t.sequence[t.uint8],
    )
    return made


class Cyclone(pinger.Stack):
    def __init__(self):
        super().__init__()
        os.environ["CYCLONEDDS_URI"] = CONFIGURATION
        from cyclonedds.core import Listener, Policy, Qos
        from cyclonedds.domain import DomainParticipant
        from cyclonedds.pub import DataWriter
        from cyclonedds.sub import DataReader
        from cyclonedds.topic import Topic
        from cyclonedds.util import duration

        self.listener, self.writer, self.reader, self.dds_topic = Listener, DataWriter, DataReader, Topic
        self.participant = DomainParticipant(int(os.environ["ROS_DOMAIN_ID"]))
        self.qos = Qos(Policy.Reliability.Reliable(duration(seconds=10)), Policy.History.KeepLast(10))
        self.types = idl()
        self.kept = []

    def kind(self, name):
        known = {pinger.TEXT: "std_msgs/String", pinger.COORDINATE: "mros_comm_measure/Coordinate"}
        return self.types[known.get(name, name)]

    def fields(self, message):
        return getattr(message, "__dataclass_fields__", None)

    def topic(self, name, topic):
        return self.dds_topic(self.participant, "rt/" + topic, self.kind(name), qos=self.qos)

    def publisher(self, name, topic):
        self.kept.append(self.writer(self.participant, self.topic(name, topic), qos=self.qos))
        return self.kept[-1].write

    def subscriber(self, name, topic, callback):
        class Taker(self.listener):
            def on_data_available(self, reader):
                for sample in reader.take(10):
                    if sample.sample_info.valid_data:
                        callback(sample)

        taker = Taker()
        reader = self.reader(self.participant, self.topic(name, topic), qos=self.qos, listener=taker)
        self.kept += [taker, reader]

    def text(self, text):
        return self.kind(pinger.TEXT)(data=text)

    def coordinate(self):
        stamp = self.types["builtin_interfaces/Time"](sec=1700000000, nanosec=0)
        return self.kind(pinger.COORDINATE)(x=1.5, y=-2.5, z=3.25, time=stamp)


if __name__ == "__main__":
    pinger.main(Cyclone)
