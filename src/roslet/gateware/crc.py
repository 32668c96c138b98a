"""The frame check sequence of Ethernet. IEEE 802.3, 3.2.9; CRC-32/ISO-HDLC in the catalogue of such algorithms."""

from __future__ import annotations

from amaranth.hdl import Cat, Const, Module, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

POLYNOMIAL = 0xEDB88320  # the generator of 3.2.9, its highest power in the lowest bit, as bits are sent
RESIDUE = 0x2144DF1C  # `fcs` after a frame and its right sequence


class FrameCheck(wiring.Component):
    """Computes the sequence from `width` bits a cycle, the lower ones being the first on the wire.

    Ports: with `clear` high it begins anew; else it takes `data`. `fcs` is the sequence over what was taken in the cycles
    before, its lowest bits to be sent first; `match`, whether that was a frame with its right sequence behind it. Fed with
    `~fcs[:width]`, `fcs` shifts down by `width`: so it can be sent from where it is.
    """

    def __init__(self, width: int) -> None:
        if not 1 <= width <= 8:
            raise ValueError(f"frames are checked in pieces of 1 to 8 bits, not {width}")
        self._width = width
        super().__init__({"clear": In(1), "data": In(width), "fcs": Out(32), "match": Out(1)})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        bits: list[Value] = [~bit for bit in self.fcs]
        for n in range(self._width):
            fed = bits[0] ^ self.data[n]
            bits = [
                bit ^ fed if POLYNOMIAL >> at & 1 else bit for at, bit in enumerate([*bits[1:], Const(0)])
            ]
        m.d.sync += self.fcs.eq(~Cat(bits))
        with m.If(self.clear):
            m.d.sync += self.fcs.eq(0)
        m.d.comb += self.match.eq(self.fcs == RESIDUE)
        return m
