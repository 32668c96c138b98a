"""Who the node is, copied from ports into its own memory before anything else happens."""

from __future__ import annotations

from collections.abc import Sequence

from amaranth.hdl import Module, Signal
from amaranth.lib import data, memory, wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.rtps.ports import WriteSignature

Store = tuple[int, int, bool]
"""An address in the memory, which word of the ports goes there, and whether it goes `name_words` words further."""


class Loader(wiring.Component):
    """Makes the stores of a program, in order, once; from when `enable` is high on.

    Ports: `index`, which word is wanted, and `word`, that word, within three cycles, and zero from the cycle
    after `done` on: it is `write.data` as it is, which is or-ed with others; `name_words`; `write`; `done`, high when
    all is written, until the next reset. A store takes 5 cycles.
    """

    def __init__(self, program: Sequence[Store], words: int, address_bits: int, name_bits: int) -> None:
        if not program:
            raise ValueError("there is nothing to load")
        self._entry = data.StructLayout({"address": address_bits, "index": range(words), "moved": 1})
        self._program = [
            {"address": address, "index": index, "moved": int(moved)} for address, index, moved in program
        ]
        super().__init__(
            {
                "enable": In(1),
                "index": Out(range(words)),
                "word": In(32),
                "name_words": In(name_bits),
                "write": Out(WriteSignature(address_bits)),
                "done": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        # Of a long one Yosys makes logic, unless told
        attrs = {"ram_style": "block"} if len(self._program) > 16 else {}
        m.submodules.program = program = memory.Memory(
            shape=self._entry, depth=len(self._program), init=self._program, attrs=attrs
        )
        read = program.read_port()
        at = Signal(range(len(self._program)))
        address = Signal.like(self.write.addr)
        entry = read.data
        m.d.comb += [read.addr.eq(at), self.index.eq(entry.index), self.write.data.eq(self.word)]
        m.d.sync += address.eq(entry.address)
        with m.If(entry.moved):
            m.d.sync += address.eq(entry.address + self.name_words)
        with m.FSM():
            with m.State("WAIT"), m.If(self.enable):
                m.next = "INDEX"
            with m.State("INDEX"):
                m.next = "WORD"
            with m.State("WORD"):
                m.next = "FOUND"
            with m.State("FOUND"):
                m.next = "WRITE"
            with m.State("WRITE"):
                m.d.comb += [self.write.en.eq(1), self.write.addr.eq(address)]
                m.d.sync += at.eq(at + 1)
                m.next = "WAIT"
                with m.If(at == len(self._program) - 1):
                    m.next = "DONE"
            with m.State("DONE"):
                m.d.comb += self.done.eq(1)
        return m
