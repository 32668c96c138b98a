"""A message for gates: the shape of its value, and the steps in which its bytes are made or taken, four octets at most each.

Nothing here knows a hardware description language; `roslet.gateware.typed` makes layouts and blocks of it. In gates every
variable part has a bound, and all that can be there has a place of its own; so positions are followed here through every
element, more exactly than `layout` does through its loops. The rules are those of XCDR version 1 (`layout.CDR`).
"""

from __future__ import annotations

from roslet.errors import Unsupported
from roslet.gen import runtime
from roslet.idl import parse_type_name
from roslet.layout import PRIMITIVE_SIZE
from roslet.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from typing import TypeAlias

    from roslet.idl import FieldType, Message, Registry, TypeName
    from roslet.wire.message import Message as MessageClass

    Path: TypeAlias = tuple[str | int, ...]
    Shape: TypeAlias = "Number | Struct | Vector | Bounded"
    Kind: TypeAlias = "str | TypeName | type[MessageClass]"

WORD = 4
"""Octets of a word, and the most that a step moves."""

FIXED, COUNT, CONTENT, LOOP = range(4)
"""What a step is: octets whose number is fixed; the uint32 before a string or a sequence; as many octets of its content as
there are, at most four; the end of an element of a sequence of messages or strings, which is no octet."""


class Bounds(Record):
    """How much room variable parts have.

    `string` is for every string (octets without the NUL), `sequence` for every sequence (elements), `at` for single ones by
    their paths: `{"header.frame_id": 16}`; of strings in an array the path is followed by `[]`:
    `{"name": 6, "name[]": 20}`, and inside messages in an array it has none: `poses.header.frame_id`.
    Where the definition has a smaller bound, that holds.
    """

    __slots__ = ("at", "sequence", "string")
    _fields = ("string", "sequence", "at")

    def __init__(
        self, string: int | None = None, sequence: int | None = None, at: Mapping[str, int] | None = None
    ) -> None:
        self.string = string
        self.sequence = sequence
        self.at = dict(at or {})
        for what, bound in (("a string", string), ("a sequence", sequence), *self.at.items()):
            if bound is not None and bound < 1:
                raise ValueError(f"the bound of {what} is at least 1, not {bound}")


class Number(Record):
    """A number of so many bits; `primitive` says what they mean."""

    __slots__ = ("bits", "primitive", "signed")
    _fields = ("primitive", "bits", "signed")

    def __init__(self, primitive: str, bits: int, signed: bool) -> None:
        self.primitive = primitive
        self.bits = bits
        self.signed = signed


class Struct(Record):
    """A message: its fields by name, in their order."""

    __slots__ = ("fields", "name")
    _fields = ("name", "fields")

    def __init__(self, name: str, fields: tuple[tuple[str, Shape], ...]) -> None:
        self.name = name
        self.fields = fields


class Vector(Record):
    """An array of exactly `size` elements."""

    __slots__ = ("element", "size")
    _fields = ("element", "size")

    def __init__(self, element: Shape, size: int) -> None:
        self.element = element
        self.size = size


class Bounded(Record):
    """A sequence of at most `bound` elements, or a string (`text`) of as many octets: `length` and `data`."""

    __slots__ = ("bound", "element", "text")
    _fields = ("element", "bound", "text")

    def __init__(self, element: Shape, bound: int, text: bool) -> None:
        self.element = element
        self.bound = bound
        self.text = text


class Piece(Record):
    """`octets` octets of a step, from octet `lane` on: those of the number at `path`, from its octet `shift` on (from the
    lowest). `wide`: of a number of eight octets, whose halves change places in big endian."""

    __slots__ = ("lane", "octets", "path", "shift", "wide")
    _fields = ("lane", "octets", "path", "shift", "wide")

    def __init__(self, lane: int, octets: int, path: Path, shift: int, wide: bool) -> None:
        self.lane = lane
        self.octets = octets
        self.path = path
        self.shift = shift
        self.wide = wide


class Step(Record):
    """One step. `align`: what the position must be made a multiple of before it, 1 where it is so anyway. `octets` of a
    FIXED one. `jump`: of a COUNT and a LOOP where nothing (more) follows, of a CONTENT where it is the last, the step to go
    to.

    Of a COUNT: `bound` and `path` of what it counts; `text`, whether a NUL is counted too; `scale`, log2 of an element's
    octets. `level`, of a LOOP and the COUNT before it: how many sequences are around; None for a COUNT before CONTENT.
    """

    __slots__ = ("align", "bound", "jump", "kind", "level", "octets", "path", "pieces", "scale", "text")
    _fields = ("kind", "align", "octets", "pieces", "path", "bound", "text", "scale", "level", "jump")

    def __init__(
        self,
        kind: int,
        align: int = 1,
        octets: int = 0,
        pieces: tuple[Piece, ...] = (),
        path: Path = (),
        bound: int = 0,
        text: bool = False,
        scale: int = 0,
        level: int | None = None,
        jump: int = 0,
    ) -> None:
        self.kind, self.align, self.octets, self.pieces = kind, align, octets, pieces
        self.path, self.bound, self.text, self.scale = path, bound, text, scale
        self.level, self.jump = level, jump


