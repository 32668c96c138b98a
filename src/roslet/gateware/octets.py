"""Octets picked out of wide registers, one at a time."""

from __future__ import annotations

from collections.abc import Sequence

from amaranth.hdl import Mux, Value


def octets(value: Value) -> list[Value]:
    """The octets of a value, the lowest bits first."""
    return [value[n : n + 8] for n in range(0, len(value), 8)]


def pick(values: Sequence[Value], index: Value) -> Value:
    """`values[index]`; behind the last one, some of them.

    A tree of two-way multiplexers, by the lowest bit of the index first: `Array` makes of it a comparison of the index with
    each number, and Yosys half as many LUTs again.
    """
    rows = list(values)
    for bit in index:
        if len(rows) % 2:
            rows.append(rows[-1])
        rows = [Mux(bit, odd, even) for even, odd in zip(rows[::2], rows[1::2], strict=True)]
    return rows[0]
