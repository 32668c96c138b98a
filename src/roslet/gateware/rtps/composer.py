"""Runs through what a template says: words of its own, and what they refer to, are written, taken, or stored."""

from __future__ import annotations

from typing import Any

from amaranth.hdl import C, Cat, Module, Mux, Shape, Signal, Value, signed
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.rtps.columns import rom_columns
from roslet.gateware.rtps.ports import READ_LATENCY, ReadSignature
from roslet.gateware.rtps.rom import ALIGNMENT, DO, WORD_BITS, Op, Rom
from roslet.gateware.rtps.tables import OwnMap, PeerMap

WINDOW = 3
"""Messages that one ACKNACK asks for."""


def age_shape(own: OwnMap, window: int) -> Shape:
    """Of how far a number is behind its writer's last: 0, it is the last; -1, the next."""
    told = len(own.writers), len(own.readers)
    return signed(max(window, *told, *(writer.depth for writer in own.writers)).bit_length() + 1)


def subject_layout(peers: PeerMap, own: OwnMap, window: int = WINDOW) -> data.StructLayout:
    """Whom and what it is about: the participant; the proxy, builtin or the user's; the number of our endpoint; the message,
    and the oldest for who is served, by their ages; where the message begins in our own memory, its words behind its length,
    in bits that are zero here, how many they are, and how many octets of the last are not its own."""
    longest = max((local.words for local in own.writers), default=0)
    return data.StructLayout(
        {
            "builtin": 1,
            "kind": 2,
            "slot": peers.slot_bits,
            "endpoint": peers.endpoint_bits,
            "local": own.local_bits,
            "age": age_shape(own, window),
            "oldest": age_shape(own, window),
            "sample": own.address_bits,
            "words": max(1, longest.bit_length()),
            "padding": 2,
        }
    )


def writer_word(own: OwnMap, subject: Any, word: Value) -> Value:
    """Where in our own memory that word of the subject's writer is: of ours for discovery, or of the user's."""
    number = Mux(subject.builtin, subject.kind[0], subject.local)
    return own.writer(number, word, subject.builtin)


