"""Several that share one: senders of frames, and askers for hardware addresses. Each in turn."""

from __future__ import annotations

from typing import Any

from amaranth.hdl import Array, Cat, Module, ShapeLike, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.meta import LookupSignature
from roslet.gateware.stream import FrameSignature


def _check(count: int, what: str) -> None:
    if count < 1:
        raise ValueError(f"an arbiter serves at least one {what}, not {count}")


class _Turn:
    """Whose turn it is: `owner`, while `busy`. When it ends, the next that wants it after `owner` has it a cycle later."""

    def __init__(self, m: Module, wants: Value) -> None:
        count = len(wants)
        self.owner = owner = Signal(range(count))
        self.busy = Signal()
        self.end = Signal()
        with m.If(self.busy):
            m.d.sync += self.busy.eq(~self.end)
        with m.Elif(wants.any()):
            m.d.sync += self.busy.eq(1)
            with m.Switch(owner):
                for now in range(count):
                    with m.Case(now):
                        # The last assignment wins: the nearest after the owner, the owner itself at last.
                        for n in reversed([(now + 1 + step) % count for step in range(count)]):
                            with m.If(wants[n]):
                                m.d.sync += owner.eq(n)


class FrameArbiter(wiring.Component):
    """Lets frames of several senders pass one after another, round robin.

    Ports: `i0`, `i1` .. one for each of `count`, and `o`, all with the same `meta`. A frame has `o` until its end is taken,
    good or bad, however long it pauses; then one cycle passes, in which the next sender that has something valid is chosen.
    So with all of them busy each sends every `count`-th frame. Throughput within a frame one octet a cycle; a frame's first
    item waits for one cycle at least. Holds nothing, drops nothing.
    """

    def __init__(self, count: int, meta: ShapeLike | None = None) -> None:
        _check(count, "sender")
        self._count = count
        members: dict[str, Any] = {f"i{n}": In(FrameSignature(meta)) for n in range(count)}
        super().__init__({**members, "o": Out(FrameSignature(meta))})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        inputs = [getattr(self, f"i{n}") for n in range(self._count)]
        o = self.o.stream
        turn = _Turn(m, Cat(i.stream.valid for i in inputs))
        m.d.comb += [
            o.payload.eq(Array(Value.cast(i.stream.payload) for i in inputs)[turn.owner]),
            o.valid.eq(turn.busy & Array(i.stream.valid for i in inputs)[turn.owner]),
            turn.end.eq(o.valid & o.ready & o.payload.end),
        ]
        if self.o.signature.layout is not None:
            m.d.comb += self.o.meta.eq(Array(Value.cast(i.meta) for i in inputs)[turn.owner])
        for n, i in enumerate(inputs):
            m.d.comb += i.stream.ready.eq(turn.busy & (turn.owner == n) & o.ready)
        return m


class LookupArbiter(wiring.Component):
    """Puts the questions of several askers to one resolver, round robin.

    Ports: `asker0`, `asker1` .. one for each of `count`, and `resolver`, whose answer, which is whole at once, goes to
    whoever asked. A question reaches the resolver one cycle after it is put or after the answer before it; with all askers
    busy each has every `count`-th answer. Holds nothing.
    """

    def __init__(self, count: int) -> None:
        _check(count, "asker")
        self._count = count
        members: dict[str, Any] = {f"asker{n}": In(LookupSignature()) for n in range(count)}
        super().__init__({**members, "resolver": Out(LookupSignature())})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        askers = [getattr(self, f"asker{n}") for n in range(self._count)]
        resolver = self.resolver
        turn = _Turn(m, Cat(asker.valid for asker in askers))
        m.d.comb += [
            resolver.valid.eq(turn.busy),
            resolver.ip.eq(Array(asker.ip for asker in askers)[turn.owner]),
            turn.end.eq(resolver.done),
        ]
        for n, asker in enumerate(askers):
            m.d.comb += [
                asker.done.eq(resolver.done & turn.busy & (turn.owner == n)),
                asker.found.eq(resolver.found),
                asker.failed.eq(resolver.failed),
                asker.mac.eq(resolver.mac),
            ]
        return m
