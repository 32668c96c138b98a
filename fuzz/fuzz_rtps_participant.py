"""Invariant: whatever datagrams come, in whatever order, no exception leaves a participant, what it holds and sends stays
within its limits, and it goes on serving the peer it has.

    python fuzz/fuzz_rtps_participant.py [libFuzzer options] [corpus]     coverage-guided; needs atheris
    python fuzz/fuzz_rtps_participant.py --smoke N                        N seeded random inputs; needs nothing
"""

from __future__ import annotations

import collections
import functools
import pathlib
import random
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "src"))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tests"))

from roslet.engine.rtps.limits import Limits
from roslet.engine.rtps.participant import Participant
from roslet.wire.rtps import locator, qos
from roslet.wire.rtps.qos import Qos

ROOT = pathlib.Path(__file__).resolve().parent.parent
LIMITS = Limits(4, 16, 8, 100000, 2, 100000, 150000, 64)
STRING = "std_msgs::msg::dds_::String_"


def victim(prefix: bytes) -> Participant:
    """A participant in the place of a recorded one, with a writer and a reader of what the recorded peers write and read."""
    meta, user = locator.udp4("127.0.0.1", 7410), locator.udp4("127.0.0.1", 7411)
    participant = Participant(
        prefix, 0, (meta,), (user,), (("239.255.0.1", 7400),), limits=LIMITS, fragment_size=200
    )
    participant.start(0.0)
    reliable = Qos((qos.RELIABLE, 10**8), qos.VOLATILE, (qos.KEEP_LAST, 5))
    participant.create_reader("rt/chatter", STRING, reliable, 0.0)
    participant.create_writer("rt/chatter", STRING, reliable, 0.0).write(b"\0\1\0\0" + bytes(500), 0.0)
    return participant


@functools.cache
def sessions() -> list[list[bytes]]:
    """Datagrams of the recorded peers."""
    import pcap

    found = []
    for path in sorted((ROOT / "tests/captures/rtps").glob("*.pcap")):
        found.append([payload for _, _, payload in pcap.read(path)])
    return found


def within(participant: Participant) -> None:
    """Raises if a bound is exceeded."""
    if len(participant.spdp.remotes) > LIMITS.participants:
        raise AssertionError("participants")
    if len(participant.endpoints) > LIMITS.participants * LIMITS.endpoints:
        raise AssertionError("endpoints")
    held = 0
    for reader in [*participant.readers.values(), *participant.sedp.readers.values()]:
        if len(reader.proxies) > LIMITS.participants * LIMITS.endpoints:
            raise AssertionError("proxies")
        for proxy in reader.proxies.values():
            real = sum(len(one[0].payload) for one in proxy.held.values() if one is not None)
            if real != proxy.held_bytes or real > LIMITS.held_bytes or len(proxy.held) > LIMITS.held_samples:
                raise AssertionError(
                    f"held: {real} octets, counted {proxy.held_bytes}, {len(proxy.held)} samples"
                )
            if len(proxy.assemblies) > LIMITS.assemblies:
                raise AssertionError("assemblies")
            held += sum(one.size for one in proxy.assemblies.values())
    if held != LIMITS.assembly_bytes - participant._budget.left or held > LIMITS.assembly_bytes:
        raise AssertionError(f"assemblies of {held} octets, {participant._budget.left} left")


def check(data: bytes) -> None:
    """The first octets choose a session and how it is spoiled; raises if the invariant does not hold."""
    source = random.Random(data)
    session = source.choice(sessions())
    participant = victim(source.choice(session)[8:20])
    now = 0.0
    for datagram in session[: 20 + len(data)]:
        now += source.choice((0.0, 0.001, 0.3))
        broken = bytearray(datagram)
        for _ in range(source.choice((0, 0, 1, 4))):
            broken[source.randrange(len(broken))] = source.choice(
                (0, 1, 0x7F, 0x80, 0xFF, source.randrange(256))
            )
        for _ in range(source.choice((1, 1, 1, 2))):
            participant.receive_datagram(bytes(broken), ("127.0.0.1", 7410), now)
        for _ in range(3):
            participant.handle_deadline(now)
            sent = participant.datagrams_to_send(now)
            if sum(len(part) for parts, _ in sent for part in parts) > 1 << 20:
                raise AssertionError("answers a small datagram with a flood")
        within(participant)
        if source.random() < 0.7:
            participant.take_events()
    COUNTED.update(participant.counters)


COUNTED: collections.Counter[str] = collections.Counter()


def smoke(count: int) -> None:
    """`count` random inputs, always the same."""
    source = random.Random(0)
    for _ in range(count):
        check(bytes(source.randrange(256) for _ in range(source.randrange(1, 100))))
    print(f"{count} inputs, no finding")


def main() -> None:
    """The command."""
    if sys.argv[1:2] == ["--smoke"]:
        smoke(int(sys.argv[2]))
        return
    import atheris

    atheris.instrument_all()
    atheris.Setup(sys.argv, check)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
