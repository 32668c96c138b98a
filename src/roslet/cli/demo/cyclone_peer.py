"""A CycloneDDS program that hears the Coordinates of `ping` and checks each: `cyclone_peer.py DOMAIN COUNT SECONDS`.

Run by an interpreter that has the package cyclonedds; nothing of roslet is in it, and the type is written here by hand. It
prints a JSON line when it is ready, and one at the end.
"""

import json
import os
import struct
import sys
import time
from dataclasses import dataclass

# Loopback only, and without multicast, which loopback often has not.
CONFIGURATION = """<CycloneDDS><Domain>
<General><Interfaces><NetworkInterface name="lo"/></Interfaces><AllowMulticast>false</AllowMulticast></General>
<Discovery><ParticipantIndex>auto</ParticipantIndex><Peers><Peer address="127.0.0.1"/></Peers></Discovery>
</Domain></CycloneDDS>"""


def report(heard: int, wrong: int, final: bool) -> None:
    """One line."""
    print(json.dumps({"heard": heard, "wrong": wrong, "final": final}), flush=True)


def main(domain: int, count: int, seconds: float) -> int:
    """Hear `count` messages, for `seconds` at most; 1 where one was not the next."""
    os.environ["CYCLONEDDS_URI"] = CONFIGURATION
    from cyclonedds.core import InstanceState, Policy, Qos, ReadCondition, SampleState, ViewState, WaitSet
    from cyclonedds.domain import DomainParticipant
    from cyclonedds.idl import IdlStruct
    from cyclonedds.idl.types import float32, int32, uint32
    from cyclonedds.sub import DataReader
    from cyclonedds.topic import Topic
    from cyclonedds.util import duration

    @dataclass
    class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
        sec: int32
        nanosec: uint32

    @dataclass
    class Coordinate(IdlStruct, typename="mros_comm_measure::msg::dds_::Coordinate_"):
        x: float32
        y: float32
        z: float32
        time: Time

    participant = DomainParticipant(domain)
    qos = Qos(
        Policy.Reliability.Reliable(duration(seconds=10)), Policy.Durability.Volatile, Policy.History.KeepAll
    )
    reader = DataReader(participant, Topic(participant, "rt/ping", Coordinate, qos=qos), qos=qos)
    waitset = WaitSet(participant)
    waitset.attach(ReadCondition(reader, SampleState.Any | ViewState.Any | InstanceState.Any))
    report(0, 0, False)
    heard = wrong = number = 0
    end, next_report = time.monotonic() + seconds, time.monotonic() + 1.0
    while heard < count and time.monotonic() < end:
        waitset.wait(duration(milliseconds=100))
        for one in reader.take(1000):
            if one.sample_info.valid_data:
                heard += 1
                before, number = number, round(one.x / 0.1)
                expected = struct.pack("<3f", 0.1 * number, 10.03 * number, 3.003 * number)
                if number != before + 1 or struct.pack("<3f", one.x, one.y, one.z) != expected:
                    wrong += 1
        if time.monotonic() >= next_report:
            next_report += 1.0
            report(heard, wrong, False)
    report(heard, wrong, True)
    return 1 if wrong or heard < count else 0


if __name__ == "__main__":
    code = main(int(sys.argv[1]), int(sys.argv[2]), float(sys.argv[3]))
    sys.stdout.flush()
    os._exit(code)  # whatever threads of the middleware are doing
