"""Datagrams of the user's own, through two memories of 32-bit words: the UDP memories of the manual, sections 3.8, 3.9, 5.

What has been received, in the memory of `RawUdpRx`:

    word  bits 31..24  23..16     15..8       7..0
    0     source address: d       c           b           a, for a.b.c.d
    1     length of the data      source port
    2     data: 4th    3rd        2nd         1st octet
    3     8th          7th        6th         5th, and so on; what is left of the last word is zero

What is to be sent, in the memory of `RawUdpTx`:

    word  bits 31..24  23..16     15..8       7..0
    0     destination address: d  c           b           a, for a.b.c.d
    1     source port             destination port
    2     (not looked at)         length of the data
    3     data: 4th    3rd        2nd         1st octet
    4     8th          7th        6th         5th, and so on; what is left of the last word is not looked at

Ports and lengths are numbers. A memory is written or read in the cycle in which `ce` is high, `rdata` stands in the next.
"""

from __future__ import annotations

from amaranth.hdl import C, Cat, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.meta import UDP_RX, UDP_TX, LookupSignature
from roslet.gateware.stream import FrameSignature

RX_HEADER, TX_HEADER = 2, 3
"""Words before the data."""


def data_limit(header: int, address_width: int, limit: int | None) -> int:
    """The most octets of data that a memory may hold behind `header` words: `limit`, or all that fit where that is None.

    Raises ValueError where that is not possible.
    """
    if not 2 <= address_width <= 14:  # 14: a word more would hold more than any datagram has
        raise ValueError(f"a UDP memory has an address of 2 to 14 bits, not {address_width}")
    fit = 4 * ((1 << address_width) - header)
    if limit is None:
        return fit
    if not 1 <= limit <= fit:
        raise ValueError(
            f"data of 1 to {fit} octets fit a UDP memory with an address of {address_width} bits, not {limit}"
        )
    return limit


