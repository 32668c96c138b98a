"""Flat, named ports of a message, for those who write Verilog: their names, widths, and a text that says what they mean."""

from __future__ import annotations

from roslet.gen.gateware import Number, Struct, Vector
from roslet.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    from roslet.gen.gateware import Plan, Shape

    Places: TypeAlias = tuple[str | None, ...]

LENGTH = "length"
ITEM = "item"


class Port(Record):
    """A port, for the value or the values at `path`, in which a None stands for every element of an array.

    There are `count` values of `width // count` bits each, the first in the lowest bits, the last index running fastest.
    `signed` is whether the port, of one value, is signed. `field` is the path as a definition has it: `poses[].position.x`.
    """

    __slots__ = ("count", "field", "meaning", "path", "signed", "width")
    _fields = ("path", "width", "signed", "count", "meaning", "field")

    def __init__(self, path: Places, width: int, signed: bool, count: int, meaning: str, field: str) -> None:
        self.path = path
        self.width = width
        self.signed = signed
        self.count = count
        self.meaning = meaning
        self.field = field


def flat_ports(prefix: str, plan: Plan) -> dict[str, Port]:
    """The ports of a message by name, in the order of its fields.

    A field is `<prefix>_<path>`, its parts joined by `_`; of an array, all elements. Of a string it is the octets, and of a
    sequence the elements; `<prefix>_<path>_length` is how many there are. Of an array of messages there is a port for each
    field of the message, with those of all elements; of an array of strings `<prefix>_<path>_item_length` has the lengths
    of the strings. A name that is there already gets a `_` behind it.
    """
    ports: dict[str, Port] = {}

    def add(name: str, path: Places, number: Number, count: int, meaning: str, field: str) -> None:
        while name in ports or name in (f"{prefix}_valid", f"{prefix}_ready"):
            name += "_"
        ports[name] = Port(path, number.bits * count, number.signed and count == 1, count, meaning, field)

    def walk(shape: Shape, name: str, path: Places, count: int, length: str, field: str) -> None:
        if isinstance(shape, Number):
            many = "" if count == 1 else f"[{count}]"
            add(name, path, shape, count, shape.primitive + many, field)
        elif isinstance(shape, Struct):
            for part, inner in shape.fields:
                walk(inner, f"{name}_{part}", (*path, part), count, LENGTH, f"{field}.{part}".lstrip("."))
        elif isinstance(shape, Vector):
            walk(shape.element, name, (*path, None), count * shape.size, f"{ITEM}_{LENGTH}", field + "[]")
        else:
            elements = count * shape.bound
            data = (*path, "data", None)
            number = Number("uint32", shape.bound.bit_length(), False)
            if shape.text:
                add(name, data, Number("uint8", 8, False), elements, f"octets[{elements}] of string", field)
            else:
                walk(shape.element, name, data, elements, f"{ITEM}_{LENGTH}", field + "[]")
            what = "its octets" if shape.text else "elements"
            add(f"{name}_{length}", (*path, "length"), number, count, f"{what}, at most {shape.bound}", field)

    walk(plan.shape, prefix, (), 1, LENGTH, "")
    return ports


def document(prefix: str, plan: Plan) -> str:
    """Lines of a Verilog comment that say what the ports are: name, bits, meaning, and path in the definition."""
    ports = flat_ports(prefix, plan)
    rows = [("port", "bits", "meaning", "field")]
    for name, port in ports.items():
        rows.append((name, str(port.width), port.meaning, port.field))
    rows.append((f"{prefix}_valid", "1", "there is a message", ""))
    rows.append((f"{prefix}_ready", "1", "it is taken at this clock edge, if valid", ""))
    widths = [max(len(row[column]) for row in rows) for column in range(3)]
    lines = [f"// {prefix}: {plan.name}, at most {plan.maximum} octets"]
    for row in rows:
        cells = [cell.ljust(width) for cell, width in zip(row, widths)]  # noqa: B905 - the last has no width
        lines.append("// " + "  ".join([*cells, row[3]]).rstrip())
    lines.append(
        "// Of several values in a port the first is in the lowest bits; floats are the bits of IEEE 754;"
    )
    lines.append("// what is behind a length means nothing.")
    return "\n".join(lines) + "\n"
