"""The typed blocks: a message leaves as it came, whole and of one moment; a bad one never appears; nothing stands still.

Of two types: a text, behind which a number stands anywhere in a word; and a sequence of structures.
"""

from __future__ import annotations

from typing import Any

from amaranth.hdl import Array, Assert, Assume, C, Cat, Cover, Module, Mux, Signal, Value

from gateware.formal import Bug, Spec
from gateware.proofs.rtps import waits
from roslet.gateware.typed import deserializer, serializer
from roslet.gen.gateware import Bounds, Plan, plan
from roslet.idl import Registry

TEXT, PAIRS = 4, 2
"""Octets of the text and elements of the sequence, at most: neither is all that its `length` can say."""
_REGISTRY = Registry("ros2", environment=None)
_LABEL = "string text\nuint16 number\n"
_LIST = f"Pair[] pairs\n{80 * '='}\nMSG: proofs/Pair\nuint16 a\nuint32 b\n"
_REGISTRY.load_full_text("proofs/msg/List", _LIST)
_REGISTRY.load_full_text("proofs/msg/Label", _LABEL)


def made(name: str, bounds: Bounds) -> Plan:
    return plan(f"proofs/msg/{name}", bounds, _REGISTRY)


class Body:
    """A body by its octets. XTypes 1.3, 7.4.1; CDR, 9.3: without the encapsulation header, little endian."""

    plan: Plan

    def legal(self, message: Any) -> Value:
        """Whether lengths are within their bounds."""
        raise NotImplementedError

    def size(self, message: Any) -> Value:
        """Octets of the body."""
        raise NotImplementedError

    def octet(self, message: Any, place: Value) -> Value:
        """The octet of the body at `place`, zero behind it."""
        raise NotImplementedError


class Label(Body):
    """`string text`, `uint16 number`: the length with the NUL, the octets, a NUL, up to one octet of padding."""

    plan = made("Label", Bounds(string=TEXT))

    def legal(self, message: Any) -> Value:
        return message.text.length <= TEXT

    def number(self, message: Any) -> Value:
        """Where the number is."""
        behind = message.text.length + 5
        return behind + behind[0]

    def size(self, message: Any) -> Value:
        return self.number(message) + 2

    def octet(self, message: Any, place: Value) -> Value:
        text, number = message.text, self.number(message)
        chosen: Value = C(0, 8)
        chosen = Mux(place == 0, text.length + 1, chosen)
        for n in range(TEXT):
            chosen = Mux((place == 4 + n) & (text.length > n), text.data[n], chosen)
        chosen = Mux(place == number, message.number[:8], chosen)
        return Mux(place == number + 1, message.number[8:], chosen)


class List(Body):
    """`Pair[] pairs`, each `uint16 a`, `uint32 b`: the length, then eight octets each."""

    plan = made("List", Bounds(sequence=PAIRS))

    def legal(self, message: Any) -> Value:
        return message.pairs.length <= PAIRS

    def size(self, message: Any) -> Value:
        return 4 + (message.pairs.length << 3)

    def octet(self, message: Any, place: Value) -> Value:
        pairs = message.pairs
        chosen: Value = Mux(place == 0, pairs.length, C(0, 8))
        for n in range(PAIRS):
            pair, start = pairs.data[n], 4 + 8 * n
            whole = Cat(pair.a, C(0, 16), pair.b)
            for k in range(8):
                there = (place == start + k) & (pairs.length > n)
                chosen = Mux(there, whole.word_select(k, 8), chosen)
        return chosen


