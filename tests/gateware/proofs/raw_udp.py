"""The handshakes of the UDP memories: nobody touches a memory that is the other's, and it changes hands when it should."""

from __future__ import annotations

from typing import Any

from amaranth.hdl import Assert, Cover, Module, Signal

from gateware.formal import Bug, Spec, assume_steady
from roslet.gateware import raw_udp

SENT = "with m.If(o.valid & o.ready):\n                    m.d.sync += at.eq(at + 1)"
LAST = 'with m.If(o.payload.end):\n                        m.next = "IDLE"'


class _Handshake(Spec):
    """`mine`: the memory is not touched while it is the user's. `kept`: which it is until the user gives it back."""

    module = raw_udp

    def handshake(self, m: Module) -> Signal:
        """Their properties; high in the first cycle in which the memory is the user's again."""
        grant, before, rel = self.dut.grant, Signal(), Signal()
        later, granted = Signal(), Signal()
        m.d.sync += [before.eq(grant), rel.eq(self.dut.rel), later.eq(1)]
        m.d.comb += [
            granted.eq(later & grant & ~before),
            Assert(~(self.dut.ce & grant), "mine"),
            Assert(grant | ~later | ~before | rel, "kept"),
        ]
        return granted


class RawUdpRxSpec(_Handshake):
    """And `earned`: the user gets the memory behind the good end of a datagram, and at no other time."""

    quick, deep = 20, 40
    bugs = (
        Bug("mine", "with m.If(self.grant | elsewhere", "with m.If(elsewhere"),
        Bug(
            "kept",
            "with m.If(self.rel):\n            m.d.sync += self.grant",
            "with m.If(1):\n            m.d.sync += self.grant",
        ),
        Bug(
            "earned", 'm.d.sync += at.eq(0)\n                        m.next = "DROP"', "m.d.sync += at.eq(0)"
        ),
    )

    def block(self) -> Any:
        return self.gates.RawUdpRx(2)

    def properties(self, m: Module) -> None:
        rules = self.assume(m, "i")
        assume_steady(m, self.dut.port)
        granted = self.handshake(m)
        good, twice = Signal(), Signal()
        m.d.sync += [good.eq(rules.ended & ~self.dut.i.stream.payload.bad), twice.eq(twice | granted)]
        m.d.comb += [Assert(good | ~granted, "earned"), Cover(granted & twice, "twice")]


class RawUdpTxSpec(_Handshake):
    """And `sent`: the user gets the memory back when its datagram has gone out or was dropped, and not before."""

    quick, deep = 24, 40
    bugs = (
        Bug("mine", 'self.ce.eq(~fsm.ongoing("IDLE"))', "self.ce.eq(1)"),
        Bug(
            "kept",
            'with m.If(self.rel):\n                    m.next = "READ"',
            'with m.If(1):\n                    m.next = "READ"',
        ),
        Bug("sent", LAST, LAST.replace("o.payload.end", "1")),
        Bug("o.steady", SENT, SENT.replace(" & o.ready", "")),
        Bug(
            "o.bad_only_at_end",
            "lookup.valid.eq(asking),",
            "lookup.valid.eq(asking), o.payload.bad.eq(word[0]),",
        ),
        Bug("o.meta_steady", "meta.length.eq(length)", "meta.length.eq(at)"),
    )

    def block(self) -> Any:
        return self.gates.RawUdpTx(2)

    def properties(self, m: Module) -> None:
        rules = self.check(m, "o")
        granted = self.handshake(m)
        over = Signal()
        m.d.sync += over.eq(rules.ended | self.dut.drop_oversize | self.dut.drop_unresolved)
        m.d.comb += Assert(over | ~granted, "sent")


SPECS: tuple[type[Spec], ...] = (RawUdpRxSpec, RawUdpTxSpec)
