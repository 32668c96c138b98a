"""A CycloneDDS peer: gates_cyclone.py NAME SECONDS. Reads `rt/count`, writes `rt/shown`, and prints what it sees."""

import json
import signal
import sys
import time
from dataclasses import dataclass

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import uint32
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration


@dataclass
class UInt32_(IdlStruct, typename="std_msgs::msg::dds_::UInt32_"):  # noqa: N801 - ROS's name on the wire
    data: uint32


qos = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(10))
participant = DomainParticipant(0)
reader = DataReader(participant, Topic(participant, "rt/count", UInt32_), qos=qos)
writer = DataWriter(participant, Topic(participant, "rt/shown", UInt32_), qos=qos)
ends = time.monotonic() + float(sys.argv[2])
stopped = []
signal.signal(signal.SIGINT, lambda *_: stopped.append(True))
got = []
number, due = 0, 0.0
while time.monotonic() < ends and not stopped:
    got += [one.data for one in reader.take(10) if getattr(one, "data", None) is not None]
    if time.monotonic() > due:
        due = time.monotonic() + 0.2
        number += 1
        writer.write(UInt32_(data=1000 + number))
        print(json.dumps({"got": got, "subscribers": len(writer.get_matched_subscriptions())}), flush=True)
    time.sleep(0.02)
del reader, writer, participant