class RawUdpRx(wiring.Component):
    """Keeps a datagram for the user in a memory. The manual, 3.9, 5.2 and Table A-1.

    Ports: `i`, the data of UDP datagrams; `port`, the one listened on; `addr`, `ce`, `we`, `wdata` write the memory, laid
    out as above; `grant` is high while the memory is the user's to read; `rel`, high for a cycle, gives it back and means
    nothing while `grant` is low.

    A datagram is taken one octet a cycle. Its first item waits for two cycles, to be judged; its end waits for three,
    in which the last word and those of the header are written, and `grant` rises in the cycle after it has been taken; a bad
    end waits for one. The memory is not touched while `grant` is high. Holds one word.

    A datagram whose end is bad is forgotten: the memory then holds some of it, and is not granted. Dropped whole, and
    counted if their end is good: `drop_port`, for another port; `drop_oversize`, more than `limit` octets (248 for the
    memory of the manual); `drop_busy`, the memory was the user's when it began.
    """

    def __init__(self, address_width: int = 6, limit: int | None = None) -> None:
        self._limit = data_limit(RX_HEADER, address_width, limit)
        super().__init__(
            {
                "i": In(FrameSignature(UDP_RX)),
                "port": In(16),
                "addr": Out(address_width),
                "ce": Out(1),
                "we": Out(1),
                "wdata": Out(32),
                "rel": In(1),
                "grant": Out(1),
                "drop_port": Out(1),
                "drop_oversize": Out(1),
                "drop_busy": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        i, meta = self.i.stream, self.i.meta
        ended = i.payload.end & ~i.payload.bad
        elsewhere, oversize = Signal(), Signal()
        m.d.sync += [
            elsewhere.eq(meta.destination_port != self.port),
            oversize.eq(meta.length > self._limit),
        ]

        word = Signal(32)
        at = Signal(2)  # of the octets of a word
        write = Signal()
        m.d.comb += [self.ce.eq(write), self.we.eq(write), self.wdata.eq(word)]
        with m.If(self.rel):
            m.d.sync += self.grant.eq(0)

        with m.FSM():
            with m.State("IDLE"):
                m.d.sync += self.addr.eq(RX_HEADER)
                with m.If(i.valid):
                    m.next = "JUDGE"
            with m.State("JUDGE"):
                m.next = "DATA"
                with m.If(self.grant | elsewhere | oversize):
                    m.next = "DROP"
            with m.State("DATA"):
                full = Signal()
                m.d.comb += [i.ready.eq(~i.payload.end), write.eq(full)]
                m.d.sync += [full.eq(0), self.addr.eq(self.addr + full)]
                with m.If(i.valid & ~i.payload.end):
                    m.d.sync += [at.eq(at + 1), full.eq(at == 3)]
                    for n in range(4):
                        with m.If(at == n):
                            m.d.sync += word.word_select(n, 8).eq(i.payload.data)
                    with m.If(at == 0):
                        m.d.sync += word[8:].eq(0)
                with m.If(i.valid & i.payload.end):
                    m.next = "LAST"
                    with m.If(i.payload.bad):
                        m.d.sync += at.eq(0)
                        m.next = "DROP"
            with m.State("LAST"):
                m.d.comb += write.eq(at != 0)
                m.d.sync += [at.eq(0), self.addr.eq(0)]
                m.next = "SOURCE"
            with m.State("SOURCE"):
                m.d.comb += [write.eq(1), self.wdata.eq(meta.source)]
                m.d.sync += self.addr.eq(1)
                m.next = "NUMBERS"
            with m.State("NUMBERS"):
                m.d.comb += [write.eq(1), self.wdata.eq(Cat(meta.source_port, meta.length)), i.ready.eq(1)]
                m.d.sync += self.grant.eq(1)
                m.next = "IDLE"
            with m.State("DROP"):
                m.d.comb += i.ready.eq(1)
                with m.If(i.valid & i.payload.end):
                    m.next = "IDLE"
                with m.If(i.valid & ended):
                    m.d.comb += [
                        self.drop_port.eq(elsewhere),
                        self.drop_oversize.eq(~elsewhere & oversize),
                        self.drop_busy.eq(~elsewhere & ~oversize),
                    ]
        return m


class RawUdpTx(wiring.Component):
    """Sends the datagram that the user has put into a memory. The manual, 3.8, 5.1 and Table A-1.

    Ports: `addr`, `ce`, `rdata` read the memory, laid out as above; `grant` is high while it is the user's to fill, as it is
    at the beginning; `rel`, high for a cycle, has it sent, and means nothing while `grant` is low; `lookup` asks for the
    hardware address; `o`, the data of the datagram.

    The memory is read while `grant` is low, and `grant` rises in the cycle after the end of the datagram has been taken.
    From `rel` to the first item of `o` it takes 9 cycles and one for each whole word of data, or until the address is found,
    for which it asks again and again from 6 cycles after `rel` on; then an octet goes out each cycle. Holds one word, and
    what is beside the datagram.

    Dropped whole, whereupon `grant` rises: `drop_oversize`, the length is more than `limit` octets (244 for the memory of
    the manual); `drop_unresolved`, nobody answers for the address.
    """

    def __init__(self, address_width: int = 6, limit: int | None = None) -> None:
        self._address_width = address_width
        self._limit = data_limit(TX_HEADER, address_width, limit)
        super().__init__(
            {
                "addr": Out(address_width),
                "ce": Out(1),
                "rdata": In(32),
                "rel": In(1),
                "grant": Out(1),
                "lookup": Out(LookupSignature()),
                "o": Out(FrameSignature(UDP_TX)),
                "drop_oversize": Out(1),
                "drop_unresolved": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        o, meta, lookup = self.o.stream, self.o.meta, self.lookup
        destination, ports, mac = Signal(32), Signal(32), Signal(48)
        length = Signal(self._address_width + 2)
        word = Signal(32)
        at = Signal(self._address_width + 2)  # octets of data before what is loaded, or sent
        at_word = at[2:]
        asking, found = Signal(), Signal()

        # The sum of words in the order of the memory is that of the words of the wire with its octets exchanged.
        total = Signal(16)
        carries = Signal(2)
        pair = (Cat(C(1, 1), word[:16]) + Cat(carries[0], word[16:]))[1:]
        added = (Cat(C(1, 1), total) + Cat(carries[1], pair[:16]))[1:]

        m.d.comb += [
            lookup.valid.eq(asking),
            lookup.ip.eq(destination),
            meta.mac.eq(mac),
            meta.destination.eq(destination),
            meta.source_port.eq(ports[16:]),
            meta.destination_port.eq(ports[:16]),
            meta.length.eq(length),
            meta.sum.eq(Cat(total[8:], total[:8])),
            o.payload.data.eq(word.word_select(at[:2], 8)),
        ]
        with m.If(asking & lookup.done & (lookup.found | lookup.failed)):
            m.d.sync += [asking.eq(0), found.eq(lookup.found), mac.eq(lookup.mac)]

        keep = Signal(4)  # of the octets that are loaded; the rest is zero
        load = Signal()
        with m.If(load):
            m.d.sync += word.eq(self.rdata)
            for n in range(4):
                with m.If(~keep[n]):
                    m.d.sync += word.word_select(n, 8).eq(0)

        with m.FSM() as fsm:
            m.d.comb += [self.grant.eq(fsm.ongoing("IDLE")), self.ce.eq(~fsm.ongoing("IDLE"))]
            with m.State("IDLE"):
                m.d.sync += [self.addr.eq(0), at.eq(0)]
                with m.If(self.rel):
                    m.next = "READ"
            with m.State("READ"):
                m.d.sync += self.addr.eq(self.addr + 1)
                m.next = "DESTINATION"
            with m.State("DESTINATION"):
                m.d.sync += [self.addr.eq(self.addr + 1), destination.eq(self.rdata)]
                m.next = "PORTS"
            with m.State("PORTS"):
                m.d.sync += [self.addr.eq(self.addr + 1), ports.eq(self.rdata)]
                m.next = "LENGTH"
            with m.State("LENGTH"):
                m.d.comb += [load.eq(1), keep.eq(0xF)]
                m.d.sync += [self.addr.eq(self.addr + 1), length.eq(self.rdata)]
                m.next = "SUM"
            with m.State("SUM"):
                # Data are loaded up to the word that is not whole, which may have none; the word before is added.
                last = at_word == length[2:]
                m.d.comb += load.eq(1)
                m.d.comb += [keep[n].eq(~last | (length[:2] > n)) for n in range(4)]
                m.d.sync += [self.addr.eq(self.addr + 1), at_word.eq(at_word + 1)]
                m.d.sync += [total.eq(added[:16]), carries.eq(Cat(pair[16], added[16]))]
                with m.If(last):
                    m.d.sync += [self.addr.eq(TX_HEADER), at.eq(0)]
                    m.next = "CARRY"
                with m.If(at_word == 0):  # the word before is that of the length
                    m.d.sync += [total.eq(0), carries.eq(0), asking.eq(1)]
                    with m.If(word[:16] > self._limit):
                        m.d.comb += self.drop_oversize.eq(1)
                        m.d.sync += asking.eq(0)
                        m.next = "IDLE"
            with m.State("CARRY"):
                # The last word is added, and twice nothing but the carries; the first word of data is loaded again.
                m.d.comb += [load.eq(1), keep.eq(Mux(at[1], 0xF, 0))]
                m.d.sync += [total.eq(added[:16]), carries.eq(Cat(pair[16], added[16])), at.eq(at + 1)]
                with m.If(at[1]):
                    m.d.sync += [self.addr.eq(self.addr + 1), at.eq(0)]
                    m.next = "SEND"
            with m.State("SEND"):
                m.d.comb += [o.valid.eq(~asking & found), o.payload.end.eq(at == length)]
                with m.If(o.valid & o.ready):
                    m.d.sync += at.eq(at + 1)
                    with m.If(at[:2] == 3):
                        m.d.comb += [load.eq(1), keep.eq(0xF)]
                        m.d.sync += self.addr.eq(self.addr + 1)
                    with m.If(o.payload.end):
                        m.next = "IDLE"
                with m.If(~asking & ~found):
                    m.d.comb += self.drop_unresolved.eq(1)
                    m.next = "IDLE"
        return m
