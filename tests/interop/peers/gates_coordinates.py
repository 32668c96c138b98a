"""CycloneDDS beside the example typed-echo: gates_coordinates.py SECONDS. Writes Coordinates to `rt/ping`, each when the one
before came back on `rt/pong`, or again after a while; prints what came."""

import json
import signal
import sys
import time
from dataclasses import astuple, dataclass

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import float32, int32, uint32
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration


@dataclass
class Time_(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):  # noqa: N801 - ROS's name on the wire
    sec: int32
    nanosec: uint32


@dataclass
class Coordinate_(IdlStruct, typename="mros_comm_measure::msg::dds_::Coordinate_"):  # noqa: N801
    x: float32
    y: float32
    z: float32
    time: Time_


QOS = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(10))
PATIENCE = 1.0

participant = DomainParticipant(0)
writer = DataWriter(participant, Topic(participant, "rt/ping", Coordinate_), qos=QOS)
reader = DataReader(participant, Topic(participant, "rt/pong", Coordinate_), qos=QOS)
ends = time.monotonic() + float(sys.argv[1])
stopped = []
signal.signal(signal.SIGINT, lambda *_: stopped.append(True))
got, due = [], 0.0
while time.monotonic() < ends and not stopped:
    taken = [one for one in reader.take(10) if getattr(one, "time", None) is not None]
    if taken:
        got += [astuple(one) for one in taken]
        print(json.dumps({"got": got[:20]}), flush=True)
    if taken or time.monotonic() > due:
        due = time.monotonic() + PATIENCE
        number = len(got) + 1
        writer.write(Coordinate_(number, number / 4, -number, Time_(-number, 1000 + number)))
    time.sleep(0.02)
