"""UDP over a serial line: scapy's packets go in, and scapy reads what comes out."""

from __future__ import annotations

import random
from typing import Any

import pytest
import sliplib
from scapy.layers.inet import ICMP, IP, UDP, fragment
from scapy.packet import Raw

from gateware.frames import STALLS, Bad, Bench
from gateware.internet import fields, octets
from gateware.network import configure
from roslet.gateware.slip import SlipLink
from roslet.gateware.slip_stack import GroupFilter, SlipStack

HERE, THERE, ELSEWHERE = "192.168.1.100", "192.168.1.10", "10.9.8.7"
GROUP, OTHER_GROUP = "239.255.0.1", "239.255.0.2"
DIVISOR = 8


class Stack:
    """A stack, and what it gave."""

    def __init__(self, stalls: int = 30, groups: tuple[str, ...] = (), **fields: Any) -> None:
        self.bench = Bench(SlipStack(len(groups), **fields), stalls)
        dut = self.bench.dut
        inputs: dict[str, Any] = {"expiration": 1_000_000} if hasattr(dut, "expiration") else {}
        configure(self.bench, **inputs)

        async def join(ctx: Any) -> None:
            for n, group in enumerate(groups):
                ctx.set(dut.groups[n], {"valid": 1, "ip": octets(group)})

        async def memory(ctx: Any) -> None:
            if "ip_payloadsmem" not in dut.signature.members:
                return
            port, held = dut.ip_payloadsmem, {}
            while True:
                _, _, ce, we, addr, wdata = await ctx.tick().sample(port.ce, port.we, port.addr, port.wdata)
                if ce and we:
                    held[addr] = wdata
                if ce:
                    ctx.set(port.rdata, held.get(addr, 0))

        self.bench.drive(join)
        self.bench.watch(memory)
        self.bench.count(*[name for name in dut.signature.members if name.startswith("drop_")])
        self.received = self.bench.receive("udp_rx")
        self.sent = self.bench.receive("tx")

    @property
    def dropped(self) -> dict[str, int]:
        return {name.removeprefix("drop_"): count for name, count in self.bench.counts.items() if count}

    def good(self) -> list[bytes]:
        return [frame for frame, _ in self.received if not isinstance(frame, Bad)]


def udp(text: bytes, **fields: Any) -> bytes:
    return bytes(IP(**{"src": THERE, "dst": HERE, **fields}) / UDP(sport=5, dport=1234) / Raw(text))


@pytest.mark.parametrize("registers", [True, False])
@pytest.mark.parametrize("stalls", [0, 60])
def test_datagrams_are_received_and_pings_answered(stalls: int, registers: bool) -> None:
    stack = Stack(stalls, registers=registers)
    ping = bytes(IP(src=ELSEWHERE, dst=HERE) / ICMP(id=3, seq=7) / Raw(b"data"))
    stack.bench.send(
        "rx", [udp(b"one"), ping, udp(b"two", src=ELSEWHERE), udp(b"all", dst="255.255.255.255")]
    )
    stack.bench.run(lambda: len(stack.received) == 3 and len(stack.sent) == 1)
    assert stack.good() == [b"one", b"two", b"all"] and stack.dropped == {}
    meta = fields(stack.received[1][1])
    assert meta == {
        "mac": 0,
        "source": octets(ELSEWHERE),
        "destination": octets(HERE),
        "source_port": 5,
        "destination_port": 1234,
        "length": 3,
        "group": 0,
    }
    reply = IP(stack.sent[0][0])
    assert (reply.src, reply.dst, reply[ICMP].type, reply[ICMP].seq) == (HERE, ELSEWHERE, 0, 7)
    assert bytes(reply[Raw]) == b"data"


@pytest.mark.parametrize("registers", [True, False])
@pytest.mark.parametrize("stalls", [0, 60])
def test_only_own_addresses_and_joined_groups_are_taken(stalls: int, registers: bool) -> None:
    stack = Stack(stalls, groups=(GROUP,), registers=registers)
    stack.bench.send(
        "rx",
        [
            udp(b"other group", dst=OTHER_GROUP),
            udp(b"group", dst=GROUP),
            udp(b"other host", dst="192.168.1.101"),
            udp(b"from us", src=HERE),
            udp(b"all hosts", dst="224.0.0.1"),
            Bad(udp(b"other group", dst=OTHER_GROUP)),
            b"\x45",
            udp(b"own"),
        ],
    )
    stack.bench.run(lambda: b"own" in stack.good())
    assert stack.good() == [b"group", b"all hosts", b"own"]
    assert stack.dropped == {"groups_group": 1, "ipv4_address": 2, "ipv4_length": 1}


