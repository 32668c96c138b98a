"""The operations of which a layout consists. Immutable records, neutral of any backend.

A message is a list of operations, carried out in order at a moving position. Nested messages that are no
arrays are flattened into the list of the message that holds them; a *path* (a tuple of field names, relative
to the message or to the element of the innermost `Sequence`) says which value an operation moves. The empty
path is the element itself.

    Run       bytes whose offsets are known: scalars, fixed numeric arrays, element counts, padding
    Text      the payload of a string; its length was in the run before
    Octets    the payload of a variable uint8 array; its count was in the run before
    Numbers   the payload of a variable numeric array; its count was in the run before
    Sequence  an array of strings or messages: a list of operations that is repeated

`align` of an operation is what has to be done at run time before it: move the position up to a multiple of
`align`, counted from the start of the message's body (in CDR: after the encapsulation header). Where the
layout could work the padding out, `align` is 1 and the padding is inside a run.
"""

from __future__ import annotations

from roslet.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Literal, TypeAlias

    from roslet.idl.records import TypeName

    Encoding: TypeAlias = Literal["ros1", "cdr"]
    Path: TypeAlias = tuple[str, ...]
    Role: TypeAlias = Literal["value", "count", "dummy"]
    Kind: TypeAlias = Literal["fixed", "bounded", "unbounded"]
    Operation: TypeAlias = "Run" | "Text" | "Octets" | "Numbers" | "Sequence"
    State: TypeAlias = tuple[int, int]
else:
    Encoding = Path = Role = Kind = Operation = State = object

ROS1: Encoding = "ros1"
CDR: Encoding = "cdr"

PRIMITIVE_SIZE = {
    "bool": 1,
    "int8": 1,
    "uint8": 1,
    "int16": 2,
    "uint16": 2,
    "int32": 4,
    "uint32": 4,
    "float32": 4,
    "int64": 8,
    "uint64": 8,
    "float64": 8,
}
"""Bytes of every fixed-size primitive; a string's length and an array's count are a uint32."""


class Slot(Record):
    """A fixed piece of a run at `offset` bytes from the run's first byte (after its alignment).

    `count` is None for a scalar, else the size of a fixed numeric array. `role` is "count" for the uint32 that precedes
    the variable operation with the same path (a string's length is in bytes, with the NUL in CDR; a wide
    string's in 16-bit units), "dummy" for the byte of 0 that CDR puts in an empty struct (its path is the
    struct's).
    """

    __slots__ = ("count", "offset", "path", "primitive", "role")
    _fields = ("offset", "primitive", "path", "count", "role")

    def __init__(
        self, offset: int, primitive: str, path: Path, count: int | None = None, role: Role = "value"
    ) -> None:
        self.offset = offset
        self.primitive = primitive
        self.path: Path = path
        self.count = count
        self.role: Role = role

    @property
    def size(self) -> int:
        """Bytes."""
        size = PRIMITIVE_SIZE[self.primitive]
        return size if self.count is None else size * self.count


class Run(Record):
    """Merged fixed pieces: `size` bytes, those between the slots are padding of value 0. At most one slot is
    a count, and it is the last one."""

    __slots__ = ("align", "size", "slots")
    _fields = ("align", "size", "slots")

    def __init__(self, align: int, size: int, slots: tuple[Slot, ...]) -> None:
        self.align = align
        self.size = size
        self.slots = slots


class Text(Record):
    """A string's bytes. UTF-8, in CDR followed by a NUL that the length counts (`terminator` is 1); `wide`:
    UTF-16 units without NUL, each in four bytes in the byte order of the stream. `bound`: bytes of UTF-8, or 16-bit units,
    without the NUL."""

    __slots__ = ("bound", "path", "terminator", "wide")
    _fields = ("path", "bound", "wide", "terminator")

    def __init__(self, path: Path, bound: int | None = None, wide: bool = False, terminator: int = 0) -> None:
        self.path: Path = path
        self.bound = bound
        self.wide = wide
        self.terminator = terminator


class Octets(Record):
    """The bytes of a bounded or unbounded uint8 array."""

    __slots__ = ("bound", "path")
    _fields = ("path", "bound")

    def __init__(self, path: Path, bound: int | None = None) -> None:
        self.path: Path = path
        self.bound = bound


class Numbers(Record):
    """The elements of a bounded or unbounded numeric or bool array. With no element there is no alignment
    either.

    `align` as in the other operations; `pad` is padding that is known to be needed if there is an element.
    """

    __slots__ = ("align", "bound", "pad", "path", "primitive")
    _fields = ("path", "primitive", "bound", "align", "pad")

    def __init__(self, path: Path, primitive: str, bound: int | None, align: int, pad: int) -> None:
        self.path: Path = path
        self.primitive = primitive
        self.bound = bound
        self.align = align
        self.pad = pad


class Sequence(Record):
    """An array of strings, messages or ROS 1 times.

    `kind` fixed: exactly `size` elements and no count in the bytes; bounded: at most `size`; unbounded: size
    is None. `element` is the element's layout; its paths start at the element. `element.minimum` is a lower
    bound at any position, fit to check a count against the bytes left.
    """

    __slots__ = ("element", "kind", "path", "size")
    _fields = ("path", "kind", "size", "element")

    def __init__(self, path: Path, kind: Kind, size: int | None, element: Layout) -> None:
        self.path: Path = path
        self.kind: Kind = kind
        self.size = size
        self.element = element


class Layout(Record):
    """The whole of a message, or of an element of a `Sequence`.

    `name` is the message's TypeName, or the primitive's name ("string", "wstring", "time", "duration") for an element
    that is no message. `structs` lists the nested values that a reader creates, outer before inner: (path,
    TypeName or "time" or "duration"). `minimum` and `maximum` are bytes of the body, exact for a message and
    lower and upper bounds at any position for an element; `maximum` is None where unbounded. The CDR
    encapsulation header is not counted.
    """

    __slots__ = ("encoding", "maximum", "minimum", "name", "operations", "structs")
    _fields = ("name", "encoding", "operations", "structs", "minimum", "maximum")

    def __init__(
        self,
        name: TypeName | str,
        encoding: Encoding,
        operations: tuple[Operation, ...],
        structs: tuple[tuple[Path, TypeName | str], ...],
        minimum: int,
        maximum: int | None,
    ) -> None:
        self.name = name
        self.encoding: Encoding = encoding
        self.operations = operations
        self.structs = structs
        self.minimum = minimum
        self.maximum = maximum

    @property
    def fixed(self) -> int | None:
        """Bytes, if every message of the type has the same size; else None."""
        return self.minimum if self.minimum == self.maximum else None
