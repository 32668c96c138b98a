"""What every node has, whatever it is linked by: a link, a stack, and its own clock domain."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from amaranth.hdl import ClockDomain, ClockSignal, DomainRenamer, Module, Value
from amaranth.lib import wiring
from amaranth.lib.cdc import ResetSynchronizer
from amaranth.lib.wiring import In, connect

from roslet.gateware.drops import DropCounters
from roslet.gateware.slip_stack import SlipStack
from roslet.gateware.stack import UdpStack
from roslet.gateware.tops.links import EthernetLink, SerialLink
from roslet.gateware.wires import expose


class LinkedNode(wiring.Component):
    """A link and the UDP stack that belongs to it; the base of nodes, which say in `_user` what uses the stack.

    `blocks`, those of the user's part whose drops are counted, by the names that these have then; `members`, the user's
    ports.

    Ports: `clk`, `rst_n`, the pins of the link, and `members`. With `counters`, two ports more: `drop_count` is how often
    something was dropped for the reason that `drop_reason` is the number of (`reasons`), a cycle later. All is in the domain
    `node`, that of `clk`, which is the node's own: whoever uses it in a larger design may have its `sync`.
    """

    def __init__(
        self,
        link: EthernetLink | SerialLink,
        stack: UdpStack | SlipStack,
        blocks: Mapping[str, Any],
        members: Mapping[str, Any],
        counters: bool = False,
    ) -> None:
        self._link, self._stack = link, stack
        self._drops = {
            f"{part}_{name.removeprefix('drop_')}".removeprefix("stack_"): getattr(block, name)
            for part, block in {link.kind: link, "stack": stack, **blocks}.items()
            for name in block.signature.members
            if name.startswith("drop_")
        }
        self._counters = DropCounters(self._drops) if counters else None
        asked = {} if self._counters is None else self._counters.signature.members
        super().__init__(
            {
                "clk": In(1),
                "rst_n": In(1),
                **{name: link.signature.members[name] for name in link.pins},
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
        m.submodules.link = link = self._link
        m.submodules.stack = stack = self._stack
        connect(m, link.rx, stack.rx)
        connect(m, stack.tx, link.tx)
        if isinstance(stack, UdpStack):
            m.d.comb += stack.enable.eq(link.up)
        expose(m, link, self, link.pins)
        self._user(m)
        if self._counters is not None:
            m.submodules.counters = counters = self._counters
            m.d.comb += [counters.drops[name].eq(signal) for name, signal in self._drops.items()]
            expose(m, counters, self, ("reason", "count"), "drop_")
        return m
