"""Queues of frames: in one clock domain, and between two whose clocks may tick in any order."""

from __future__ import annotations

from typing import Any

from amaranth.hdl import Array, Assert, Assume, C, Cat, Cover, Module, Mux, Signal, Value

from gateware.formal import Bug, Spec, assume_steady
from roslet.gateware import fifo

PACK = "Cat(Mux(item.end, item.bad, item.data[0]), item.data[1:], item.end)"
TO = "o.payload.bad.eq(end & queue.r_data[0])"
GIVE = "m.d.comb += [o.valid.eq(queue.r_rdy), queue.r_en.eq(o.ready)]"
HOLD = "with m.If(~o.valid | o.ready):"


class FifoSpec(Spec):
    """What is the nth to go in is the nth to come out, for any n; and nothing comes out that did not go in."""

    module = fifo
    quick, deep = 12, 24
    clocks = ("sync", "sync")
    says_why = C(1)  # whether the data of an end are kept, but for the lowest bit
    bugs: tuple[Bug, ...] = (
        Bug("o.steady", HOLD, "with m.If(1):"),
        Bug("o.bad_only_at_end", TO, TO.replace("end & ", "")),
        Bug("order", PACK, PACK.replace("item.data[0]", "0")),
        Bug("nothing_else", "o.valid.eq(queue.r_rdy)", "o.valid.eq(1)"),
    )

    def block(self) -> Any:
        return self.gates.FrameFifo(3)

    def entering(self, m: Module) -> Value:
        """High in the cycle in which an item goes in."""
        i = self.dut.i.stream
        entering: Value = i.valid & i.ready
        return entering

    def properties(self, m: Module) -> None:
        i_domain, o_domain = self.clocks
        self.assume(m, "i", i_domain)
        self.check(m, "o", o_domain)
        i, o = self.dut.i.stream, self.dut.o.stream
        # What is the same always is so in every domain.
        n, item = self.free(3, "n"), Signal.like(i.payload)
        assume_steady(m, n, i_domain)
        sent, got, inside = Signal(4), Signal(4), Signal()
        with m.If(self.entering(m) & ~sent[3]):
            m.d[i_domain] += sent.eq(sent + 1)
            with m.If(sent == n):
                m.d[i_domain] += [item.eq(i.payload), inside.eq(1)]
        with m.If(o.valid & o.ready & ~got[3]):
            m.d[o_domain] += got.eq(got + 1)
        with m.If(o.valid & (got == n)):
            seen = o.payload
            same = (seen.end == item.end) & (seen.bad == item.bad)
            same &= (seen.data[1:] == item.data[1:]) | (seen.end & ~self.says_why)
            if "padding" in seen.shape().members:
                same &= seen.padding == item.padding
            m.d.comb += [
                Assert(inside, "nothing_else"),
                Assert(~inside | (same & (seen.end | (seen.data[0] == item.data[0]))), "order"),
            ]
        m.d.comb += Cover(got == 4, "several")


REGISTER = "o.payload.eq(Mux(spared, spare, i.payload)),"
GONE = "gone.eq(o.valid & o.ready & o.payload.end)"


class RegisterSpec(FifoSpec):
    """The same of a register with meta; and every frame has its own beside it.

    An end goes in while it waits: it is taken when it has come out. Its data may change meanwhile, as they mean nothing.
    """

    says_why = C(0)
    bugs = (
        Bug("o.steady", HOLD, "with m.If(1):"),
        Bug("o.bad_only_at_end", REGISTER, REGISTER + " o.payload.bad.eq(i.payload.data[0]),"),
        Bug("order", REGISTER, "o.payload.eq(i.payload),"),
        Bug("nothing_else", "o.valid.eq(spared | comes)", "o.valid.eq(1)"),
        Bug("o.meta_steady", GONE, "gone.eq(comes & i.payload.end)"),
        Bug("meta", GONE, "gone.eq(comes & i.payload.end)"),
    )

    def block(self) -> Any:
        return self.gates.FrameRegister(2)

    def entering(self, m: Module) -> Value:
        i, entered = self.dut.i.stream, Signal()
        m.d.sync += entered.eq(i.valid & i.payload.end & ~i.ready)
        entering: Value = i.valid & Mux(i.payload.end, ~entered, i.ready)
        return entering

    def properties(self, m: Module) -> None:
        super().properties(m)
        i, o = self.dut.i, self.dut.o
        begun, gone = Signal(2), Signal(2)  # frames that have ended at either side
        m.d.sync += [
            begun.eq(begun + (i.stream.valid & i.stream.ready & i.stream.payload.end)),
            gone.eq(gone + (o.stream.valid & o.stream.ready & o.stream.payload.end)),
        ]
        m.d.comb += [Assume(i.meta == begun, "numbered"), Assert(~o.stream.valid | (o.meta == gone), "meta")]


FREE = "free = ~o.valid | o.ready"
STAGED = "o.valid.eq(i.valid & ~copied)"
WAITS = "i.ready.eq(free & (copied | ~i.payload.end))"


class StageSpec(RegisterSpec):
    """The same of a register with one place."""

    bugs = (
        Bug("o.steady", FREE, "free = C(1)"),
        Bug("o.bad_only_at_end", STAGED, STAGED + ", o.payload.bad.eq(i.payload.data[0])"),
        Bug("order", FREE, FREE + " | i.valid"),
        Bug("nothing_else", STAGED, "o.valid.eq(1)"),
        Bug("o.meta_steady", WAITS, "i.ready.eq(free)"),
        Bug("meta", WAITS, "i.ready.eq(free)"),
    )

    def block(self) -> Any:
        return self.gates.FrameStage(2)


