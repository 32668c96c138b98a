"""A roslet peer on the participant itself, without a node. roslet_rtps.py ROLE COUNT [SIZE] [best_effort] [transient_local]
[ros2://...] [hasty]

The same facts in the same words as rclpy_rtps.py and cyclone_rtps.py. `hasty`: it announces itself twice a second, and is
taken for gone when it has been silent for three.
"""

import os
import struct
import sys
import time

from roslet.engine.rtps import events
from roslet.io.select import Reactor
from roslet.io.udp import Domain
from roslet.names import parse_ros2_network
from roslet.wire.rtps import qos
from roslet.wire.rtps.qos import Qos

TYPE = "std_msgs::msg::dds_::String_"


def say(*words):
    print(*words, flush=True)


def main():
    role, count = sys.argv[1], int(sys.argv[2])
    size = next((int(word) for word in sys.argv[3:] if word.isdigit()), 0)
    policies = Qos(
        reliability=(qos.BEST_EFFORT if "best_effort" in sys.argv else qos.RELIABLE, 10**8),
        durability=qos.TRANSIENT_LOCAL if "transient_local" in sys.argv else qos.VOLATILE,
        history=(qos.KEEP_LAST, 10),
    )
    heard = []

    def on_event(event):
        if isinstance(event, events.SampleReceived):
            length = struct.unpack_from("<I", event.payload, 4)[0]
            text = bytes(event.payload[8 : 8 + length - 1]).decode()
            heard.append(text)
            say("heard", len(text) if size else text)
        elif isinstance(event, events.QosIncompatible):
            say("incompatible", *event.policies)

    reactor = Reactor()
    url = next((word for word in sys.argv if word.startswith("ros2:")), None)
    hasty = {"period": 0.5, "lease": 3.0} if "hasty" in sys.argv else {}
    domain = Domain(reactor, on_event, parse_ros2_network(url, os.environ), **hasty)
    participant = domain.participant
    ends = time.monotonic() + 60.0
    with reactor.lock:
        make = participant.create_writer if role == "talker" else participant.create_reader
        endpoint = make("rt/chatter", TYPE, policies, reactor.now())
        domain.flush()
        say("ready")  # before what another thread may hear says so
    if role == "talker":
        reactor.run_until(lambda: endpoint.proxies, 60.0)
        for number in range(count):
            text = ("hello %d" % number + "x" * size).encode() + b"\0"
            with reactor.lock:
                endpoint.write(struct.pack("<HHI", 0x0100, 0, len(text)) + text, reactor.now())
                domain.flush()
            reactor.run_until(lambda: False, 0.05)
        say("acknowledged", reactor.run_until(lambda: endpoint.acknowledged(count), 30.0))
    else:
        reactor.run_until(lambda: len(heard) >= count or time.monotonic() > ends, 60.0)
        reactor.run_until(lambda: False, 0.1)
    if "counters" in sys.argv:
        print(participant.counters, domain.errors, file=sys.stderr)
    domain.close()
    reactor.close()


main()
