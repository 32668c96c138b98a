"""A message's fields as ports of their own, for Verilog."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from amaranth.hdl import Cat, Module, Value, signed
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.typed.layout import message_layout, plan_of
from roslet.gen.gateware_ports import document, flat_ports

if TYPE_CHECKING:
    from roslet.gen.gateware import Bounds, Kind, Plan
    from roslet.gen.gateware_ports import Port


class Flat(wiring.Component):
    """Between flat ports and a stream of messages; wires only.

    Ports: `<prefix>_<field>` for each field (`ports`, by name; `text` documents them), `<prefix>_valid` and
    `<prefix>_ready`; and the stream: `o` of what the flat ports give, or, if `gives`, `i` of what they are to show.
    """

    def __init__(
        self, prefix: str, kind: Kind | Plan, bounds: Bounds | None = None, *, gives: bool = False
    ) -> None:
        if not prefix.isidentifier() or not prefix.isascii() or prefix.startswith("_"):
            raise ValueError(f"a prefix is a Verilog name that begins with a letter, not {prefix!r}")
        plan = plan_of(kind, bounds)
        self.prefix = prefix
        self.gives = gives
        self.ports = flat_ports(prefix, plan)
        self.text = document(prefix, plan)
        self.layout = message_layout(plan)
        shapes = {
            name: signed(port.width) if port.signed else port.width for name, port in self.ports.items()
        }
        there, back = (Out, In) if gives else (In, Out)
        super().__init__(
            {
                **{name: there(shape) for name, shape in shapes.items()},
                f"{prefix}_valid": there(1),
                f"{prefix}_ready": back(1),
                ("i" if gives else "o"): back(stream.Signature(self.layout)),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        typed = self.i if self.gives else self.o
        valid, ready = (getattr(self, f"{self.prefix}_{name}") for name in ("valid", "ready"))
        pairs = [
            (valid, typed.valid),
            *((getattr(self, name), Cat(*values(typed.payload, port))) for name, port in self.ports.items()),
        ]
        if self.gives:
            m.d.comb += [*(flat.eq(inner) for flat, inner in pairs), typed.ready.eq(ready)]
        else:
            m.d.comb += [*(inner.eq(flat) for flat, inner in pairs), ready.eq(typed.ready)]
        return m


def values(message: Any, port: Port) -> list[Value]:
    """The values of a port, in its order."""
    found = [message]
    for part in port.path:
        if part is None:
            found = [one[n] for one in found for n in range(one.shape().length)]
        else:
            found = [one[part] for one in found]
    return [Value.cast(one) for one in found]
