"""Writes what a template says: words of its own, and what they refer to."""

from __future__ import annotations

from amaranth.hdl import C, Cat, Module, Mux, Signal
from amaranth.lib import data, memory, wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.rtps.ports import ReadSignature
from roslet.gateware.rtps.rom import WORD_BITS, Op, Register, Rom
from roslet.gateware.rtps.tables import OwnMap, PeerMap

SUBJECT = data.StructLayout({"builtin": 1, "kind": 2, "slot": 8, "endpoint": 8, "entity": 8, "sample": 32, "words": 16})
"""Whom and what it is about: the participant; the proxy, builtin or the user's; the number of our endpoint as its entity id has
it; where the message begins in our own memory, and how many words it has."""


class Composer(wiring.Component):
    """Runs through the template that begins at `at`, from `start`, high for a cycle, on: one word a cycle, from 2 cycles later.

    Ports: `subject`, steady until `done`, which is high in the cycle after the last word, or with it; `register`, in the same
    cycle, the value of the sender's that `which` names;
    `peers` and `own`, read ports; `push` with `word`, what is written. What takes the words must have room for all.
    """

    def __init__(self, rom: Rom, peers: PeerMap, own: OwnMap) -> None:
        self._rom, self._peers, self._own = rom, peers, own
        super().__init__(
            {
                "at": In(range(len(rom.words))),
                "start": In(1),
                "which": Out(Register),
                "register": In(32),
                "subject": In(SUBJECT),
                "peers": Out(ReadSignature(peers.address_bits)),
                "own": Out(ReadSignature(own.address_bits)),
                "push": Out(1),
                "word": Out(32),
                "done": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.rom = rom = memory.Memory(shape=WORD_BITS, depth=len(self._rom.words), init=self._rom.init())
        read = rom.read_port()
        subject = self.subject
        here = Signal.like(self.at)
        running = Signal()  # `read.data` is a word of the template
        argument = read.data[:32]
        word = Signal(16)  # of the message
        in_message = (read.data[32:] == Op.MESSAGE.value) & (word != subject.words)

        # What is pushed in the next cycle
        literal, source, ready = Signal(32), Signal(2), Signal()
        from_literal, from_own, from_peers = range(3)
        proxy = Mux(
            subject.builtin,
            self._peers.builtin(subject.slot, subject.kind, argument[:3]),
            self._peers.endpoint(subject.endpoint, argument[:3]),
        )
        m.d.comb += [
            read.addr.eq(Mux(running, Mux(in_message, here, here + 1), self.at)),
            self.which.eq(argument[:4]),
            self.push.eq(ready),
            self.word.eq(
                Mux(source == from_own, self.own.data, Mux(source == from_peers, self.peers.data, literal))
            ),
        ]
        m.d.sync += ready.eq(0)
        with m.If(self.start):
            m.d.sync += [running.eq(1), here.eq(self.at), word.eq(0)]
        with m.Elif(running):
            m.d.sync += [here.eq(read.addr), ready.eq(1), source.eq(from_literal), literal.eq(argument)]
            with m.Switch(read.data[32:]):
                with m.Case(Op.OWN.value):
                    m.d.comb += self.own.addr.eq(argument)
                    m.d.sync += source.eq(from_own)
                with m.Case(Op.PARTICIPANT.value):
                    m.d.comb += self.peers.addr.eq(self._peers.participant(subject.slot, argument[:4]))
                    m.d.sync += source.eq(from_peers)
                with m.Case(Op.PROXY.value):
                    m.d.comb += self.peers.addr.eq(proxy)
                    m.d.sync += source.eq(from_peers)
                with m.Case(Op.REGISTER.value):
                    m.d.sync += literal.eq(self.register)
                with m.Case(Op.ENTITY.value):
                    m.d.sync += literal[16:24].eq(subject.entity)
                with m.Case(Op.LENGTH.value):
                    m.d.sync += literal[16:].eq(argument[16:32] + Cat(C(0, 2), subject.words[:14]))
                with m.Case(Op.MESSAGE.value):
                    m.d.comb += self.own.addr.eq(subject.sample + 1 + word)
                    m.d.sync += [source.eq(from_own), ready.eq(in_message), word.eq(word + 1)]
                with m.Case(Op.END.value):
                    m.d.comb += self.done.eq(1)
                    m.d.sync += [running.eq(0), ready.eq(0)]
        return m

