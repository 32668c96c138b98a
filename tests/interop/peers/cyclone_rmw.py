"""The service dialect of rmw_cyclonedds, spoken by cyclonedds. cyclone_rmw.py ROLE COUNT: server or client of /ask.

A 16-byte header (client, number) in front of each body; `serviceid=` or `clientid=` in USER_DATA. Prints one line a fact:
`ready`, `asked yes`, `answer yes`, `foreign` for a reply to somebody else. Ends by itself after COUNT facts, or 30 seconds.
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

CLIENT = 0x0123456789ABCDEF


@dataclass
class Request(IdlStruct, typename="std_srvs::srv::dds_::SetBool_Request_"):
    client: uint64
    number: int64
    data: bool


@dataclass
class Response(IdlStruct, typename="std_srvs::srv::dds_::SetBool_Response_"):
    client: uint64
    number: int64
    success: bool
    message: str


def say(*words):
    print(*words, flush=True)


def main():
    role, count = sys.argv[1], int(sys.argv[2])
    key = "serviceid" if role == "server" else "clientid"
    qos = Qos(
        Policy.Reliability.Reliable(duration(seconds=1)),
        Policy.Durability.Volatile,
        Policy.History.KeepLast(10),
        Policy.Userdata((key + "= 1.2.3.4.5.6.7.8.9.a.b.c.d.e.f.10;").encode()),
    )
    participant = DomainParticipant(0)
    asks = Topic(participant, "rq/askRequest", Request)
    answers = Topic(participant, "rr/askReply", Response)
    done = 0
    ends = time.monotonic() + 30.0
    if role == "server":
        reader, writer = DataReader(participant, asks, qos=qos), DataWriter(participant, answers, qos=qos)
        say("ready")
        while done < count and time.monotonic() < ends:
            for sample in reader.take(10):
                if getattr(sample, "data", None) is not None:
                    done += 1
                    say("asked", "yes" if sample.data else "no")
                    # The request may come before Cyclone knows who hears the reply; its rmw waits for that likewise.
                    while not writer.get_matched_subscriptions() and time.monotonic() < ends:
                        time.sleep(0.001)
                    text = "yes" if sample.data else "no"
                    writer.write(Response(sample.client, sample.number, sample.data, text))
            time.sleep(0.005)
        time.sleep(0.5)
    else:
        writer, reader = DataWriter(participant, asks, qos=qos), DataReader(participant, answers, qos=qos)
        while not (writer.get_matched_subscriptions() and reader.get_matched_publications()):
            time.sleep(0.02)
        say("ready")
        sent = 0
        while done < count and time.monotonic() < ends:
            if sent == done:
                writer.write(Request(CLIENT, 1000 + sent, sent % 2 == 0))
                sent += 1
            for sample in reader.take(10):
                if getattr(sample, "message", None) is None:
                    continue
                if (sample.client, sample.number) == (CLIENT, 1000 + done):
                    done += 1
                    say("answer", sample.message)
                else:
                    say("foreign")
            time.sleep(0.005)


main()
