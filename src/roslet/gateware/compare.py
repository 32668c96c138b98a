"""Comparisons that need no carry chain."""

from __future__ import annotations

from amaranth.hdl import C, Cat, Value


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


def by_pairs(one: Value, other: Value) -> Value:
    """Which two bits are the same in two numbers, and the two next, and so on. Each takes one LUT4 where it has a register;
    of the comparison of all Yosys makes up to twice the LUTs."""
    return Cat(one[n : n + 2] == other[n : n + 2] for n in range(0, len(one), 2))
