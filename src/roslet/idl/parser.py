"""Text of .msg, .srv and .action files to records. No I/O; every error is a DefinitionError with its place.

ROS 1 (http://wiki.ros.org/msg, /srv, and actionlib's .action): a line is `type name` or `type NAME=value`.
ROS 2 (the interface page of its documentation): a line is `type name`, `type name default` or
`type NAME=value`, and types may be bounded.
In both, `#` begins a comment, except in a ROS 1 string constant, whose value is the whole rest of the line.
"""

from __future__ import annotations

from roslet.errors import DefinitionError
from roslet.idl.derived import ros1_action, ros2_action, ros2_event
from roslet.idl.records import Array, Constant, Field, FieldType, Message, Service, TypeName
from roslet.idl.spelling import (
    PRIMITIVES,
    constant_problem,
    field_problem,
    interface_problem,
    package_problem,
)
from roslet.idl.values import default_value, scalar_value

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import NoReturn

    from roslet.idl.records import Action, Dialect, Interface, Value

# Lengths of arrays and strings travel as 32-bit counts, so no bound can be greater.
MAXIMUM_BOUND = 0xFFFFFFFF

# Error messages quote no more of a text than this.
_QUOTED = 60

_SEPARATOR = "---"
_SEPARATOR_RULE = "the separator is a line that holds --- and begins with it"
# What ROS 1 calls a primitive. ROS 2 has no such words; roslet reads them as the messages that took their place, so that
# one definition serves on both networks.
_TIMES = {
    "time": TypeName("builtin_interfaces", "msg", "Time"),
    "duration": TypeName("builtin_interfaces", "msg", "Duration"),
}


def parse(text: str, name: TypeName, dialect: Dialect, file: str = "", own_header: bool = True) -> Interface:
    """The interface that `text` defines; `name.kind` says whether as a .msg, .srv or .action.

    Nested types are named, not looked up. In ROS 2 `time` and `duration` are those of builtin_interfaces, and the bare
    word `Header` is std_msgs/Header where the package has no `own_header`; ROS 2 itself refuses all three. Raises
    DefinitionError, and nothing else, for any wrong text; `file` is only shown there. Time is linear in the length of the
    text.
    """
    problem = package_problem(name.package, dialect) or interface_problem(name.name, dialect)
    if problem:
        raise DefinitionError(f"{name}: {problem}", file)
    reader = _Reader(name, dialect, file, own_header)
    if name.kind == "msg":
        return reader.message(name, text, 1)
    if name.kind == "srv":
        return reader.service(text)
    return reader.action(text)


