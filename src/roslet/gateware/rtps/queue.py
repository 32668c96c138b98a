"""Datagrams as messages of words, with the verdict on each beside it as soon as that is known."""

from __future__ import annotations

from amaranth.hdl import Cat, Const, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.fifo import SyncFIFOBuffered
from amaranth.lib.wiring import In, Out

from roslet.gateware.meta import UDP_RX
from roslet.gateware.stream import FrameSignature
from roslet.gateware.words import WORD, MessageSignature

SPARE = 2
"""Places for the last word and the end of a datagram that is too long."""


class DatagramQueue(wiring.Component):
    """A queue of words for datagrams of up to `longest` octets.

    Ports: `i`, the data of datagrams; `o`, the same in words, cut through; `known` is high while the end of the datagram
    that `o` gives is in the queue, or at `o`, and `good` is then whether it is a good one. So who reads `o` may act on what
    it has read before it has read all of it.

    Throughput one octet a cycle; a word leaves 4 cycles after its last octet came. After the end of a datagram `i` waits
    until that has been taken from `o`: what comes meanwhile must be held elsewhere. A datagram that is too long gets a bad
    end in place of what does not fit, and is counted by `drop_long` if its own end is good.
    """

    def __init__(self, longest: int) -> None:
        if longest < 4:
            raise ValueError(f"a queue is for datagrams of 4 octets or more, not {longest}")
        self._depth = (longest + 3) // 4 + SPARE
        super().__init__(
            {
                "i": In(FrameSignature(UDP_RX)),
                "o": Out(MessageSignature()),
                "known": Out(1),
                "good": Out(1),
                "drop_long": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        i, o = self.i.stream, self.o.stream
        m.submodules.words = words = SyncFIFOBuffered(width=WORD.size, depth=self._depth)
        held = Signal(24)  # octets of a word that is not whole yet
        at = Signal(2)
        long = Signal()
        item = Signal(WORD)
        count = Signal(range(self._depth))  # words of the datagram that are in the queue, or were
        room = count != self._depth - SPARE
        whole = Signal()
        spare, spared = Signal(WORD.size), Signal()  # a word for which `o` was not ready
        m.d.comb += [
            words.w_data.eq(item),
            words.r_en.eq(~spared),
            whole.eq(at == 3),
        ]
        # Block RAM is slow, and who reads decides late whether it does.
        with m.If(~o.valid | o.ready):
            m.d.sync += [
                o.payload.eq(Mux(spared, spare, words.r_data)),
                o.valid.eq(spared | words.r_rdy),
                spared.eq(0),
            ]
        with m.Elif(words.r_rdy & ~spared):
            m.d.sync += [spare.eq(words.r_data), spared.eq(1)]
        last = Signal(2)  # octets of the last word, 0 where that is whole
        with m.If(self.known), m.If(o.valid & o.ready & o.payload.end):
            m.d.sync += self.known.eq(0)
        with m.Elif(i.valid & i.payload.end):
            with m.If(at != 0):
                m.d.comb += [item.data.eq(held), words.w_en.eq(~long)]
                m.d.sync += [at.eq(0), last.eq(at)]
            with m.Else():
                bad = i.payload.bad | long
                m.d.comb += [
                    item.end.eq(1),
                    item.bad.eq(bad),
                    item.padding.eq(Mux(bad, 0, Const(0, 2) - last)),
                    words.w_en.eq(1),
                    i.ready.eq(1),
                    self.drop_long.eq(long & ~i.payload.bad),
                ]
                m.d.sync += [self.known.eq(1), self.good.eq(~bad), long.eq(0), last.eq(0), count.eq(0)]
        with m.Elif(i.valid):
            octet = i.payload.data
            m.d.comb += [i.ready.eq(1), item.data.eq(Cat(held, octet)), words.w_en.eq(whole & room & ~long)]
            m.d.sync += [at.eq(at + 1), count.eq(count + (whole & room))]
            with m.Switch(at):
                for n in range(3):
                    with m.Case(n):
                        m.d.sync += held.word_select(n, 8).eq(octet)
            with m.If(at == 0):
                m.d.sync += held[8:].eq(0)
            with m.If(whole & ~room):
                m.d.sync += long.eq(1)
        return m
