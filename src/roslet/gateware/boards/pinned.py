"""More inputs than a package has pins: those that hardly ever change come from a shift register instead."""

from __future__ import annotations

from amaranth.hdl import Cat, ClockDomain, ClockSignal, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In

from roslet.gateware.wires import expose


class Pinned(wiring.Component):
    """`design` with its ports, but for the inputs `names`, which are set one bit a cycle of `clk` through `settings`.

    A design with some 400 ports can so be placed and routed alone. It costs a flip-flop for each bit of these inputs, which
    are `bits`, and no LUT; in use they would be registers or constants.
    """

    def __init__(self, design: wiring.Component, names: tuple[str, ...]) -> None:
        members = design.signature.members
        for name in ("clk", *names):
            if name not in members or members[name].flow != In:
                raise ValueError(f"the design has no input {name}")
        self._design, self._names = design, names
        self.bits = sum(len(getattr(design, name)) for name in names)
        kept = {name: member for name, member in members.items() if name not in names}
        super().__init__({**kept, "settings": In(1)})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.design = design = self._design
        m.domains.settings = ClockDomain(reset_less=True, local=True)
        m.d.comb += ClockSignal("settings").eq(self.clk)
        chain = Signal(self.bits, reset_less=True)
        m.d.settings += chain.eq(Cat(self.settings, chain))
        m.d.comb += Cat(getattr(design, name) for name in self._names).eq(chain)
        expose(m, design, self, (name for name in self.signature.members if name != "settings"))
        return m
