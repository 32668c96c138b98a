"""Invariant: whatever datagrams come, from whomever, in whatever order and at whatever time, no exception leaves a
participant, and what it holds and sends stays within its limits.

An input is a program: an even first octet makes it one of two matched peers that say anything, by hand; an odd one a
recorded session that is spoiled.

    python fuzz/fuzz_rtps_participant.py [libFuzzer options] [corpus]     coverage-guided; needs atheris
    python fuzz/fuzz_rtps_participant.py --smoke N                        N seeded random inputs; needs nothing
"""

from __future__ import annotations

import collections
import functools
import pathlib
import random
import sys
from typing import Any

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "src"))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tests"))

from engine.rtps import hand
from roslet.engine.rtps.fragments import cost
from roslet.engine.rtps.history import HistoryFull
from roslet.engine.rtps.limits import Limits
from roslet.engine.rtps.participant import Participant
from roslet.engine.rtps.repairs import MAX_RESENT
from roslet.wire.rtps import locator, qos
from roslet.wire.rtps.qos import Qos

ROOT = pathlib.Path(__file__).resolve().parent.parent
LIMITS = Limits(4, 16, 8, 100000, 2, 100000, 150000, 64)
MAX_HISTORY = 1 << 20
# Every reader may ask once for each sample that a writer keeps.
MAX_BULK = 5 * LIMITS.participants * LIMITS.endpoints
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
    if len(participant._by_writer) > LIMITS.participants * (LIMITS.endpoints + 3):
        raise AssertionError("routes")
    if len(participant.counters) > 100:
        raise AssertionError("reasons")
    if any(len(remote.hosts) > 140 for remote in participant.spdp.remotes.values()):
        raise AssertionError("addresses")
    for writer in [*participant.writers.values(), *participant.sedp.writers.values()]:
        if len(writer.proxies) > LIMITS.participants * LIMITS.endpoints:
            raise AssertionError("readers")
        if any(len(proxy.resent) > MAX_RESENT + 1 for proxy in writer.proxies.values()):
            raise AssertionError("repeats")
        if writer.history.bytes > MAX_HISTORY:
            raise AssertionError(f"a history of {writer.history.bytes} octets")
    bulk = sum(len(flow.waiting) + len(flow.repairs) for flow in participant.outbox._flows)
    if bulk > MAX_BULK:
        raise AssertionError(f"{bulk} samples wait to be sent")
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
            held += sum(cost(one.size, one.fragment_size) for one in proxy.assemblies.values())
    if held != LIMITS.assembly_bytes - participant._common.assembling.left or held > LIMITS.assembly_bytes:
        raise AssertionError(f"assemblies of {held} octets, {participant._common.assembling.left} left")


def recorded(data: bytes) -> None:
    """The octets choose a session and how it is spoiled."""
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
        turn(participant, now)
        if source.random() < 0.7:
            participant.take_events()
    COUNTED.update(participant.counters)


def turn(participant: Participant, now: float) -> None:
    """What a runtime does after a datagram."""
    for _ in range(3):
        participant.handle_deadline(now)
        sent = participant.datagrams_to_send(now)
        if sum(len(part) for parts, _ in sent for part in parts) > 1 << 20:
            raise AssertionError("answers a small datagram with a flood")
    within(participant)


PEERS = (hand.PREFIX, b"\x01\x10" + bytes(range(10)), b"\x01\x52" + bytes(10))
HOSTS = ("10.0.0.9", "10.0.0.66", "127.0.0.1", "0.0.0.0")
WRITERS = (
    *(hand.WRITER,) * 4,
    hand.PUBLICATIONS_WRITER,
    hand.SUBSCRIPTIONS_WRITER,
    hand.SPDP_WRITER,
    b"\0\2\0\xc2",
)
READERS = (*(hand.ANYONE,) * 4, b"\0\0\1\4", hand.PUBLICATIONS_READER, hand.SUBSCRIPTIONS_READER)
# The victim's, and what acknowledges them.
OURS = (*(b"\0\0\2\3",) * 4, hand.PUBLICATIONS_WRITER, hand.SUBSCRIPTIONS_WRITER, b"\0\2\0\xc2")
THEIRS = (*(hand.READER,) * 4, hand.PUBLICATIONS_READER, hand.SUBSCRIPTIONS_READER, b"\0\2\0\xc7")
NUMBERS = (
    *(1, 2, 3, 4, 5, 6, 7, 8) * 3,
    *(20, 100, 257, (1 << 31) - 1, 1 << 32, (1 << 63) - 300, (1 << 63) - 1, 0, -1, -(1 << 63)),
)
SMALL = (1, 1, 2, 2, 3, 3, 0, 8, 255, 256, 257, 65535, 0xFFFFFFFF)
BODIES = (b"\0\1\0\0hello", b"", b"\0", b"\0\1\0\0" + bytes(3000))


