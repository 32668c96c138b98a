"""The receive half of a MAC, in the clock of its PHY: what MII and GMII have in common. IEEE 802.3, 4.2.9, 22.2, 35.2."""

from __future__ import annotations

from amaranth.hdl import Cat, Const, Module, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware import ieee802_3
from roslet.gateware.crc import FrameCheck
from roslet.gateware.stream import OCTET, FrameSignature

REASONS = ("fcs", "rx_er", "runt", "giant", "odd", "sfd")
"""Why a frame was dropped. The bit 1 + n of `data` at a bad end stands for the nth."""


class Receiver(wiring.Component):
    """Frames out of the pins of a PHY that gives `width` bits a cycle: 4 or 8, the lower ones first.

    Ports: `rxd`, `rx_dv`, `rx_er` are the pins. `o` gives frames from the destination to the last octet of data or padding;
    it never waits: whoever takes it must always be ready.

    A frame that must be forgotten has a bad end, at which one bit of `data` says why (`REASONS`). Reasons of which `o` gives
    nothing more once they are seen: `rx_er`, an error from the PHY within a frame or its preamble; `giant`, more than 1518
    octets; `sfd`, the carrier came without a whole start frame delimiter behind any number of preamble octets (on MII at
    least a nibble). Reasons that the end of the frame shows, the first that holds being told: `odd`, half an octet at the
    end; `runt`, less than 64 octets; `fcs`. Where the first cycle after reset is within a frame, there is nothing of it.

    Latency: an octet leaves 2 cycles after the last bits of the fourth one behind it came; the end, 2 cycles after the first
    cycle without `rx_dv`. Holds 4 octets, so as not to give the FCS. One cycle without `rx_dv` between frames is enough.
    """

    def __init__(self, width: int) -> None:
        if width not in (4, 8):
            raise ValueError(f"a PHY gives 4 or 8 bits a cycle, not {width}")
        self._width = width
        super().__init__({"rxd": In(width), "rx_dv": In(1), "rx_er": In(1), "o": Out(FrameSignature())})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        width = self._width
        data, valid, error = Signal(width), Signal(init=1), Signal()
        m.d.sync += [data.eq(self.rxd), valid.eq(self.rx_dv), error.eq(self.rx_er)]

        give, item = Signal(), Signal(OCTET)
        m.d.sync += [self.o.stream.valid.eq(give), self.o.stream.payload.eq(item)]

        half: Value = Const(0)
        whole: Value = Const(1)
        octet: Value = data
        if width == 4:
            half = whole = Signal()
            lower = Signal(4)
            m.d.sync += [half.eq(~half), lower.eq(data)]
            octet = Cat(lower, data)
        taken = Signal(range(ieee802_3.MAX_SIZE + 1))
        behind = Signal(8 * ieee802_3.FCS_SIZE)
        full = taken[2:].any()  # FCS_SIZE and more
        enough = taken[6:].any()  # MIN_SIZE and more
        m.d.comb += item.data.eq(behind[:8])

        m.submodules.crc = crc = FrameCheck(width)
        m.d.comb += crc.data.eq(data)

        def end_badly(reason: str) -> None:
            m.d.comb += [give.eq(1), item.end.eq(1), item.bad.eq(1), item.data.eq(2 << REASONS.index(reason))]

        preamble = ieee802_3.PREAMBLE & ((1 << width) - 1)
        delimiter = ieee802_3.SFD >> (8 - width)
        with m.FSM(init="DROP"):
            for state in ("IDLE", "PREAMBLE"):
                with m.State(state):
                    m.d.comb += crc.clear.eq(1)
                    m.d.sync += taken.eq(0)
                    if width == 4:
                        m.d.sync += half.eq(0)
                    with m.If(~valid):
                        if state == "PREAMBLE":
                            end_badly("sfd")
                            m.next = "IDLE"
                    with m.Elif(error):
                        end_badly("rx_er")
                        m.next = "DROP"
                    with m.Elif((data == delimiter) & (state == "PREAMBLE" or width == 8)):
                        m.next = "DATA"
                    with m.Elif(data == preamble):
                        m.next = "PREAMBLE"
                    with m.Else():
                        end_badly("sfd")
                        m.next = "DROP"
            with m.State("DATA"):
                with m.If(~valid):
                    m.d.comb += [give.eq(1), item.end.eq(1)]
                    with m.If(half):
                        end_badly("odd")
                    with m.Elif(~enough):
                        end_badly("runt")
                    with m.Elif(~crc.match):
                        end_badly("fcs")
                    m.next = "IDLE"
                with m.Elif(error):
                    end_badly("rx_er")
                    m.next = "DROP"
                with m.Elif(whole):
                    m.d.sync += [taken.eq(taken + 1), behind.eq(Cat(behind[8:], octet))]
                    m.d.comb += give.eq(full)
                    with m.If(taken == ieee802_3.MAX_SIZE):
                        end_badly("giant")
                        m.next = "DROP"
            with m.State("DROP"), m.If(~valid):
                m.next = "IDLE"
        return m