def test_without_groups_no_group_is_taken() -> None:
    stack = Stack()
    stack.bench.send("rx", [udp(b"group", dst=GROUP), udp(b"own")])
    stack.bench.run(lambda: b"own" in stack.good())
    assert stack.good() == [b"own"] and stack.dropped == {"groups_group": 1}


@pytest.mark.parametrize("registers", [True, False])
def test_fragments_are_put_together_and_long_datagrams_are_cut(registers: bool) -> None:
    stack = Stack(0, mtu=296, echo_data=56, registers=registers)
    text = random.Random(1).randbytes(900)
    whole = IP(src=THERE, dst=HERE, id=9) / UDP(sport=5, dport=1234) / Raw(text)
    parts = fragment(whole, fragsize=640)  # type: ignore[no-untyped-call]
    stack.bench.send("rx", [bytes(part) for part in parts])
    meta = {
        "mac": 0,
        "destination": octets(ELSEWHERE),
        "source_port": 7,
        "destination_port": 8,
        "length": 400,
        "sum": sum(int.from_bytes(text[n : n + 2], "big") for n in range(0, 400, 2)) % 0xFFFF,
    }
    stack.bench.send("udp_tx", [text[:400]], [meta])
    stack.bench.run(lambda: len(stack.received) == 1 and len(stack.sent) == 2)
    assert stack.good() == [text] and stack.dropped == {}
    assert all(len(frame) <= 296 for frame, _ in stack.sent)
    first, second = (IP(frame) for frame, _ in stack.sent)
    assert (first.dst, first.flags.MF, second.frag * 8) == (ELSEWHERE, True, 272)
    cut = UDP(bytes(first.payload) + bytes(second.payload))
    assert (cut.sport, cut.dport, bytes(cut.payload)) == (7, 8, text[:400])


@pytest.mark.parametrize("registers", [True, False])
def test_without_reassembly_fragments_are_dropped_and_without_echo_pings(registers: bool) -> None:
    stack = Stack(30, fragments=1, echo_data=None, longest=400, registers=registers)
    whole = IP(src=THERE, dst=HERE, id=9) / UDP(sport=5, dport=1234) / Raw(bytes(900))
    parts = fragment(whole, fragsize=640)  # type: ignore[no-untyped-call]
    ping = bytes(IP(src=THERE, dst=HERE) / ICMP() / Raw(b"data"))
    stack.bench.send("rx", [bytes(parts[0]), ping, bytes(parts[1]), udp(b"whole")])
    text = random.Random(1).randbytes(400)
    meta = {
        "mac": 0,
        "destination": octets(ELSEWHERE),
        "source_port": 7,
        "destination_port": 8,
        "length": 400,
        "sum": sum(int.from_bytes(text[n : n + 2], "big") for n in range(0, 400, 2)) % 0xFFFF,
    }
    stack.bench.send("udp_tx", [text] * 2, [meta] * 2)
    stack.bench.run(lambda: len(stack.received) == 1 and len(stack.sent) == 2)
    assert stack.good() == [b"whole"]
    assert stack.dropped == {"reassembly_none": 2, "protocol_protocol": 1}
    assert [bytes(IP(frame)[UDP].payload) for frame, _ in stack.sent] == [text] * 2
    assert "ip_payloadsmem" not in stack.bench.dut.signature.members


def test_lookups_find_everybody_at_once() -> None:
    stack = Stack(askers=2)
    answers: list[tuple[int, int, int, int]] = []

    async def ask(ctx: Any) -> None:
        lookup = stack.bench.dut.lookup1
        ctx.set(lookup.ip, octets(ELSEWHERE))
        ctx.set(lookup.valid, 1)
        for _ in range(4):
            _, _, *answer = await ctx.tick().sample(lookup.done, lookup.found, lookup.failed, lookup.mac)
            answers.append(tuple(answer))
        ctx.set(lookup.valid, 0)

    stack.bench.drive(ask)
    stack.bench.run()
    assert answers == [(0, 0, 0, 0), (1, 1, 0, 0)] * 2


