"""Python source of a serialiser: `serialize_into`, and `serialize` where one `struct` call makes the whole."""

from __future__ import annotations

from roslet.gen.python_codec import ENCAPSULATION, SHORT_TEXT, Codec, Form
from roslet.gen.python_names import attribute
from roslet.layout import PRIMITIVE_SIZE, Numbers, Octets, Run, Sequence, Text
from roslet.wire.arrays import TYPECODES
from roslet.wire.message import GATHER_MINIMUM
from roslet.wire.primitives import MAX_TABLE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Generator, Iterator

    from roslet.gen.lines import Block
    from roslet.layout import Layout, Slot
    from roslet.layout.operations import Operation, Path

# Strings of a list that are kept, and characters of each, for the next message: more are seldom the same again, and what is
# kept stays in memory. A string of so few is never gathered.
KEPT_TEXTS, KEPT_LENGTH = 64, 1024

# A gathered payload takes no room in the buffer; the origin of alignment moves so that it is counted
# nevertheless. The placeholders are the payload's size and the names of its start and end.
_GATHERED = "base -= o + %s - e"


def _without_base(block: Block) -> Block:
    """`block` without what only keeps `base` right, at any depth."""
    return [
        part if isinstance(part, str) else _without_base(part)
        for part in block
        if not (isinstance(part, str) and part.startswith("base -= "))
    ]


