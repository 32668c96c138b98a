"""The RTPS blocks: nothing is longer or shorter than it says, nothing bad is taken for good, nobody waits for ever."""

from __future__ import annotations

from typing import Any, ClassVar

from amaranth.hdl import Assert, Assume, Cat, Const, Cover, Module, Mux, Signal, Value

from gateware.formal import Bug, Spec, assume_steady
from roslet.gateware.rtps import composer, outbox, parameters, queue, submessages, tables, walker
from roslet.gateware.rtps.rom import ALIGNMENT, DO, Op, _do
from roslet.gateware.rtps.tables import Local, OwnMap, PeerMap
from roslet.wire.rtps.submessage import GAP


def waits(m: Module, stream: Any, bound: int, free: Value, name: str) -> None:
    """What is valid at `stream` is taken within `bound` cycles in which `free` is high."""
    count = Signal(range(bound + 2))
    with m.If(~stream.valid | stream.ready):
        m.d.sync += count.eq(0)
    with m.Elif(free):
        m.d.sync += count.eq(count + 1)
    m.d.comb += Assert(count <= bound, name)


LONGEST = 4


class QueueSpec(Spec):
    """`octet`: the nth octet of a datagram leaves at its place, for any n. `words`: a good one has as many words as
    it needs and says how many octets are too many. `verdict`: an end is good only if it came good; `kept`: a good one stays
    so if it is not too long. `known`: whenever an end can be seen, its verdict is said already, and stays.
    """

    module = queue
    quick, deep = 13, 18
    bugs = (
        Bug("o.steady", "with m.If(~o.valid):", "with m.If(1):"),
        Bug(
            "o.bad_only_at_end",
            "o.payload.bad.eq(~fetched & ~self.good)",
            "o.payload.bad.eq(~self.good)",
        ),
        Bug("octet", "held.word_select(at, 8)", "held.word_select(at & 1, 8)"),
        Bug("words", "padding.eq(-at)", "padding.eq(at)"),
        Bug("verdict", "bad = i.payload.bad | too_long", "bad = too_long"),
        Bug("kept", "full.eq(count == self._depth)", "full.eq(count == self._depth - 1)"),
        Bug("known", "o.payload.bad.eq(~fetched & ~self.good)", "o.payload.bad.eq(0)"),
    )

    def block(self) -> Any:
        return self.gates.DatagramQueue(LONGEST)

    def properties(self, m: Module) -> None:
        dut = self.dut
        rules, given = self.assume(m, "i"), self.check(m, "o")
        i, o = dut.i.stream, dut.o.stream
        n = self.steady(m, 3, "n")
        octet, count, words = Signal(8), Signal(5), Signal(4)
        bad, over = Signal(), Signal()
        with m.If(rules.transfer & ~i.payload.end):
            m.d.sync += count.eq(count + ~count.all())
            with m.If(count == n):
                m.d.sync += octet.eq(i.payload.data)
        with m.If(rules.ended):
            m.d.sync += [bad.eq(i.payload.bad), over.eq(1)]
        with m.If(given.transfer & ~o.payload.end):
            m.d.sync += words.eq(words + ~words.all())
        with m.If(given.ended):
            m.d.sync += [words.eq(0), count.eq(0), over.eq(0)]
        before, promised = Signal(), Signal()
        m.d.sync += [before.eq(dut.known & ~given.ended), promised.eq(dut.good)]
        at_end = o.valid & o.payload.end
        good = at_end & ~o.payload.bad
        lane = o.payload.data.word_select(n[:2], 8)
        here = o.valid & ~o.payload.end & (words == n[2:]) & (n < count)
        m.d.comb += [
            Assert(~here | (lane == octet), "octet"),
            Assert(~good | ((words == (count + 3)[2:]) & (o.payload.padding == (-count)[:2])), "words"),
            Assert(~good | (over & ~bad & ((words << 2) >= count)), "verdict"),
            Assert(~at_end | ~o.payload.bad | bad | (count > LONGEST), "kept"),
            Assert(~at_end | (dut.known & (dut.good == ~o.payload.bad)), "known"),
            Assert(~before | (dut.known & (dut.good == promised)), "known"),
            Cover(at_end & o.payload.bad & ~bad, "long"),
            Cover(good & (words == 1) & (o.payload.padding == 1), "three"),
        ]


SKIPPED = """with m.If(left[-1] & ~to_end):
                    m.next = "{}"
                with m.Elif(ended):"""


