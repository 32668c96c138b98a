"""The C++ function that moves a message's fields to octets or back: one spelling of a layout, for writer and reader."""

from __future__ import annotations

from roslet.gen.cpp_names import STAMP_PARTS
from roslet.gen.lines import render
from roslet.layout import Layout, Numbers, Octets, Run, Sequence, Slot, Text

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from roslet.gen.lines import Block
    from roslet.idl import TypeName
    from roslet.layout.operations import Operation, Path

    Members = Callable[[TypeName], dict[str, str]]

WIDTH = 110
"""Columns of a line of generated code, except for names that are longer."""

_LARGEST_END = 0xFFFF  # the ends of a run's fields are uint16
_FAIL: list[str | Block] = [["return false;"], "}"]


class Codec:
    """Spells the body of `transfer`. Afterwards `fields` are the names of all fields, whose places are their numbers."""

    def __init__(self, layout: Layout, members: Members) -> None:
        self.members = members
        self.fields: list[str] = []
        self.numbers: dict[str, int] = {}
        self.declared = False
        self.body: list[str | Block] = [*self._operations(layout, "self", "", 0), "return true;"]

    def _operations(self, layout: Layout, root: str, label: str, depth: int) -> Iterator[str | Block]:
        scope = _Scope(layout, root, label, self.members)
        operations = layout.operations
        for index, operation in enumerate(operations):
            after = operations[index + 1] if index + 1 < len(operations) else None
            if isinstance(operation, Run):
                yield from self._run(operation, after, scope)
            elif isinstance(operation, Sequence):
                item = "item" if depth == 0 else "item%d" % (depth + 1)
                expression = scope.expression(operation.path)
                before = self.declared
                label_inside = scope.label(operation.path) + "[]"
                inside = list(self._operations(operation.element, item, label_inside, depth + 1))
                self.declared = before
                if not inside:
                    continue  # empty messages in ROS 1, which have no octets
                text = render(inside)
                used = item + "." in text or item + ", " in text
                yield "for (%sauto& %s : %s) {" % ("" if used else "[[maybe_unused]] ", item, expression)
                yield inside
                yield "}"

    def _run(self, run: Run, after: Operation | None, scope: _Scope) -> Iterator[str | Block]:
        slots = [slot for slot in run.slots if slot.size]
        start, align = 0, run.align
        while slots:
            taken = 1
            while taken < len(slots) and _end(slots[taken - 1]) - start <= _LARGEST_END:
                taken += 1
            piece, slots = slots[:taken], slots[taken:]
            size = (_end(piece[-1]) if slots else run.size) - start
            yield from self._piece(piece, start, size, align, after, scope)
            start, align = start + size, 1

    def _piece(
        self, slots: list[Slot], start: int, size: int, align: int, after: Operation | None, scope: _Scope
    ) -> Iterator[str | Block]:
        numbers = [self._number(scope.label(slot.path)) for slot in slots]
        ends = [_end(slot) - start for slot in slots[:-1]]
        yield from self._get(align, numbers[0], size, ends)
        position = 0
        for slot, number in zip(slots, numbers, strict=True):
            offset = slot.offset - start
            if offset > position:
                yield "codec.padding(%s, %d);" % (_place(position), offset - position)
            position = offset + slot.size
            if slot.role == "dummy":
                yield "codec.padding(%s, 1);  // an empty struct" % _place(offset)
            elif slot.role == "count":
                yield "if (!codec.%s(%s, %s, %d)) {" % (
                    _variable(after),
                    _place(offset),
                    scope.expression(slot.path),
                    number,
                )
                yield from _FAIL
            else:
                yield "codec.value(%s, %s);" % (_place(offset), scope.expression(slot.path))

    def _get(self, align: int, number: int, size: int, ends: list[int]) -> Iterator[str | Block]:
        """Set `at` to the first octet of a run."""
        head = "at = codec.run(roslet::run<" if self.declared else "auto* at = codec.run(roslet::run<"
        self.declared = True
        line = head
        more: list[str | Block] = []
        arguments = [str(argument) for argument in (align, number, size, *ends)]
        for index, argument in enumerate(arguments):
            text = argument + (", " if index + 1 < len(arguments) else ">);")
            if len(line) + len(text) > WIDTH - 12:
                more.append(line.rstrip())
                line = ""
            line += text
        if more:
            yield more[0]
            yield [*more[1:], line]
        else:
            yield line
        yield "if (at == nullptr) {"
        yield from _FAIL

    def _number(self, label: str) -> int:
        if label not in self.numbers:
            self.numbers[label] = len(self.fields)
            self.fields.append(label)
        return self.numbers[label]


class _Scope:
    """How paths are spelled in a message, or in an element of a sequence."""

    def __init__(self, layout: Layout, root: str, label: str, members: Members) -> None:
        self.structs: dict[Path, TypeName | str] = {(): layout.name, **dict(layout.structs)}
        self.root = root
        self.prefix = label
        self.members = members

    def expression(self, path: Path) -> str:
        """The value at a path."""
        text = self.root
        for index, part in enumerate(path):
            holder = self.structs[path[:index]]
            text += "." + (STAMP_PARTS[part] if isinstance(holder, str) else self.members(holder)[part])
        return text

    def label(self, path: Path) -> str:
        """The path as people read it, from the message on: `poses[].header.frame_id`."""
        parts = [self.prefix] if self.prefix else []
        for index, part in enumerate(path):
            parts.append(STAMP_PARTS[part] if isinstance(self.structs[path[:index]], str) else part)
        return ".".join(parts) or "(empty)"


def _end(slot: Slot) -> int:
    return slot.offset + slot.size


def _place(offset: int) -> str:
    return "at + %d" % offset if offset else "at"


def _variable(operation: Operation | None) -> str:
    """The function for what follows its count."""
    if isinstance(operation, Text):
        return "text"
    if isinstance(operation, (Octets, Numbers)):
        return "numbers"
    return "count"
