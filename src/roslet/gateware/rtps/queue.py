"""Datagrams as messages of words, with the verdict on each beside it as soon as that is known."""

from __future__ import annotations

from amaranth.hdl import Module, Signal
from amaranth.lib import memory, wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.meta import UDP_RX
from roslet.gateware.stream import FrameSignature
from roslet.gateware.words import MessageSignature


class DatagramQueue(wiring.Component):
    """A queue of words for datagrams of up to `longest` octets.

    Ports: `i`, the data of datagrams; `o`, the same in words, cut through; `known` is high while the end of the datagram
    that `o` gives is in the queue, or at `o`, and `good` is then whether it is a good one. So who reads `o` may act on what
    it has read before it has read all of it.

    Throughput one octet a cycle, one word in two; a word leaves 4 cycles after its last octet came. After the end of a
    datagram `i` waits until that has been taken from `o`: what comes meanwhile must be held elsewhere. So each datagram
    begins at the beginning of the memory. One that is too long gets a bad end in place of what does not fit, and is counted
    by `drop_long` if its own end is good.
    """

    def __init__(self, longest: int) -> None:
        if longest < 4:
            raise ValueError(f"a queue is for datagrams of 4 octets or more, not {longest}")
        self._depth = (longest + 3) // 4
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
        m.submodules.words = words = memory.Memory(shape=32, depth=self._depth + 1, init=[])
        write, read = words.write_port(), words.read_port()

        # -- in
        held, at = Signal(32), Signal(2)
        whole = Signal()  # `held` is, and is being written
        count = Signal(range(self._depth + 1))  # words that are written
        full, long, too_long = Signal(), Signal(), Signal()
        m.d.comb += [
            full.eq(count == self._depth),
            too_long.eq(long | (whole & full)),
            write.addr.eq(count),
            write.data.eq(held),
            write.en.eq(whole & ~full),
        ]
        m.d.sync += [count.eq(count + write.en), long.eq(too_long), whole.eq(0)]
        padding = Signal(2)
        taken = Signal()  # `o` gave the end
        with m.If(i.valid & ~self.known):
            with m.If(~i.payload.end):
                m.d.comb += i.ready.eq(1)
                m.d.sync += [at.eq(at + 1), whole.eq(at == 3)]
                with m.If(at == 0):
                    m.d.sync += held.eq(0)
                m.d.sync += held.word_select(at, 8).eq(i.payload.data)
            with m.Elif(at != 0):
                m.d.sync += [at.eq(0), whole.eq(1), padding.eq(-at)]
            with m.Else():
                bad = i.payload.bad | too_long
                m.d.comb += [i.ready.eq(1), self.drop_long.eq(too_long & ~i.payload.bad)]
                m.d.sync += [self.known.eq(1), self.good.eq(~bad)]
                with m.If(bad):
                    m.d.sync += padding.eq(0)

        # -- out
        next_, more = Signal.like(count), Signal()
        fetched = Signal()  # `more` words were there a cycle before, and what is read is the next of them
        m.d.comb += [
            read.addr.eq(next_),
            more.eq(next_ != count),
            taken.eq(o.valid & o.ready & o.payload.end),
        ]
        m.d.sync += fetched.eq(more)
        with m.If(o.valid & o.ready):
            m.d.sync += o.valid.eq(0)
        with m.If(~o.valid):
            m.d.sync += [
                o.payload.data.eq(read.data),
                o.payload.end.eq(~fetched),
                o.payload.bad.eq(~fetched & ~self.good),
                o.payload.padding.eq(padding & (~fetched).replicate(2)),
                o.valid.eq(fetched | (self.known & ~more)),
            ]
            with m.If(fetched):
                m.d.sync += [next_.eq(next_ + 1), fetched.eq(0)]
        with m.If(taken):
            m.d.sync += [self.known.eq(0), count.eq(0), next_.eq(0), long.eq(0), padding.eq(0)]
        return m