class Program:
    """Choices from octets; at their end it is over."""

    def __init__(self, data: bytes) -> None:
        self.data = data
        self.at = 0

    def over(self) -> bool:
        return self.at >= len(self.data)

    def octet(self) -> int:
        self.at += 1
        return self.data[self.at - 1] if self.at <= len(self.data) else 0

    def one(self, choices: tuple[Any, ...]) -> Any:
        return choices[self.octet() % len(choices)]

    def set(self) -> bytes:
        bits = self.one((0, 0, 1, 1, 8, 32, 32, 256, 256, 257, 0xFFFFFFFF))
        return hand.number_set(self.one(NUMBERS), bits, (0xFFFFFFFF,) * min(9, (bits + 31) // 32))


def said(program: Program) -> bytes:
    """One submessage."""
    kind = program.octet() % 10
    e = program.one(("<", ">"))
    writer, reader = program.one(WRITERS), program.one(READERS)
    number, count = program.one(NUMBERS), program.octet()
    if kind == 0:
        return hand.data(
            writer, number, program.one(BODIES), reader, e, flags=program.one((4, 4, 4, 8, 0, 12))
        )
    if kind == 1:
        return hand.heartbeat(writer, number, program.one(NUMBERS), count, reader, e, program.one((0, 2, 4)))
    if kind == 2:
        return hand.gap(writer, number, program.set(), e)
    if kind == 3:
        return hand.acknack(program.one(THEIRS), program.one(OURS), program.set(), count, e)
    if kind == 4:
        size, total = (
            program.one((1000, 1000, 1000, 100, 1, 0, 65535)),
            program.one((3000, 3000, 2500, 99000, 99000, 1, 0, 0xFFFFFFFF)),
        )
        first, many = (
            program.one((1, 1, 2, 2, 3, 3, 30, 0, 0xFFFFFFFF)),
            program.one((1, 1, 1, 1, 2, 3, 0, 65535)),
        )
        return hand.data_frag(writer, number, first, many, size, total, bytes(min(size * many, 60000)), e)
    if kind == 5:
        bits = program.one((1, 32, 256, 256, 257))
        words = (0xFFFFFFFF,) * ((bits + 31) // 32)
        return hand.nack_frag(
            program.one(THEIRS), program.one(OURS), number, program.one(SMALL), bits, words, count
        )
    if kind == 6:
        frag = reader + writer + hand.number(number, e) + count.to_bytes(8, "little")
        return hand.submessage(0x13, 0, frag, e)
    if kind == 7:
        guid = program.one(PEERS) + bytes((0, 0, count)) + program.one((b"\3", b"\4", b"\2", b"\7"))
        more = hand.parameter(program.one((0x2F, 0x2C, 0x1B, 0x23, 0x29, 0x4123)), program.one(BODIES))
        endpoint = hand.endpoint(
            guid, program.one(("rt/chatter", "t", "")), program.one((STRING, "T")), e, more
        )
        if program.octet() & 1:
            return hand.data(writer, number, endpoint, e=e)
        status = hand.parameters(hand.parameter(0x70, guid), hand.parameter(0x71, b"\0\0\0\3"))
        return hand.data(writer, number, hand.payload(hand.parameter(0x5A, guid)), qos=status, flags=8)
    if kind == 8:
        return program.one(
            (hand.INFO_TS_INVALID, hand.info_ts(1), hand.info_dst(PEERS[2]), hand.info_src(PEERS[0]))
        )
    length = program.octet()
    octets = bytes(program.octet() for _ in range(length % 64))
    return hand.submessage(program.octet(), program.octet(), octets, e, program.one((None, 0, 1, 65535)))


def met() -> Participant:
    """A victim that two peers have met, each with a writer and a reader."""
    participant = victim(PEERS[2])
    for prefix in PEERS[:2]:
        writer = hand.endpoint(prefix + hand.WRITER, "rt/chatter", STRING)
        reader = hand.endpoint(prefix + hand.READER, "rt/chatter", STRING)
        for datagram in (
            hand.spdp(prefix),
            hand.message(hand.data(hand.PUBLICATIONS_WRITER, 1, writer), prefix=prefix),
            hand.message(hand.heartbeat(hand.PUBLICATIONS_WRITER, 1, 1, 1), prefix=prefix),
            hand.message(hand.data(hand.SUBSCRIPTIONS_WRITER, 1, reader), prefix=prefix),
            hand.message(hand.heartbeat(hand.SUBSCRIPTIONS_WRITER, 1, 1, 1), prefix=prefix),
            hand.message(hand.heartbeat(hand.WRITER, 1, 0, 1), prefix=prefix),
        ):
            participant.receive_datagram(datagram, hand.SOURCE, 0.0)
    turn(participant, 0.0)
    return participant


def invented(program: Program) -> None:
    """Two peers that have met the victim, and then say anything."""
    participant = met()
    now = 0.0
    while not program.over():
        now += program.one((*(0.0,) * 8, *(0.001,) * 4, 0.02, 0.1, 0.3, 3.0))
        source = (program.one((*(HOSTS[0],) * 4, *HOSTS)), 7410)
        does = program.octet() % 16
        if does == 0:
            stranger = b"\x01\x01" + bytes((program.octet() & 15,)) * 10
            prefix = program.one((*PEERS, stranger))
            host, e = program.one(HOSTS), program.one(("<", ">"))
            participant.receive_datagram(hand.spdp(prefix, host, e, 1 + program.octet()), source, now)
        elif does == 1 and program.octet() & 1:
            now += program.one((1.0, 9.0, 11.0, 21.0, 1000.0))
        elif does == 1:
            participant.receive_datagram(hand.departure(program.one(PEERS)), source, now)
        elif does == 2:
            for writer in participant.writers.values():
                if not writer.full(1000):
                    try:
                        writer.write(b"\0\1\0\0" + bytes(program.octet() * 4), now)
                    except HistoryFull:
                        raise AssertionError("full, but said that it is not") from None
        elif does == 3:
            participant.take_events()
        else:
            submessages = [said(program) for _ in range(1 + program.octet() % 3)]
            datagram = hand.message(*submessages, prefix=program.one(PEERS))
            participant.receive_datagram(datagram[:65507], source, now)
        turn(participant, now)
    COUNTED.update(participant.counters)


def check(data: bytes) -> None:
    """Raises if the invariant does not hold."""
    if data[:1] and data[0] & 1 == 0:
        invented(Program(data[1:400]))
    else:
        recorded(data)


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
