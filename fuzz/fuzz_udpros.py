"""Invariant: whatever datagrams come, a UDPROS receiver delivers only frames whose length is true, holds no more than its
bound, and counts a reason for every datagram that led to nothing.

    python fuzz/fuzz_udpros.py [libFuzzer options] [corpus]     coverage-guided; needs atheris
    python fuzz/fuzz_udpros.py --smoke N                        N seeded random inputs; needs nothing
"""

from __future__ import annotations

import pathlib
import random
import sys
from struct import pack

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "src"))

from roslet.engine.ros1.engine import Engine
from roslet.engine.ros1.reasons import REASONS
from roslet.engine.ros1.udp import UdpReceiver
from roslet.wire.udpros import emit

MAXIMUM = 200


def check(data: bytes) -> None:
    """Raises if the invariant does not hold. The input is datagrams, each behind its length in one byte."""
    got: list[int] = []

    def sink(view: memoryview, start: int, end: int, link: object) -> None:
        if int.from_bytes(view[start - 4 : start], "little") != end - start or end != len(view):
            raise AssertionError(f"a frame from {start} to {end} in {len(view)} bytes")
        got.append(end - start)

    engine = Engine("/n", "http://master:1", "host")
    subscription = engine.subscribe("/t", "t/T", "*", "", sink, 0.0, max_frame=MAXIMUM, transport="udp")
    receiver = UdpReceiver(engine, subscription, "http://p:1/")
    receiver.accepted(["UDPROS", "p", 1, 1, 1500, b""])
    at = 0
    while at < len(data):
        size = data[at]
        datagram = data[at + 1 : at + 1 + size]
        at += 1 + size
        before, held = sum(engine.counters.values()) + len(got), len(receiver._held)
        receiver.receive_datagram(memoryview(datagram), ("p", 1), 0.0)
        if receiver._held_bytes != sum(map(len, receiver._held.values())):
            raise AssertionError("what is held is miscounted")
        if receiver._held_bytes > MAXIMUM + 4:
            raise AssertionError(f"{receiver._held_bytes} bytes held")
        if sum(engine.counters.values()) + len(got) == before and len(receiver._held) != held + 1:
            raise AssertionError(f"{datagram!r} vanished without a reason")
    unknown = set(engine.counters) - set(REASONS)
    if unknown:
        raise AssertionError(f"unexplained reasons {unknown}")


def smoke(count: int) -> None:
    """`count` random inputs, always the same."""
    source = random.Random(0)
    for _ in range(count):
        datagrams: list[bytes] = []
        for message in range(source.randrange(1, 5)):
            body = source.randbytes(source.choice([0, 1, 50, MAXIMUM, MAXIMUM + 1]))
            frame = pack("<I", len(body) + source.choice([0, 0, 0, 1])) + body
            datagrams += emit(
                source.choice([1, 1, 1, 2]), message, memoryview(frame), source.choice([9, 20, 100])
            )
        for _ in range(source.randrange(4)):
            at = source.randrange(len(datagrams))
            datagrams.insert(at, source.choice([source.randbytes(9), datagrams[at][: source.randrange(12)]]))
            at = source.randrange(len(datagrams))
            other = source.randrange(len(datagrams))
            datagrams[at], datagrams[other] = datagrams[other], datagrams[at]
        check(b"".join(bytes([len(datagram)]) + datagram for datagram in datagrams))
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
