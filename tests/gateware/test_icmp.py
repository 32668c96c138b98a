"""Scapy asks, and judges the answers."""

from __future__ import annotations

import random
from typing import Any

import pytest
from scapy.layers.inet import ICMP
from scapy.packet import Raw
from scapy.utils import checksum

from gateware.frames import STALLS, Bad, Bench
from gateware.internet import OWN, PEER, ipv4_rx, lead, noise, turning
from roslet.gateware.icmp import IcmpEcho

DROPS = tuple(f"drop_{reason}" for reason in ("type", "group", "length", "size", "busy", "checksum"))


def request(data: bytes = b"", **of: Any) -> bytes:
    return bytes(ICMP(**{"type": "echo-request", "id": 0x1234, "seq": 1, **of}) / Raw(data))


def reply(asked: bytes) -> bytes:
    answer = ICMP(asked)
    answer.type = 0
    del answer.chksum
    return bytes(answer)


def meta(length: int, peer: str = PEER, *, group: int = 0) -> dict[str, int]:
    return ipv4_rx(length, 1, peer, "224.0.0.1" if group else OWN, group)


def exchange(
    block: IcmpEcho,
    messages: list[bytes],
    replies: int,
    metas: list[dict[str, int]] | None = None,
    stalls: int = 0,
    cycles: int = 20_000,
) -> tuple[list[tuple[bytes, bytes]], dict[str, int]]:
    """The replies, with the leads that they were behind; and the drops that are not 0."""
    bench = Bench(block, stalls)
    bench.watch(turning(bench.dut))
    bench.send("i", messages, metas or [meta(len(message)) for message in messages])
    got = bench.receive("o")
    bench.count(*DROPS)
    bench.run(lambda: len(got) >= replies, cycles=cycles)
    assert len(got) == replies
    return [(frame[14:], frame[:14]) for frame, _ in got], {
        name: count for name, count in bench.counts.items() if count
    }


def apart(messages: list[bytes], gap: int) -> list[bytes]:
    """With bad frames between, which take their time and give nothing."""
    return [item for message in messages for item in (message, Bad(bytes(gap)))]


@pytest.mark.parametrize("stalls", STALLS)
def test_a_request_by_hand_is_answered_to_who_asked(stalls: int) -> None:
    asked = bytes.fromhex("0800 f7fd 0001 0001")
    (got,), drops = exchange(IcmpEcho(), [asked], 1, stalls=stalls)
    assert got[0] == bytes.fromhex("0000 fffd 0001 0001")
    assert got[1] == lead(PEER, 1, 8)
    assert not drops


@pytest.mark.parametrize("stalls", STALLS)
def test_requests_of_every_size_are_answered_in_order(stalls: int) -> None:
    sizes = [0, 1, 2, 3, 56, 0, 57]
    asked = [request(noise(size, size), id=1000 + size, seq=n) for n, size in enumerate(sizes)]
    peers = [f"10.1.2.{n}" for n in range(len(sizes))]
    metas = [meta(len(message), peer) for message, peer in zip(asked, peers, strict=True)]
    frames, beside = apart(asked, 80), [m for own in metas for m in (own, meta(80))]
    got, drops = exchange(IcmpEcho(57), frames, len(sizes), beside, stalls=stalls)
    assert [frame for frame, _ in got] == [reply(message) for message in asked]
    assert [before for _, before in got] == [
        lead(peer, 1, len(message)) for message, peer in zip(asked, peers, strict=True)
    ]
    assert not drops


def test_the_largest_of_one_packet_is_answered_and_one_octet_more_is_not() -> None:
    asked = request(noise(1472))
    got, drops = exchange(IcmpEcho(), [asked, request(noise(1473))], 1)
    assert got[0][0] == reply(asked)
    assert drops == {"drop_size": 1}


