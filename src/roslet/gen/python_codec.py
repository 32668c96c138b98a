"""Python source of the serialiser and deserialiser of one message, spelled from its layout.

One `struct` call a run; nested messages inlined; a loop for an array of strings or messages. Positions are
kept as a variable and a constant, so that consecutive runs and payloads cost one addition. All names that
start with an underscore are globals of the generated code (`globals_` says how each is made); locals have
none.

What can go wrong raises one of `primitives.FAILURES` and the whole message is done again by the field table,
which knows exactly what is wrong. In particular a deserialiser does not check every string: what runs past
the end fails at the next run or at the comparison with the end. It checks every count that drives a loop.
"""

from __future__ import annotations

from roslet.gen.python_names import Locals, attribute, class_reference
from roslet.layout import CDR, PRIMITIVE_SIZE, Numbers, Octets, Run, Sequence, Text
from roslet.wire.arrays import TYPECODES
from roslet.wire.cursor import MAX_EMPTY_ELEMENTS, SMALL_OCTETS
from roslet.wire.message import GATHER_MINIMUM

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Generator, Iterator

    from roslet.gen.lines import Block
    from roslet.layout import Layout, Slot
    from roslet.layout.operations import Operation, Path

# The encapsulation header of little-endian CDR without options, 00 01 00 00, as a little-endian number.
_ENCAPSULATION = 256

# A gathered payload takes no room in the buffer; the origin of alignment moves so that it is counted
# nevertheless.
_GATHERED = "base -= o + n - e"


def _without(block: Block, line: str) -> Block:
    """`block` without `line`, at any depth."""
    return [part if isinstance(part, str) else _without(part, line) for part in block if part != line]


def has_views(operations: tuple[Operation, ...]) -> bool:
    """Whether a message read with these operations may hold views on the buffer."""
    for operation in operations:
        if isinstance(operation, (Octets, Numbers)):
            return True
        if isinstance(operation, Sequence) and has_views(operation.element.operations):
            return True
        if isinstance(operation, Run) and any(map(_is_view, operation.slots)):
            return True
    return False


def _is_view(slot: Slot) -> bool:
    return slot.count is not None and not _is_bytes(slot)


def _is_bytes(slot: Slot) -> bool:
    """A fixed uint8 array that is read as bytes."""
    return slot.primitive == "uint8" and slot.count is not None and slot.count <= SMALL_OCTETS


def _sum(variable: str, constant: int) -> str:
    return "%s + %d" % (variable, constant) if constant else variable


class _Form:
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

    def __str__(self) -> str:
        return "<" + "".join(
            ["%d%s" % part if part[0] != 1 or part[1] == "s" else part[1] for part in self.parts]
        )


class _Codec:
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
        self.depth = 0

    def position(self, more: int = 0) -> str:
        return _sum(self.variable, self.constant + more)

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

    def struct(self, maker: str, form: str, *more: object) -> str:
        """A global with the packer or unpacker of a format."""
        expression = "%s(%s)" % (maker, ", ".join(['"%s"' % form, *map(str, more)]))
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


