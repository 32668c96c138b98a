"""The handshakes of the user's messages: none has parts of two, on either side, and nobody waits for ever."""

from __future__ import annotations

from typing import Any

from amaranth.hdl import Array, Assert, Assume, C, Cat, Cover, Module, Mux, Signal, Value

from gateware.formal import Bug, Spec
from roslet.gateware.tops import app_data

SIZE = 5
"""Octets of a message, at most: two words, of which the second has one."""
WORDS = 2
SENT, GRANTED = 12, 8
"""Cycles until what is due goes, and the right is given, at most: of the publishing side."""
TAKEN, MOVED = SIZE + 4, SIZE + 4
"""And of the subscribing side: until a word is taken, and the right is given."""


class _Right(Spec):
    """`kept`: who has the right has it until it is given back."""

    module = app_data

    def right(self, m: Module) -> Signal:
        """High from the second cycle on."""
        later, before = Signal(), Signal()
        grant = self.dut.grant
        m.d.sync += [later.eq(1), before.eq(grant & ~self.dut.rel)]
        m.d.comb += [
            Assert(~before | grant, "kept"),
            Cover(later & ~grant & self.dut.req, "waits"),
        ]
        return later

    def within(self, m: Module, bound: int, wanted: Value, free: Value, name: str) -> None:
        """What is `wanted` comes within `bound` cycles in which `free` is high."""
        count = Signal(range(bound + 2))
        with m.If(~wanted):
            m.d.sync += count.eq(0)
        with m.Elif(free):
            m.d.sync += count.eq(count + 1)
        m.d.comb += Assert(count <= bound, name)


class PublishSpec(_Right):
    """The data change where the user has the right to change them, and there only, in any cycle. `whole`: a message has the
    data, and their length, of one moment. `mine`: the user does not have the right meanwhile. `due`: it goes for a reason,
    and each reason once. `long`: one that is too long never goes. `granted`: who asks gets the right, and `sent`: what is
    due goes, within some cycles in which the stream, or the user, is ready."""

    quick, deep = 24, 36
    bugs = (
        Bug("kept", "m.d.sync += grant.eq(~rel)", "m.d.sync += grant.eq(~rel & ~wanted)"),
        Bug("mine", "with m.Elif(req & ~moving & ~begins):", "with m.Elif(req & ~begins):"),
        Bug("whole", "left.eq((self.length + 3)[2:])", "left.eq((self.length + 2)[2:])"),
        Bug(
            "due",
            "with m.If(begins):\n            m.d.sync += due.eq(0)",
            "with m.If(begins & o.ready):\n            m.d.sync += due.eq(0)",
        ),
        Bug("long", "self.length > self._size", "self.length > self._size + 1"),
        Bug("granted", " & ~(before & req)", ""),
        Bug("sent", "~(before & req)", "~req"),
        Bug(
            "o.steady",
            "with m.If(o.ready):\n                    m.d.sync += [self.index",
            "with m.If(1):\n                    m.d.sync += [self.index",
        ),
        Bug(
            "o.bad_only_at_end",
            "o.payload.end.eq(left == 0)]",
            "o.payload.end.eq(left == 0), o.payload.bad.eq(left == 1)]",
        ),
    )

    def block(self) -> Any:
        return self.gates.AppDataTx(SIZE)

    def properties(self, m: Module) -> None:
        dut = self.dut
        given = self.check(m, "o")
        later = self.right(m)
        o = dut.o.stream
        # The user's data; `word` is from the cycle before, as in `Ros2Ether`.
        words = [self.free(32, f"word{n}") for n in range(WORDS)]
        was = [Signal(32, name=f"was{n}") for n in range(WORDS)]
        granted, length, index = Signal(), Signal(8), Signal.like(dut.index)
        m.d.sync += [granted.eq(dut.grant), length.eq(dut.length), index.eq(dut.index)]
        m.d.sync += [old.eq(new) for old, new in zip(was, words, strict=True)]
        m.d.comb += Assume(dut.word == Array(was)[index], "memory")
        with m.If(later & ~granted):
            m.d.comb += Assume(dut.length == length, "the length stays")
            for old, new in zip(was, words, strict=True):
                m.d.comb += Assume(old == new, "the data stay")

        # Those of the moment in which the message began
        begins = o.valid & ~given.within
        moment, octets = [Signal(32, name=f"moment{n}") for n in range(WORDS)], Signal(8)
        with m.If(begins):
            m.d.sync += octets.eq(dut.length)
            m.d.sync += [kept.eq(word) for kept, word in zip(moment, words, strict=True)]
        meant = Array(Mux(begins, word, kept) for word, kept in zip(words, moment, strict=True))
        needs = Mux(begins, dut.length, octets)
        m.d.comb += [
            Assert(~o.valid | ((given.taken < (needs + 3)[2:]) == ~o.payload.end), "whole"),
            Assert(~o.valid | o.payload.end | (o.payload.data == meant[given.taken[0]]), "whole"),
            Assert(~o.valid | ~o.payload.end | (o.payload.padding == (-needs)[:2]), "whole"),
            Assert(~o.valid | ~o.payload.bad, "whole"),
            Assert(~o.valid | ~dut.grant, "mine"),
            Assert(~o.valid | (needs <= SIZE), "long"),
            Assert(~dut.drop_long | (dut.length > SIZE), "long"),
            Cover(given.ended & (needs == SIZE), "longest"),
            Cover(given.ended & (needs == 0), "empty"),
        ]
        # Why: a message is at `o` two cycles after it was decided, so reasons are looked at as late.
        reason, enable, long = (Signal(2, name=name) for name in ("reason", "enable", "long"))
        reasons = dut.periodic | (dut.grant & dut.rel)
        m.d.sync += [reason.eq(Cat(reasons, reason)), enable.eq(Cat(dut.enable, enable))]
        m.d.sync += long.eq(Cat(dut.drop_long, long))
        due, starts = Signal(), begins | long[1]
        with m.If(starts):
            m.d.sync += due.eq(0)
        with m.If(reason[1]):
            m.d.sync += due.eq(1)
        with m.If(~enable[1]):
            m.d.sync += due.eq(0)
        m.d.comb += Assert(~starts | due, "due")
        self.within(m, SENT, due & ~starts, ~dut.grant & o.ready, "sent")
        self.within(m, GRANTED, dut.req & ~dut.grant, o.ready, "granted")


