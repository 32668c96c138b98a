"""What the spelling of a serialiser (`python_write`) and of a deserialiser (`python_read`) have in common.

One `struct` call a run, and one for a run, a short string and the run behind it: there is a format for each
length that occurs, kept in a table. Nested messages are inlined; an array of strings or messages is a loop.
Positions are kept as a variable and a constant, so that consecutive runs and payloads cost one addition. All
names that start with an underscore are globals of the generated code (`globals_` says how each is made);
locals have none.

What can go wrong raises one of `primitives.FAILURES` and the whole message is done again by the field table,
which knows exactly what is wrong. In particular a deserialiser does not check every string: what runs past
the end fails at the next run or at the comparison with the end. It checks every count that drives a loop.
"""

from __future__ import annotations

from roslet.gen.python_names import Locals, class_reference
from roslet.layout import CDR, Numbers, Octets, Run, Sequence
from roslet.wire.cursor import SMALL_OCTETS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator

    from roslet.layout import Layout, Slot
    from roslet.layout.operations import Operation

# The encapsulation header of little-endian CDR without options, 00 01 00 00, as a little-endian number.
ENCAPSULATION = 256

SHORT_TEXT = 128
"""Bytes below which a string is written and read in the same `struct` call as what stands behind it."""


def has_views(operations: tuple[Operation, ...]) -> bool:
    """Whether a message read with these operations may hold views on the buffer."""
    for operation in operations:
        if isinstance(operation, (Octets, Numbers)):
            return True
        if isinstance(operation, Sequence) and has_views(operation.element.operations):
            return True
        if isinstance(operation, Run) and any(map(is_view, operation.slots)):
            return True
    return False


def is_view(slot: Slot) -> bool:
    return slot.count is not None and not is_bytes(slot)


def is_bytes(slot: Slot) -> bool:
    """A fixed uint8 array that is read as bytes."""
    return slot.primitive == "uint8" and slot.count is not None and slot.count <= SMALL_OCTETS


def plus(variable: str, constant: int) -> str:
    return "%s + %d" % (variable, constant) if constant else variable


class Form:
    """A struct format under construction; runs of one code are merged."""

    def __init__(self) -> None:
        self.parts: list[tuple[int, str]] = []
        self.end = 0

    def add(self, code: str, size: int) -> None:
        if self.parts and self.parts[-1][1] == code and code not in "s":
            self.parts[-1] = (self.parts[-1][0] + 1, code)
        else:
            self.parts.append((1, code))
        self.end += size

    def text(self, size: int) -> None:
        self.parts.append((size, "s"))
        self.end += size

    def pad_to(self, offset: int) -> None:
        if offset > self.end:
            if self.parts and self.parts[-1][1] == "x":
                self.parts[-1] = (self.parts[-1][0] + offset - self.end, "x")
            else:
                self.parts.append((offset - self.end, "x"))
            self.end = offset

    def codes(self) -> str:
        """The format without its byte order."""
        return "".join(["%d%s" % part if part[0] != 1 or part[1] == "s" else part[1] for part in self.parts])

    def __str__(self) -> str:
        return "<" + self.codes()


class Codec:
    """What both directions share: names, the position, nested values."""

    prefix = ""

    def __init__(self, layout: Layout) -> None:
        self.layout = layout
        self.cdr = layout.encoding == CDR
        self.locals = Locals()
        self.globals_: dict[str, str] = {}
        self.references: dict[str, object] = {}
        self.made: dict[str, str] = {}
        self.variable = ""
        self.constant = 0
        self.uses_base = False

    def position(self, more: int = 0) -> str:
        return plus(self.variable, self.constant + more)

    def settle(self, name: str = "o") -> Iterator[str]:
        """Bring the position into the variable `name`."""
        if self.variable != name or self.constant:
            if self.variable == name:
                yield "%s += %d" % (name, self.constant)
            else:
                yield "%s = %s" % (name, self.position())
            self.variable, self.constant = name, 0

    def need(self, name: str, expression: str) -> str:
        """A global made by `expression`."""
        self.globals_[name] = expression
        return name

    def struct(self, maker: str, *arguments: object) -> str:
        """A global with a packer or unpacker, or a table of them."""
        shown = ['"%s"' % one if isinstance(one, str) else str(one) for one in arguments]
        expression = "%s(%s)" % (maker, ", ".join(shown))
        name = self.made.get(expression)
        if name is None:
            name = self.made[expression] = self.need("_%s%d" % (self.prefix, len(self.made)), expression)
        return name

    def numbers(self, primitive: str, what: str) -> str:
        """A global that is an attribute of the primitive's array type."""
        return self.need("_%s_%s" % (primitive, what), '_numbers("%s").%s' % (primitive, what))

    def reference(self, name: object) -> str:
        text = class_reference(name)  # type: ignore[arg-type]
        self.references[text] = name
        return text
