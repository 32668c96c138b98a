"""IGMPv2 as RFC 2236 has it: reports by hand and read by scapy, queries by hand and written by scapy."""

from __future__ import annotations

import struct
from typing import Any

import pytest
from scapy.contrib.igmp import IGMP  # type: ignore[attr-defined]
from scapy.contrib.igmpv3 import IGMPv3, IGMPv3mq  # type: ignore[attr-defined]
from scapy.layers import inet

from gateware.frames import STALLS, Bad, Bench
from gateware.network import IP, configure, number, watch_pauses
from roslet.gateware.igmp import Igmp
from roslet.gateware.igmp_rx import IgmpRx

SECOND = 320
"""Cycles, so that ten seconds are simulated in one."""

DISCOVERY, OTHER = bytes((239, 255, 0, 1)), bytes((224, 1, 2, 200))
META = {"mac": 0, "source": 0, "destination": 0, "protocol": 2, "length": 8, "group": 1}


def checksum(data: bytes) -> int:
    """RFC 1071, by big numbers: the ones' complement sum is the remainder by 0xFFFF."""
    total = int.from_bytes(data + bytes(len(data) % 2), "big")
    return ~(total % 0xFFFF or 0xFFFF) & 0xFFFF


def query(max_response: int, group: bytes = bytes(4), kind: int = 0x11, more: bytes = b"") -> bytes:
    message = struct.pack("!BBH4s", kind, max_response, 0, group) + more
    return message[:2] + struct.pack("!H", checksum(message)) + message[4:]


def report(group: bytes) -> bytes:
    header = bytes.fromhex("4600 0020 0000 4000 0102 0000") + IP + group + bytes.fromhex("9404 0000")
    header = header[:10] + struct.pack("!H", checksum(header)) + header[12:]
    return bytes((1, 0, 0x5E, group[1] & 0x7F, *group[2:])) + header + query(0, group, 0x16)


class Host:
    """An Igmp block on a bench, whose reports are noted with the cycle in which they were complete."""

    def __init__(self, count: int = 1, stalls: int = 0, **inputs: Any) -> None:
        self.bench = Bench(Igmp(SECOND, count), stalls)
        groups = [{"valid": 1, "ip": number(group)} for group in (DISCOVERY, OTHER)]
        configure(self.bench, **{"enable": 1, "groups": groups[:count], **inputs})
        self.sent = self.bench.receive("o")
        self.bench.count("drop_igmp")
        self.dut: Any = self.bench.dut

    async def tell(self, ctx: Any, *messages: bytes) -> None:
        port = self.dut.i.stream
        for message in messages:
            items = [{"data": octet, "end": 0, "bad": 0} for octet in message]
            for item in [*items, {"data": 0, "end": 1, "bad": isinstance(message, Bad)}]:
                ctx.set(port.payload, item)
                ctx.set(port.valid, 1)
                await ctx.tick().until(port.ready)
                ctx.set(port.valid, 0)

    async def next(self, ctx: Any, within: int) -> int:
        """Wait for one more report; how long that took."""
        before = len(self.sent)
        for waited in range(within):
            if len(self.sent) > before:
                return waited
            await ctx.tick()
        raise AssertionError(f"no report within {within} cycles")

    async def joined(self, ctx: Any) -> None:
        """Wait until the reports of joining are over."""
        for _ in range(3):
            await self.next(ctx, 10 * SECOND + 300)
        await ctx.tick().repeat(10)

    def run(self, process: Any) -> None:
        self.bench.drive(process)
        self.bench.run(cycles=100_000)


@pytest.mark.parametrize("stalls", STALLS)
def test_a_group_is_reported_at_once_and_twice_again_within_ten_seconds(stalls: int) -> None:
    host = Host(stalls=stalls)
    pauses = watch_pauses(host.bench)
    times: list[int] = []

    async def process(ctx: Any) -> None:
        times.append(await host.next(ctx, 300 if stalls < 50 else 1000))
        times.append(await host.next(ctx, 10 * SECOND + 1000))
        times.append(await host.next(ctx, 10 * SECOND + 1000))
        await ctx.tick().repeat(2000)

    host.run(process)
    assert pauses == []
    assert len(set(times)) == 3
    assert [frame for frame, _ in host.sent] == [report(DISCOVERY)] * 3
    for frame, meta in host.sent:
        assert meta.type == 0x0800
        assert frame[:6] == bytes.fromhex("0100 5e7f 0001")
        frame = frame[6:]
        packet = inet.IP(frame)
        assert (packet.ttl, packet.src, packet.dst) == (1, "192.168.1.100", "239.255.0.1")
        assert packet.options[0].name == "IPOption_Router_Alert" or packet.options[0].option == 20
        message = IGMP(bytes(packet.payload))
        assert (message.type, message.mrcode, message.gaddr) == (0x16, 0, "239.255.0.1")
        assert checksum(frame[:24]) == checksum(frame[24:]) == 0