class Plan(Record):
    """All that gates need to know of a message.

    `unused` are the numbers of octets that can be left in its last word. `aligned`: every step begins with a word; then a
    step is a word, and no octets need be shifted. `maximum`: octets of the longest body.
    """

    __slots__ = ("aligned", "maximum", "name", "shape", "steps", "unused")
    _fields = ("name", "shape", "steps", "unused", "aligned", "maximum")

    def __init__(
        self,
        name: str,
        shape: Struct,
        steps: tuple[Step, ...],
        unused: tuple[int, ...],
        aligned: bool,
        maximum: int,
    ) -> None:
        self.name = name
        self.shape = shape
        self.steps = steps
        self.unused = unused
        self.aligned = aligned
        self.maximum = maximum


def plan(kind: Kind, bounds: Bounds | None = None, registry: Registry | None = None) -> Plan:
    """The plan of a ROS 2 message, by its name or its class; of the process's definitions if there is no `registry`.

    Raises UnknownType; Unsupported for a wstring; ValueError for a variable part without a bound, or a bound of nothing.
    """
    found = runtime.registry("ros2") if registry is None else registry
    name: str | TypeName = kind._type if isinstance(kind, type) else kind
    message = found.message(parse_type_name(name, "msg") if isinstance(name, str) else name)
    shapes = _Shapes(found, Bounds() if bounds is None else bounds, str(message.name))
    shape = shapes.message(message, "")
    unknown = sorted(set(shapes.bounds.at) - shapes.met)
    if unknown:
        raise ValueError(f"{message.name} has no string or sequence {', '.join(unknown)}")
    return _Walk().plan(str(message.name), shape)


class _Shapes:
    """From definitions to shapes; `met` are the paths of what has a bound."""

    def __init__(self, registry: Registry, bounds: Bounds, name: str) -> None:
        self.registry = registry
        self.bounds = bounds
        self.name = name
        self.met: set[str] = set()

    def message(self, message: Message, path: str) -> Struct:
        dot = path + "." if path else ""
        fields = tuple([(field.name, self.field(field.type, dot + field.name)) for field in message.fields])
        return Struct(str(message.name), fields)

    def field(self, kind: FieldType, path: str) -> Shape:
        array = kind.array
        if array is None:
            return self.single(kind, path, path)
        if array.kind == "fixed":
            return Vector(self.single(kind, path, path + "[]"), array.size or 0)
        bound = self.bound(path, self.bounds.sequence, array.size, "sequence")
        return Bounded(self.single(kind, path, path + "[]"), bound, False)

    def single(self, kind: FieldType, path: str, text_path: str) -> Shape:
        primitive = kind.primitive
        if kind.message is not None:
            return self.message(self.registry.message(kind.message), path)
        if primitive == "string":
            bound = self.bound(text_path, self.bounds.string, kind.string_bound, "string")
            return Bounded(Number("uint8", 8, False), bound, True)
        if primitive is None or primitive not in PRIMITIVE_SIZE:
            raise Unsupported(f"{self.name}: {path} is a {primitive}, which gates do not take")
        bits = 1 if primitive == "bool" else 8 * PRIMITIVE_SIZE[primitive]
        return Number(primitive, bits, primitive.startswith("int"))

    def bound(self, path: str, default: int | None, defined: int | None, what: str) -> int:
        self.met.add(path)
        given = self.bounds.at.get(path, default)
        known = [bound for bound in (given, defined) if bound is not None]
        if not known:
            raise ValueError(f"{self.name}: the {what} {path} has no bound; gates need one")
        return min(known)


