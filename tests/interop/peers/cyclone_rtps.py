"""A CycloneDDS peer. cyclone_rtps.py ROLE COUNT [SIZE] [best_effort] [transient_local]
ROLE is talker or listener, of String on rt/chatter.

Prints one line a fact: `ready`, `heard TEXT`. Ends by itself after COUNT facts, or a minute.
"""

import os
import sys
import time
from dataclasses import dataclass

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration


@dataclass
class String_(IdlStruct, typename="std_msgs::msg::dds_::String_"):  # noqa: N801 - ROS's name on the wire
    data: str


def say(*words):
    print(*words, flush=True)


def main():
    role, count = sys.argv[1], int(sys.argv[2])
    size = next((int(word) for word in sys.argv[3:] if word.isdigit()), 0)
    qos = Qos(
        Policy.Reliability.BestEffort
        if "best_effort" in sys.argv
        else Policy.Reliability.Reliable(duration(seconds=1)),
        Policy.Durability.TransientLocal if "transient_local" in sys.argv else Policy.Durability.Volatile,
        Policy.History.KeepLast(10),
    )
    participant = DomainParticipant(int(os.environ.get("ROS_DOMAIN_ID", "0")))
    topic = Topic(participant, "rt/chatter", String_)
    ends = time.monotonic() + 60.0
    if role == "talker":
        writer = DataWriter(participant, topic, qos=qos)
        say("ready")
        while not writer.get_matched_subscriptions() and time.monotonic() < ends:
            time.sleep(0.02)
        for number in range(count):
            writer.write(String_(data=("hello %d" % number) + "x" * size))
            time.sleep(0.05)
        writer.wait_for_acks(duration(seconds=30))
    else:
        reader = DataReader(participant, topic, qos=qos)
        say("ready")
        done = 0
        while done < count and time.monotonic() < ends:
            for sample in reader.take(10):
                if getattr(sample, "data", None) is None:
                    continue
                done += 1
                say("heard", len(sample.data) if size else sample.data)
            time.sleep(0.01)


main()