def test_nothing_is_reported_before_it_is_enabled_nor_of_a_group_that_is_not_valid() -> None:
    host = Host(
        2, enable=0, groups=[{"valid": 0, "ip": number(DISCOVERY)}, {"valid": 1, "ip": number(OTHER)}]
    )

    async def process(ctx: Any) -> None:
        await host.tell(ctx, query(1))
        await ctx.tick().repeat(500)
        assert host.sent == []
        ctx.set(host.dut.enable, 1)
        await host.joined(ctx)
        assert [frame for frame, _ in host.sent] == [report(OTHER)] * 3
        ctx.set(host.dut.groups[0].valid, 1)
        await host.next(ctx, 200)

    host.run(process)
    assert host.sent[-1][0] == report(DISCOVERY)


def test_a_query_is_answered_at_a_random_time_within_what_it_allows() -> None:
    host = Host()
    times: list[int] = []

    async def process(ctx: Any) -> None:
        await host.joined(ctx)
        written = IGMP(type=0x11, mrcode=20, gaddr="0.0.0.0")
        for _ in range(8):
            await host.tell(ctx, bytes(written))
            times.append(await host.next(ctx, 2 * SECOND + 300))
            await ctx.tick().repeat(37)

    host.run(process)
    assert len(set(times)) > 5
    assert max(times) - min(times) > SECOND // 2
    assert len(host.sent) == 11


@pytest.mark.parametrize(
    "message",
    [
        query(0),  # version 1: 10 s
        query(5, DISCOVERY),
        query(5, more=bytes.fromhex("0000 0000")),  # version 3
        bytes(IGMPv3(type=0x11, mrcode=10) / IGMPv3mq(gaddr="239.255.0.1")),
    ],
)
def test_queries_of_all_versions_of_all_and_of_one_are_answered(message: bytes) -> None:
    host = Host()

    async def process(ctx: Any) -> None:
        await host.joined(ctx)
        await host.tell(ctx, message)
        await host.next(ctx, 10 * SECOND + 300)

    host.run(process)
    assert host.sent[-1][0] == report(DISCOVERY)
    assert host.bench.counts == {"drop_igmp": 0}


def test_of_several_groups_a_query_of_one_is_answered_with_that_one_and_of_all_with_all() -> None:
    host = Host(2)

    async def process(ctx: Any) -> None:
        await ctx.tick().repeat(250)
        assert sorted(frame for frame, _ in host.sent) == sorted([report(DISCOVERY), report(OTHER)])
        for _ in range(4):
            await host.next(ctx, 10 * SECOND + 300)
        await ctx.tick().repeat(200)
        host.sent.clear()
        await host.tell(ctx, query(2, OTHER))
        await ctx.tick().repeat(3 * SECOND)  # of the numbers drawn one in 128 is small enough
        assert [frame for frame, _ in host.sent] == [report(OTHER)]
        host.sent.clear()
        await host.tell(ctx, query(2))
        await ctx.tick().repeat(3 * SECOND)

    host.run(process)
    assert sorted(frame for frame, _ in host.sent) == sorted([report(DISCOVERY), report(OTHER)])


def test_a_query_that_allows_less_time_hastens_the_answer_and_one_that_allows_more_does_not_delay_it() -> (
    None
):
    host = Host()

    async def process(ctx: Any) -> None:
        await host.joined(ctx)
        for _ in range(4):
            await host.tell(ctx, query(100), query(3), query(255))
            await host.next(ctx, SECOND + 300)
            await ctx.tick().repeat(50)

    host.run(process)
    assert len(host.sent) == 7


@pytest.mark.parametrize("stalls", STALLS)
def test_malformed_messages_are_dropped_and_counted_and_others_reports_are_not(stalls: int) -> None:
    good = query(10)
    wrong = [bytes([*good[:n], good[n] ^ 1, *good[n + 1 :]]) for n in range(8)]
    wrong += [good[:size] for size in range(8)]
    wrong += [query(0, DISCOVERY, kind) for kind in (0x00, 0x10, 0x13, 0x18, 0xFF)]
    wrong += [good + b"\x01", query(10, more=bytes(3))[:-1] + b"\x80"]
    others = [query(0, DISCOVERY, kind) for kind in (0x12, 0x16, 0x17, 0x22)]
    strangers = [query(10, OTHER), query(10, bytes([*DISCOVERY[:3], 2])), query(10, bytes([0, 0, 0, 1]))]
    bench = Bench(IgmpRx(1), stalls)
    configure(bench, groups=[{"valid": 1, "ip": number(DISCOVERY)}])
    messages = [
        *wrong,
        *others,
        *strangers,
        *map(Bad, [*wrong, good]),
        good,
        query(7, DISCOVERY),
        good + b"\0",
    ]
    bench.send("i", messages, [META] * len(messages))
    bench.count("query", "drop_igmp")
    bench.run()
    assert bench.counts == {"query": 3, "drop_igmp": len(wrong)}


def test_a_message_is_taken_an_octet_a_cycle() -> None:
    bench = Bench(Igmp(SECOND), stalls=0)
    configure(bench, enable=1)
    bench.send("i", [query(10)] * 20, [META] * 20)
    bench.run(cycles=20 * 9 + 5)


@pytest.mark.parametrize(
    ("clock", "count", "sentence"),
    [(159, 1, "a clock has at least 160 Hz here, not 159"), (160, 0, "at least one group, not 0")],
)
def test_impossible_parameters_are_refused(clock: int, count: int, sentence: str) -> None:
    with pytest.raises(ValueError, match=sentence):
        Igmp(clock, count)
