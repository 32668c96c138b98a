"""Block RAM that spoils what it reads while it is written, for simulated designs.

Amaranth promises the old word; block RAM of an FPGA promises nothing, and `toolchain.free_collisions` tells Yosys that the
designs need nothing. With this platform a design that does use such a word gets a wrong one, in every test of the suite.
"""

from __future__ import annotations

from typing import Any

from amaranth.hdl import Cat, MemoryInstance, Module, Mux, Shape, Signal, Value
from amaranth.lib import memory


class SpoiledCollisions:
    """A platform whose synchronous read ports give the complement of a word that is written at the same edge of their
    clock, but for ports that are `transparent_for` the writing one."""

    def get_memory(self, stored: memory.Memory) -> Any:
        """What Amaranth asks a platform for in place of its own memory."""
        m = Module()
        m.submodules.instance = instance = MemoryInstance(
            data=stored.data, attrs=stored.attrs, src_loc=stored.src_loc
        )
        written = {
            port: instance.write_port(
                domain=port.domain, addr=port.addr, data=Value.cast(port.data), en=port.en
            )
            for port in stored.write_ports
        }
        for port in stored.read_ports:
            word = Signal(Shape.cast(stored.shape))
            seen = tuple(written[one] for one in port.transparent_for)
            instance.read_port(
                domain=port.domain, data=word, addr=port.addr, en=port.en, transparent_for=seen
            )
            rivals = [
                one
                for one in stored.write_ports
                if one.domain == port.domain and one not in port.transparent_for
            ]
            if not rivals:
                m.d.comb += Value.cast(port.data).eq(word)
                continue
            spoiled = Signal(reset_less=True)
            with m.If(port.en):
                m.d[port.domain] += spoiled.eq(
                    Cat(one.en.any() & (one.addr == port.addr) for one in rivals).any()
                )
            m.d.comb += Value.cast(port.data).eq(Mux(spoiled, ~word, word))
        return m