class _Serializer(Spec):
    """Messages stand until they are taken, and then others do. Of the kth of them, any: `octet`, any octet of its words is
    that of the kth message, also behind its end; `length`: it has as many, and says how many are too many. `bound`: it ends
    badly if, and only if, a length in it is over its bound, and that is counted. `taken`: it is, within some cycles in which
    the stream is ready. `no_gap`: while there is something to be sent, `o` is empty for a few cycles at most."""

    module = serializer
    body: Body
    quick, deep = 13, 24
    bound, gap = 7, 2
    shared_bugs = (
        Bug(
            "o.bad_only_at_end",
            "item.bad.eq(ends & refused)",
            "item.bad.eq((ends & refused) | (~ends & word[31]))",
        ),
        Bug("octet", "value[8 * (piece.shift + octet) :][:8]", "value[8 * piece.shift :][:8]"),
        Bug("bound", "(raw[:bits] > bound)", "(raw[:bits] > bound + 1)"),
        Bug("no_gap", "run.eq(i.valid & free)", "run.eq(i.valid & free & self.o.stream.ready)"),
        Bug("taken", "ends.eq(program.ended & ~position.pads)", "ends.eq(program.ended & ~refused)"),
    )

    def block(self) -> Any:
        return self.gates.Serializer(self.body.plan)

    def properties(self, m: Module) -> None:
        dut, body = self.dut, self.body
        i, o = dut.i, dut.o.stream
        given = self.check(m, "o")
        held, before = Signal(), Signal.like(i.payload.as_value())
        m.d.sync += [held.eq(i.valid & ~i.ready), before.eq(i.payload)]
        m.d.comb += Assume(~held | (i.valid & (i.payload.as_value() == before)), "steady")
        which, place = self.steady(m, 1, "which"), self.steady(m, 5, "place")
        into, out, there = Signal(2), Signal(2), Signal()
        kept = Signal(dut.layout)
        with m.If(i.valid & (into == which)):
            m.d.sync += [kept.eq(i.payload), there.eq(1)]
        with m.If(i.valid & i.ready):
            m.d.sync += into.eq(into + ~into.all())
        with m.If(given.ended):
            m.d.sync += out.eq(out + ~out.all())
        legal, size, octet = Signal(), Signal(6), Signal(8)
        m.d.comb += [legal.eq(body.legal(kept)), size.eq(body.size(kept)), octet.eq(body.octet(kept, place))]
        mine = o.valid & (out == which)
        needs = (size + 3)[2:]
        here = mine & legal & ~o.payload.end & (given.taken == place[2:])
        waiting, idle = i.valid | (into != out), Signal(range(self.gap + 2))
        m.d.sync += idle.eq(Mux(o.valid | ~waiting, 0, idle + 1))
        m.d.comb += [
            Assert(~mine | there, "length"),
            Assert(~mine | ~legal | ((given.taken < needs) == ~o.payload.end), "length"),
            Assert(~mine | ~legal | ~o.payload.end | (o.payload.padding == (-size)[:2]), "length"),
            Assert(~here | (o.payload.data.word_select(place[:2], 8) == octet), "octet"),
            Assert(~(mine & o.payload.end) | (o.payload.bad == ~legal), "bound"),
            Assert(dut.drop_bound == (i.valid & i.ready & ~body.legal(i.payload)), "bound"),
            Assert(idle <= self.gap, "no_gap"),
            Cover(given.transfer & (out == 1), "another"),
            Cover(given.ended & o.payload.bad, "over"),
        ]
        waits(m, i, self.bound, o.ready, "taken")


class LabelSerializerSpec(_Serializer):
    __doc__ = _Serializer.__doc__
    body = Label()
    bugs = (
        *_Serializer.shared_bugs,
        Bug("o.steady", "free.eq(~full | ~emits | o.ready)", "free.eq(1)"),
        Bug("length", "unused.eq(position.padding[:2])", "unused.eq(0)"),
    )


class ListSerializerSpec(_Serializer):
    __doc__ = _Serializer.__doc__
    body = List()
    quick = 15
    bugs = (
        *_Serializer.shared_bugs,
        Bug("o.steady", "free.eq(~full | o.ready)]", "free.eq(1)]"),
        Bug("length", "~(program.is_loop | over)", "~over"),
    )