class WalkerSpec(Spec):
    """`length`: a body has no more words than its header says, and at a good end as many. `data`: they are the message's.
    `good`: a good end is given only of a datagram that is known to be good, and whose octets are all there. `heard`:
    only then is anybody heard. `taken`: whatever comes is taken within a few cycles, and so is the end of a datagram,
    wherever it comes. `idle`: then the walker is, and stays so while it is held; and never within a body.

    Prefixes have one word here. The memories hold anything, in each cycle something else.
    """

    module = walker
    quick, deep = 16, 25
    scale = (("_PREFIX_WORDS = 3", "_PREFIX_WORDS = 1"),)
    bugs = (
        Bug("o.steady", "o.valid.eq(i.valid), i.ready.eq(o.ready)", "o.valid.eq(i.valid), i.ready.eq(1)"),
        Bug(
            "o.bad_only_at_end",
            "o.payload.data.eq(word),",
            "o.payload.data.eq(word), o.payload.bad.eq(i.payload.bad | (word == 5)),",
        ),
        Bug("o.meta_steady", "self.o.meta.known.eq(is_known)", "self.o.meta.known.eq(i.valid)"),
        Bug("length", "less = Signal(15, init=-1), Signal(15)", "less = Signal(14, init=-1), Signal(14)"),
        Bug("data", "o.payload.data.eq(word),", "o.payload.data.eq(word | 1),"),
        Bug("good", "o.payload.bad.eq(~self.good | missing)", "o.payload.bad.eq(~self.good)"),
        Bug("heard", "~o.payload.bad & is_known", "is_known"),
        Bug(
            "taken",
            SKIPPED.format("SUBMESSAGE"),
            SKIPPED.format("SKIP"),
        ),
        Bug(
            "idle",
            'with m.If(ended):\n                    m.next = "START"',
            'with m.If(ended):\n                    m.next = "SKIP"',
        ),
    )

    def block(self) -> Any:
        return self.gates.Walker(PeerMap(1, 1), OwnMap([], [Local("t", "T")]))

    def properties(self, m: Module) -> None:
        dut = self.dut
        rules, given = self.assume(m, "i"), self.check(m, "o")
        i, o = dut.i.stream, dut.o.stream
        verdict_assumed(m, dut)

        header, count = Signal(32), Signal(4)
        ended = Signal()
        word = given.transfer & ~o.payload.end
        m.d.sync += ended.eq(rules.ended)
        with m.If(rules.transfer & ~word):
            m.d.sync += header.eq(i.payload.data)
        with m.If(word):
            m.d.sync += count.eq(count + ~count.all())
        with m.If(given.ended):
            m.d.sync += count.eq(0)
        length = Mux(header[8], header[16:32], header[24:32] | header[16:24] << 8)
        held = Signal()
        m.d.sync += held.eq(dut.idle & dut.hold)
        needs = (length + 3) >> 2
        good = o.valid & o.payload.end & ~o.payload.bad
        missing = i.payload.end & (i.payload.padding > (-length)[:2])
        m.d.comb += [
            Assert(~o.valid | o.payload.end | (length == 0) | (count < needs), "length"),
            Assert(
                ~good | (length == 0) | ((count == needs) & (o.payload.padding == (-length)[:2])), "length"
            ),
            Assert(~word | (rules.transfer & (o.payload.data == i.payload.data)), "data"),
            Assert(~good | (dut.known & dut.good & ~((length != 0) & missing)), "good"),
            Assert(~dut.heard | (given.ended & ~o.payload.bad & dut.o.meta.known), "heard"),
            Assert(~(ended | held) | dut.idle, "idle"),
            Assert(~dut.idle | ~(o.valid | given.within), "idle"),
            Cover(given.ended & ~o.payload.bad & (count == 2), "body"),
            Cover(given.ended & o.payload.bad & (count == 1), "cut"),
        ]
        waits(m, i, 6, o.ready & dut.known & ~dut.hold, "taken")


def verdict_assumed(m: Module, dut: Any) -> None:
    """`known` and `good` are as `DatagramQueue` has them."""
    i = dut.i.stream
    ended = i.valid & i.ready & i.payload.end
    before, promised = Signal(), Signal()
    m.d.sync += [before.eq(dut.known & ~ended), promised.eq(dut.good)]
    m.d.comb += [
        Assume(~(i.valid & i.payload.end) | (dut.known & (dut.good == ~i.payload.bad)), "verdict"),
        Assume(~before | (dut.known & (dut.good == promised)), "verdict stays"),
        Assume(~(i.valid & i.payload.end & i.payload.bad) | (i.payload.padding == 0), "no padding"),
    ]


