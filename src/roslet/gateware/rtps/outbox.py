"""Composed datagrams on their way to UDP."""

from __future__ import annotations

from amaranth.hdl import C, Cat, Module, Mux, Signal
from amaranth.lib import memory, wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.meta import UDP_TX, LookupSignature
from roslet.gateware.stream import FrameSignature

HEADER = 3
"""Words before those of a datagram: address, port and length, sum."""


class Outbox(wiring.Component):
    """A ring of `depth` words, in which datagrams are written one after another and sent in that order.

    Ports: with `push` the word `word` is the next of a datagram, to which `ip` and `port` belong when `finish` is high for a
    cycle, with or after its last word; then three cycles pass with `busy` high, in which no word may come. `room` is high
    while a datagram of `longest` octets can be written. `source_port`, ours. `lookup` asks for hardware addresses; `o`, the
    data.

    A datagram begins to leave 7 cycles after `finish` if its hardware address is known and none is before it, then an octet
    a cycle. Who does not answer to ARP within `patience` cycles gets nothing (`drop_unresolved`): who comes behind waits no
    longer than that.
    """

    def __init__(self, longest: int, depth: int = 512, patience: int = 100_000) -> None:
        if depth & (depth - 1) or depth < HEADER + (longest + 3) // 4 + 1:
            raise ValueError(f"a ring of {depth} words is no power of two, or too small for {longest} octets")
        self._depth, self._patience = depth, patience
        self._least = HEADER + (longest + 3) // 4
        super().__init__(
            {
                "push": In(1),
                "word": In(32),
                "finish": In(1),
                "busy": Out(1),
                "ip": In(32),
                "port": In(16),
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
        bits = (self._depth - 1).bit_length()
        begin, done = Signal(bits), Signal(bits)  # of the datagram that is written; of what has been sent
        used = Signal(bits)
        m.d.comb += used.eq(begin - done)
        m.d.sync += self.room.eq(~(used >= self._depth - self._least))

        # -- in
        length = Signal(bits)
        total, carries = Signal(16), Signal(2)
        pair, added = Signal(17), Signal(17)
        m.d.comb += [
            pair.eq(Mux(self.push, self.word[:16], 0) + Mux(self.push, self.word[16:], 0) + carries[0]),
            added.eq(total + pair[:16] + carries[1]),
            write.data.eq(self.word),
            write.addr.eq(begin + HEADER + length),
            write.en.eq(self.push),
        ]
        settling = Signal()  # nothing but the carries is added
        with m.If(self.push | settling):
            m.d.sync += [total.eq(added[:16]), carries.eq(Cat(pair[16], added[16]))]
        with m.If(self.push):
            m.d.sync += length.eq(length + 1)
        with m.FSM(name="write"):
            with m.State("IDLE"), m.If(self.finish):
                m.next = "ADDRESS"
            with m.State("ADDRESS"):
                m.d.comb += [self.busy.eq(1), settling.eq(1)]
                m.d.comb += [write.en.eq(1), write.addr.eq(begin), write.data.eq(self.ip)]
                m.next = "NUMBERS"
            with m.State("NUMBERS"):
                m.d.comb += [
                    self.busy.eq(1),
                    settling.eq(1),
                    write.en.eq(1),
                    write.addr.eq(begin + 1),
                    write.data.eq(Cat(self.port, length)),
                ]
                m.next = "SUM"
            with m.State("SUM"):
                m.d.comb += [
                    self.busy.eq(1),
                    write.en.eq(1),
                    write.addr.eq(begin + 2),
                    write.data.eq(Cat(total[8:], total[:8])),
                ]
                m.d.sync += [begin.eq(begin + HEADER + length), length.eq(0), total.eq(0), carries.eq(0)]
                m.d.sync += self.room.eq(0)  # it does not know of this datagram yet
                m.next = "IDLE"

        # -- out
        o, meta, lookup = self.o.stream, self.o.meta, self.lookup
        address, port, octets, checksum, mac = Signal(32), Signal(16), Signal(16), Signal(16), Signal(48)
        asking, found = Signal(), Signal()
        waited = Signal(range(self._patience + 1))
        at = Signal(bits)
        left, lane = Signal(bits), Signal(2)
        word = Signal(32)
        after = Signal(bits)  # where the next datagram begins
        m.d.comb += [
            read.addr.eq(at),
            lookup.valid.eq(asking),
            lookup.ip.eq(address),
            meta.mac.eq(mac),
            meta.destination.eq(address),
            meta.source_port.eq(self.source_port),
            meta.destination_port.eq(port),
            meta.length.eq(octets),
            meta.sum.eq(checksum),
        ]
        with m.If(asking):
            m.d.sync += waited.eq(waited + 1)
            with m.If(lookup.done & (lookup.found | lookup.failed | (waited == self._patience))):
                m.d.sync += [asking.eq(0), found.eq(lookup.found), mac.eq(lookup.mac)]
            with m.If(waited == self._patience):
                m.d.sync += waited.eq(waited)
        with m.FSM(name="read"):
            with m.State("IDLE"):
                m.d.sync += [at.eq(done), waited.eq(0), lane.eq(0)]
                with m.If(begin != done):
                    m.d.comb += read.addr.eq(done)
                    m.d.sync += at.eq(done + 1)
                    m.next = "ADDRESS"
            with m.State("ADDRESS"):
                m.d.sync += [address.eq(read.data), asking.eq(1), found.eq(0), at.eq(at + 1)]
                m.next = "NUMBERS"
            with m.State("NUMBERS"):
                m.d.sync += [port.eq(read.data[:16]), left.eq(read.data[16:]), at.eq(at + 1)]
                m.d.sync += octets.eq(Cat(C(0, 2), read.data[16:30]))
                m.next = "SUM"
            with m.State("SUM"):
                m.d.sync += [checksum.eq(read.data[:16]), at.eq(at + 1), after.eq(at + left)]
                m.next = "FIRST"
            with m.State("FIRST"):
                m.d.sync += word.eq(read.data)
                m.next = "SEND"
            with m.State("SEND"):
                m.d.comb += [
                    o.valid.eq(~asking & found),
                    o.payload.end.eq(left == 0),
                    o.payload.data.eq(word.word_select(lane, 8)),
                ]
                with m.If(o.valid & o.ready):
                    m.d.sync += lane.eq(lane + 1)
                    with m.If(lane == 3):
                        m.d.sync += [word.eq(read.data), at.eq(at + 1), left.eq(left - 1)]
                    with m.If(o.payload.end):
                        m.d.sync += done.eq(after)
                        m.next = "IDLE"
                with m.If(~asking & ~found):
                    m.d.comb += self.drop_unresolved.eq(1)
                    m.d.sync += done.eq(after)
                    m.next = "IDLE"
        return m
