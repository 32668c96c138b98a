"""The Amaranth layout of a message.

    bool                     1 bit
    int8 .. int64            signed(8) .. signed(64)
    uint8 .. uint64          8 .. 64 bits, unsigned; byte and char are uint8
    float32, float64         32, 64 bits: those of IEEE 754, as they are; gates do no arithmetic with them
    another message          its layout
    T[3]                     ArrayLayout(T, 3)
    string, T[], T[<=3]      StructLayout: `length`, wide enough for the bound, and `data`, an ArrayLayout as long as the
                             bound; of a string its octets (UTF-8) without a NUL

Elements of `data` behind `length` mean nothing. A message without fields has no bits.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from amaranth.hdl import Value, signed, unsigned
from amaranth.lib import data

from roslet.gen.gateware import Bounded, Bounds, Number, Plan, Struct, Vector, plan

if TYPE_CHECKING:
    from roslet.gen.gateware import Kind, Path, Shape


def plan_of(kind: Kind | Plan, bounds: Bounds | None = None) -> Plan:
    """The plan of a type, or the plan that is given. Raises what `roslet.gen.gateware.plan` does."""
    if not isinstance(kind, Plan):
        return plan(kind, bounds)
    if bounds is not None:
        raise ValueError(f"the plan of {kind.name} has its bounds already")
    return kind


def message_layout(kind: Kind | Plan, bounds: Bounds | None = None) -> data.StructLayout:
    """The layout of a ROS 2 message: by its name, its class or its plan."""
    return _layout(plan_of(kind, bounds).shape)


def _layout(shape: Shape) -> Any:
    if isinstance(shape, Number):
        return signed(shape.bits) if shape.signed else unsigned(shape.bits)
    if isinstance(shape, Struct):
        return data.StructLayout({name: _layout(field) for name, field in shape.fields})
    element = _layout(shape.element)
    if isinstance(shape, Vector):
        return data.ArrayLayout(element, shape.size)
    assert isinstance(shape, Bounded)
    return data.StructLayout(
        {"length": unsigned(shape.bound.bit_length()), "data": data.ArrayLayout(element, shape.bound)}
    )


def at_path(value: Any, path: Path) -> Value:
    """The bits at `path` of a view of a message."""
    for part in path:
        value = value[part]
    return Value.cast(value)