class _Reader:
    """Reads one file; holds what every error message needs."""

    __slots__ = ("dialect", "file", "line", "name", "own_header", "primitives")

    def __init__(self, name: TypeName, dialect: Dialect, file: str, own_header: bool) -> None:
        self.name = name
        self.dialect: Dialect = dialect
        self.file = file
        self.line = 0
        self.own_header = own_header
        self.primitives = PRIMITIVES[dialect]

    def fail(self, message: str, column: int, line: int | None = None) -> NoReturn:
        raise DefinitionError(message, self.file, self.line if line is None else line, column) from None

    # .srv and .action: parts between separator lines

    def parts(self, text: str) -> list[tuple[str, int]]:
        """The parts' texts, each with the number of its first line.

        The texts are cut as the dialect's own tools cut them, since ROS 1 sends them to its peers.
        """
        ros1 = self.dialect == "ros1"
        parts: list[tuple[list[str], int]] = [([], 1)]
        for number, line in enumerate(text.split("\n"), 1):
            if line.startswith(_SEPARATOR) and (ros1 or line.rstrip() == _SEPARATOR):
                parts.append(([], number + 1))
            else:
                parts[-1][0].append(line)
        end = "\n" if ros1 else ""
        return [("\n".join(lines) + end if lines else "", first) for lines, first in parts]

    def service(self, text: str) -> Service:
        parts = self.parts(text)
        if self.dialect == "ros1":
            # genmsg takes every line after the first separator for the response and a missing one for an
            # empty response.
            request = self.message(self.part_name("Request"), *parts[0])
            rest = [self.message(self.part_name("Response"), *part) for part in parts[1:]]
            response = self.join(self.part_name("Response"), rest)
            return Service(self.name, self.dialect, request, response, None, text, self.file)
        self.expect_parts(
            text, parts, 2, "a service has a request and a response, with one line --- between them"
        )
        request = self.message(self.part_name("_Request"), *parts[0])
        response = self.message(self.part_name("_Response"), *parts[1])
        event = ros2_event(self.name, self.file)
        return Service(self.name, self.dialect, request, response, event, text, self.file)

    def action(self, text: str) -> Action:
        parts = self.parts(text)
        self.expect_parts(
            text, parts, 3, "an action has a goal, a result and a feedback, with lines --- between them"
        )
        separator = "" if self.dialect == "ros1" else "_"
        goal, result, feedback = [
            self.message(self.part_name(separator + part), *parts[index])
            for index, part in enumerate(("Goal", "Result", "Feedback"))
        ]
        derive = ros1_action if self.dialect == "ros1" else ros2_action
        return derive(self.name, goal, result, feedback, text, self.file)

    def expect_parts(self, text: str, parts: list[tuple[str, int]], count: int, rule: str) -> None:
        if len(parts) > count:
            self.fail("one line --- too many: " + rule, 1, parts[count][1] - 1)
        if len(parts) < count:
            for part, first_line in parts:
                for line, code in enumerate(part.split("\n"), first_line):
                    if code.lstrip().startswith(_SEPARATOR):
                        column = len(code) - len(code.lstrip()) + 1
                        self.fail(_SEPARATOR_RULE, column, line)
            last_line = text.rstrip("\n").count("\n") + 1
            self.fail("a line --- is missing: " + rule, 1, last_line)

    def part_name(self, suffix: str) -> TypeName:
        kind = "msg" if self.dialect == "ros1" and self.name.kind == "action" else self.name.kind
        return TypeName(self.name.package, kind, self.name.name + suffix)

    def join(self, name: TypeName, parts: list[Message]) -> Message:
        if len(parts) == 1:
            return parts[0]
        fields = tuple([field for part in parts for field in part.fields])
        constants = tuple([constant for part in parts for constant in part.constants])
        self.check_unique(fields, constants)
        return Message(
            name, self.dialect, fields, constants, "".join([part.text for part in parts]), self.file
        )

    def check_unique(self, fields: tuple[Field, ...], constants: tuple[Constant, ...]) -> None:
        taken: dict[str, int] = {}
        entries: list[Field | Constant] = [*fields, *constants]
        for entry in sorted(entries, key=lambda entry: entry.line):
            if entry.name in taken:
                self.fail(f"{entry.name} is defined twice, first in line {taken[entry.name]}", 1, entry.line)
            taken[entry.name] = entry.line

    # One message's lines

    def message(self, name: TypeName, text: str, first_line: int) -> Message:
        fields: list[Field] = []
        constants: list[Constant] = []
        taken: dict[str, int] = {}
        self.line = first_line - 1
        for line in text.split("\n"):
            self.line += 1
            comment = line.find("#")
            code = line if comment < 0 else line[:comment]
            words = code.split(None, 1)
            if not words:
                continue
            spelled = words[0]
            type_at = code.find(spelled)
            if len(words) == 1:
                self.incomplete(spelled, type_at)
            rest = words[1].rstrip()
            rest_at = code.find(rest, type_at + len(spelled))
            entry: Field | Constant
            entry_name, after = _leading_name(rest)
            after_at = rest_at + len(rest) - len(after)
            if after[:1] == "=":
                if spelled == "string" and self.dialect == "ros1":
                    after = line[after_at:]
                entry = self.constant(spelled, type_at, entry_name, rest_at, after, after_at)
                constants.append(entry)
            else:
                entry = self.field(spelled, type_at, entry_name, rest_at, after, after_at)
                fields.append(entry)
            if entry_name in taken:
                first = taken[entry_name]
                self.fail(f"{entry_name} is defined twice, first in line {first}", rest_at + 1)
            taken[entry_name] = self.line
        return Message(name, self.dialect, tuple(fields), tuple(constants), text, self.file)

    def incomplete(self, word: str, at: int) -> NoReturn:
        if word.startswith(_SEPARATOR):
            if self.name.kind == "msg":
                self.fail("lines --- belong to .srv and .action files", at + 1)
            self.fail(_SEPARATOR_RULE, at + 1)
        self.fail(f"expected a name after the type {_quoted(word)}", at + len(word) + 1)

    def field(self, spelled: str, type_at: int, name: str, name_at: int, after: str, after_at: int) -> Field:
        type_ = self.type(spelled, type_at)
        problem = field_problem(name, self.dialect) if name else "the name is missing"
        if problem:
            self.fail(f"{_quoted(name or after)} is no field name: {problem}", name_at + 1)
        if not after:
            return Field(name, type_, None, self.line)
        if self.dialect == "ros1":
            self.fail(
                f"expected the end of the line after {name}: ROS 1 fields have no default values",
                after_at + 1,
            )
        try:
            return Field(name, type_, default_value(type_, after), self.line)
        except ValueError as error:
            self.fail(f"default of {name}: {error}", after_at + 1)

    def constant(
        self, spelled: str, type_at: int, name: str, name_at: int, after: str, after_at: int
    ) -> Constant:
        type_ = self.primitives.get(spelled)
        if type_ is None or spelled in _TIMES:
            self.type(spelled, type_at)  # a spelling mistake is the better error
            self.fail(
                f"a constant is a number, a bool or a string, not of type {_quoted(spelled)}", type_at + 1
            )
        problem = constant_problem(name, self.dialect) if name else "the name is missing"
        if problem:
            self.fail(f"{_quoted(name or after)} is no constant name: {problem}", name_at + 1)
        text = after[1:].strip()
        try:
            value: Value = scalar_value(self.dialect, type_, text)
        except ValueError as error:
            value_at = after_at + 1 + len(after[1:]) - len(after[1:].lstrip())
            self.fail(f"constant {name}: {error}", value_at + 1)
        return Constant(name, type_, value, text, self.line)

    # Types

    def type(self, spelled: str, at: int) -> FieldType:
        simple = self.primitives.get(spelled)
        if simple is not None:
            return simple
        base, array = spelled, None
        bracket = spelled.rfind("[") if spelled[-1] == "]" else -1
        if bracket > 0:
            base = spelled[:bracket]
            array = self.array(spelled[bracket + 1 : -1], at + bracket + 1)
        elif "[" in spelled or "]" in spelled:
            self.fail(f"{_quoted(spelled)}: brackets do not match", at + 1 + max(spelled.find("["), 0))
        simple = self.primitives.get(base)
        if simple is not None:
            return FieldType(simple.primitive, None, base, None, array)
        if "[" in base or "]" in base:
            self.fail(
                f"{_quoted(spelled)}: arrays have one dimension",
                at + base.find("[" if "[" in base else "]") + 1,
            )
        less = base.find("<")
        if less >= 0:
            return self.bounded_string(base, less, at, array)
        return FieldType(None, self.nested(base, array, at), base, None, array)

    def array(self, size: str, at: int) -> Array:
        if not size:
            return Array("unbounded")
        if size[0] == "<":
            if self.dialect == "ros1":
                self.fail("ROS 1 has no bounded arrays", at + 1)
            if size[:2] != "<=":
                self.fail("a bound is written [<=N]", at + 1)
            return Array("bounded", self.size(size[2:], at + 2, 1))
        return Array("fixed", self.size(size, at, 0 if self.dialect == "ros1" else 1))

    def size(self, digits: str, at: int, minimum: int) -> int:
        if not digits.isdecimal() or not digits.isascii():
            self.fail(f"expected a size in decimal digits, not {_quoted(digits)}", at + 1)
        # The text of an array type enters the MD5 of ROS 1, where 03 and 3 would differ.
        if len(digits) > 1 and digits[0] == "0":
            self.fail("a size has no leading zeros", at + 1)
        if len(digits) > len(str(MAXIMUM_BOUND)) or not minimum <= int(digits) <= MAXIMUM_BOUND:
            self.fail(f"a size is at least {minimum} and at most {MAXIMUM_BOUND}", at + 1)
        return int(digits)

    def bounded_string(self, base: str, less: int, at: int, array: Array | None) -> FieldType:
        spelled = base[:less]
        if spelled not in ("string", "wstring"):
            self.fail(f"only string and wstring have a bound, not {_quoted(spelled or base)}", at + less + 1)
        if self.dialect == "ros1":
            self.fail("ROS 1 has no bounded strings", at + less + 1)
        if base[less : less + 2] != "<=":
            self.fail(f"a bound is written {spelled}<=N", at + less + 1)
        return FieldType(spelled, None, spelled, self.size(base[less + 2 :], at + less + 2, 1), array)

    def nested(self, base: str, array: Array | None, at: int) -> TypeName:
        dialect = self.dialect
        if dialect == "ros2" and base in _TIMES:
            return _TIMES[base]
        if base == "Header" and array is None and (dialect == "ros1" or not self.own_header):
            # Only the bare word: an array of them means the package's own type, as genmsg reads it.
            return TypeName("std_msgs", "msg", "Header")
        package, slash, name = base.partition("/")
        if not slash:
            package, name = self.name.package, base
        elif "/" in name:
            self.fail(f"{_quoted(base)} is no type name: expected package/Name", at + 1)
        problem = package_problem(package, dialect) if package else "the package is missing"
        if problem:
            self.fail(f"{_quoted(base)} is no type name: {problem}", at + 1)
        problem = interface_problem(name, dialect) if name else "the name is missing"
        if problem:
            self.fail(f"{_quoted(base)} is no type: {problem}", at + len(base) - len(name) + 1)
        return TypeName(package, "msg", name)


def _leading_name(rest: str) -> tuple[str, str]:
    """The first word of `rest`, up to white space or `=`, and what follows it."""
    equals = rest.find("=")
    head = rest if equals < 0 else rest[:equals]
    words = head.split(None, 1)
    if len(words) == 1:
        return words[0], "" if equals < 0 else rest[equals:]
    if not words:
        return "", rest[equals:]
    return words[0], rest[rest.find(words[1], len(words[0])) :]


def _quoted(text: str) -> str:
    return text if len(text) <= _QUOTED else text[: _QUOTED - 3] + "..."
