"""Comparisons that need no carry chain."""

from __future__ import annotations

from amaranth.hdl import C, Value


def below(value: Value, bound: int) -> Value:
    """Whether a value is less than a number that is small beside what it could be: nothing is in the bits above those of
    the number, and the others are less. Yosys makes a subtraction of all bits of `value < bound`."""
    low = (bound - 1).bit_length()
    least: Value = value[:low] < bound
    return (value[low:] == 0) & least


def above(value: Value, bound: int) -> Value:
    """Whether a value is more than a number: bit by bit, from the lowest on."""
    result: Value = C(0)
    for place, bit in enumerate(value):
        result = bit & result if bound >> place & 1 else bit | result
    return result
