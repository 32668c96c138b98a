"""The user's two memories: words by hand, and who may touch them when watched throughout each simulation."""

from __future__ import annotations

import random
from collections.abc import Callable
from typing import Any

import pytest

from gateware.frames import STALLS, Bad, Bench
from roslet.gateware.raw_udp import RawUdpRx, RawUdpTx, data_limit

PORT = 1234
MAC = 0x06_05_04_03_02_01
HERE, THERE = 0x6401A8C0, 0x0A01A8C0  # 192.168.1.100, 192.168.1.10


def metas(frames: list[bytes], ports: list[int] | None = None) -> list[dict[str, int]]:
    return [
        {
            "mac": MAC,
            "source": THERE,
            "destination": HERE,
            "source_port": 4660 + n,
            "destination_port": ports[n] if ports else PORT,
            "length": len(frame),
            "group": 0,
        }
        for n, frame in enumerate(frames)
    ]


class Receiver:
    """A memory written by the block, and a user who reads what it is granted: `got` has the words, to the end of the data.

    `hold` says for how many cycles the user keeps the nth datagram.
    """

    def __init__(self, bench: Bench, words: int = 64, hold: Callable[[int], int] = lambda n: 3) -> None:
        self.got: list[list[int]] = []
        self.writes = 0
        self.granted = 0
        self._stale = 0xDEADBEEF

        async def memory_and_user(ctx: Any) -> None:
            dut = bench.dut
            ctx.set(dut.port, PORT)
            memory = [self._stale] * words
            release_in = -1
            was_granted = False
            while True:
                ctx.set(dut.rel, release_in == 0)
                _, _, ce, we, addr, wdata, grant = await ctx.tick().sample(
                    dut.ce, dut.we, dut.addr, dut.wdata, dut.grant
                )
                self.granted += grant
                if ce and we:
                    assert not grant, "written while granted"
                    memory[addr] = wdata
                    self.writes += 1
                if grant and not was_granted:
                    size = (memory[1] >> 16) + 3 >> 2
                    self.got.append(memory[: 2 + size])
                    assert all(word == self._stale for word in memory[2 + size :]), "written beyond the data"
                    memory = [self._stale] * words
                    release_in = 1 + hold(len(self.got) - 1)
                was_granted = grant
                release_in -= 1

        bench._simulator.add_testbench(memory_and_user, background=True)


def kept(frame: bytes, source_port: int = 4660) -> list[int]:
    """What the memory has of a datagram: the layout of the documentation, in octets."""
    octets = (
        bytes([192, 168, 1, 10])
        + source_port.to_bytes(2, "little")
        + len(frame).to_bytes(2, "little")
        + frame
    )
    octets += bytes(-len(octets) % 4)
    return [int.from_bytes(octets[n : n + 4], "little") for n in range(0, len(octets), 4)]


DROPS = ("drop_port", "drop_oversize", "drop_busy")


@pytest.mark.parametrize("stalls", STALLS)
def test_a_datagram_by_hand_is_in_the_memory_when_it_is_granted(stalls: int) -> None:
    bench = Bench(RawUdpRx(), stalls)
    receiver = Receiver(bench)
    bench.count(*DROPS)
    bench.send("i", [b"UDP Send Test\n"], metas([b"UDP Send Test\n"]))
    bench.run(lambda: len(receiver.got) == 1)
    assert receiver.got == [
        [0x0A01A8C0, 0x000E1234, 0x20504455, 0x646E6553, 0x73655420, 0x00000A74],
    ]
    assert bench.counts == dict.fromkeys(DROPS, 0)


@pytest.mark.parametrize("stalls", STALLS)
def test_all_lengths_are_kept_whole_up_to_the_limit(stalls: int) -> None:
    rng = random.Random(stalls)
    frames = [rng.randbytes(n) for n in (0, 1, 2, 3, 4, 5, 7, 8, 9, 247, 248)]
    bench = Bench(RawUdpRx(), stalls)
    receiver = Receiver(bench, hold=lambda n: 0)
    bench.count(*DROPS)
    # Between them others, for the time that the user needs to give the memory back.
    spaced = [part for frame in frames for part in (frame, b"elsewhere")]
    bench.send("i", spaced, metas(spaced, [PORT, PORT + 1] * len(frames)))
    bench.run(lambda: len(receiver.got) == len(frames), rest=200)
    assert receiver.got == [kept(frame, 4660 + 2 * n) for n, frame in enumerate(frames)]
    assert bench.counts == {"drop_port": len(frames), "drop_oversize": 0, "drop_busy": 0}


