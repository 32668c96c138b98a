"""Writes what a template says: words of its own, and what they refer to."""

from __future__ import annotations

from amaranth.hdl import C, Cat, Module, Mux, Signal
from amaranth.lib import data, memory, wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.rtps.ports import READ_LATENCY, ReadSignature
from roslet.gateware.rtps.rom import REGISTER_BITS, WORD_BITS, Op, Rom
from roslet.gateware.rtps.tables import OwnMap, PeerMap


def subject_layout(peers: PeerMap, own: OwnMap) -> data.StructLayout:
    """Whom and what it is about: the participant; the proxy, builtin or the user's; the number of our endpoint; where the
    message begins in our own memory, its words behind its length, in bits that are zero here, how many they are, and how
    many octets of the last are not its own; and of the numbers from the one that is wanted on, which are missing, the first
    in the highest bit."""
    longest = max((local.words for local in own.writers), default=0)
    return data.StructLayout(
        {
            "builtin": 1,
            "kind": 2,
            "slot": peers.slot_bits,
            "endpoint": peers.endpoint_bits,
            "local": own.local_bits,
            "sample": own.address_bits,
            "words": max(1, longest.bit_length()),
            "padding": 2,
            "missing": 32,
        }
    )


class Composer(wiring.Component):
    """Runs through the template that begins at `at`, from `start`, high for a cycle, on: one word a cycle, from 7 cycles
    later.

    Ports: `subject`, steady until `done`, which is high a cycle or two after the last word; `register`, in the same
    cycle, the value of the sender's that `which` names;
    `peers` and `own`, read ports, of which `hide_peers` and `hide_own` say a cycle later that zero shall be given for what
    lies there; `push` with `word`, what is written. What takes the words must have room for all.
    """

    def __init__(self, rom: Rom, peers: PeerMap, own: OwnMap) -> None:
        self._rom, self._peers, self._own = rom, peers, own
        super().__init__(
            {
                "at": In(range(len(rom.words))),
                "start": In(1),
                "which": Out(REGISTER_BITS),
                "register": In(32),
                "subject": In(subject_layout(peers, own)),
                "peers": Out(ReadSignature(peers.address_bits)),
                "own": Out(ReadSignature(own.address_bits)),
                "hide_peers": Out(1),
                "hide_own": Out(1),
                "push": Out(1),
                "word": Out(32),
                "done": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.rom = rom = memory.Memory(
            shape=WORD_BITS, depth=len(self._rom.words), init=self._rom.words
        )
        read = rom.read_port()
        subject = self.subject
        starting = Signal()
        here = Signal.like(self.at)  # what the ROM looks at
        # Of the template: a word comes from the ROM, then it is in `item`, then what it refers to is read, and is pushed.
        coming, there = Signal(), Signal()
        item = Signal(WORD_BITS)
        argument, op = item[:32], item[32:]
        words = subject.words
        word = Signal.like(words)  # of the message
        in_message = Signal()
        m.d.comb += in_message.eq(there & (op == Op.MESSAGE.value) & (word != words))

        # One of these, the others are zero: so they need not be chosen from
        literal, register = [Signal(32), Signal(32)], [Signal(32), Signal(32)]
        ready, over = Signal(READ_LATENCY), Signal(READ_LATENCY)
        read_own, read_peers, was_there = Signal(), Signal(), Signal()
        proxy = Mux(
            subject.builtin,
            self._peers.builtin(subject.slot, subject.kind, argument[:3]),
            self._peers.endpoint(subject.endpoint, argument[:3]),
        )
        pushes, ends = Signal(), Signal()
        added = Signal(16)
        m.d.comb += [
            read.addr.eq(here),
            read.en.eq(~in_message),
            self.which.eq(argument[:REGISTER_BITS]),
            self.hide_own.eq(was_there & ~read_own),
            self.hide_peers.eq(was_there & ~read_peers),
        ]
        m.d.sync += [
            self.push.eq(ready[-1]),
            self.word.eq(self.own.data | self.peers.data | literal[1] | register[1]),
            self.done.eq(over[-1]),
            ready.eq(Cat(pushes, ready[:-1])),
            over.eq(Cat(ends, over[:-1])),
            literal[0].eq(0),
            literal[1].eq(literal[0]),
            register[0].eq(0),
            register[1].eq(register[0]),
            was_there.eq(there),
            read_own.eq(0),
            read_peers.eq(0),
        ]
        with m.If(~in_message):
            m.d.sync += [here.eq(here + 1), item.eq(read.data), there.eq(coming)]
        with m.If(self.start):
            m.d.sync += [here.eq(self.at), word.eq(0), coming.eq(0), there.eq(0)]
            m.d.sync += starting.eq(1)
        with m.If(starting):
            m.d.sync += [starting.eq(0), coming.eq(1)]
        with m.If(there):
            m.d.comb += pushes.eq(1)
            with m.Switch(op):
                with m.Case(Op.OWN.value):
                    m.d.comb += self.own.addr.eq(argument)
                    m.d.sync += read_own.eq(1)
                with m.Case(Op.PARTICIPANT.value):
                    m.d.comb += self.peers.addr.eq(self._peers.participant(subject.slot, argument[:4]))
                    m.d.sync += read_peers.eq(1)
                with m.Case(Op.PROXY.value):
                    m.d.comb += self.peers.addr.eq(proxy)
                    m.d.sync += read_peers.eq(1)
                with m.Case(Op.REGISTER.value):
                    m.d.sync += register[0].eq(self.register)
                with m.Case(Op.BITMAP.value):
                    m.d.sync += register[0].eq(subject.missing)
                with m.Case(Op.WRITER.value):
                    number = Mux(subject.builtin, subject.kind[0], subject.local)
                    m.d.comb += self.own.addr.eq(self._own.writer(number, argument[:2], subject.builtin))
                    m.d.sync += read_own.eq(1)
                with m.Case(Op.LITERAL.value, Op.ENTITY.value, Op.LENGTH.value, Op.PADDING.value):
                    m.d.sync += literal[0].eq(Cat(argument[:16], argument[16:32] + added))
                    with m.If(op == Op.ENTITY.value):
                        m.d.comb += added.eq(subject.local + 1)
                    with m.If(op == Op.LENGTH.value):
                        m.d.comb += added.eq(Cat(C(0, 2), words))
                    with m.If(op == Op.PADDING.value):
                        m.d.comb += added.eq(Cat(C(0, 8), subject.padding))
                with m.Case(Op.MESSAGE.value):
                    m.d.comb += [self.own.addr.eq(subject.sample | (word + 1)), pushes.eq(in_message)]
                    m.d.sync += [read_own.eq(1), word.eq(word + 1)]
                with m.Case(Op.END.value):
                    m.d.comb += [pushes.eq(0), ends.eq(1)]
                    m.d.sync += [there.eq(0), coming.eq(0)]
        return m