class Serializer(_Codec):
    """Spells `serialize_into`."""

    prefix = "pack"

    def source(self) -> Block:
        """The lines of the method. Afterwards `globals_` and `references` say what they need."""
        self.variable = "offset"
        body = list(self.body())
        yield "def serialize_into(self, buffer, offset=0, parts=None):"
        yield [
            "try:",
            ["base = offset + 4", *body] if self.uses_base else _without(body, _GATHERED),
            "except _FAILURES as error:",
            ["return _rescue_write(self, buffer, offset, parts, error)"],
        ]

    def body(self) -> Iterator[str | Block]:
        operations = self.layout.operations
        header = self.cdr
        if header and not (operations and isinstance(operations[0], Run) and operations[0].align == 1):
            yield "%s(buffer, offset, %d)" % (self.struct("_packer", "<I"), _ENCAPSULATION)
            self.constant = 4
            header = False
        yield from self.sequence_of(operations, self.structs(self.layout, "self"), header)
        yield "return " + self.position()

    def structs(self, layout: Layout, root: str) -> dict[Path, str]:
        """The variables of nested values; `begin` yields how they are set."""
        holders: dict[Path, str] = {(): root}
        for path, _name in layout.structs:
            holders[path] = self.locals.name("_".join([attribute(part) for part in path]))
        self.pending = [
            "%s = %s" % (holders[path], self.value(path, holders)) for path, _name in layout.structs
        ]
        return holders

    def value(self, path: Path, holders: dict[Path, str]) -> str:
        if not path:
            return holders[()]
        return "%s.%s" % (holders[path[:-1]], attribute(path[-1]))

    def sequence_of(
        self, operations: tuple[Operation, ...], holders: dict[Path, str], header: bool
    ) -> Iterator[str | Block]:
        yield from self.pending
        self.pending = []
        folded = False
        for index, operation in enumerate(operations):
            after = operations[index + 1] if index + 1 < len(operations) else None
            if isinstance(operation, Run):
                yield from self.run(operation, after, holders, header, folded)
                header = False
                folded = False
            elif isinstance(operation, Text):
                fold = after.align if isinstance(after, Run) else 1
                yield from self.text(operation, fold)
                folded = fold > 1
            elif isinstance(operation, Octets):
                yield from self.payload("n")
            elif isinstance(operation, Numbers):
                yield from self.numeric(operation)
            else:
                yield from self.loop(operation, holders)

    def run(
        self, run: Run, after: Operation | None, holders: dict[Path, str], header: bool, folded: bool
    ) -> Iterator[str | Block]:
        form = _Form()
        arguments: list[str] = []
        if header:
            form.add("I", 4)
            arguments.append(str(_ENCAPSULATION))
        shift = form.end
        for slot in run.slots:
            form.pad_to(shift + slot.offset)
            size = PRIMITIVE_SIZE[slot.primitive]
            if slot.role == "count":
                arguments.append((yield from self.prepare(after, holders)))
                form.add("I", size)
            elif slot.role == "dummy":
                form.pad_to(form.end + 1)
            elif slot.count is not None:
                name = self.locals.name("data")
                yield from self.fixed(slot, name, self.value(slot.path, holders))
                arguments.append(name)
                form.text(slot.size)
            else:
                value = self.value(slot.path, holders)
                arguments.append("_BOOL[%s]" % value if slot.primitive == "bool" else value)
                form.add(TYPECODES[slot.primitive], size)
        form.pad_to(shift + run.size)
        values = "".join([", " + argument for argument in arguments])
        if run.align > 1 and not folded:
            self.uses_base = True
            yield from self.settle()
            yield "p = base - o & %d" % (run.align - 1)
            name = self.struct("_packers", str(form), run.align)
            yield "%s[p](buffer, o%s)" % (name, values)
            yield "o += p + %d" % form.end
        else:
            name = self.struct("_packer", str(form))
            yield "%s(buffer, %s%s)" % (name, self.position(), values)
            self.constant += form.end

    def fixed(self, slot: Slot, name: str, value: str) -> Iterator[str | Block]:
        """Set `name` to the bytes of a fixed array."""
        yield "%s = %s" % (name, value)
        if slot.primitive == "uint8":
            yield "if type(%s) is not bytes:" % name
            yield ["%s = bytes(_octets(%s))" % (name, name)]
        else:
            raw = self.numbers(slot.primitive, "raw")
            yield "if type(%s) is _ndarray and %s.dtype is %s:" % (
                name,
                name,
                self.numbers(slot.primitive, "tag"),
            )
            yield ["%s = %s.tobytes()" % (name, name)]
            yield "else:"
            yield ["%s = bytes(%s(%s))" % (name, raw, name)]
        yield "if len(%s) != %d:" % (name, slot.size)
        yield ["raise ValueError"]

    def prepare(
        self, operation: Operation | None, holders: dict[Path, str]
    ) -> Generator[str | Block, None, str]:
        """Set `n` (and `data`) for the variable operation that follows; returns the count's expression."""
        if isinstance(operation, Text):
            value = self.value(operation.path, holders)
            if operation.wide:
                yield "data = _encode_wide(%s, False)" % value
                yield "n = len(data)"
                yield from self.bounded(operation.bound, 2)
                return "n // 2"
            yield "data = %s.encode()" % value
            yield "n = len(data)"
            yield from self.bounded(operation.bound, 1)
            return "n + 1" if operation.terminator else "n"
        if isinstance(operation, Octets):
            yield "data = %s" % self.value(operation.path, holders)
            yield "if type(data) is not bytes:"
            yield ["data = _octets(data)"]
            yield "n = len(data)"
            yield from self.bounded(operation.bound, 1)
            return "n"
        if isinstance(operation, Numbers):
            size = PRIMITIVE_SIZE[operation.primitive]
            raw = self.numbers(operation.primitive, "raw")
            yield "data = %s" % self.value(operation.path, holders)
            yield "if type(data) is _ndarray and data.dtype is %s and data.nbytes < %d:" % (
                self.numbers(operation.primitive, "tag"),
                GATHER_MINIMUM,
            )
            yield ["data = data.tobytes()"]
            yield "else:"
            yield ["data = %s(data)" % raw]
            yield "n = len(data)"
            yield from self.bounded(operation.bound, size)
            return "n" if size == 1 else "n // %d" % size
        if isinstance(operation, Sequence):
            name = self.items(operation, holders)
            yield "%s = %s" % (name, self.value(operation.path, holders))
            yield "n = len(%s)" % name
            if operation.element.name == "string":  # a lone string would pass for a list of letters
                yield "if type(%s) is str:" % name
                yield ["raise ValueError"]
            yield from self.bounded(operation.size, 1)
            return "n"
        raise ValueError("a count precedes a variable operation")

    def items(self, operation: Sequence, holders: dict[Path, str]) -> str:
        self.items_name = self.locals.name("items")
        return self.items_name

    def bounded(self, bound: int | None, size: int) -> Iterator[str | Block]:
        if bound is not None:
            yield "if n > %d:" % (bound * size)
            yield ["raise ValueError"]

    def text(self, operation: Text, fold: int) -> Iterator[str | Block]:
        if not operation.terminator and fold == 1:
            yield from self.payload("n")
            return
        if self.variable != "o" or self.constant:
            yield "o = %s" % self.position()
        if fold == 1:
            yield 'data += b"\\0"'
            yield "n += 1"
        else:
            self.uses_base = True
            if operation.terminator:
                yield "n += 1"
            yield "p = base - o - n & %d" % (fold - 1)
            yield "data += _ZEROS[p + 1]" if operation.terminator else "data += _ZEROS[p]"
            yield "n += p"
        self.variable, self.constant = "o", 0
        yield from self.payload("n")

    def payload(self, size: str) -> Iterator[str | Block]:
        """Write `data`, whose length is `size`."""
        if self.variable != "o" or self.constant:
            yield "o = %s" % self.position()
        yield "e = o + n"
        yield "if n < %d:" % GATHER_MINIMUM
        yield ["buffer[o:e] = data"]
        yield "else:"
        inside = ["e = _place(buffer, o, data, parts)"]
        if self.cdr:
            inside.append(_GATHERED)
        yield inside
        self.variable, self.constant = "e", 0

    def numeric(self, operation: Numbers) -> Iterator[str | Block]:
        if operation.align == 1 and not operation.pad:
            yield from self.payload("n")
            return
        yield from self.settle()
        inside: list[str | Block] = []
        self.uses_base = True
        if operation.align == 1:
            zeros, pad = "_ZEROS[%d]" % operation.pad, str(operation.pad)
        else:
            inside.append("p = base - o & %d" % (operation.align - 1))
            zeros, pad = "_ZEROS[p]", "p"
        inside += [
            "if n < %d:" % GATHER_MINIMUM,
            ["n += %s" % pad, "buffer[o:o + n] = %s + data" % zeros, "o += n"],
            "else:",
            [
                "buffer[o:o + %s] = %s" % (pad, zeros),
                "o += %s" % pad,
                "e = _place(buffer, o, data, parts)",
                _GATHERED,
                "o = e",
            ],
        ]
        yield "if n:"
        yield inside
        self.variable, self.constant = "o", 0

    def loop(self, operation: Sequence, holders: dict[Path, str]) -> Iterator[str | Block]:
        if operation.kind == "fixed":
            name = self.items(operation, holders)
            yield "%s = %s" % (name, self.value(operation.path, holders))
            yield "if len(%s) != %d:" % (name, operation.size or 0)
            yield ["raise ValueError"]
        name = self.items_name
        if not operation.element.operations:  # messages without fields: the count is all
            return
        element = self.locals.name("element")
        yield from self.settle()
        yield "for %s in %s:" % (element, name)
        inner = self.structs(operation.element, element)
        body = list(self.sequence_of(operation.element.operations, inner, False))
        body += self.settle()
        yield body


