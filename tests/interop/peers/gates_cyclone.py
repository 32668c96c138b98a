"""CycloneDDS beside the node in gates: gates_cyclone.py NAME SECONDS [MODE].

Reads `rt/count`, writes `rt/shown`, and prints what it sees. In mode `many` ten participants do; in mode `again` a new
participant, which comes when the one before has had a message, and has gone.
"""

import gc
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

MANY = 10


@dataclass
class UInt32_(IdlStruct, typename="std_msgs::msg::dds_::UInt32_"):  # noqa: N801 - ROS's name on the wire
    data: uint32


QOS = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(10))


class Peer:
    def __init__(self):
        self.participant = DomainParticipant(0)
        self.reader = DataReader(self.participant, Topic(self.participant, "rt/count", UInt32_), qos=QOS)
        self.writer = DataWriter(self.participant, Topic(self.participant, "rt/shown", UInt32_), qos=QOS)
        self.got = []

    def look(self):
        self.got += [one.data for one in self.reader.take(10) if getattr(one, "data", None) is not None]
        return self.got

    def matched(self):
        return len(self.writer.get_matched_subscriptions())


def say(**values):
    print(json.dumps(values), flush=True)


mode = sys.argv[3] if len(sys.argv) > 3 else "one"
ends = time.monotonic() + float(sys.argv[2])
stopped = []
signal.signal(signal.SIGINT, lambda *_: stopped.append(True))


def live(peers, number, came):
    """Until it is time to end, or, in mode `again`, a message has come; returns the number of the next one to write."""
    due = 0.0
    while time.monotonic() < ends and not stopped:
        got = [peer.look() for peer in peers]
        if mode == "again" and got[0]:
            break
        if time.monotonic() > due:
            due = time.monotonic() + 0.2
            number += 1
            peers[0].writer.write(UInt32_(data=1000 + number))
            say(got=got[0], subscribers=peers[0].matched(), all=[len(one) for one in got], came=came)
        time.sleep(0.02)
    return number


number = came = 0
while time.monotonic() < ends and not stopped:
    number = live([Peer() for _ in range(MANY if mode == "many" else 1)], number, came)
    gc.collect()  # who is gone says so now
    came += 1
    say(came=came, got=[], all=[])