class _Walk:
    """Makes steps while it follows where they can begin: `positions`, modulo 8."""

    def __init__(self) -> None:
        self.steps: list[Step] = []
        self.positions = {0}
        self.longest = 0
        self.aligned = True
        self.level = 0
        self.pieces: list[Piece] = []  # of the step that is open
        self.filled = 0
        self.starts: set[int] = set()
        self.align = 1

    def plan(self, name: str, shape: Struct) -> Plan:
        self.shape(shape, ())
        self.close()
        unused = tuple(sorted({-position % WORD for position in self.positions}))
        return Plan(name, shape, tuple(self.steps), unused, self.aligned, self.longest)

    def shape(self, shape: Shape, path: Path) -> None:
        if isinstance(shape, Number):
            self.number(PRIMITIVE_SIZE[shape.primitive], path)
        elif isinstance(shape, Vector):
            for index in range(shape.size):
                self.shape(shape.element, (*path, index))
        elif isinstance(shape, Struct):
            for name, field in shape.fields:
                self.shape(field, (*path, name))
            if not shape.fields:  # an IDL struct has a member
                self.unit(1, 1, None)
        elif isinstance(shape.element, Number):
            self.content(shape, shape.element, path)
        else:
            self.elements(shape, path)

    def number(self, size: int, path: Path) -> None:
        if size <= WORD:
            self.unit(size, size, Piece(0, size, path, 0, False))
        else:
            self.unit(WORD, size, Piece(0, WORD, path, 0, True))
            self.unit(WORD, WORD, Piece(0, WORD, path, WORD, True))

    def unit(self, octets: int, align: int, piece: Piece | None) -> None:
        """Octets that belong to the open step if they still fit its word, or else to a new one."""
        pads = {-(start + self.filled) % align for start in self.starts}
        lane = self.filled + (pads.pop() if len(pads) == 1 else WORD)
        # Where it is known how the step lies, it must not reach into the next word.
        start = next(iter(self.starts)) % WORD if len({start % WORD for start in self.starts}) == 1 else 0
        if pads or start + lane + octets > WORD:
            self.close()
            self.open(align)
            lane = 0
        if piece is not None:
            self.pieces.append(piece.replace(lane=lane))
        self.filled = lane + octets

    def open(self, align: int) -> None:
        self.align = self.need(align)
        self.starts = set(self.positions)

    def close(self) -> None:
        if self.filled:
            self.steps.append(Step(FIXED, self.align, self.filled, tuple(self.pieces)))
            self.move({self.filled})
            self.longest += self.filled
        self.pieces, self.filled, self.starts = [], 0, set()

    def need(self, align: int) -> int:
        """Align the positions; what of it has to be done by the step."""
        self.longest += -self.longest % align
        if align > WORD:
            words = {position + -position % WORD & align - 1 for position in self.positions}
            if words == {WORD}:  # always a word of padding
                self.steps.append(Step(FIXED, self.need(WORD), WORD))
                self.positions = {0}
            if len(words) == 1:
                align = WORD
        needed = align if any(position % align for position in self.positions) else 1
        self.positions = {(position + -position % align) % 8 for position in self.positions}
        self.aligned = self.aligned and not any(position % WORD for position in self.positions)
        return needed

    def move(self, octets: Iterable[int]) -> None:
        self.positions = {(position + by) % 8 for position in self.positions for by in octets}

    def count(self, shape: Bounded, path: Path, scale: int, level: int | None) -> int:
        self.close()
        align = self.need(WORD)
        number = len(self.steps)
        self.steps.append(
            Step(COUNT, align, WORD, (), (*path, "length"), shape.bound, shape.text, scale, level)
        )
        self.move({WORD})
        self.longest += WORD
        return number

    def jump_here(self, numbers: Iterable[int]) -> None:
        for number in numbers:
            self.steps[number] = self.steps[number].replace(jump=len(self.steps))

    def content(self, shape: Bounded, element: Number, path: Path) -> None:
        size = PRIMITIVE_SIZE[element.primitive]
        jumps = [self.count(shape, path, size.bit_length() - 1, None)]
        ends = set() if shape.text else set(self.positions)
        unit = min(size, WORD)
        total = shape.bound * size + shape.text
        align = self.need(size)
        for first in range(0, total, WORD):
            pieces = []
            for octet in range(first, min(first + WORD, shape.bound * size), unit):
                index, shift = divmod(octet, size)
                pieces.append(Piece(octet - first, unit, (*path, "data", index), shift, size > WORD))
            jumps.append(len(self.steps))
            self.steps.append(Step(CONTENT, align, 0, tuple(pieces), text=shape.text))
            align = 1
            # A number of eight octets does not end with its first half.
            here = [n for n in range(unit, WORD + 1, unit) if first + n <= total and (first + n) % size == 0]
            ends |= {(position + n) % 8 for position in self.positions for n in here}
            self.move({WORD})
        self.longest += total
        self.positions = ends
        self.jump_here(jumps)

    def elements(self, shape: Bounded, path: Path) -> None:
        jumps = [self.count(shape, path, 0, self.level)]
        ends = set(self.positions)
        self.level += 1
        for index in range(shape.bound):
            self.shape(shape.element, (*path, "data", index))
            self.close()
            jumps.append(len(self.steps))
            self.steps.append(Step(LOOP, level=self.level - 1))
            ends |= self.positions
        self.level -= 1
        self.positions = ends
        self.jump_here(jumps)
