"""Python source of a deserialiser: `deserialize_from` and `deserialize`."""

from __future__ import annotations

from roslet.gen.python_codec import ENCAPSULATION, SHORT_TEXT, Codec, Form, has_views, is_bytes
from roslet.gen.python_names import attribute
from roslet.layout import PRIMITIVE_SIZE, Numbers, Octets, Run, Sequence, Text
from roslet.wire.arrays import TYPECODES
from roslet.wire.cursor import MAX_EMPTY_ELEMENTS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator

    from roslet.gen.lines import Block
    from roslet.layout import Layout
    from roslet.layout.operations import Operation, Path


class Deserializer(Codec):
    """Spells `deserialize_from`."""

    prefix = "unpack"

    def source(self) -> Block:
        """The lines of the function `_read` that, as a class method, is both `deserialize_from` and
        `deserialize`, which has no bounds. Afterwards `globals_` and `references` say what they need."""
        self.variable = "start"
        body = list(self.body())
        yield "def _read(cls, buffer, start=0, end=None):"
        whole = ["end = len(buffer)"]
        if has_views(self.layout.operations):
            whole.append("buffer = memoryview(buffer)")
        yield [
            "if end is None:",
            ["if type(buffer) is not bytes:", ["return _deserialize(cls, buffer)"], *whole],
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
        yield "if kind & 65535 != %d:" % ENCAPSULATION
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
        index = 0
        while index < len(operations):
            operation = operations[index]
            index += 1
            if isinstance(operation, Run):
                yield from self.run(operation, holders, header)
                header = False
            elif isinstance(operation, Text) and operation.wide:
                yield from self.wide(operation, holders)
            elif isinstance(operation, Text):
                after = operations[index] if index < len(operations) else None
                if isinstance(after, Run):
                    index += 1
                    yield from self.text(operation, after, holders)
                else:
                    yield from self.text(operation, None, holders)
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
        if run.align > 1:
            self.uses_base = True
            yield from self.settle()
            yield "o += base - o & %d" % (run.align - 1)
        form = Form()
        targets: list[str] = []
        if header:
            form.add("I", 4)
            targets.append("kind")
        shift = form.end
        rest = self.slots(run, form, targets, holders)
        if targets:
            call = "%s(buffer, %s)" % (self.struct("_unpacker", str(form)), self.position())
            yield "%s = %s" % (_left(targets), call)
        if header:
            yield from self.check_kind()
        yield from rest
        self.constant += shift + run.size

    def slots(self, run: Run, form: Form, targets: list[str], holders: dict[Path, str]) -> list[str]:
        """Add a run to `form` and `targets`; the lines that make the rest of its values, from the position of
        the form's start."""
        rest: list[str] = []
        shift = form.end
        for slot in run.slots:
            size = PRIMITIVE_SIZE[slot.primitive]
            if slot.role == "dummy":
                continue
            if slot.count is not None and not is_bytes(slot):
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
        return rest

    def text(self, text: Text, after: Run | None, holders: dict[Path, str]) -> Iterator[str | Block]:
        """A string and the run behind it: one call if the string is short."""
        bound = text.bound
        yield from self.bounded(None if bound is None else bound + text.terminator)
        yield from self.settle()
        yield "e = o + n"
        pad = after is not None and after.align > 1
        if pad and after is not None:
            self.uses_base = True
            yield "p = base - e & %d" % (after.align - 1)
            yield "e += p"
        self.variable, self.constant = "e", 0
        form = Form()
        targets: list[str] = []
        rest = [] if after is None else self.slots(after, form, targets, holders)
        arguments = (form.codes(), text.terminator)
        table = self.struct("_padded_text_unpackers" if pad else "_text_unpackers", *arguments)
        stop = "o + n - %d" % text.terminator if text.terminator else "o + n" if pad else "e"
        raw = 'str(buffer[o:%s], "utf-8", "surrogateescape")' % stop
        long = [self.store(text.path, holders, raw)]
        if targets:
            long.append("%s = %s(buffer, e)" % (_left(targets), self.struct("_unpacker", str(form))))
        yield "if n < %d:" % SHORT_TEXT
        call = "%s[%s](buffer, o)" % (table, "n << 3 | p" if pad else "n")
        # The strict decoder is the quicker one. Bytes that are no UTF-8 raise, and the rescue reads them.
        raw = "raw.decode()"
        yield ["%s = %s" % (_left(["raw", *targets]), call), self.store(text.path, holders, raw)]
        yield "else:"
        yield long
        yield from rest
        self.constant = 0 if after is None else after.size

    def wide(self, text: Text, holders: dict[Path, str]) -> Iterator[str | Block]:
        yield from self.bounded(text.bound)
        yield from self.settle()
        yield "e = o + n * 4"
        yield self.store(text.path, holders, "_decode_wide(buffer[o:e], False)")
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
        if element.name == "string":
            self.items_name = items
            yield from self.texts(element)
            return
        yield "for _ in range(n):"
        body: list[str | Block] = []
        saved = self.holders
        if element.name == "wstring":
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

    def texts(self, element: Layout) -> Iterator[str | Block]:
        """`n` strings from `o`; each call reads a string together with the length of the next."""
        length, text = element.operations
        if not isinstance(length, Run) or not isinstance(text, Text):
            raise ValueError("the layout of a string is a length and a payload")
        follow = Run(PRIMITIVE_SIZE["uint32"] if self.cdr else 1, length.size, length.slots)
        inside: list[str | Block] = ["m = n - 1", *self.run(length, {}, False), *self.settle()]
        body = [*self.text(text, follow, {}), *self.settle()]
        inside += ["for _ in range(m):", body, *self.text(text, None, {}), *self.settle()]
        yield "if n:"
        yield inside


def _left(targets: list[str]) -> str:
    return ", ".join(targets) if len(targets) > 1 else "(%s,)" % targets[0]