def test_every_checksum_becomes_a_right_one() -> None:
    rng = random.Random(5)
    edges = [0x0000, 0x0001, 0x00FF, 0xF7FF, 0xF800, 0xF8FF, 0xF7FE, 0xFEFF, 0xFFFE, 0xFFFD, 0xFF00, 0xF700]
    wanted = (
        edges
        + [rng.randrange(0xFFFF) for _ in range(60)]
        + [rng.randrange(0xF700, 0xFFFF) for _ in range(60)]
    )
    asked = []
    for target in wanted:  # two octets of data bring the checksum there
        plain = bytes([8, 0, 0, 0]) + rng.randbytes(4)
        data = checksum(plain + target.to_bytes(2, "big")).to_bytes(2, "big")
        message = plain[:2] + target.to_bytes(2, "big") + plain[4:] + data
        assert checksum(message) == 0
        asked.append(message)
    asked += [bytes.fromhex("0800f7ff") + bytes(4), bytes.fromhex("0800f7ff00000000") + bytes(10)]
    frames = apart(asked, 30)
    got, drops = exchange(IcmpEcho(20), frames, len(asked), [meta(min(len(frame), 28)) for frame in frames])
    assert not drops
    for message, (frame, _) in zip(asked, got, strict=True):
        assert checksum(frame) == 0, message
        assert frame[:2] == b"\0\0"
        assert frame[4:] == message[4:]


def test_what_is_no_request_to_us_is_dropped_for_its_reason() -> None:
    good = request(noise(20))
    wrong: list[tuple[str, bytes, int]] = [
        ("drop_type", bytes(ICMP(type="echo-reply") / Raw(noise(20))), 0),
        ("drop_type", bytes(ICMP(type="dest-unreach", code=3) / Raw(noise(20))), 0),
        ("drop_type", request(noise(20), code=1), 0),
        ("drop_type", b"\0", 0),
        ("drop_length", b"\x08\x01", 0),
        ("drop_type", bytes(ICMP(type="echo-reply") / Raw(noise(20))), 1),
        ("drop_group", good, 1),
        *(("drop_length", good[:size], 0) for size in range(2, 8)),
        ("drop_length", b"", 0),
        ("drop_size", request(noise(21)), 0),
        *(("drop_checksum", good[:at] + bytes([good[at] ^ 1]) + good[at + 1 :], 0) for at in range(2, 28)),
        ("drop_checksum", good[:-1], 0),
    ]
    frames, metas = [], []
    for _, message, group in wrong:
        frames += [message, Bad(message), good, Bad(bytes(40))]
        metas += [meta(len(message), group=group)] * 2 + [meta(28), meta(40)]
    got, drops = exchange(IcmpEcho(20), frames, len(wrong), metas, stalls=30)
    assert [frame for frame, _ in got] == [reply(good)] * len(wrong)
    expected: dict[str, int] = {}
    for reason, _, _ in wrong:
        expected[reason] = expected.get(reason, 0) + 1
    assert drops == expected


def test_a_request_cut_anywhere_is_forgotten() -> None:
    good = request(noise(20))
    frames: list[bytes] = [Bad(good[:size]) for size in range(29)]
    got, drops = exchange(IcmpEcho(20), [*frames, good], 1, [meta(28)] * 30)
    assert got[0][0] == reply(good)
    assert not drops


def test_two_are_held_and_keep_their_octets_while_others_are_dropped() -> None:
    asked = [request(noise(20, n), seq=n) for n in range(6)]
    bench = Bench(IcmpEcho(20), stalls=0)
    bench.watch(turning(bench.dut))
    bench.send("i", asked, [meta(28)] * 6)
    bench.count(*DROPS)
    got: list[bytes] = []

    async def take(ctx: Any) -> None:
        stream = bench.dut.o.stream
        await ctx.tick().repeat(6 * (14 + 29) + 10)  # until then nobody takes the replies
        assert bench.counts["drop_busy"] == 4
        ctx.set(stream.ready, 1)
        octets = bytearray()
        while len(got) < 2:
            (_, _, valid, item) = await ctx.tick().sample(stream.valid, stream.payload)
            if valid and item.end:
                got.append(bytes(octets)[14:])
                octets.clear()
            elif valid:
                octets.append(item.data)

    bench.drive(take)
    bench.run()
    assert got == [reply(message) for message in asked[:2]]


