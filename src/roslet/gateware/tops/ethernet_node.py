"""What every node on Ethernet has: a MAC, a stack, and what is between them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from amaranth.hdl import ClockDomain, ClockSignal, DomainRenamer, Module, Value
from amaranth.lib import wiring
from amaranth.lib.cdc import ResetSynchronizer
from amaranth.lib.wiring import In, Out, connect

from roslet.gateware.drops import DropCounters
from roslet.gateware.fifo import FrameFifo
from roslet.gateware.mac import Mac, PhyReset, phy_clock
from roslet.gateware.stack import UdpStack
from roslet.gateware.wires import expose

PHY_RESET = 10e-6
"""Seconds. PHYs ask for 1 us (DP83848) or less."""


class EthernetNode(wiring.Component):
    """A MAC and a UDP stack, with queues of `rx_depth` and `tx_depth` between them; the base of nodes, which say in `_user`
    what uses the stack.

    `clk_hz`, by which the reset of the PHY is counted; `blocks`, those of the user's part whose drops are counted, by the
    names that these have then; `members`, the user's ports.

    Ports: `clk`, `rst_n`, those of the PHY, and `members`. With `counters`, two ports more: `drop_count` is how often
    something was dropped for the reason that `drop_reason` is the number of (`reasons`), a cycle later. All is in the domain
    `node`, that of `clk`, which is the node's own: whoever uses it in a larger design may have its `sync`.
    """

    def __init__(
        self,
        mac: Mac,
        stack: UdpStack,
        clk_hz: float,
        blocks: Mapping[str, Any],
        members: Mapping[str, Any],
        counters: bool = False,
        rx_depth: int = 2048,
        tx_depth: int = 2,
    ) -> None:
        self._mac, self._stack = mac, stack
        self._phy_reset = max(1, round(PHY_RESET * clk_hz))
        self._depths = rx_depth, tx_depth
        self._drops = {
            f"{part}_{name.removeprefix('drop_')}".removeprefix("stack_"): getattr(block, name)
            for part, block in {"mac": mac, "stack": stack, **blocks}.items()
            for name in block.signature.members
            if name.startswith("drop_")
        }
        self._counters = DropCounters(self._drops) if counters else None
        asked = {} if self._counters is None else self._counters.signature.members
        super().__init__(
            {
                "clk": In(1),
                "rst_n": In(1),
                "phy_rx_clk": In(1),
                "phy_tx_clk": In(1),
                **mac.pins.signature.members,
                "phy_rst_n": Out(1),
                **members,
                **{f"drop_{name}": asked[name] for name in ("reason", "count") if name in asked},
            }
        )

    @property
    def reasons(self) -> dict[str, int]:
        """The numbers of what is dropped; empty without counters."""
        return {} if self._counters is None else self._counters.numbers

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.domains.node = ClockDomain(local=True)
        m.d.comb += ClockSignal("node").eq(self.clk)
        m.submodules.reset = ResetSynchronizer(self._reset(), domain="node")
        m.submodules.node = DomainRenamer("node")(self._node())
        return m

    def _reset(self) -> Value:
        """When all of it is in reset."""
        reset: Value = ~self.rst_n
        return reset

    def _user(self, m: Module) -> None:
        """What uses the stack."""
        raise NotImplementedError

    def _node(self) -> Module:
        m = Module()
        phy_clock(m, "phy_rx", self.phy_rx_clk)
        phy_clock(m, "phy_tx", self.phy_tx_clk)
        m.submodules.phy_reset = phy_reset = PhyReset(self._phy_reset)
        m.submodules.mac = mac = self._mac
        m.submodules.stack = stack = self._stack
        rx_depth, tx_depth = self._depths
        m.submodules.rx_queue = rx_queue = FrameFifo(rx_depth)
        m.submodules.tx_queue = tx_queue = FrameFifo(tx_depth)
        connect(m, mac.rx, rx_queue.i)
        connect(m, rx_queue.o, stack.rx)
        connect(m, stack.tx, tx_queue.i)
        connect(m, tx_queue.o, mac.tx)
        m.d.comb += [self.phy_rst_n.eq(phy_reset.phy_rst_n), stack.enable.eq(self.phy_rst_n)]
        expose(m, mac.pins, self)
        self._user(m)
        if self._counters is not None:
            m.submodules.counters = counters = self._counters
            m.d.comb += [counters.drops[name].eq(signal) for name, signal in self._drops.items()]
            expose(m, counters, self, ("reason", "count"), "drop_")
        return m