@pytest.mark.parametrize("stalls", STALLS)
def test_what_is_not_for_the_user_is_dropped_whole_and_counted(stalls: int) -> None:
    frames = [b"elsewhere", bytes(249), bytes(300), Bad(b"elsewhere"), Bad(bytes(249)), bytes(249), b"mine"]
    bench = Bench(RawUdpRx(), stalls)
    receiver = Receiver(bench)
    bench.count(*DROPS)
    bench.send("i", frames, metas(frames, [7400, PORT, PORT, 80, PORT, 1235, PORT]))
    bench.run(lambda: len(receiver.got) == 1)
    assert receiver.got == [kept(b"mine", 4666)]
    assert receiver.writes == 3
    assert bench.counts == {"drop_port": 2, "drop_oversize": 2, "drop_busy": 0}


@pytest.mark.parametrize("stalls", STALLS)
def test_a_datagram_that_ends_badly_is_forgotten(stalls: int) -> None:
    frames = [Bad(b"1"), Bad(b"1234"), Bad(b""), Bad(b"123456"), b"good", Bad(b"12345")]
    bench = Bench(RawUdpRx(), stalls)
    receiver = Receiver(bench, hold=lambda n: 1)
    bench.count(*DROPS)
    bench.send("i", frames, metas(frames))
    bench.run(lambda: len(receiver.got) == 1)
    assert receiver.got == [kept(b"good", 4664)]
    assert bench.counts == dict.fromkeys(DROPS, 0)