def test_a_peer_on_the_wires_pings_and_sends_through_noise() -> None:
    """The whole, from the pins on; the peer's clock is 2 % off."""
    from amaranth.hdl import Module
    from amaranth.lib import wiring
    from amaranth.lib.wiring import In, Out, connect

    from roslet.gateware.meta import ADDRESSES

    class Node(wiring.Component):
        def __init__(self) -> None:
            self.link, self.stack = SlipLink(DIVISOR, max_size=96, tx_depth=128), SlipStack(fragment_size=16)
            members = self.link.signature.members
            self.drops = [name for name in members if name.startswith("drop_")]
            super().__init__(
                {
                    "uart_rx": members["uart_rx"],
                    "uart_tx": members["uart_tx"],
                    "addresses": In(ADDRESSES),
                    "udp_rx": Out(self.stack.udp_rx.signature),
                    **{name: members[name] for name in self.drops},
                }
            )

        def elaborate(self, platform: object) -> Module:
            m = Module()
            m.submodules.link, m.submodules.stack = link, stack = self.link, self.stack
            connect(m, link.rx, stack.rx)
            connect(m, stack.tx, link.tx)
            connect(m, stack.udp_rx, wiring.flipped(self.udp_rx))
            m.d.comb += [link.uart_rx.eq(self.uart_rx), self.uart_tx.eq(link.uart_tx)]
            m.d.comb += [stack.addresses.eq(self.addresses)]
            m.d.comb += [getattr(self, name).eq(getattr(link, name)) for name in self.drops]
            return m

    bench = Bench(Node(), stalls=0)
    configure(bench)
    ping = bytes(IP(src=THERE, dst=HERE) / ICMP(seq=7) / Raw(b"\xc0\xdb"))
    noise = random.Random(2).randbytes(60)
    stream = b"".join(
        b"\xc0" + part + b"\xc0"
        for part in (
            sliplib.encode(ping),
            noise,
            b"\x45\x00\xdb\xdb",
            bytes(100),
            sliplib.encode(udp(b"hello")),
        )
    )

    async def peer(ctx: Any) -> None:
        ctx.set(bench.dut.uart_rx, 1)
        await ctx.tick().repeat(100)
        at, cycle = 0.0, 0
        for octet in stream:
            for level in (0, *(octet >> n & 1 for n in range(8)), 1):
                ctx.set(bench.dut.uart_rx, level)
                at += DIVISOR * 1.02
                await ctx.tick().repeat(round(at) - cycle)
                cycle = round(at)

    heard = bytearray()

    async def listen(ctx: Any) -> None:
        while True:
            _, _, level = await ctx.tick().sample(bench.dut.uart_tx)
            if level:
                continue
            await ctx.tick().repeat(DIVISOR // 2)
            octet = 0
            for n in range(8):
                octet |= await sampled(ctx) << n
            await sampled(ctx)
            heard.append(octet)

    async def sampled(ctx: Any) -> int:
        await ctx.tick().repeat(DIVISOR)
        return int(ctx.get(bench.dut.uart_tx))

    bench.drive(peer)
    bench.watch(listen)
    received = bench.receive("udp_rx")
    bench.count(*bench.dut.drops)
    bench.run(lambda: len(received) == 1 and heard.count(b"\xc0") >= 2, cycles=200_000)
    assert received[0][0] == b"hello"
    driver = sliplib.Driver()
    driver.receive(bytes(heard))
    reply = IP(driver.get(block=False))
    assert (reply.dst, reply[ICMP].type, reply[ICMP].seq, bytes(reply[Raw])) == (THERE, 0, 7, b"\xc0\xdb")
    assert bench.counts["drop_rx_escape"] >= 1 and bench.counts["drop_rx_too_long"] >= 1
    assert bench.counts["drop_uart_framing"] == bench.counts["drop_uart_overrun"] == 0


def test_bounds_are_checked() -> None:
    with pytest.raises(ValueError, match="1500 octets at most, not 1501"):
        SlipStack(mtu=1501)
    with pytest.raises(ValueError, match="a power of two of items"):
        SlipLink(8, tx_depth=1500)


@pytest.mark.parametrize("stalls", STALLS)
def test_an_empty_packet_is_not_taken_for_one_of_the_group_before_it(stalls: int) -> None:
    bench = Bench(GroupFilter(1), stalls)
    received = bench.receive("o")
    bench.count("drop_group")
    bench.send("i", [udp(b"not for us", dst=OTHER_GROUP), b"", udp(b"for us")])
    bench.run()
    assert [(frame, type(frame)) for frame, _ in received[1:]] == [(b"", bytes), (udp(b"for us"), bytes)]
    assert bench.counts["drop_group"] == 1
