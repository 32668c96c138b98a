"""A service as rmw_cyclonedds has it, of plain CycloneDDS peers. cyclone_service.py ROLE COUNT; ROLE is server or client.

The request and the reply begin with 16 octets: who asks, and the number of the request. /ask is of std_srvs/srv/SetBool.
Prints one line a fact: `ready`, `answer SUCCESS TEXT`. Ends by itself after COUNT facts, or 30 seconds.
"""

import sys
import time
from dataclasses import dataclass

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import int64, uint64
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration


@dataclass
class Request(IdlStruct, typename="std_srvs::srv::dds_::SetBool_Request_"):
    client: uint64
    number: int64
    data: bool


@dataclass
class Reply(IdlStruct, typename="std_srvs::srv::dds_::SetBool_Response_"):
    client: uint64
    number: int64
    success: bool
    message: str


def say(*words):
    print(*words, flush=True)


def main():
    role, count = sys.argv[1], int(sys.argv[2])
    qos = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(10))
    participant = DomainParticipant(0)
    requests = Topic(participant, "rq/askRequest", Request)
    replies = Topic(participant, "rr/askReply", Reply)
    ends = time.monotonic() + 30.0
    if role == "server":
        reader = DataReader(participant, requests, qos=qos)
        writer = DataWriter(participant, replies, qos=qos)
        say("ready")
        done = 0
        while done < count and time.monotonic() < ends:
            for one in reader.take(10):
                if getattr(one, "number", None) is not None:
                    writer.write(Reply(one.client, one.number, one.data, "yes" if one.data else "no"))
                    done += 1
            time.sleep(0.01)
        time.sleep(0.5)
        return
    writer = DataWriter(participant, requests, qos=qos)
    reader = DataReader(participant, replies, qos=qos)
    say("ready")
    while not writer.get_matched_subscriptions() and time.monotonic() < ends:
        time.sleep(0.02)
    time.sleep(0.3)
    for number in range(1, count + 1):
        writer.write(Request(0x1122334455667788, number, number % 2 == 1))
        while time.monotonic() < ends:
            found = [one for one in reader.take(10) if getattr(one, "number", None) == number]
            if found:
                say("answer", found[0].success, found[0].message)
                break
            time.sleep(0.01)


main()