class Composer(wiring.Component):
    """Runs through the template that `at` named, as the ROM counts, when `load` was high last, from `start`, high for a
    cycle, then or later, on: one word a cycle.

    Ports: `subject`, steady until `done` but for what is taken for it; `borrow`, the lower word of the number that is asked
    for is above that of the last; `peers` and `own`, read ports, of which `hide_peers` and `hide_own` say a cycle later that
    zero shall be given for what lies there; `word`, which `push` says is to be written, and `do` what else: it is zero
    otherwise. The first word comes 7 cycles after `start`. What takes the words must have room for all. In the cycle of
    the last, or the one or two after it, `done` is high, with what comes then in `do.then`, and `send` if they are a
    datagram. Up to `window` messages are asked for at once.
    """

    def __init__(self, rom: Rom, peers: PeerMap, own: OwnMap, window: int = WINDOW) -> None:
        self._rom, self._peers, self._own, self._window = rom, peers, own, window
        super().__init__(
            {
                "at": In(range(-(-len(rom.words) // ALIGNMENT))),
                "load": In(1),
                "start": In(1),
                "subject": In(subject_layout(peers, own, window)),
                "borrow": In(1),
                "peers": Out(ReadSignature(peers.address_bits)),
                "own": Out(ReadSignature(own.address_bits)),
                "hide_peers": Out(1),
                "hide_own": Out(1),
                "push": Out(1),
                "word": Out(32),
                "do": Out(DO),
                "done": Out(1),
                "send": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        reads = rom_columns(m, self._rom.words, WORD_BITS)
        subject = self.subject
        # Who says where has thought about it for most of a cycle.
        at, load, start = Signal.like(self.at), Signal(), Signal()
        m.d.sync += [at.eq(self.at), load.eq(self.load), start.eq(self.start)]
        here = Signal(range(len(self._rom.words)))  # what the ROM looks at
        # Of the template: a word comes from the ROM, then it is in `item`, then what it refers to is read, and is added to.
        running, coming, there = Signal(), Signal(), Signal()
        item = Signal(WORD_BITS)
        argument, op = item[:32], item[32:]
        of_memory, of_peers = op[3], op[2]
        does = of_memory & (op != Op.OWN.value)  # what `do` says
        do = data.View(DO, argument[: DO.size])
        words = subject.words
        word = Signal.like(words)  # of the message
        in_message, last = Signal(), Signal()
        m.d.comb += [
            in_message.eq(there & (op == Op.MESSAGE.value) & (word != words)),
            last.eq(there & does & do.end),
        ]
        for read in reads:
            m.d.comb += [read.addr.eq(here), read.en.eq(~in_message)]
        with m.If(~in_message):
            m.d.sync += [item.eq(Cat(read.data for read in reads)), coming.eq(running), there.eq(coming)]
            with m.If(running):
                m.d.sync += here.eq(here + 1)
        with m.If(load):
            m.d.sync += here.eq(at * ALIGNMENT)
        with m.If(start):
            m.d.sync += [running.eq(1), word.eq(0)]
        with m.If(last):
            m.d.sync += [running.eq(0), coming.eq(0), there.eq(0)]

        # -- where it is
        with m.If(of_peers):
            with m.If(op[0]):
                m.d.comb += self.peers.addr.eq(
                    Mux(
                        subject.builtin,
                        self._peers.builtin(subject.slot, subject.kind, do.word),
                        self._peers.endpoint(subject.endpoint, do.word),
                    )
                )
            with m.Else():
                m.d.comb += self.peers.addr.eq(self._peers.participant(subject.slot, do.word))
        with m.Switch(op[:2]):
            with m.Case(Op.OWN.value & 3):
                m.d.comb += self.own.addr.eq(argument)
            with m.Case(Op.WRITER.value & 3):
                m.d.comb += self.own.addr.eq(writer_word(self._own, subject, do.word))
            with m.Case(Op.SIZE.value & 3):
                m.d.comb += self.own.addr.eq(subject.sample)
            with m.Case(Op.MESSAGE.value & 3):
                m.d.comb += self.own.addr.eq(subject.sample | (word + 1))
        with m.If(in_message):
            m.d.sync += word.eq(word + 1)

        # -- what is read, or a literal: one of these, the others are zero, so they need not be chosen from
        literal, kind = [Signal(32), Signal(32)], Signal(3)
        todo = [Signal(DO), Signal(DO)]
        pushed, over = Signal(READ_LATENCY), Signal(READ_LATENCY)
        read_own, read_peers = Signal(), Signal()
        m.d.comb += [self.hide_own.eq(~read_own), self.hide_peers.eq(~read_peers)]
        m.d.sync += [
            read_own.eq(there & of_memory & ~of_peers),
            read_peers.eq(there & of_memory & of_peers),
            pushed.eq(Cat(there & ~(does & do.quiet), pushed)),
            over.eq(Cat(last, over)),
            literal[0].eq(argument),
            kind.eq(op),
            todo[0].eq(do),
            literal[1].eq(literal[0]),
            todo[1].eq(todo[0]),
        ]
        with m.If(~there | of_memory):
            m.d.sync += [literal[0].eq(0), kind.eq(Op.LITERAL.value)]
        with m.If(~(there & does)):
            m.d.sync += todo[0].eq(0)
        with m.If(there & (op == Op.MESSAGE.value)):
            m.d.sync += pushed[0].eq(in_message)

        # -- what is added to it: one of these, the others are zero
        carried, given = Signal(signed(2)), todo[0]
        missing = Cat(subject.age >= n for n in reversed(range(self._window)))
        added, total = Signal(signed(34)), Signal(signed(35))
        m.d.sync += added.eq(
            Mux(given.minus_age, -subject.age, 0)
            | Mux(given.minus_oldest, -subject.oldest, 0)
            | given.one
            | Mux(given.carry, carried, 0)
            | Mux(given.borrow & self.borrow, C(-1, signed(2)), 0)
            | Mux(kind == Op.ENTITY.value, (subject.local + 1) << 16, 0)
            | Mux(kind == Op.LENGTH.value, words << 18, 0)
            | Mux(kind == Op.PADDING.value, subject.padding << 24, 0)
            | Mux(kind == Op.BITMAP.value, missing << 32 - self._window, 0)
        )
        m.d.comb += total.eq((self.own.data | self.peers.data | literal[1]) + added)
        m.d.sync += [
            self.word.eq(total),
            self.push.eq(pushed[-1]),
            self.do.eq(todo[1]),
            self.done.eq(over[-1]),
            self.send.eq(over[-1] & todo[1].send),
        ]
        with m.If(todo[1].minus_age | todo[1].minus_oldest | todo[1].one):
            m.d.sync += carried.eq(total[32:])
        return m