class SubmessagesSpec(Spec):
    """`user`: a message of the user's ends well only where the body does, and `word`: is made of its words. `over`: a
    body's end is not taken before discovery has taken its. `kept`: something is
    written only at a good end: nothing is kept of a datagram that ends badly. `passes`: but for words of a key, which are
    said while they pass, and no list does. `taken`:
    what comes is taken within some cycles, of all but a GAP, which takes one more for each bit of its first word."""

    module = submessages
    quick, deep = 27, 36
    bugs = (
        Bug("user.steady", "m.d.comb += i.ready.eq(user.ready)", "m.d.comb += i.ready.eq(1)"),
        Bug(
            "user.bad_only_at_end",
            "user.payload.bad.eq(i.payload.bad)",
            "user.payload.bad.eq(i.payload.bad | (word == 9))",
        ),
        Bug(
            "user.meta_steady",
            "self.user.meta.reader.eq(local)",
            "self.user.meta.reader.eq(self.peers.data)",
        ),
        Bug(
            "discovery.steady",
            "m.d.comb += self.discovery.stream.valid.eq(i.valid)",
            "m.d.comb += self.discovery.stream.valid.eq(i.valid & ~self.peers.data[0])",
        ),
        Bug(
            "discovery.bad_only_at_end",
            "self.discovery.stream.payload.eq(i.payload)",
            "self.discovery.stream.payload.eq(i.payload), self.discovery.stream.payload.bad.eq(1)",
        ),
        Bug(
            "discovery.meta_steady",
            "self.discovery.meta.gone.eq(gone)",
            "self.discovery.meta.gone.eq(self.peers.data[0])",
        ),
        Bug("user", "user.payload.bad.eq(i.payload.bad)", "user.payload.bad.eq(i.payload.bad & (word == 0))"),
        Bug("word", "self.user.stream.payload.data.eq(word)", "self.user.stream.payload.data.eq(number)"),
        Bug(
            "over",
            "with m.If(~i.payload.end):\n                    m.d.comb += i.ready.eq(self.discovery.stream.ready)",
            "with m.If(1):\n                    m.d.comb += i.ready.eq(self.discovery.stream.ready)",
        ),
        Bug("kept", "with m.If(~found | wrong | i.payload.bad):", "with m.If(~found | wrong):"),
        Bug(
            "passes",
            "with m.If(came):\n                m.d.comb += i.ready.eq(1)",
            "with m.If(came):\n                m.d.comb += i.ready.eq(~self.keep.en)",
        ),
        Bug(
            "taken",
            'with m.If(~meta.known):\n                        m.next = "FOUND"',
            'with m.If(~meta.known):\n                        m.next = "FIND"',
        ),
    )

    def block(self) -> Any:
        return self.gates.Submessages(PeerMap(1, 1), OwnMap([], [Local("t", "T")]))

    def properties(self, m: Module) -> None:
        dut = self.dut
        rules = self.assume(m, "i")
        self.check(m, "user")
        lists = self.check(m, "discovery")
        i, user = dut.i.stream, dut.user.stream
        ended = i.valid & i.payload.end
        good = user.valid & user.payload.end & ~user.payload.bad
        word = user.valid & ~user.payload.end
        m.d.comb += [
            Assert(~good | (ended & ~i.payload.bad), "user"),
            Assert(~word | (i.valid & ~i.payload.end & (user.payload.data == i.payload.data)), "word"),
            Assert(~rules.ended | ~(lists.within | dut.discovery.stream.valid), "over"),
            Assert(~dut.write.en | (ended & ~i.payload.bad), "kept"),
            Assert(~dut.keep.en | (i.valid & i.ready & ~ended & ~lists.within), "passes"),
            Cover(dut.write.en, "written"),
        ]
        free = user.ready & dut.discovery.stream.ready & (dut.i.meta.id != GAP)
        waits(m, i, 18, free, "taken")


