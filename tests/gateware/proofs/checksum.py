"""OctetSum against a naive model: 16-bit words added up in a wide register, and what is carried folded in at the end."""

from __future__ import annotations

from typing import Any

from amaranth.hdl import Assert, Cover, Module, Signal

from gateware.formal import Bug, Spec
from roslet.gateware import checksum


class SumSpec(Spec):
    """The sum is that of the words taken since the last `clear`, as RFC 1071, 1 has it."""

    module = checksum
    quick, deep = 8, 14
    bugs = (Bug("sum", "total[16])[:16]", "total[15])[:16]"),)

    def block(self) -> Any:
        return self.gates.OctetSum()

    def properties(self, m: Module) -> None:
        total, odd = Signal(24), Signal()
        with m.If(self.dut.clear):
            m.d.sync += [total.eq(0), odd.eq(0)]
        with m.Elif(self.dut.add):
            m.d.sync += odd.eq(~odd)
            with m.If(odd):
                m.d.sync += total.eq(total + self.dut.data)
            with m.Else():
                m.d.sync += total.eq(total + (self.dut.data << 8))
        once = total[:16] + total[16:]
        m.d.comb += [
            Assert(self.dut.sum == (once[:16] + once[16:])[:16], "sum"),
            Cover((self.dut.sum == 1) & (total[:16] == 0xFFFF), "carry"),
        ]


SPECS: tuple[type[Spec], ...] = (SumSpec,)