@pytest.mark.parametrize("stalls", STALLS)
def test_of_a_flood_each_reply_is_whole_and_each_request_is_answered_or_counted(stalls: int) -> None:
    rng = random.Random(stalls)
    asked = [request(noise(rng.randrange(21), n), seq=n) for n in range(40)]
    bench = Bench(IcmpEcho(20), stalls)
    bench.watch(turning(bench.dut))
    bench.send("i", asked, [meta(len(message)) for message in asked])
    got = bench.receive("o")
    bench.count(*DROPS)
    bench.run(rest=2_000)
    assert len(got) + bench.counts["drop_busy"] == 40
    answers = [reply(message) for message in asked]
    found = [answers.index(frame[14:]) for frame, _ in got]
    assert found == sorted(found)
    assert len(got) > 10


def test_pings_as_fast_as_an_ethernet_brings_them_are_all_answered() -> None:
    """Between two of them are the gap, preamble, FCS and the headers of Ethernet and IPv4: 58 octets, 14 of which a request
    that has come waits for. The way out costs as much: the lead is no part of it, and 3 cycles pass before that."""
    asked = [request(noise(56), seq=n) for n in range(20)]
    bench = Bench(IcmpEcho(), stalls=0)
    got: list[bytes] = []

    async def bring(ctx: Any) -> None:
        stream = bench.dut.i.stream
        ctx.set(bench.dut.i.meta, meta(64))
        for message in asked:
            await ctx.tick().repeat(58 - 14)
            ctx.set(stream.valid, 1)
            for n, octet in enumerate(message):
                ctx.set(stream.payload, {"data": octet, "end": 0, "bad": 0})
                if n == 0:
                    await ctx.tick().repeat(14)
                assert ctx.get(stream.ready)
                await ctx.tick()
            ctx.set(stream.payload, {"data": 0, "end": 1, "bad": 0})
            await ctx.tick()
            ctx.set(stream.valid, 0)
        await ctx.tick().repeat(300)

    async def take(ctx: Any) -> None:
        stream = bench.dut.o.stream
        while len(got) < len(asked):
            frame = bytearray()
            await ctx.tick().until(stream.valid)
            await ctx.tick().repeat(57 - 14 - 3)
            ctx.set(stream.ready, 1)
            while not ctx.get(stream.payload.end):
                frame.append(ctx.get(stream.payload.data))
                await ctx.tick()
            await ctx.tick()
            ctx.set(stream.ready, 0)
            got.append(bytes(frame)[14:])

    bench.watch(turning(bench.dut))
    bench.drive(bring)
    bench.drive(take)
    bench.count("drop_busy")
    bench.run()
    assert got == [reply(message) for message in asked]
    assert bench.counts == {"drop_busy": 0}


def test_a_reply_begins_4_cycles_after_its_request() -> None:
    bench = Bench(IcmpEcho(), stalls=0)
    asked = request(noise(5))
    bench.watch(turning(bench.dut))
    bench.send("i", [asked], [meta(13)])
    got = bench.receive("o")
    waits: list[int] = []

    async def watch(ctx: Any) -> None:
        stream = bench.dut.i.stream
        while not (ctx.get(stream.valid) and ctx.get(stream.payload.end)):
            await ctx.tick()
        waited = 0
        while not ctx.get(bench.dut.o.stream.valid):
            await ctx.tick()
            waited += 1
        waits.append(waited)

    bench.drive(watch)
    bench.run(lambda: len(got) == 1)
    assert waits == [4]


@pytest.mark.parametrize("size", [-1, 65508])
def test_a_size_that_cannot_be_is_refused(size: int) -> None:
    with pytest.raises(ValueError, match="an echo carries 0 to 65507 octets"):
        IcmpEcho(size)