class ParametersSpec(Spec):
    """`done`: a list is read only at a good end, and if it is none or ended with its sentinel, behind whole values. `stays`:
    what is read of it is steady until it may proceed. `told`: of what ended well something is said. `kept`: nothing but
    the scratch area is written. `quiet`: who deals with a list that is done has the memories for itself, and what was
    written of it is there. `keeps`: what passed before is kept.
    `taken`: what comes is taken within some cycles, but for the end of what is read."""

    module = parameters
    quick, deep = 20, 26
    bugs = (
        Bug("done", "self.done.eq(~i.payload.bad)", "self.done.eq(1)"),
        Bug(
            "done",
            'with m.Elif(ended):\n                    m.next = "MALFORMED"',
            'with m.Elif(ended):\n                    m.next = "DONE"',
        ),
        Bug("done", "passed[2:] == 0", "passed[3:] == 0"),
        Bug("stays", "i.ready.eq(self.proceed | i.payload.bad)", "i.ready.eq(1)"),
        Bug("told", "self.drop_malformed.eq(ended & ~i.payload.bad)", "self.drop_malformed.eq(0)"),
        Bug(
            "kept",
            "self._peers.scratch(v.target)",
            "self._peers.participant(Signal(1), v.target)",
        ),
        Bug("keeps", "v.target.eq(self.keep.word)", "v.target.eq(self.keep.word | 1)"),
        Bug(
            "quiet",
            "[self.done.eq(~i.payload.bad), ",
            "[self.done.eq(~i.payload.bad), self.own.addr.eq(v.little), ",
        ),
        Bug(
            "taken",
            'with m.If(ended):\n                    m.next = "MALFORMED"',
            'with m.If(ended):\n                    m.next = "PARAMETER"',
        ),
    )

    def block(self) -> Any:
        return self.gates.Parameters(PeerMap(1, 1), OwnMap([Local("t", "T")], [Local("t", "T")]))

    def properties(self, m: Module) -> None:
        dut = self.dut
        rules = self.assume(m, "i")
        i = dut.i.stream
        word, taken = i.payload.data, rules.transfer & ~i.payload.end
        # 9.4.2.11: what must follow now
        beginning, header, value, rest, wrong = range(5)
        expected, little, left = Signal(range(5)), Signal(), Signal(14)
        pid = Mux(little, word[:16], Cat(word[8:16], word[:8]))
        length = Mux(little, word[16:], Cat(word[24:], word[16:24]))
        with m.If(taken), m.Switch(expected):
            with m.Case(beginning):
                right = (word[:8] == 0) & ((word[8:16] == 2) | (word[8:16] == 3))
                m.d.sync += [little.eq(word[8]), expected.eq(Mux(right, header, wrong))]
            with m.Case(header):
                m.d.sync += [left.eq(length[2:]), expected.eq(Mux(length[2:] != 0, value, header))]
                with m.If(length[:2] != 0):
                    m.d.sync += expected.eq(wrong)
                with m.If(pid == 1):
                    m.d.sync += expected.eq(rest)
            with m.Case(value):
                m.d.sync += [left.eq(left - 1), expected.eq(Mux(left == 1, header, value))]
        with m.If(rules.ended):
            m.d.sync += expected.eq(beginning)
        good = i.valid & i.payload.end & ~i.payload.bad
        held, read, same = Signal(), Signal.like(dut.read.as_value()), Signal.like(dut.same)
        m.d.sync += [held.eq(dut.done & ~dut.proceed), read.eq(dut.read), same.eq(dut.same)]
        wrote, place = Signal(), Signal(4)
        writes = Cat(dut.peers.addr, dut.own.addr, dut.write.addr, dut.write.data, dut.write.en)
        kept = Cat(dut.keep.en, Signal(2, name="kept"))  # now, and before
        m.d.sync += [wrote.eq(dut.write.en), kept[1:].eq(kept), place.eq(dut.keep.word)]
        m.d.comb += [
            Assume(~kept[0] | ~(i.valid | rules.within), "kept before"),
            Assume(~kept[1:].any() | ~i.valid, "kept before"),
            Assert(((i.valid | rules.within) & ~dut.done) | kept[1] | ~writes.any(), "quiet"),
            Assert(~kept[1] | (dut.write.en & (dut.write.addr == PeerMap(1, 1).scratch(place))), "keeps"),
            Assert(~dut.done | ~wrote, "quiet"),
            Assert(~dut.done | (good & ((expected == beginning) | (expected == rest))), "done"),
            Assert(~held | (dut.done & (dut.read.as_value() == read) & (dut.same == same)), "stays"),
            Assert(~(rules.ended & good) | (dut.done ^ dut.drop_malformed), "told"),
            Assert(~dut.drop_malformed | (rules.ended & good), "told"),
            Assert(~dut.write.en | (dut.write.addr[4:] == PeerMap(1, 1)._scratch >> 4), "kept"),
            Cover(dut.done & (expected == rest) & dut.read.refused, "refused"),
            Cover(dut.write.en & (dut.write.addr[:4] != tables.LEASE), "written"),
        ]
        waits(m, i, 9, ~dut.done | dut.proceed, "taken")


