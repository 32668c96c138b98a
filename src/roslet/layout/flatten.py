"""The layout pass: definition records to operations, following alignment as far as it can be known.

What is known of a position is a pair (modulus, residue): the position is `residue` modulo `modulus`. It
starts as (8, 0); a string makes it (1, 0); an alignment at run time makes it (n, 0); a loop keeps what holds
before and after its body. ROS 1 aligns nothing, which is the same pass with a largest alignment of 1.
"""

from __future__ import annotations

from roslet.layout.operations import (
    CDR,
    PRIMITIVE_SIZE,
    Layout,
    Numbers,
    Octets,
    Run,
    Sequence,
    Slot,
    Text,
)
from roslet.layout.sizes import PERIOD, element_sizes, message_sizes

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable

    from roslet.idl.records import FieldType, Message, TypeName
    from roslet.layout.operations import Encoding, Operation, Path, Role, State


def layout(message: Message, resolve: Callable[[TypeName], Message], encoding: Encoding) -> Layout:
    """The layout of `message` in `encoding` ("ros1" or "cdr", which is XCDR version 1 of either byte order).

    `resolve` gives the definition of a nested type; the types must not be recursive (`idl.Registry` sees to
    that).
    """
    flatten = _Flatten(resolve, encoding, (PERIOD, 0))
    flatten.message(message, ())
    operations = flatten.finish()
    minimum, maximum = message_sizes(operations)
    return Layout(message.name, encoding, operations, tuple(flatten.structs), minimum, maximum)


def join(one: State, other: State) -> State:
    """What is known of a position of which either `one` or `other` holds."""
    modulus = min(one[0], other[0])
    while one[1] % modulus != other[1] % modulus:
        modulus //= 2
    return modulus, one[1] % modulus


class _Flatten:
    """One list of operations under construction: a message's, or an element's."""

    def __init__(self, resolve: Callable[[TypeName], Message], encoding: Encoding, state: State) -> None:
        self.resolve = resolve
        self.encoding: Encoding = encoding
        self.largest = PERIOD if encoding == CDR else 1
        self.terminator = 1 if encoding == CDR else 0
        self.modulus, self.residue = state
        self.operations: list[Operation] = []
        self.structs: list[tuple[Path, TypeName | str]] = []
        self.slots: list[Slot] = []
        self.run_size = 0
        self.run_align = 1

    def finish(self) -> tuple[Operation, ...]:
        """Close the open run and return all operations."""
        self.close_run()
        return tuple(self.operations)

    def close_run(self) -> None:
        if self.slots:
            self.operations.append(Run(self.run_align, self.run_size, tuple(self.slots)))
            self.slots = []
        self.run_size = 0
        self.run_align = 1

    def state(self) -> State:
        return self.modulus, self.residue

    def set_state(self, state: State) -> None:
        self.modulus, self.residue = state

    def message(self, message: Message, path: Path) -> None:
        """Every field of `message`, whose value stands at `path`."""
        for field in message.fields:
            self.field(field.type, (*path, field.name))
        if not message.fields and self.encoding == CDR:
            self.slot("uint8", path, None, "dummy")

    def field(self, kind: FieldType, path: Path) -> None:
        if kind.array is not None:
            self.array(kind, path)
        else:
            self.single(kind, path)

    def single(self, kind: FieldType, path: Path) -> None:
        """One value that is no array: a field, or the element of an array."""
        primitive = kind.primitive
        if primitive is None:
            name = kind.message
            if name is None:
                raise ValueError("a field type is either primitive or a message")
            if path:
                self.structs.append((path, name))
            self.message(self.resolve(name), path)
        elif primitive == "string" or primitive == "wstring":
            self.slot("uint32", path, None, "count")
            self.close_run()
            wide = primitive == "wstring"
            self.operations.append(Text(path, kind.string_bound, wide, 0 if wide else self.terminator))
            self.set_state((min(self.modulus, 4), self.residue % 4) if wide else (1, 0))
        elif primitive == "time" or primitive == "duration":
            integer = "uint32" if primitive == "time" else "int32"
            if path:
                self.structs.append((path, primitive))
            self.slot(integer, (*path, "secs"), None, "value")
            self.slot(integer, (*path, "nsecs"), None, "value")
        else:
            self.slot(primitive, path, None, "value")

    def slot(self, primitive: str, path: Path, count: int | None, role: Role) -> None:
        """Add a fixed piece to the open run, or to a new one where the alignment is not known well enough."""
        size = PRIMITIVE_SIZE[primitive]
        align = min(size, self.largest)
        if align > self.modulus:
            self.close_run()
            self.run_align = align
            self.modulus, self.residue = align, 0
        pad = -self.residue % align
        offset = self.run_size + pad
        whole = size if count is None else size * count
        self.slots.append(Slot(offset, primitive, path, count, role))
        self.run_size = offset + whole
        self.residue = (self.residue + pad + whole) % self.modulus

    def array(self, kind: FieldType, path: Path) -> None:
        array = kind.array
        if array is None:
            raise ValueError("not an array")
        numeric = kind.primitive in PRIMITIVE_SIZE
        if array.kind == "fixed":
            if numeric and kind.primitive is not None:
                self.slot(kind.primitive, path, array.size, "value")
                return
            self.close_run()
            self.sequence(kind, path)
            return
        self.slot("uint32", path, None, "count")
        self.close_run()
        primitive = kind.primitive
        if primitive == "uint8":
            self.operations.append(Octets(path, array.size))
            self.set_state((1, 0))
        elif numeric and primitive is not None:
            self.numbers(primitive, path, array.size)
        else:
            self.sequence(kind, path)

    def numbers(self, primitive: str, path: Path, bound: int | None) -> None:
        size = PRIMITIVE_SIZE[primitive]
        align = min(size, self.largest)
        known = align <= self.modulus
        pad = -self.residue % align if known else 0
        self.operations.append(Numbers(path, primitive, bound, 1 if known else align, pad))
        empty = self.state()
        if known:
            modulus = min(self.modulus, size) if size > 1 else 1
            filled = (modulus, (self.residue + pad) % modulus)
        else:
            filled = (align, 0)
        self.set_state(join(empty, filled))

    def sequence(self, kind: FieldType, path: Path) -> None:
        array = kind.array
        if array is None:
            raise ValueError("not an array")
        state = self.state()
        while True:
            body = _Flatten(self.resolve, self.encoding, state)
            body.single(kind, ())
            operations = body.finish()
            joined = join(state, body.state())
            if joined == state:
                break
            state = joined
        minimum, maximum = element_sizes(operations, self.encoding == CDR)
        name = kind.message or kind.primitive or ""
        element = Layout(name, self.encoding, operations, tuple(body.structs), minimum, maximum)
        self.operations.append(Sequence(path, array.kind, array.size, element))
        self.set_state(state)