@pytest.mark.parametrize("stalls", STALLS)
def test_while_the_user_holds_the_memory_datagrams_are_dropped_whole_even_if_it_is_given_back_meanwhile(
    stalls: int,
) -> None:
    frames = [b"first", b"second, while held", b"third" * 40, b"fourth"]
    bench = Bench(RawUdpRx(), stalls)
    # Given back when about half of the third is over, by the sender's pace.
    receiver = Receiver(bench, hold=lambda n: (19 + 100) * 100 // (100 - stalls) if n == 0 else 0)
    bench.count(*DROPS)
    bench.send("i", frames, metas(frames))
    bench.run(lambda: len(receiver.got) == 2)
    assert receiver.got == [kept(b"first"), kept(b"fourth", 4663)]
    assert bench.counts == {"drop_port": 0, "drop_oversize": 0, "drop_busy": 2}


def test_rel_means_nothing_before_the_grant() -> None:
    bench = Bench(RawUdpRx(), stalls=0)
    granted: list[int] = []

    async def user(ctx: Any) -> None:
        ctx.set(bench.dut.port, PORT)
        ctx.set(bench.dut.rel, 1)
        for _ in range(100):
            _, _, grant = await ctx.tick().sample(bench.dut.grant)
            granted.append(grant)

    bench.drive(user)
    bench.send("i", [b"12345"], metas([b"12345"]))
    bench.run()
    assert granted.count(1) == 1  # the cycle in which it is high, and `rel` with it


def test_a_datagram_is_granted_four_cycles_after_its_end_has_come_and_an_octet_is_taken_every_cycle() -> None:
    frames = [bytes(248)] * 3
    bench = Bench(RawUdpRx(), stalls=0)
    receiver = Receiver(bench, hold=lambda n: 0)
    bench.send("i", frames, metas(frames))
    # The second comes while the first is held: dropped.
    bench.run(
        lambda: len(receiver.got) == 2, cycles=(1 + 248 + 1 + 3) + (1 + 248 + 1) + (1 + 248 + 1 + 3) + 6
    )


def test_a_greater_memory_holds_more() -> None:
    frame = random.Random(0).randbytes(1472)
    bench = Bench(RawUdpRx(9), stalls=0)
    receiver = Receiver(bench, words=512)
    bench.send("i", [frame], metas([frame]))
    bench.run(lambda: len(receiver.got) == 1)
    assert receiver.got == [kept(frame)]


@pytest.mark.parametrize(
    ("header", "width", "limit", "sentence"),
    [
        (2, 6, 249, "data of 1 to 248 octets fit a UDP memory with an address of 6 bits, not 249"),
        (3, 6, 245, "data of 1 to 244 octets fit a UDP memory with an address of 6 bits, not 245"),
        (2, 6, 0, "data of 1 to 248 octets"),
        (3, 1, None, "an address of 2 to 14 bits, not 1"),
        (2, 15, None, "an address of 2 to 14 bits, not 15"),
    ],
)
def test_a_limit_that_the_memory_cannot_hold_is_refused(
    header: int, width: int, limit: int | None, sentence: str
) -> None:
    with pytest.raises(ValueError, match=sentence):
        data_limit(header, width, limit)


# -- what is sent


def ones_sum(octets: bytes) -> int:
    """The ones' complement sum of 16-bit words. RFC 1071."""
    total = sum(int.from_bytes(octets[n : n + 2].ljust(2, b"\0"), "big") for n in range(0, len(octets), 2))
    while total >> 16:
        total = (total & 0xFFFF) + (total >> 16)
    return total


def filled(frame: bytes, length: int | None = None, words: int = 64) -> list[int]:
    """What the user writes to send a datagram from port 1234 to 192.168.1.10:4660, over what was there before."""
    length = len(frame) if length is None else length
    octets = (
        bytes([192, 168, 1, 10, 0x34, 0x12, 0xD2, 0x04]) + length.to_bytes(2, "little") + b"\xbe\xef" + frame
    )
    octets += b"\xde\xad\xbe\xef" * words
    return [int.from_bytes(octets[n : n + 4], "little") for n in range(0, 4 * words, 4)]


class Sender:
    """A memory, a user who fills it with one datagram after another, and who answers for addresses, after `answer` cycles.

    `answers` are "found", "failed" or "pending"; the last is repeated.
    """

    def __init__(
        self, bench: Bench, memories: list[list[int]], answers: tuple[str, ...] = ("found",)
    ) -> None:
        self.over = False
        self.asked: list[int] = []
        self.cycle = self.released = 0
        wait = bench.random

        async def memory_and_user(ctx: Any) -> None:
            dut = bench.dut
            rdata = 0
            held: list[int] = []
            for memory in [*memories, None]:
                while True:  # for the grant, and to the end of the last one
                    ctx.set(dut.rdata, rdata)
                    _, _, ce, addr, grant = await ctx.tick().sample(dut.ce, dut.addr, dut.grant)
                    self.cycle += 1
                    assert not (ce and grant), "read while the user's"
                    rdata = held[addr] if ce else wait.randrange(1 << 32)
                    if grant:
                        break
                if memory is None:
                    break
                held = memory
                await ctx.tick().repeat(3)
                ctx.set(dut.rel, 1)
                _, _, ce = await ctx.tick().sample(dut.ce)
                assert not ce
                ctx.set(dut.rel, 0)
                self.cycle = 0
            self.over = True

        async def resolver(ctx: Any) -> None:
            lookup = bench.dut.lookup
            number = 0
            while True:
                valid, ip = False, 0
                while not valid:
                    _, _, valid, ip = await ctx.tick().sample(lookup.valid, lookup.ip)
                self.asked.append(ip)
                for _ in range(wait.randrange(10)):
                    _, _, valid, still = await ctx.tick().sample(lookup.valid, lookup.ip)
                    assert valid, "a question was withdrawn"
                    assert still == ip, "a question was changed"
                answer = answers[min(number, len(answers) - 1)]
                number += 1
                ctx.set(lookup.done, 1)
                ctx.set(lookup.found, answer == "found")
                ctx.set(lookup.failed, answer == "failed")
                ctx.set(lookup.mac, MAC if answer == "found" else 0)
                await ctx.tick()
                ctx.set(lookup.done, 0)
                ctx.set(lookup.found, 0)
                ctx.set(lookup.failed, 0)
                ctx.set(lookup.mac, 0)

        bench.drive(memory_and_user)
        bench._simulator.add_testbench(resolver, background=True)


@pytest.mark.parametrize("stalls", STALLS)
def test_a_datagram_by_hand_goes_out_with_its_sum(stalls: int) -> None:
    bench = Bench(RawUdpTx(), stalls)
    memory = [0x0A01A8C0, 0x04D21234, 0xFFFF000E, 0x20504455, 0x646E6553, 0x73655420, 0xFFFF0A74, *[0] * 57]
    sender = Sender(bench, [memory])
    got = bench.receive("o")
    bench.count("drop_oversize", "drop_unresolved")
    bench.run(lambda: sender.over)
    ((frame, meta),) = got
    assert frame == b"UDP Send Test\n"
    assert (meta.mac, meta.destination, meta.source_port, meta.destination_port) == (MAC, THERE, 1234, 4660)
    # 5544+5020+5365+6e64+2054+6573+740a = 260fe
    assert (meta.length, meta.sum) == (14, 0x6100)
    assert set(sender.asked) == {THERE}
    assert bench.counts == {"drop_oversize": 0, "drop_unresolved": 0}


@pytest.mark.parametrize("stalls", STALLS)
def test_all_lengths_go_out_up_to_the_limit_and_nothing_of_what_was_there_before(stalls: int) -> None:
    rng = random.Random(stalls)
    frames = [rng.randbytes(n) for n in (0, 1, 2, 3, 4, 5, 7, 8, 9, 63, 243, 244)]
    bench = Bench(RawUdpTx(), stalls)
    sender = Sender(bench, [filled(frame) for frame in frames])
    got = bench.receive("o")
    bench.run(lambda: sender.over)
    assert [frame for frame, _ in got] == frames
    assert [(meta.length, meta.sum) for _, meta in got] == [(len(frame), ones_sum(frame)) for frame in frames]


def test_sums_with_every_carry_are_right() -> None:
    rng = random.Random(0)
    frames = [bytes(rng.choice([0, 255, 255, 254, 1]) for _ in range(rng.randrange(20))) for _ in range(80)]
    bench = Bench(RawUdpTx(), stalls=0)
    sender = Sender(bench, [filled(frame) for frame in frames])
    got = bench.receive("o")
    bench.run(lambda: sender.over)
    assert [frame for frame, _ in got] == frames
    assert [meta.sum for _, meta in got] == [ones_sum(frame) for frame in frames]


@pytest.mark.parametrize("stalls", STALLS)
def test_a_length_over_the_limit_is_refused_counted_and_granted_back(stalls: int) -> None:
    bench = Bench(RawUdpTx(), stalls)
    lengths = [245, 256, 0x8001, 0xFFFF]
    sender = Sender(bench, [*(filled(b"x", length) for length in lengths), filled(b"good")])
    got = bench.receive("o")
    bench.count("drop_oversize", "drop_unresolved")
    bench.run(lambda: sender.over)
    assert [frame for frame, _ in got] == [b"good"]
    assert bench.counts == {"drop_oversize": 4, "drop_unresolved": 0}
    assert len(sender.asked) == 1


@pytest.mark.parametrize("stalls", STALLS)
def test_it_asks_again_while_the_address_is_asked_for(stalls: int) -> None:
    bench = Bench(RawUdpTx(), stalls)
    sender = Sender(bench, [filled(b"good")], ("pending",) * 30 + ("found",))
    got = bench.receive("o")
    bench.run(lambda: sender.over)
    assert [(frame, meta.mac) for frame, meta in got] == [(b"good", MAC)]
    assert sender.asked == [THERE] * 31


@pytest.mark.parametrize("stalls", STALLS)
@pytest.mark.parametrize("size", [0, 200])
def test_a_datagram_to_whom_nobody_answers_for_is_dropped_counted_and_granted_back(
    stalls: int, size: int
) -> None:
    bench = Bench(RawUdpTx(), stalls)
    answers = ("failed", "pending", "pending", "failed", "found")
    sender = Sender(bench, [filled(bytes(size)), filled(bytes(size)), filled(b"good")], answers)
    got = bench.receive("o")
    bench.count("drop_oversize", "drop_unresolved")
    bench.run(lambda: sender.over)
    assert [frame for frame, _ in got] == [b"good"]
    assert bench.counts == {"drop_oversize": 0, "drop_unresolved": 2}


def test_64_octets_begin_25_cycles_after_rel_where_the_address_is_known() -> None:
    bench = Bench(RawUdpTx(), stalls=0)
    waited = []

    async def user(ctx: Any) -> None:
        dut = bench.dut
        ctx.set(dut.lookup.done, 1)
        ctx.set(dut.lookup.found, 1)
        ctx.set(dut.rdata, 64)
        ctx.set(dut.rel, 1)
        await ctx.tick()
        ctx.set(dut.rel, 0)
        waited.append(await _cycles_until(ctx, dut.o.stream.valid))

    bench.drive(user)
    bench.run()
    assert waited == [25]


async def _cycles_until(ctx: Any, signal: Any) -> int:
    for cycles in range(1, 1000):
        _, _, high = await ctx.tick().sample(signal)
        if high:
            return cycles
    raise AssertionError("never")


def test_a_greater_memory_sends_more() -> None:
    frame = random.Random(0).randbytes(1472)
    bench = Bench(RawUdpTx(9), stalls=0)
    sender = Sender(bench, [filled(frame, words=512)])
    got = bench.receive("o")
    bench.run(lambda: sender.over)
    assert [(frame, meta.sum) for frame, meta in got] == [(frame, ones_sum(frame))]
