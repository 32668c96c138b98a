"""Looking for an endpoint among those that match."""

from __future__ import annotations

import random
from typing import Any

import pytest
from amaranth.hdl import Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out
from amaranth.sim import Simulator

from gateware.words import Tables, WordBench
from roslet.gateware.rtps.ports import ReadSignature
from roslet.gateware.rtps.scan import find_endpoint, lowest
from roslet.gateware.rtps.tables import OwnMap, PeerMap

Endpoint = tuple[int, int, int, int]
"""Key, slot, whether it is a writer, our endpoint's number."""


class Finder(wiring.Component):
    """The two states, and those before and behind them."""

    def __init__(self, peers: PeerMap) -> None:
        self._peers = peers
        super().__init__(
            {
                "peers": Out(ReadSignature(peers.address_bits)),
                "matched": In(peers.endpoints),
                "key": In(32),
                "slot": In(8),
                "writer": In(1),
                "start": In(1),
                "over": Out(1),
                "found": Out(1),
                "endpoint": Out(range(peers.endpoints)),
                "info": Out(32),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        found = Signal()
        m.d.comb += self.found.eq(found)
        with m.FSM():
            with m.State("IDLE"):
                m.d.sync += [found.eq(0), self.endpoint.eq(0)]
                with m.If(self.start):
                    m.next = "SCAN"
            port = self.peers
            find_endpoint(m, self._peers, port.addr, port.data, self.matched, self.key, self.slot, self.writer,
                          self.endpoint, self.info, found, "OVER")  # fmt: skip
            with m.State("OVER"):
                m.d.comb += self.over.eq(1)
                m.next = "IDLE"
        return m


@pytest.mark.parametrize("many", [1, 2, 5])
def test_the_one_with_this_key_of_this_participant_and_of_this_kind_is_found_if_it_matches(many: int) -> None:
    random_ = random.Random(many)
    peers, own = PeerMap(2, many), OwnMap([], [])
    table: list[Endpoint] = []
    while len(table) < many:
        one = (random_.randrange(1, 3), random_.randrange(2), random_.randrange(2), random_.randrange(256))
        if one[:3] not in [other[:3] for other in table]:
            table.append(one)
    theirs = [0] * peers.depth
    for n, (key, slot, writer, local) in enumerate(table):
        theirs[peers._endpoints + 8 * n] = key
        theirs[peers._endpoints + 8 * n + 1] = slot | local << 8 | writer << 16
    bench = WordBench(
        Tables(peers, own, own.init(bytes(12), bytes(4), 0, 0), theirs=theirs, finder=Finder(peers))
    )
    dut = bench.dut.finder

    async def ask(ctx: Any) -> None:
        for _ in range(60):
            key, slot, writer = random_.randrange(1, 4), random_.randrange(2), random_.randrange(2)
            matched = random_.getrandbits(many)
            for port, value in (
                (dut.key, key),
                (dut.slot, slot),
                (dut.writer, writer),
                (dut.matched, matched),
            ):
                ctx.set(port, value)
            ctx.set(dut.start, 1)
            await ctx.tick()
            ctx.set(dut.start, 0)
            cycles = 0
            while not ctx.get(dut.over):
                await ctx.tick()
                cycles += 1
            right = [n for n, one in enumerate(table) if one[:3] == (key, slot, writer) and matched >> n & 1]
            last = right[0] if right else many - 1
            assert ctx.get(dut.found) == bool(right)
            if right:
                assert ctx.get(dut.endpoint) == right[0]
                assert ctx.get(dut.info) == theirs[peers._endpoints + 8 * right[0] + 1]
            assert cycles == last + 1 + 3 * (matched & (2 << last) - 1).bit_count()
            await ctx.tick()

    bench.drive(ask)
    bench.run()


@pytest.mark.parametrize("width", [1, 2, 3, 5, 8, 11])
def test_the_lowest_bit_that_is_high_is_found(width: int) -> None:
    m, bits, found = Module(), Signal(width), Signal(range(max(2, width)))
    m.d.comb += found.eq(lowest(bits))

    async def process(ctx: Any) -> None:
        for value in range(1 << width):
            ctx.set(bits, value)
            assert ctx.get(found) == max((value & -value).bit_length() - 1, 0)

    simulator = Simulator(m)
    simulator.add_testbench(process)
    simulator.run()