class OutboxSpec(Spec):
    """Of datagrams written one after another, each is sent or dropped, in that order: `length`, `where` it goes, and
    `content`, any octet of any of them. Of their sums nothing is said, and none are made."""

    module = outbox
    quick, deep = 15, 20
    scale = (("added.eq((Cat(C(1, 1), total) + Cat(carry, pair[:16]))[1:])", "added.eq(0)"),)
    bugs = (
        Bug("o.steady", "o.valid.eq(found)", "o.valid.eq(found & ~lookup.mac[0])"),
        Bug(
            "o.bad_only_at_end",
            "o.payload.end.eq(over)",
            "o.payload.bad.eq(lane == 1), o.payload.end.eq(over)",
        ),
        Bug("o.meta_steady", "meta.source_port.eq(self.source_port)", "meta.source_port.eq(self.word)"),
        Bug("length", "meta.length.eq(Cat(C(0, 2), count))", "meta.length.eq(Cat(C(0, 1), count))"),
        Bug("where", "ip.eq(port), ", "ip.eq(port + 1), "),
        Bug("where", "heading.eq(3)", "heading.eq(1)"),
        Bug("where", "meta.destination.eq(address)", "meta.destination.eq(ip)"),
        Bug("content", "read.addr.eq(Cat(at, ~place))", "read.addr.eq(Cat(at, place))"),
    )

    def block(self) -> Any:
        return self.gates.Outbox(12, 1)

    def properties(self, m: Module) -> None:
        dut = self.dut
        given = self.check(m, "o")
        o, lookup = dut.o.stream, dut.lookup
        assume_steady(m, dut.source_port)
        # Who writes
        written, number = Signal(3), Signal(3)
        with m.If(dut.finish):
            m.d.sync += [written.eq(0), number.eq(number + ~number.all())]
        with m.Elif(dut.push):
            m.d.sync += written.eq(written + 1)
        start = self.steady(m, 1, "which")
        place = self.steady(m, 4, "place")
        octet, length, target, target_port, there = Signal(8), Signal(5), Signal(32), Signal(16), Signal()
        with m.If(number == start):
            with m.If(dut.push):
                with m.If(written == 0):
                    m.d.sync += target.eq(dut.word)
                with m.If(written == 1):
                    m.d.sync += target_port.eq(dut.word)
                with m.If(written == place[2:] + 2):
                    m.d.sync += octet.eq(dut.word.word_select(place[:2], 8))
            with m.If(dut.finish):
                m.d.sync += [length.eq((written + dut.push - 2) << 2), there.eq(1)]
        m.d.comb += [
            Assume(~dut.push | (~dut.busy & (written < 5)), "writes within"),
            Assume(~dut.push | (written != 0) | dut.room, "begins with room"),
            Assume(~dut.finish | (~dut.busy & (written + dut.push > 2)), "finishes what it began"),
            Assume(~lookup.done | lookup.valid, "answers"),
            Assume(~(lookup.found & lookup.failed), "one answer"),
        ]
        # What is sent
        sent, count = Signal(3), Signal(5)
        with m.If(given.ended | dut.drop_unresolved):
            m.d.sync += [sent.eq(sent + ~sent.all()), count.eq(0)]
        with m.Elif(given.transfer):
            m.d.sync += count.eq(count + 1)
        mine = o.valid & (sent == start)
        meta = dut.o.meta
        m.d.comb += [
            Assert(
                ~mine | (there & (meta.length == length) & ((count < length) == ~o.payload.end)), "length"
            ),
            Assert(~mine | ((meta.destination == target) & (meta.destination_port == target_port)), "where"),
            Assert(~mine | o.payload.end | (count != place) | (o.payload.data == octet), "content"),
            Cover(dut.drop_unresolved, "unresolved"),
        ]


