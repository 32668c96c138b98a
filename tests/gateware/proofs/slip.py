"""SLIP: what a line makes of packets comes back as it was, and nothing else that comes on it is taken for a packet."""

from __future__ import annotations

from typing import Any

from amaranth.hdl import Assert, Cat, Const, Cover, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from gateware.formal import Bug, Spec, assume_steady
from gateware.proofs.rtps import waits
from roslet.gateware import slip, slip_stack
from roslet.gateware.stream import FrameSignature

END, ESC, ESC_END, ESC_ESC = 0xC0, 0xDB, 0xDC, 0xDD
"""RFC 1055."""
LONGEST = 2


class SlipReceiverSpec(Spec):
    """Octets of any kind, of which some are bad, and may take the place of others that were not taken. `packet`: at an END
    there is a good end if, and only if, since the last one there was nothing wrong, and as many octets as a packet may
    have. `octet`: the nth of them was the nth. `reason`: of anything wrong one is counted, once for a packet. `steady`, as
    long as what comes is so. `taken`: and it is, whenever `o` is ready."""

    module = slip
    quick, deep = 12, 20
    bugs = (
        Bug(
            "o.bad_only_at_end",
            "o.payload.data.eq(octet)",
            "o.payload.data.eq(octet), o.payload.bad.eq(count == 1)",
        ),
        Bug(
            "steady",
            "m.d.comb += [o.valid.eq(i.valid), i.ready.eq(o.ready)]",
            "m.d.comb += [o.valid.eq(i.valid & ~o.ready), i.ready.eq(o.ready)]",
        ),
        Bug("packet", "with m.If(moved & is_end):", "with m.If(moved & (octet[:7] == slip.END & 127)):"),
        Bug("octet", "Mux(octet[0], slip.ESC, slip.END)", "Mux(octet[1], slip.ESC, slip.END)"),
        Bug("reason", "m.d.comb += reason.eq(moved)", "m.d.comb += reason.eq(moved & begun)"),
        Bug(
            "taken",
            "with m.Elif(is_escape):\n                    m.d.comb += i.ready.eq(1)",
            "with m.Elif(is_escape):\n                    m.d.comb += i.ready.eq(begun)",
        ),
    )

    def block(self) -> Any:
        return self.gates.SlipRx(LONGEST)

    def properties(self, m: Module) -> None:
        dut = self.dut
        i, o = dut.i, dut.o.stream
        given = self.check(m, "o", waits=False)
        octet, moved = i.payload.data, i.valid & i.ready
        ends = moved & ~i.payload.bad & (octet == END)
        # What is on the line since the last END, by the specification
        wrong, escaped, count = Signal(), Signal(), Signal(4)
        n = self.steady(m, range(LONGEST), "n")
        kept = Signal(8)
        known = (octet == ESC_END) | (octet == ESC_ESC)
        meant = Mux(escaped, Mux(octet == ESC_END, Const(END, 8), Const(ESC, 8)), octet)
        is_data = ~i.payload.bad & Mux(escaped, known, (octet != ESC) & (octet != END))
        with m.If(moved):
            m.d.sync += escaped.eq(~escaped & (octet == ESC))
            with m.If(is_data):
                m.d.sync += count.eq(count + ~count.all())
                with m.If(count == n):
                    m.d.sync += kept.eq(meant)
            with m.Elif(i.payload.bad | escaped):
                m.d.sync += wrong.eq(1)
        with m.If(ends):
            m.d.sync += [wrong.eq(0), escaped.eq(0), count.eq(0)]
        whole = ~wrong & ~escaped & (count != 0) & (count <= LONGEST)
        good = given.ended & ~o.payload.bad
        drops = Cat(dut.drop_line, dut.drop_escape, dut.drop_too_long)
        told, telling = Signal(), Signal()
        m.d.comb += telling.eq(drops.any())
        m.d.sync += told.eq(~ends & (told | telling))
        faulty = wrong | escaped | (count > LONGEST)
        held, before, was = Signal(), Signal.like(i.payload.as_value()), Signal.like(o.payload.as_value())
        m.d.sync += [held.eq(o.valid & ~o.ready), before.eq(i.payload), was.eq(o.payload)]
        stays = held & i.valid & (i.payload.as_value() == before)
        data = given.transfer & ~o.payload.end
        m.d.comb += [
            Assert(good == (ends & whole), "packet"),
            Assert(~data | (given.taken != n) | (o.payload.data == Mux(count == n, meant, kept)), "octet"),
            Assert(~data | is_data, "octet"),
            Assert(~good | (given.taken == count), "packet"),
            Assert(~ends | ((told | telling) == faulty), "reason"),
            Assert(~(told & telling), "reason"),
            Assert(~stays | (o.valid & (o.payload.as_value() == was)), "steady"),
            Cover(good & (count == LONGEST) & (kept == ESC), "escaped"),
            Cover(ends & faulty, "faulty"),
        ]
        waits(m, i, 0, o.ready, "taken")


class _Line(wiring.Component):
    """A sender, and a receiver at the other end of the line, which takes its time."""

    def __init__(self, tx: Any, rx: Any) -> None:
        self.tx, self.rx = tx, rx
        super().__init__({"i": In(FrameSignature()), "o": Out(FrameSignature()), "open": In(1)})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.tx, m.submodules.rx = self.tx, self.rx
        connect(m, flipped(self.i), self.tx.i)
        connect(m, self.rx.o, flipped(self.o))
        m.d.comb += [
            self.rx.i.valid.eq(self.tx.o.valid & self.open),
            self.rx.i.payload.data.eq(self.tx.o.payload),
            self.tx.o.ready.eq(self.rx.i.ready & self.open),
        ]
        return m


