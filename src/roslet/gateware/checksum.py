"""The checksum of the Internet protocols. RFC 1071."""

from __future__ import annotations

from amaranth.hdl import C, Cat, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out


class SerialSum(wiring.Component):
    """Sums octets as 16-bit words in the order of the wire, by an adder of 8 bits; an odd last one is the upper half of its
    word. The two halves of the sum take turns at the adder; a carry out of either belongs to the other, which is next.

    Ports: `clear` begins anew (it wins over `add`); with `add` the octet `data` is taken, in that cycle. All that is said of
    the sum is of what was taken until the cycle before; it is not complemented: 0xFFFF over data with a right checksum in
    it. `result` is the half that the next octet goes to. `right`: the sum is 0xFFFF, be the number of octets odd or even.

    To spell the sum of an even number of octets, add two octets of 0: as each is, `result` gives a half, the upper first,
    where the last octet before them was not 0xFF (else the lower may carry into the upper, which is out).
    """

    def __init__(self) -> None:
        super().__init__(
            {
                "clear": In(1),
                "add": In(1),
                "data": In(8),
                "result": Out(8),
                "right": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        turn, other = Signal(8), Signal(8)
        carry = Signal()
        total = Signal(9)
        m.d.comb += [
            total.eq((Cat(C(1, 1), turn) + Cat(carry, self.data))[1:]),
            self.result.eq(turn + carry),
            self.right.eq(other.all() & turn[1:].all() & (turn[0] ^ carry)),
        ]
        with m.If(self.clear):
            m.d.sync += [turn.eq(0), other.eq(0), carry.eq(0)]
        with m.Elif(self.add):
            m.d.sync += [turn.eq(other), other.eq(total[:8]), carry.eq(total[8])]
        return m