class Deserializer(_Codec):
    """Spells `deserialize_from`."""

    prefix = "unpack"

    def source(self) -> Block:
        """The lines of the method, without its `classmethod` decorator. Afterwards `globals_` and
        `references` say what they need."""
        self.variable = "start"
        body = list(self.body())
        yield "def deserialize_from(cls, buffer, start, end):"
        yield [
            "try:",
            ["base = start + 4", *body] if self.uses_base else body,
            "except _FAILURES:",
            ["return _rescue_read(cls, buffer, start, end)"],
        ]

    def body(self) -> Iterator[str | Block]:
        operations = self.layout.operations
        header = self.cdr
        if header and not (operations and isinstance(operations[0], Run) and operations[0].align == 1):
            yield "(kind,) = %s(buffer, start)" % self.struct("_unpacker", "<I")
            yield from self.check_kind()
            self.constant = 4
            header = False
        yield "message = _new(cls)"
        yield from self.create(self.layout, "message")
        yield from self.sequence_of(operations, self.holders, header)
        # What follows a CDR body is not looked at, see `roslet.wire.cdr`.
        yield "if %s %s end:" % (self.position(), ">" if self.cdr else "!=")
        yield ["raise ValueError"]
        yield "return message"

    def check_kind(self) -> Iterator[str | Block]:
        yield "if kind & 65535 != %d:" % _ENCAPSULATION
        yield ["raise ValueError"]

    def create(self, layout: Layout, root: str) -> Iterator[str]:
        """Make the nested values of `root`; sets `holders`."""
        holders: dict[Path, str] = {(): root}
        for path, name in layout.structs:
            holders[path] = self.locals.name("_".join([attribute(part) for part in path]))
            yield "%s = %s = _new(%s)" % (holders[path], self.target(path, holders), self.reference(name))
        self.holders = holders

    def target(self, path: Path, holders: dict[Path, str]) -> str:
        return "%s.%s" % (holders[path[:-1]], attribute(path[-1]))

    def store(self, path: Path, holders: dict[Path, str], value: str) -> str:
        if path:
            return "%s = %s" % (self.target(path, holders), value)
        return "%s.append(%s)" % (self.items_name, value)

    def sequence_of(
        self, operations: tuple[Operation, ...], holders: dict[Path, str], header: bool
    ) -> Iterator[str | Block]:
        for operation in operations:
            if isinstance(operation, Run):
                yield from self.run(operation, holders, header)
                header = False
            elif isinstance(operation, Text):
                yield from self.text(operation, holders)
            elif isinstance(operation, Octets):
                yield from self.bounded(operation.bound)
                yield from self.settle()
                yield "e = o + n"
                yield self.store(operation.path, holders, "buffer[o:e]")
                self.variable, self.constant = "e", 0
            elif isinstance(operation, Numbers):
                yield from self.numeric(operation, holders)
            else:
                yield from self.loop(operation, holders)

    def bounded(self, bound: int | None) -> Iterator[str | Block]:
        if bound is not None:
            yield "if n > %d:" % bound
            yield ["raise ValueError"]

    def run(self, run: Run, holders: dict[Path, str], header: bool) -> Iterator[str | Block]:
        form = _Form()
        targets: list[str] = []
        rest: list[str] = []
        if run.align > 1:
            self.uses_base = True
            yield from self.settle()
            yield "o += base - o & %d" % (run.align - 1)
        if header:
            form.add("I", 4)
            targets.append("kind")
        shift = form.end
        for slot in run.slots:
            size = PRIMITIVE_SIZE[slot.primitive]
            if slot.role == "dummy":
                continue
            if slot.count is not None and not _is_bytes(slot):
                at = self.position(shift + slot.offset)
                if slot.primitive == "uint8":
                    value = "buffer[%s:%s]" % (at, self.position(shift + slot.offset + slot.size))
                elif slot.count == 0:
                    value = self.numbers(slot.primitive, "zeros") + "(0)"
                else:
                    view = self.numbers(slot.primitive, "view")
                    tag = self.numbers(slot.primitive, "tag")
                    value = "%s(buffer, %s, %d, %s)" % (view, tag, slot.count, at)
                rest.append(self.store(slot.path, holders, value))
                continue
            form.pad_to(shift + slot.offset)
            if slot.role == "count":
                targets.append("n")
                form.add("I", size)
            elif slot.count is not None:
                targets.append(self.target(slot.path, holders))
                form.text(slot.size)
            elif slot.primitive == "bool":
                flag = self.locals.name(attribute(slot.path[-1]))
                targets.append(flag)
                rest.append(self.store(slot.path, holders, flag + " != 0"))
                form.add("B", size)
            else:
                targets.append(self.target(slot.path, holders))
                form.add(TYPECODES[slot.primitive], size)
        if targets:
            left = ", ".join(targets) if len(targets) > 1 else "(%s,)" % targets[0]
            yield "%s = %s(buffer, %s)" % (left, self.struct("_unpacker", str(form)), self.position())
        if header:
            yield from self.check_kind()
        yield from rest
        self.constant += shift + run.size

    def text(self, operation: Text, holders: dict[Path, str]) -> Iterator[str | Block]:
        bound = operation.bound
        yield from self.bounded(None if bound is None else bound + operation.terminator)
        yield from self.settle()
        if operation.wide:
            yield "e = o + n * 2"
            value = "_decode_wide(buffer[o:e], False)"
        else:
            yield "e = o + n"
            stop = "e - 1" if operation.terminator else "e"
            value = 'str(buffer[o:%s], "utf-8", "surrogateescape")' % stop
        yield self.store(operation.path, holders, value)
        self.variable, self.constant = "e", 0

    def numeric(self, operation: Numbers, holders: dict[Path, str]) -> Iterator[str | Block]:
        size = PRIMITIVE_SIZE[operation.primitive]
        yield from self.bounded(operation.bound)
        yield from self.settle()
        inside: list[str] = []
        if operation.align > 1:
            self.uses_base = True
            inside.append("o += base - o & %d" % (operation.align - 1))
        elif operation.pad:
            inside.append("o += %d" % operation.pad)
        view = self.numbers(operation.primitive, "view")
        tag = self.numbers(operation.primitive, "tag")
        inside.append(self.store(operation.path, holders, "%s(buffer, %s, n, o)" % (view, tag)))
        inside.append("o += n" if size == 1 else "o += n * %d" % size)
        yield "if n:"
        yield inside
        yield "else:"
        yield [self.store(operation.path, holders, self.numbers(operation.primitive, "empty"))]
        self.variable, self.constant = "o", 0

    def loop(self, operation: Sequence, holders: dict[Path, str]) -> Iterator[str | Block]:
        element = operation.element
        if operation.kind == "fixed":
            yield "n = %d" % (operation.size or 0)
        else:
            yield from self.bounded(operation.size)
            least = element.minimum
            if least:
                left = "end - (%s)" % self.position() if self.constant else "end - " + self.position()
                yield "if n%s > %s:" % (" * %d" % least if least > 1 else "", left)
            else:
                yield "if n > %d:" % MAX_EMPTY_ELEMENTS
            yield ["raise ValueError"]
        yield from self.settle()
        items = self.locals.name("items")
        yield "%s = %s = []" % (items, self.target(operation.path, holders))
        yield "for _ in range(n):"
        body: list[str | Block] = []
        saved = self.holders
        if isinstance(element.name, str) and element.name in ("string", "wstring"):
            inner: dict[Path, str] = {}
        else:
            root = self.locals.name("element")
            body.append("%s = _new(%s)" % (root, self.reference(element.name)))
            body.append("%s.append(%s)" % (items, root))
            body += self.create(element, root)
            inner = self.holders
        self.items_name = items
        body += self.sequence_of(element.operations, inner, False)
        body += self.settle()
        self.holders = saved
        yield body
