"""SerialSum against a naive model: 16-bit words added up in a wide register, and what is carried folded in at the end."""

from __future__ import annotations

from typing import Any

from amaranth.hdl import Assert, Cover, Module, Mux, Signal

from gateware.formal import Bug, Spec
from roslet.gateware import checksum


class SumSpec(Spec):
    """What is said of the sum is so of the words taken since the last `clear`, as RFC 1071, 1 has them."""

    module = checksum
    quick, deep = 7, 9
    bugs = (
        Bug("right", "(turn[0] ^ carry)", "turn[0]"),
        Bug("result", "self.result.eq(turn + carry)", "self.result.eq(turn)"),
    )

    def block(self) -> Any:
        return self.gates.SerialSum()

    def properties(self, m: Module) -> None:
        dut = self.dut
        total, odd, full = Signal(24), Signal(), Signal()
        with m.If(dut.clear):
            m.d.sync += [total.eq(0), odd.eq(0), full.eq(0)]
        with m.Elif(dut.add):
            m.d.sync += [
                odd.eq(~odd),
                total.eq(total + Mux(odd, dut.data, dut.data << 8)),
                full.eq(dut.data == 0xFF),
            ]
        once = total[:16] + total[16:]
        folded = (once[:16] + once[16:])[:16]
        m.d.comb += [
            Assert(dut.right == (folded == 0xFFFF), "right"),
            Assert(odd | full | (dut.result == folded[8:]), "result"),
            Cover(dut.right & (total[16:] != 0), "carry"),
        ]


SPECS: tuple[type[Spec], ...] = (SumSpec,)
