"""How Python spells the names of a definition."""

from __future__ import annotations

from keyword import kwlist

TYPE_CHECKING = False
if TYPE_CHECKING:
    from roslet.idl.records import TypeName

# Names that a field may not have as they are: Python's keywords, the methods of
# `roslet.wire.message.Message`, and the first parameter of a method.
RESERVED = frozenset(
    [
        *kwlist,
        "copy",
        "deserialize",
        "deserialize_from",
        "self",
        "serialize",
        "serialize_into",
        "serialized_size",
    ]
)


def attribute(name: str) -> str:
    """A field's attribute: its name, with an underscore behind it where the name is reserved."""
    return name + "_" if name in RESERVED else name


def class_reference(name: TypeName | str) -> str:
    """The global name under which generated code knows a nested class."""
    if isinstance(name, str):
        return {"time": "_Time", "duration": "_Duration"}[name]
    return "_%s_%s" % (name.package, name.name)


class Locals:
    """Unique names for a function's local variables."""

    def __init__(self) -> None:
        self.used = set(RESERVED)
        self.used.update(["buffer", "offset", "parts", "cls", "start", "end", "base", "error", "message"])
        self.used.update(["o", "e", "n", "p", "m", "raw", "data", "kind"])
        self.used.update(
            ["len", "range", "type", "str", "bytes", "ValueError", "int", "list", "True", "False"]
        )

    def name(self, wish: str) -> str:
        """`wish`, or `wish` with a number behind it if it is taken."""
        name = wish
        number = 1
        while name in self.used:
            number += 1
            name = "%s%d" % (wish, number)
        self.used.add(name)
        return name
