"""The transmit half of a MAC, in the clock of its PHY: what MII and GMII have in common. IEEE 802.3, 4.2.8, 22.2, 35.2."""

from __future__ import annotations

from amaranth.hdl import Const, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware import ieee802_3
from roslet.gateware.crc import FrameCheck
from roslet.gateware.stream import FrameSignature

MIN_OCTETS = ieee802_3.MIN_SIZE - ieee802_3.FCS_SIZE
MAX_OCTETS = ieee802_3.MAX_SIZE - ieee802_3.FCS_SIZE


class Transmitter(wiring.Component):
    """Frames onto the pins of a PHY that takes `width` bits a cycle: 4 or 8, the lower ones first.

    Ports: `i` takes frames from the destination on; they are padded with zeros to 60 octets and get preamble and FCS. `txd`,
    `tx_en`, `tx_er` are the pins. `drop_underrun` and `drop_giant` are high for one cycle each.

    A frame begins when its first octet is valid and 96 bit times have passed since the last one: no sooner, and no later.
    From then on it cannot wait: the first octet is taken at the end of the preamble's 8 octets, another one or the end every
    8 / `width` cycles. Where there is none (`drop_underrun`), or one more than 1514 (`drop_giant`), or a bad end, the frame
    is spoilt: it stops at once, the complement of the right FCS follows, with `tx_er`, and what is still to come of it is
    taken and forgotten before the gap. Frames without any octets are nothing. There is no half duplex: the pins of carrier
    and collision are not looked at.

    Latency from the first valid octet to the preamble's first bits: 2 cycles. Holds one octet.
    """

    def __init__(self, width: int) -> None:
        if width not in (4, 8):
            raise ValueError(f"a PHY takes 4 or 8 bits a cycle, not {width}")
        self._width = width
        super().__init__(
            {
                "i": In(FrameSignature()),
                "txd": Out(width),
                "tx_en": Out(1),
                "tx_er": Out(1),
                "drop_underrun": Out(1),
                "drop_giant": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        width, i = self._width, self.i.stream
        octet = Signal(8)
        done: Value = Const(1)  # the last bits of the octet are going out
        if width == 4:
            done = Signal()
            m.d.sync += [done.eq(~done), octet.eq(octet >> 4)]

        sending, checking, spoilt = Signal(), Signal(), Signal()
        m.submodules.crc = crc = FrameCheck(width)
        m.d.comb += crc.data.eq(Mux(checking, ~crc.fcs[:width], octet[:width]))
        m.d.sync += [
            self.tx_en.eq(sending),
            self.tx_er.eq(checking & spoilt),
            self.txd.eq(Mux(checking, crc.fcs[:width] ^ spoilt.replicate(width), octet[:width])),
        ]

        count = Signal(range(MAX_OCTETS))  # of octets in this state, but over DATA and PAD together
        short = Signal()  # padding is needed, if this octet was the last one
        remains = Signal()  # of a spoilt frame
        with m.If(done):
            m.d.sync += count.eq(count + 1)
        filled = count[:6] == MIN_OCTETS - 1

        def begin(state: str) -> None:
            m.d.sync += count.eq(0)
            m.next = state

        with m.FSM():
            with m.State("WAIT"):
                m.d.comb += [crc.clear.eq(1), i.ready.eq(i.payload.end)]
                m.d.sync += [
                    count.eq(0),
                    octet.eq(ieee802_3.PREAMBLE),
                    short.eq(1),
                    spoilt.eq(0),
                    remains.eq(0),
                ]
                if width == 4:
                    m.d.sync += done.eq(0)
                with m.If(i.valid & ~i.payload.end):
                    m.next = "PREAMBLE"
            with m.State("PREAMBLE"):
                m.d.comb += [sending.eq(1), crc.clear.eq(1)]
                with m.If(done):
                    m.d.sync += octet.eq(ieee802_3.PREAMBLE)
                    with m.If(count[:3] == ieee802_3.PREAMBLE_SIZE - 1):
                        m.d.sync += octet.eq(ieee802_3.SFD)
                        m.next = "SFD"
            with m.State("SFD"):
                m.d.comb += [sending.eq(1), crc.clear.eq(1)]
                with m.If(done):
                    m.d.comb += i.ready.eq(1)
                    m.d.sync += octet.eq(i.payload.data)
                    begin("DATA")
            with m.State("DATA"):
                m.d.comb += sending.eq(1)
                with m.If(done):
                    m.d.comb += i.ready.eq(1)
                    m.d.sync += octet.eq(i.payload.data)
                    with m.If(filled):
                        m.d.sync += short.eq(0)
                    with m.If(~i.valid):
                        m.d.comb += self.drop_underrun.eq(1)
                        m.d.sync += [spoilt.eq(1), remains.eq(1)]
                        begin("FCS")
                    with m.Elif(i.payload.end):
                        m.d.sync += [octet.eq(0), spoilt.eq(i.payload.bad)]
                        with m.If(short & ~filled & ~i.payload.bad):
                            m.next = "PAD"
                        with m.Else():
                            begin("FCS")
                    with m.Elif(count == MAX_OCTETS - 1):
                        m.d.comb += self.drop_giant.eq(1)
                        m.d.sync += [spoilt.eq(1), remains.eq(1)]
                        begin("FCS")
            with m.State("PAD"):
                m.d.comb += sending.eq(1)
                with m.If(done & filled):
                    begin("FCS")
            with m.State("FCS"):
                m.d.comb += [sending.eq(1), checking.eq(1)]
                with m.If(done & (count[:2] == ieee802_3.FCS_SIZE - 1)):
                    begin("GAP")
                    with m.If(remains):
                        m.next = "DROP"
            with m.State("DROP"):
                m.d.comb += i.ready.eq(1)
                with m.If(i.valid & i.payload.end):
                    begin("GAP")
            # WAIT takes the last cycle of the gap: of GMII's an octet, of MII's half of one
            with m.State("GAP"), m.If(count[:4] == ieee802_3.GAP_SIZE - (2 if width == 8 else 1)):
                m.next = "WAIT"
        return m