class SubscribeSpec(_Right):
    """The memory is one place of it, `place`, any. `mine`: it is not touched while the user has the right to it. `whole`:
    while the user has, and whenever a message is said to be there, it has that one's octet, and `length` and
    `representation` are that one's; of messages that ended well and are not too long each is there once, in their order.
    `bad`: of others nothing is. `new`: that there is one is said until the right is given, or another one comes. `room`,
    where it is, `i` is ready until a message has come. `granted`: who asks gets the right, and `taken`: what comes is taken,
    within some cycles in which the user has it not."""

    quick, deep = 20, 26
    bugs = (
        Bug("kept", "m.d.sync += grant.eq(~rel)", "m.d.sync += grant.eq(~rel & ~wanted)"),
        Bug("mine", "with m.Elif(req & ~moving & ~begins):", "with m.Elif(req & ~begins):"),
        Bug("whole", "self.length.eq(at)", "self.length.eq(place[:2])"),
        Bug("bad", "judging.eq(~i.payload.bad)", "judging.eq(1)"),
        Bug(
            "new",
            "& ~self.grant):\n            m.d.sync += self.recv.eq(0)",
            "& ~self.grant):\n            pass",
        ),
        Bug("room", "self.room.eq(self.enable & i.ready)", "self.room.eq(self.enable)"),
        Bug("taken", "~(before & req)", "~req"),
        Bug(
            "granted",
            "with m.Elif(req & ~moving & ~begins):",
            "with m.Elif(req & ~moving & wanted & ~begins):",
        ),
    )

    def block(self) -> Any:
        return self.gates.AppDataRx(SIZE)

    def properties(self, m: Module) -> None:
        dut = self.dut
        rules = self.assume(m, "i")
        self.right(m)
        i = dut.i.stream
        place = self.steady(m, range(SIZE), "place")
        # Of what comes
        words = Signal(3)
        octet = Signal(8)
        word = rules.transfer & ~i.payload.end
        with m.If(word):
            m.d.sync += words.eq(words + ~words.all())
            with m.If(words == place[2:]):
                m.d.sync += octet.eq(i.payload.data.word_select(place[:2], 8))
        with m.If(rules.ended):
            m.d.sync += words.eq(0)
        length = Cat(C(0, 2), words) - i.payload.padding
        fits = (words <= WORDS) & (length <= SIZE)
        good = rules.ended & ~i.payload.bad
        too_long = Signal()  # as is said a cycle later
        m.d.sync += too_long.eq(good & ~fits)
        m.d.comb += Assume(~(i.valid & i.payload.end & (words == 0)) | (i.payload.padding == 0), "padding")
        # The one that is kept, and the one in the memory
        there, kept_octet, kept_length, kept_kind = Signal(), Signal(8), Signal(8), Signal(16)
        shown, shown_octet, shown_length, shown_kind = Signal(), Signal(8), Signal(8), Signal(16)
        memory, recv, grant = Signal(8), Signal(), Signal()
        with m.If(dut.ce & dut.we & (dut.addr == place)):
            m.d.sync += memory.eq(dut.wdata)
        m.d.sync += [recv.eq(dut.recv), grant.eq(dut.grant)]
        comes = dut.recv & ~recv
        with m.If(comes):
            m.d.sync += [there.eq(0), shown.eq(1), shown_octet.eq(kept_octet)]
            m.d.sync += [shown_length.eq(kept_length), shown_kind.eq(kept_kind)]
        with m.If(good & fits):
            m.d.sync += [there.eq(1), kept_octet.eq(octet), kept_length.eq(length)]
            m.d.sync += kept_kind.eq(dut.i.meta.representation)
        right_octet = (memory == Mux(comes, kept_octet, shown_octet)) | (place >= dut.length)
        right = right_octet & (dut.length == Mux(comes, kept_length, shown_length))
        right &= dut.representation == Mux(comes, kept_kind, shown_kind)
        reads = dut.recv | (dut.grant & shown)
        m.d.comb += [
            Assert(~(dut.ce & dut.grant), "mine"),
            Assert(dut.ce == dut.we, "mine"),
            Assert(~reads | right, "whole"),
            Assert(~(good & fits & there & ~comes), "whole"),
            Assert(~comes | there, "bad"),
            Assert(~dut.ce | there, "bad"),
            Assert(dut.drop_long == too_long, "bad"),
            Assert(~recv | dut.recv | there | dut.grant, "new"),
            Assert(~(dut.recv & dut.grant), "new"),
            Assert(~dut.room | (i.ready & dut.enable), "room"),
            Cover(dut.grant & ~grant & recv & (dut.length == SIZE), "longest"),
            Cover(comes & shown & (dut.length == 0), "another"),
            Cover(dut.drop_long, "long"),
        ]
        self.within(m, TAKEN, i.valid & ~i.ready, ~dut.grant, "taken")
        self.within(m, MOVED, dut.req & ~dut.grant, C(1, 1), "granted")


SPECS: tuple[type[Spec], ...] = (PublishSpec, SubscribeSpec)
