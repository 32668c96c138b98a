"""Composed datagrams on their way to UDP."""

from __future__ import annotations

from amaranth.hdl import C, Cat, Module, Signal
from amaranth.lib import memory, wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.meta import UDP_TX, LookupSignature
from roslet.gateware.stream import FrameSignature


class Outbox(wiring.Component):
    """Two places of a power of two of words: a datagram is written in one while the one before is sent from the other.

    Ports: with `push` the word `word` is the next of: the address that a datagram goes to, the port, in the lower half of a
    word, and the datagram, of one word or more. `finish` is high for a cycle with the last word or after it. Then `busy` is
    high for two cycles and until the one before has been sent, and no word may come; `room` is high while a datagram of
    `longest` octets can be written. `source_port`, ours. `lookup` asks for hardware addresses; `o`, the data.

    A datagram begins to leave 6 cycles after `finish` if its hardware address is known and none is before it, then an octet
    a cycle. Who does not answer to ARP within two to the `patience` cycles gets nothing (`drop_unresolved`): who comes
    behind waits no longer than that.
    """

    def __init__(self, longest: int, patience: int = 17) -> None:
        words = -(-longest // 4)
        self._depth, self._patience = 2 << words.bit_length(), patience
        super().__init__(
            {
                "push": In(1),
                "word": In(32),
                "finish": In(1),
                "busy": Out(1),
                "room": Out(1),
                "source_port": In(16),
                "lookup": Out(LookupSignature()),
                "o": Out(FrameSignature(UDP_TX)),
                "drop_unresolved": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.words = words = memory.Memory(shape=32, depth=self._depth, init=[])
        write, read = words.write_port(), words.read_port()
        place = Signal()  # where it is written; it is read in the other
        length = Signal((self._depth // 2 - 1).bit_length())
        waiting, given = Signal(), Signal()  # for the one before; a datagram, from who writes to who sends

        # -- in
        pair, total, carry = Signal(17), Signal(16), Signal()
        added = Signal(17)
        m.d.comb += [
            write.addr.eq(Cat(length, place)),
            write.data.eq(self.word),
            write.en.eq(self.push),  # the address and the port too, where the first words will lie
            added.eq((Cat(C(1, 1), total) + Cat(carry, pair[:16]))[1:]),
            self.room.eq(~self.busy),
        ]
        # Two halves in one cycle, to the sum in the next; what is carried, a cycle later.
        m.d.sync += [pair.eq(pair[16]), total.eq(added[:16]), carry.eq(added[16])]
        ip, port, settling = Signal(32), Signal(32), Signal(2)
        heading = Signal(2, init=3)  # the address, or the port, is yet to come
        with m.If(self.push & (heading != 0)):
            m.d.sync += [heading.eq(heading[1:]), ip.eq(port), port.eq(self.word)]
        with m.Elif(self.push):
            m.d.sync += length.eq(length + 1)
            m.d.sync += pair.eq((Cat(C(1, 1), self.word[:16]) + Cat(pair[16], self.word[16:]))[1:])
        m.d.sync += settling.eq(Cat(self.finish, settling[0]))
        with m.If(self.finish):
            m.d.sync += [heading.eq(3), self.busy.eq(1)]
        with m.If(settling[1]):
            m.d.sync += waiting.eq(1)

        # -- out
        o, meta, lookup = self.o.stream, self.o.meta, self.lookup
        address, number, count, checksum = Signal(32), Signal(16), Signal.like(length), Signal(16)
        mac = Signal(48)
        asking, found = Signal(), Signal()
        waited = Signal(self._patience + 1)
        at, lane, over = Signal.like(length), Signal(2), Signal()
        word = Signal(32)
        with m.If(given):
            m.d.sync += [waiting.eq(0), self.busy.eq(0), place.eq(~place), length.eq(0)]
            m.d.sync += [address.eq(ip), number.eq(port), count.eq(length), asking.eq(1), found.eq(0)]
            m.d.sync += [checksum.eq(Cat(added[8:16], added[:8])), total.eq(0), carry.eq(0)]
        m.d.comb += [
            read.addr.eq(Cat(at, ~place)),
            lookup.valid.eq(asking),
            lookup.ip.eq(address),
            meta.mac.eq(mac),
            meta.destination.eq(address),
            meta.source_port.eq(self.source_port),
            meta.destination_port.eq(number),
            meta.length.eq(Cat(C(0, 2), count)),
            meta.sum.eq(checksum),
        ]
        with m.If(~asking):
            m.d.sync += waited.eq(0)
        with m.Elif(~waited[-1]):
            m.d.sync += waited.eq(waited + 1)
        with m.If(asking & lookup.done):
            m.d.sync += mac.eq(lookup.mac)
            with m.If(lookup.found | lookup.failed | waited[-1]):
                m.d.sync += [asking.eq(0), found.eq(lookup.found)]
        with m.FSM():
            with m.State("IDLE"):
                m.d.sync += [at.eq(0), lane.eq(0), over.eq(0)]
                m.d.comb += given.eq(waiting)
                with m.If(waiting):
                    m.next = "FETCH"
            with m.State("FETCH"):
                m.d.sync += at.eq(1)
                m.next = "FIRST"
            with m.State("FIRST"):
                m.d.sync += word.eq(read.data)
                m.next = "SEND"
            with m.State("SEND"):
                m.d.comb += [
                    o.valid.eq(found),
                    o.payload.end.eq(over),
                    o.payload.data.eq(word.word_select(lane, 8)),
                ]
                with m.If(o.valid & o.ready):
                    m.d.sync += lane.eq(lane + 1)
                    with m.If(lane == 3):
                        m.d.sync += [word.eq(read.data), at.eq(at + 1), over.eq(at == count)]
                    with m.If(over):
                        m.next = "IDLE"
                with m.If(~asking & ~found):
                    m.d.comb += self.drop_unresolved.eq(1)
                    m.next = "IDLE"
        return m
