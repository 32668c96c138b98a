"""A ROM of which nothing has to be chosen behind block RAM, whose words come late."""

from __future__ import annotations

from collections.abc import Sequence

from amaranth.hdl import Cat, Module
from amaranth.lib import memory, wiring
from amaranth.lib.wiring import In, Out

BLOCK = 1 << 14
"""Bits of a block RAM, ECP5's and that of Xilinx's 7 series, without those that are for parity."""
SHALLOW = 1 << 10
"""Words of which two blocks have 36 bits."""


class ColumnRom(wiring.Component):
    """`words` of `width` bits. Of more than SHALLOW each column is as narrow as one block is deep enough for: synthesis
    would take the fewest blocks, and choose from what all of them give.

    Ports: `addr`, and `data`, what lies there, a cycle later if `en`.
    """

    def __init__(self, words: Sequence[int], width: int) -> None:
        self._words, self._width = words, width
        super().__init__({"addr": In(range(len(words))), "en": In(1), "data": Out(width)})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        depth = 1 << (len(self._words) - 1).bit_length()
        column = self._width if depth <= SHALLOW else max(1, BLOCK // depth + BLOCK // depth // 8)
        found = []
        for low in range(0, self._width, column):
            bits = min(column, self._width - low)
            init = [word >> low & (1 << bits) - 1 for word in self._words]
            m.submodules[f"bits{low}"] = words = memory.Memory(shape=bits, depth=len(init), init=init)
            read = words.read_port()
            m.d.comb += [read.addr.eq(self.addr), read.en.eq(self.en)]
            found.append(read.data)
        m.d.comb += self.data.eq(Cat(found))
        return m