class _Deserializer(Spec):
    """Bodies of any octets in both byte orders. `whole`: what is given is what was in a message that ended well, all of it
    and of no other. `once`: after such an end there is a message, or a reason why not, and never after a bad one; it is
    `steady` until it is taken. `kept`: a message that has all that its type needs, within its bounds, is given, and
    `reason`: of others the reason is one that they have. `taken`: what comes is taken within some cycles, while there is no
    message that the user leaves."""

    module = deserializer
    quick, deep = 12, 18
    words = 4
    bound = 3
    bugs = (
        Bug("whole", "piece.lane + piece.octets - 1 - octet", "piece.lane + octet"),
        Bug("once", "with m.If(good & ~short):", "with m.If(~short):"),
        Bug(
            "steady", "m.d.comb += self.o.valid.eq(1)", "m.d.comb += [self.o.valid.eq(1), store.eq(i.valid)]"
        ),
        Bug("kept", "(i.payload.padding > unused)", "(i.payload.padding >= unused)"),
        Bug("reason", "(count > bound)", "(count >= bound)"),
        Bug(
            "taken",
            "i.ready.eq(1),\n                    self.drop_bound",
            "i.ready.eq(ended),\n                    self.drop_bound",
        ),
    )

    def block(self) -> Any:
        return self.gates.Deserializer(self.plan)

    plan: Plan

    def properties(self, m: Module) -> None:
        dut = self.dut
        i, o = dut.i.stream, dut.o
        rules = self.assume(m, "i")
        count, words = Signal(4), [Signal(32, name=f"word{n}") for n in range(self.words)]
        last, big, ended = Signal(6), Signal(), Signal()
        word = rules.transfer & ~i.payload.end
        with m.If(word):
            m.d.sync += count.eq(count + ~count.all())
            for n, one in enumerate(words):
                with m.If(count == n):
                    m.d.sync += one.eq(i.payload.data)
        with m.If(rules.ended):
            m.d.sync += [count.eq(0), last.eq((count << 2) - i.payload.padding), big.eq(dut.i.meta.big)]
        good = rules.ended & ~i.payload.bad
        drops = Cat(dut.drop_bound, dut.drop_text, dut.drop_short)
        gives, held, before = Signal(), Signal(), Signal.like(o.payload.as_value())
        m.d.sync += [
            gives.eq(good & ~drops.any()),
            ended.eq(good),
            held.eq(o.valid & ~o.ready),
            before.eq(o.payload),
        ]
        drop = Signal(3)
        m.d.sync += drop.eq(drops)
        octets = [word.word_select(k, 8) for word in words for k in range(4)]
        right, complete, over, text, short = self.judge(octets, last, big, o.payload)
        m.d.comb += [
            Assume(~(i.valid & i.payload.end & (count == 0)) | (i.payload.padding == 0), "padding"),
            Assert(o.valid == (gives | held), "once"),
            Assert(~drops.any() | (good & ((drops & (drops - 1)) == 0)), "once"),
            Assert(~held | (o.payload.as_value() == before), "steady"),
            Assert(~gives | (right & complete), "whole"),
            Assert(~(ended & complete) | gives, "kept"),
            Assert(~drop[0] | over, "reason"),
            Assert(~drop[1] | text, "reason"),
            Assert(~drop[2] | short, "reason"),
            Cover(gives & big, "big endian"),
            Cover(gives & ~big, "little endian"),
            Cover(drop[0], "over"),
            Cover(drop[2], "short"),
        ]
        waits(m, i, self.bound, ~o.valid | o.ready, "taken")

    def judge(self, octets: list[Value], size: Value, big: Value, given: Any) -> tuple[Value, ...]:
        """Of a message of `size` octets: whether `given` is what it has; whether it has all that is needed; whether a
        length is over its bound, there is no NUL, it is too short."""
        raise NotImplementedError


def ordered(octets: list[Value], big: Value) -> Value:
    """A number in the order that is said."""
    return Mux(big, Cat(*reversed(octets)), Cat(*octets))


class LabelDeserializerSpec(_Deserializer):
    __doc__ = _Deserializer.__doc__
    plan = Label.plan

    def judge(self, octets: list[Value], size: Value, big: Value, given: Any) -> tuple[Value, ...]:
        many = ordered(octets[:4], big)  # with the NUL
        at = many[:4] + 4
        at = (at + at[0])[:5]
        over, empty, begun = many > TEXT + 1, many == 0, size >= 4
        rows = Array(octets)
        nul = rows[(many[:3] + 3)[:4]] == 0
        inside = ~over & ~empty
        complete = begun & inside & nul & (size >= at + 2)
        right = (given.text.length == many - 1) & (
            given.number == ordered([rows[at[:4]], rows[(at + 1)[:4]]], big)
        )
        for n in range(TEXT):
            right &= (many <= n + 1) | (given.text.data[n] == octets[4 + n])
        return right, complete, over, empty | ~nul, ~begun | ~inside | (size < at + 2)


class ListDeserializerSpec(_Deserializer):
    __doc__ = _Deserializer.__doc__
    plan = List.plan
    words = 6
    quick = 13

    def judge(self, octets: list[Value], size: Value, big: Value, given: Any) -> tuple[Value, ...]:
        many = ordered(octets[:4], big)
        over = many > PAIRS
        needs = (many[:2] << 3) + 4
        right = given.pairs.length == many
        for n in range(PAIRS):
            pair, start = given.pairs.data[n], 4 + 8 * n
            same = (pair.a == ordered(octets[start : start + 2], big)) & (
                pair.b == ordered(octets[start + 4 : start + 8], big)
            )
            right &= (many <= n) | same
        short = (size < 4) | over | (size < needs)
        return right, ~short, over, C(0, 1), short


SPECS: tuple[type[Spec], ...] = (
    LabelSerializerSpec,
    ListSerializerSpec,
    LabelDeserializerSpec,
    ListDeserializerSpec,
)
