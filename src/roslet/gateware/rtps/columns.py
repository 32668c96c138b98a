"""A ROM of which nothing has to be chosen behind block RAM, whose words come late."""

from __future__ import annotations

from collections.abc import Sequence

from amaranth.hdl import Module
from amaranth.lib import memory

BLOCK = 1 << 14
"""Bits of a block RAM, ECP5's and that of Xilinx's 7 series, without those that are for parity."""
SHALLOW = 1 << 10
"""Words of which two blocks have 36 bits."""


def rom_columns(m: Module, words: Sequence[int], width: int) -> list[memory.ReadPort]:
    """Read ports of the columns of `words`, which have `width` bits: the lowest bits first, to be read together.

    Of more than SHALLOW words each column is as narrow as one block is deep enough for: synthesis would take the fewest
    blocks, and choose from what all of them give.
    """
    depth = 1 << (len(words) - 1).bit_length()
    column = width if depth <= SHALLOW else max(1, BLOCK // depth + BLOCK // depth // 8)
    reads = []
    for low in range(0, width, column):
        bits = min(column, width - low)
        init = [word >> low & (1 << bits) - 1 for word in words]
        rom = memory.Memory(shape=bits, depth=len(words), init=init)
        m.submodules[f"rom{low}" if bits < width else "rom"] = rom
        read = rom.read_port()
        reads.append(read)
    return reads