class _Templates:
    """Two templates: a datagram of four words and a message, with something that is stored; and one word."""

    _first = (
        (Op.LITERAL, 0x11111111),
        (Op.LENGTH, 20 << 16 | 0x15),
        _do(Op.WRITER, 1, "quiet", "store"),
        (Op.MESSAGE, 0),
        _do(Op.WRITER, 3),
        _do(Op.PARTICIPANT, 2),
        _do(Op.END, 0, "quiet", "end", "send"),
    )
    _second = ((Op.OWN, 1 << DO["quiet"].offset), _do(Op.END, 0, "quiet", "end"))
    second = 1  # in the place behind the first
    words: ClassVar[list[int]] = [
        op << 32 | argument
        for op, argument in (*_first, *[(Op.END, 0)] * (ALIGNMENT - len(_first)), *_second)
    ]

    def init(self) -> list[int]:
        return self.words


class ComposerSpec(Spec):
    """`count`: when it is done, as many words have come as the template has, and the message. `none_before`, after the
    end: nothing comes of itself. `declared`: the length that is said is that of what follows. `stored`: the word that says
    so, before the message, and no other. `sent`: the first one, at its end. `over`: soon enough."""

    module = composer
    quick, deep = 18, 27
    bugs = (
        Bug("count", "pushed[0].eq(in_message)", "pushed[0].eq(1)"),
        Bug("count", "there & ~(does & do.quiet)", "there"),
        Bug("count", "does & do.quiet", "of_memory & do.quiet"),
        Bug("none_before", "[running.eq(0), coming.eq(0), there.eq(0)]", "[running.eq(0), there.eq(0)]"),
        Bug("declared", "words << 18", "words << 17"),
        Bug("stored", "self.do.eq(todo[1])", "self.do.eq(todo[0])"),
        Bug("sent", "self.send.eq(over[-1] & todo[1].send)", "self.send.eq(todo[0].send)"),
        Bug("over", "(word != words)", "(word != words + 1)"),
    )

    def block(self) -> Any:
        return self.gates.Composer(_Templates(), PeerMap(1, 1), OwnMap([Local("t", "T", words=3)], []))

    def properties(self, m: Module) -> None:
        dut = self.dut
        loaded, running, stored, count, cycles = Signal(), Signal(), Signal(), Signal(5), Signal(5)
        words = dut.subject.words
        assume_steady(m, words)
        assume_steady(m, dut.at)
        second = dut.at == _Templates.second
        pushed = count + dut.push
        with m.If(dut.load):
            m.d.sync += loaded.eq(1)
        with m.If(dut.start):
            m.d.sync += [loaded.eq(0), running.eq(1), stored.eq(0), count.eq(0), cycles.eq(0)]
        with m.Elif(running):
            m.d.sync += [count.eq(pushed), cycles.eq(cycles + 1), running.eq(~dut.done)]
            m.d.sync += stored.eq(stored | dut.do.store)
        needs = Mux(second, 1, 4 + words)
        hidden = Signal(2)
        m.d.sync += hidden.eq(Cat(dut.hide_own, dut.hide_peers))
        m.d.comb += [
            Assume((dut.at == 0) | second, "a template"),
            Assume(words <= 3, "a message that fits"),
            Assume(~dut.load | ~(running | dut.start), "one after another"),
            Assume(~dut.start | loaded, "one after another"),
            Assume(~hidden[0] | (dut.own.data == 0), "hidden"),
            Assume(~hidden[1] | (dut.peers.data == 0), "hidden"),
            Assert(~(running & dut.done) | (pushed == needs), "count"),
            Assert(running | (~dut.push & ~dut.done), "none_before"),
            Assert(
                ~(running & dut.push & ~second & (count == 1))
                | (dut.word[16:] == Const(20, 16) + (words << 2)),
                "declared",
            ),
            Assert(~dut.do.store | (running & ~second & ~stored & ~dut.push & (count == 2)), "stored"),
            Assert(~(running & dut.done & ~second) | stored, "stored"),
            Assert(dut.send == (dut.done & ~second), "sent"),
            Assert(cycles <= needs + 9, "over"),
            Cover(running & dut.done & ~second & (words == 2), "message"),
        ]


SPECS: tuple[type[Spec], ...] = (
    QueueSpec,
    WalkerSpec,
    SubmessagesSpec,
    ParametersSpec,
    OutboxSpec,
    ComposerSpec,
)