class LineSpec(Spec):
    """`good`: nothing ends badly. `octet`: of the packets that ended well, the nth octet of the kth that comes out was the
    nth of the kth that went in, and `length`: they are as long. Nothing is `dropped` but what is too long for the sender.
    `on`: within some cycles in which the line and who takes packets are ready there is something at `o`, or nothing left."""

    module = slip
    quick, deep = 16, 21
    bugs = (
        Bug(
            "o.bad_only_at_end",
            "o.payload.data.eq(octet)",
            "o.payload.data.eq(octet), o.payload.bad.eq(count == 1)",
        ),
        Bug("good", "Mux(is_end, slip.ESC_END, slip.ESC_ESC)", "Mux(is_end, slip.ESC_END, slip.ESC)"),
        Bug("octet", "Mux(octet[0], slip.ESC, slip.END)", "Mux(octet[1], slip.ESC, slip.END)"),
        Bug("length", "is_end.eq(item.payload.data == slip.END)", "is_end.eq(0)"),
        Bug("dropped", "count == self._max_size", "count == self._max_size - 1"),
        Bug("on", "o.valid.eq(item.valid)", "o.valid.eq(item.valid & ~o.ready)"),
    )

    def block(self) -> Any:
        return _Line(self.gates.SlipTx(4), self.gates.SlipRx(LONGEST + 1))

    def properties(self, m: Module) -> None:
        dut = self.dut
        rules, given = self.assume(m, "i"), self.check(m, "o", waits=False)
        i, o = dut.i.stream, dut.o.stream
        which, n = self.steady(m, 1, "which"), self.steady(m, 2, "n")
        into, out = Signal(2), Signal(2)
        octet, length, there = Signal(8), Signal(4), Signal()
        good = rules.ended & ~i.payload.bad & (rules.taken != 0) & ~dut.tx.drop_too_long
        with m.If(rules.transfer & (into == which)):
            with m.If(~i.payload.end & (rules.taken == n)):
                m.d.sync += octet.eq(i.payload.data)
            with m.If(good):
                m.d.sync += [length.eq(rules.taken), there.eq(1)]
        with m.If(good):
            m.d.sync += into.eq(into + ~into.all())
        with m.If(given.ended):
            m.d.sync += out.eq(out + ~out.all())
        mine = o.valid & (out == which)
        drops = Cat(dut.rx.drop_line, dut.rx.drop_escape, dut.rx.drop_too_long)
        left, idle = into != out, Signal(4)
        free = dut.open & o.ready
        m.d.sync += idle.eq(Mux(o.valid | ~left, 0, idle + (free & ~idle.all())))
        m.d.comb += [
            Assert(~(o.valid & o.payload.end & o.payload.bad), "good"),
            Assert(~mine | there, "length"),
            Assert(~mine | ((given.taken < length) == ~o.payload.end), "length"),
            Assert(~mine | o.payload.end | (given.taken != n) | (o.payload.data == octet), "octet"),
            Assert(~drops.any(), "dropped"),
            Assert(idle <= 8, "on"),
            Cover(given.ended & (out == 1), "two"),
            Cover(mine & ~o.payload.end & (given.taken == n) & (octet == END), "escaped"),
        ]


class GroupFilterSpec(Spec):
    """With one group, which may be joined, and stays so. `passes`: octets do as they come, and `end`: so do ends, of packets
    with a whole header, unless the destination is a group that is neither joined nor 224.0.0.1; `told`: that is counted."""

    module = slip_stack
    quick, deep = 23, 46
    bugs = (
        Bug("o.steady", "o.valid.eq(i.valid),", "o.valid.eq(i.valid & ~o.ready),"),
        Bug("o.bad_only_at_end", "~joined.any() & i.payload.end", "~joined.any()"),
        Bug("passes", "i.ready.eq(o.ready),", "i.ready.eq(1),"),
        Bug("end", "((first & valid) | (~first & bit))", "((first & valid) | ~first)"),
        Bug("told", "unwanted & ~i.payload.bad", "unwanted"),
    )

    def block(self) -> Any:
        return self.gates.GroupFilter(1)

    def properties(self, m: Module) -> None:
        dut = self.dut
        rules, _ = self.assume(m, "i"), self.check(m, "o")
        i, o = dut.i.stream, dut.o.stream
        (group,) = dut.groups
        assume_steady(m, Value.cast(dut.groups))
        count, destination = Signal(range(64)), Signal(32)
        with m.If(rules.ended):
            m.d.sync += count.eq(0)
        with m.Elif(rules.transfer):
            m.d.sync += count.eq(count + ~count.all())
            with m.If((count >= 16) & (count < 20)):  # RFC 791, 3.1
                m.d.sync += destination.eq(Cat(destination[8:], i.payload.data))
        is_group = destination[4:8] == 0xE
        wanted = (
            ~is_group | (destination == 0x010000E0) | (group.valid & (destination == Value.cast(group.ip)))
        )
        same = (o.payload.data == i.payload.data) & (o.payload.end == i.payload.end)
        at_end = i.valid & i.payload.end
        counts = at_end & (count >= 20)
        m.d.comb += [
            Assert((o.valid == i.valid) & (o.ready == i.ready) & (~i.valid | same), "passes"),
            Assert(~counts | (o.payload.bad == (i.payload.bad | ~wanted)), "end"),
            Assert(dut.drop_group == (rules.ended & o.payload.bad & ~i.payload.bad), "told"),
            Cover(counts & is_group & ~o.payload.bad & (destination != 0x010000E0), "joined"),
            Cover(dut.drop_group & counts, "not joined"),
        ]


SPECS: tuple[type[Spec], ...] = (SlipReceiverSpec, LineSpec, GroupFilterSpec)