class LateStageSpec(StageSpec):
    """The same where what is known passes through a register, too."""

    def block(self) -> Any:
        return self.gates.FrameStage(2, late=True)


TAKEN = "m.d.sync += o.valid.eq(~o.ready)"
COMES = "o.valid.eq(i.valid & ~gone)"
PLACED = f"m.d.sync += [o.payload.eq(i.payload), {COMES}]"


class MessageRegisterSpec(RegisterSpec):
    """The same of a register of messages with one place."""

    bugs = (
        Bug("o.steady", TAKEN, "m.d.sync += o.valid.eq(0)"),
        Bug("o.bad_only_at_end", PLACED, PLACED + "; m.d.sync += o.payload.bad.eq(i.payload.data[0])"),
        Bug("order", TAKEN, TAKEN + "; m.d.sync += o.payload.eq(i.payload)"),
        Bug("nothing_else", COMES, "o.valid.eq(1)"),
        Bug("o.meta_steady", "gone | (~o.valid & ~i.payload.end)", "~o.valid"),
        Bug("meta", "gone | (~o.valid & ~i.payload.end)", "~o.valid"),
    )

    def block(self) -> Any:
        return self.gates.MessageRegister(2)


class AsyncFifoSpec(FifoSpec):
    """The same between two clocks: a cycle of the proof is one in which either, both or none may tick."""

    quick, deep = 20, 32
    clocks = ("phy_rx", "sync")
    domains = clocks
    bugs = (Bug("o.steady", GIVE, GIVE.replace("(o.ready)", "(1)")), *FifoSpec.bugs[1:])

    def block(self) -> Any:
        return self.gates.AsyncFrameFifo(4, *self.clocks)

    def properties(self, m: Module) -> None:
        super().properties(m)


LOST = "with m.If(begun):\n                        m.d[i_domain] += owed.eq(1)"
WHOLE = "begun.eq(~i.payload.end)"


class LossyFifoSpec(Spec):
    """What comes out well is a whole frame that went in well, and frames keep their order; whatever of them is lost.

    The frames that go in say themselves what they are: an octet is its place in its frame, and the frame's number, modulo 4.
    How long the frames of a number are, up to 3 octets, and whether they are bad, is free, but always the same.
    """

    module = fifo
    quick, deep = 14, 24
    bugs = (
        Bug("o.steady", GIVE, GIVE.replace("(o.ready)", "(1)")),
        Bug("o.bad_only_at_end", TO, TO.replace("end & ", "")),
        Bug("whole", "queue.w_data.eq(0b1_0000_0001)", "queue.w_data.eq(0b1_0000_0000)"),
        Bug("bad", PACK, PACK.replace("item.bad", "0")),
        Bug("place", LOST, LOST.replace("(begun)", "(0)")),
        Bug("frame", WHOLE, WHOLE.replace("~i.payload.end", "0")),
        Bug("ready", "i.ready.eq(1), ", "i.ready.eq(queue.w_rdy), "),
        Bug(
            "one_drop",
            "with m.If(~i.payload.end):\n                        m.next",
            "with m.If(0):\n                        m.next",
        ),
    )

    def block(self) -> Any:
        return self.gates.LossyFrameFifo(4, "sync", "sync")

    def properties(self, m: Module) -> None:
        self.assume(m, "i")
        self.check(m, "o")
        i, o = self.dut.i.stream, self.dut.o.stream
        sizes = Array(self.steady(m, 2, f"size{n}") for n in range(4))
        bads = Array(self.steady(m, 1, f"bad{n}") for n in range(4))
        for size in sizes:
            m.d.comb += Assume(size > 0, "no_empty")

        number, place = Signal(2), Signal(2)
        with m.If(i.valid):
            m.d.comb += [
                Assume(i.payload.end == (place == sizes[number]), "length"),
                Assume(i.payload.data == Cat(place, number), "contents"),
                Assume(i.payload.bad == (i.payload.end & bads[number]), "end"),
                Assert(i.ready, "ready"),
            ]
            m.d.sync += place.eq(place + 1)
            with m.If(i.payload.end):
                m.d.sync += [place.eq(0), number.eq(number + 1)]

        at, of = Signal(2), Signal(2)
        with m.If(o.valid):
            first = at == 0
            with m.If(o.payload.end):
                m.d.comb += [
                    Assert(o.payload.bad | (at == sizes[of]), "whole"),
                    Assert(o.payload.bad | ~bads[of], "bad"),
                ]
            with m.Else():
                m.d.comb += [
                    Assert(o.payload.data[:2] == at, "place"),
                    Assert(first | (o.payload.data[2:4] == of), "frame"),
                ]
            with m.If(o.ready):
                m.d.sync += at.eq(at + 1)
                with m.If(first):
                    m.d.sync += of.eq(o.payload.data[2:4])
                with m.If(o.payload.end):
                    m.d.sync += at.eq(0)

        frames, drops, goods = Signal(4), Signal(4), Signal(4)
        m.d.sync += [
            frames.eq(frames + (i.valid & i.payload.end)),
            drops.eq(drops + self.dut.drop_overflow),
            goods.eq(goods + (o.valid & o.ready & o.payload.end & ~o.payload.bad)),
        ]
        # A drop is told of at most once for each frame that has ended or is passing.
        m.d.comb += [
            Assert(drops + goods <= frames + (place != 0), "one_drop"),
            Cover(drops == 2, "drops"),
            Cover((drops == 1) & (goods == 2), "drop_between"),
        ]


SPECS: tuple[type[Spec], ...] = (
    FifoSpec,
    RegisterSpec,
    StageSpec,
    LateStageSpec,
    MessageRegisterSpec,
    AsyncFifoSpec,
    LossyFifoSpec,
)
