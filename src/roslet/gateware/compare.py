"""Comparisons that need no carry chain."""

from __future__ import annotations

from amaranth.hdl import Value


def below(value: Value, bound: int) -> Value:
    """Whether a value is less than a number that is small beside what it could be: nothing is in the bits above those of
    the number, and the others are less. Yosys makes a subtraction of all bits of `value < bound`."""
    low = (bound - 1).bit_length()
    least: Value = value[:low] < bound
    return (value[low:] == 0) & least