class Serializer(Codec):
    """Spells `serialize_into`."""

    prefix = "pack"

    def __init__(self, layout: Layout) -> None:
        super().__init__(layout)
        self.locals.used.difference_update(["data", "n"])
        self.data = self.size = ""  # the names of the payload that was prepared last, and of its length
        self.items = ""
        self.pending: list[str] = []

    def source(self) -> Block:
        """The lines of the method. Afterwards `globals_` and `references` say what they need."""
        self.variable = "offset"
        body = list(self.body())
        yield "def serialize_into(self, buffer, offset=0, parts=None):"
        yield [
            "try:",
            ["base = offset + 4", *body] if self.uses_base else _without_base(body),
            "except _FAILURES as error:",
            ["return _rescue_write(self, buffer, offset, parts, error)"],
        ]

    def body(self) -> Iterator[str | Block]:
        operations = self.layout.operations
        header = self.cdr
        if header and not (operations and isinstance(operations[0], Run) and operations[0].align == 1):
            yield "%s(buffer, offset, %d)" % (self.struct("_packer", "<I"), ENCAPSULATION)
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
        index = 0
        while index < len(operations):
            operation = operations[index]
            index += 1
            after = _at(operations, index)
            lead: Run | None = None
            if isinstance(operation, Run):
                if not isinstance(after, Text) or after.wide:
                    pieces = yield from self.pieces(operation, after, holders, header)
                    header = False
                    yield from self.run(operation, *pieces)
                    continue
                lead, operation = operation, after
                index += 1
                after = _at(operations, index)
            if isinstance(operation, Text) and operation.wide:
                yield from self.payload()
            elif isinstance(operation, Text):
                follow = after if isinstance(after, Run) else None
                index += follow is not None
                yield from self.text(lead, operation, follow, _at(operations, index), holders, header)
                header = False
            elif isinstance(operation, Octets):
                yield from self.payload()
            elif isinstance(operation, Numbers):
                yield from self.numeric(operation)
            elif isinstance(operation, Sequence):
                yield from self.loop(operation, holders)

    def pieces(
        self, run: Run, after: Operation | None, holders: dict[Path, str], header: bool
    ) -> Generator[str | Block, None, tuple[Form, str]]:
        """Yields what has to be done before a run is packed; returns its format and its arguments, each behind
        a comma."""
        form = Form()
        arguments: list[str] = []
        if header:
            form.add("I", 4)
            arguments.append(str(ENCAPSULATION))
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
        return form, "".join([", " + argument for argument in arguments])

    def run(self, run: Run, form: Form, values: str) -> Iterator[str | Block]:
        if run.align > 1:
            self.uses_base = True
            yield from self.settle()
            yield "p = base - o & %d" % (run.align - 1)
            yield "%s[p](buffer, o%s)" % (self.struct("_packers", str(form), run.align), values)
            yield "o += p + %d" % form.end
        else:
            yield "%s(buffer, %s%s)" % (self.struct("_packer", str(form)), self.position(), values)
            self.constant += form.end

    def text(
        self,
        lead: Run | None,
        text: Text,
        follow: Run | None,
        after: Operation | None,
        holders: dict[Path, str],
        header: bool,
    ) -> Iterator[str | Block]:
        """The run before a string, the string, and the run behind it: one call if the string is short."""
        front, front_values = Form(), ""
        if lead is not None:
            front, front_values = yield from self.pieces(lead, text, holders, header)
        data, size = self.data, self.size
        back, back_values = Form(), ""
        if follow is not None:
            back, back_values = yield from self.pieces(follow, after, holders, False)
        moving = lead is not None and lead.align > 1
        if moving and lead is not None:
            self.uses_base = True
            yield from self.settle()
            yield "p = base - o & %d" % (lead.align - 1)
        fold = 1 if follow is None else follow.align
        if fold > 1:
            self.uses_base = True

        # A short string: the key of the table is its length with the padding behind it.
        end = self.position(front.end + text.terminator)
        short: list[str] = []
        key = size
        if fold > 1:
            key = "m"
            behind = "(%s)" % (end + " + p" if moving else end)
            short.append("m = %s + (base - %s - %s & %d)" % (size, behind, size, fold - 1))
        name = self.struct(
            "_padded_text_packers" if moving else "_text_packers",
            front.codes(),
            back.codes(),
            text.terminator,
        )
        index = key + " << 3 | p" if moving else key
        values = "%s, %s%s" % (front_values, data, back_values)
        short.append("%s[%s](buffer, %s%s)" % (name, index, self.position(), values))
        short.append("e = %s + %s%s" % (end, key, " + p" if moving else ""))

        long: list[str | Block] = []
        if moving and lead is not None:
            table = self.struct("_packers", str(front), lead.align)
            long.append("%s[p](buffer, o%s)" % (table, front_values))
            long.append("o += p + %d" % front.end)
        elif lead is not None:
            packer = self.struct("_packer", str(front))
            long.append("%s(buffer, %s%s)" % (packer, self.position(), front_values))
            self.constant += front.end
        self.data, self.size, prepared = data, size, (self.data, self.size)
        long += self.long_text(text, fold)
        self.data, self.size = prepared
        if follow is not None:
            long.append("%s(buffer, e%s)" % (self.struct("_packer", str(back)), back_values))
        if text.bound is not None and text.bound < SHORT_TEXT:
            yield from short
        else:
            yield "if %s < %d:" % (size, SHORT_TEXT)
            yield short
            yield "else:"
            yield long
        self.variable, self.constant = "e", back.end

    def long_text(self, text: Text, fold: int) -> Iterator[str | Block]:
        """A string of any length, with its NUL and `fold` alignment behind it."""
        data, size = self.data, self.size
        if self.variable != "o" or self.constant:
            yield "o = %s" % self.position()
        self.variable, self.constant = "o", 0
        if fold > 1:
            yield "p = base - o - %s - %d & %d" % (size, text.terminator, fold - 1)
            yield "%s += _ZEROS[p + %d]" % (data, text.terminator)
            yield "%s += p + %d" % (size, text.terminator)
        elif text.terminator:
            yield '%s += b"\\0"' % data
            yield "%s += 1" % size
        yield from self.payload()

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
            count = slot.size // PRIMITIVE_SIZE[slot.primitive]
            if slot.primitive in ("float32", "float64") and count < MAX_TABLE:
                # What a program writes down by hand; integers would need a look at their range on MicroPython.
                pack = self.need(
                    "_%s_pack%d" % (slot.primitive, count),
                    '_numbers("%s").packers[%d]' % (slot.primitive, count),
                )
                yield "elif type(%s) is list:" % name
                yield ["%s = %s(*%s)" % (name, pack, name)]
            yield self.is_array(name, slot.primitive)
            yield ["%s = %s.tobytes()" % (name, name)]
            yield "else:"
            yield ["%s = bytes(%s(%s))" % (name, raw, name)]
        yield "if len(%s) != %d:" % (name, slot.size)
        yield ["raise ValueError"]

    def is_array(self, name: str, primitive: str, more: str = "") -> str:
        """Whether the array of the standard library has just these bytes."""
        kind = self.numbers(primitive, "array")
        return 'elif type(%s) is %s and %s.typecode == "%s"%s:' % (
            name,
            kind,
            name,
            TYPECODES[primitive],
            more,
        )

    def prepare(
        self, operation: Operation | None, holders: dict[Path, str]
    ) -> Generator[str | Block, None, str]:
        """Bring the value of the variable operation that follows into variables, whose names are then `data`
        and `size`; returns the count's expression."""
        data = self.data = self.locals.name("data")
        n = self.size = self.locals.name("n")
        if isinstance(operation, Sequence):
            self.items = self.locals.name("items")
            yield "%s = %s" % (self.items, self.value(operation.path, holders))
            yield "%s = len(%s)" % (n, self.items)
            if operation.element.name == "string":  # a lone string would pass for a list of letters
                yield "if type(%s) is str:" % self.items
                yield ["raise ValueError"]
            yield from self.bounded(operation.size)
            return n
        if operation is None or isinstance(operation, Run):
            raise ValueError("a count precedes a variable operation")
        value = self.value(operation.path, holders)
        unit = 1
        count = n
        if isinstance(operation, Text) and operation.wide:
            yield "%s = _encode_wide(%s, False)" % (data, value)
            unit = 4
        elif isinstance(operation, Text):
            yield "%s = %s.encode()" % (data, value)
            count = n + " + 1" if operation.terminator else n
        elif isinstance(operation, Octets):
            yield "%s = %s" % (data, value)
            yield "if type(%s) is not bytes:" % data
            yield ["%s = _octets(%s)" % (data, data)]
        else:
            unit = PRIMITIVE_SIZE[operation.primitive]
            tag = self.numbers(operation.primitive, "tag")
            yield "%s = %s" % (data, value)
            small = "%s.nbytes < %d" % (data, GATHER_MINIMUM)
            yield "if type(%s) is _ndarray and %s.dtype is %s and %s:" % (data, data, tag, small)
            yield ["%s = %s.tobytes()" % (data, data)]
            most = GATHER_MINIMUM // PRIMITIVE_SIZE[operation.primitive]
            yield self.is_array(data, operation.primitive, " and len(%s) < %d" % (data, most))
            yield ["%s = %s.tobytes()" % (data, data)]
            yield "else:"
            yield ["%s = %s(%s)" % (data, self.numbers(operation.primitive, "raw"), data)]
        yield "%s = len(%s)" % (n, data)
        yield from self.bounded(None if operation.bound is None else operation.bound * unit)
        return count if unit == 1 else "%s // %d" % (n, unit)

    def bounded(self, bound: int | None) -> Iterator[str | Block]:
        if bound is not None:
            yield "if %s > %d:" % (self.size, bound)
            yield ["raise ValueError"]

    def payload(self) -> Iterator[str | Block]:
        """Write the payload that was prepared."""
        if self.variable != "o" or self.constant:
            yield "o = %s" % self.position()
        yield "e = o + %s" % self.size
        yield "if %s < %d:" % (self.size, GATHER_MINIMUM)
        yield ["buffer[o:e] = %s" % self.data]
        yield "else:"
        inside = ["e = _place(buffer, o, %s, parts)" % self.data]
        if self.cdr:
            inside.append(_GATHERED % self.size)
        yield inside
        self.variable, self.constant = "e", 0

    def numeric(self, operation: Numbers) -> Iterator[str | Block]:
        if operation.align == 1 and not operation.pad:
            yield from self.payload()
            return
        yield from self.settle()
        data, n = self.data, self.size
        inside: list[str | Block] = []
        if operation.align == 1:
            zeros, pad = "_ZEROS[%d]" % operation.pad, str(operation.pad)
        else:
            self.uses_base = True
            inside.append("p = base - o & %d" % (operation.align - 1))
            zeros, pad = "_ZEROS[p]", "p"
        inside += [
            "if %s < %d:" % (n, GATHER_MINIMUM),
            ["%s += %s" % (n, pad), "buffer[o:o + %s] = %s + %s" % (n, zeros, data), "o += " + n],
            "else:",
            [
                "buffer[o:o + %s] = %s" % (pad, zeros),
                "o += " + pad,
                "e = _place(buffer, o, %s, parts)" % data,
                _GATHERED % n,
                "o = e",
            ],
        ]
        yield "if %s:" % n
        yield inside
        self.variable, self.constant = "o", 0

    def loop(self, operation: Sequence, holders: dict[Path, str]) -> Iterator[str | Block]:
        if operation.kind == "fixed":
            self.items = self.locals.name("items")
            yield "%s = %s" % (self.items, self.value(operation.path, holders))
            yield "if len(%s) != %d:" % (self.items, operation.size or 0)
            yield ["raise ValueError"]
        name = self.items
        if not operation.element.operations:  # messages without fields: the count is all
            return
        count = self.size
        element = self.locals.name("element")
        yield from self.settle()
        inner = self.structs(operation.element, element)
        body = list(self.sequence_of(operation.element.operations, inner, False))
        body += self.settle()
        every: Block = ["for %s in %s:" % (element, name), body]
        if operation.element.name == "string" and operation.kind != "fixed":
            yield from self.repeated(name, count, every)
        else:
            yield from every

    def repeated(self, items: str, count: str, every: Block) -> Iterator[str | Block]:
        """`every` writes strings that are often those of the message before, such as names of joints: what they came to
        is kept from the second time on, and copied. A count precedes them, so that their padding is the same anywhere."""
        cell = self.need("_texts%d" % len(self.globals_), "[((), None)]")
        names, last, kept, start = (self.locals.name(one) for one in ("names", "last", "kept", "start"))
        yield "%s = tuple(%s)" % (names, items)
        yield "%s, %s = %s[0]" % (last, kept, cell)
        yield "if %s is not None and %s == %s:" % (kept, names, last)
        yield ["e = o + len(%s)" % kept, "buffer[o:e] = " + kept, "o = e"]
        yield "else:"
        yield [
            start + " = o",
            *every,
            "if %s != %s:" % (names, last),
            ["%s[0] = (%s if %s <= %d else (), None)" % (cell, names, count, KEPT_TEXTS)],
            "elif %s < o and max(map(len, %s)) < %d:" % (start, names, KEPT_LENGTH),
            ["%s[0] = (%s, bytes(buffer[%s:o]))" % (cell, names, start)],
        ]

    def whole(self) -> Block | None:
        """The lines of `serialize`, if one call makes all bytes (with a short string among them or without);
        else None."""
        operations = self.layout.operations
        shapes = ((Run,), (Run, Text), (Run, Text, Run))
        if tuple(map(type, operations)) not in shapes or (len(operations) > 1 and operations[1].wide):  # type: ignore[union-attr]
            return None
        lead = operations[0]
        holders = self.structs(self.layout, "self")
        body: list[str | Block] = [*self.pending]
        body += self.whole_body(operations, holders, lead)  # type: ignore[arg-type]
        self.pending = []
        return [
            "def serialize(self):",
            ["try:", body, "except _FAILURES:", ["pass"], "return _serialize(self)"],
        ]

    def whole_body(
        self, operations: tuple[Operation, ...], holders: dict[Path, str], lead: Run
    ) -> Iterator[str | Block]:
        text = _at(operations, 1)
        form, values = yield from self.pieces(lead, text, holders, self.cdr)
        if not isinstance(text, Text):
            yield "return %s(%s)" % (self.struct("_bytes_packer", str(form)), values[2:])
            return
        data, n = self.data, self.size
        follow = _at(operations, 2)
        back, back_values = Form(), ""
        key = n
        if isinstance(follow, Run):
            back, back_values = yield from self.pieces(follow, None, holders, False)
            if follow.align > 1:
                end = lead.size + text.terminator
                key = "%s + (%d - %s & %d)" % (n, -end % follow.align, n, follow.align - 1)
        name = self.struct("_text_bytes_packers", form.codes(), back.codes(), text.terminator)
        call = "return %s[%s](%s, %s%s)" % (name, key, values[2:], data, back_values)
        yield "if %s < %d:" % (n, SHORT_TEXT)
        yield [call]


def _at(operations: tuple[Operation, ...], index: int) -> Operation | None:
    return operations[index] if index < len(operations) else None
