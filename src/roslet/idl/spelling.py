"""Which names are legal in each dialect, and the primitive types by every spelling. No I/O."""

from __future__ import annotations

from roslet.errors import DefinitionError, InvalidName
from roslet.idl.records import FieldType, TypeName

TYPE_CHECKING = False
if TYPE_CHECKING:
    from roslet.idl.records import Dialect, Kind

# Between the parts of a full text stands a line of so many `=`.
RULE_LENGTH = 80

KINDS: tuple[Kind, ...] = ("msg", "srv", "action")

_NUMBERS = (
    ("bool", "bool"),
    ("int8", "int8"),
    ("uint8", "uint8"),
    ("int16", "int16"),
    ("uint16", "uint16"),
    ("int32", "int32"),
    ("uint32", "uint32"),
    ("int64", "int64"),
    ("uint64", "uint64"),
    ("float32", "float32"),
    ("float64", "float64"),
    ("string", "string"),
    ("char", "uint8"),
)


def _table(*more: tuple[str, str]) -> dict[str, FieldType]:
    return {spelled: FieldType(primitive, None, spelled) for spelled, primitive in _NUMBERS + more}


# ROS 1: http://wiki.ros.org/msg, section "Field types"; ROS 2: the interface concept page of its
# documentation, where `byte` is an octet.
PRIMITIVES: dict[str, dict[str, FieldType]] = {
    "ros1": _table(("byte", "int8"), ("time", "time"), ("duration", "duration")),
    "ros2": _table(("byte", "uint8"), ("wstring", "wstring")),
}

# The integers and the values that each holds.
INTEGER_RANGES: dict[str, tuple[int, int]] = {
    "int8": (-0x80, 0x7F),
    "uint8": (0, 0xFF),
    "int16": (-0x8000, 0x7FFF),
    "uint16": (0, 0xFFFF),
    "int32": (-0x80000000, 0x7FFFFFFF),
    "uint32": (0, 0xFFFFFFFF),
    "int64": (-0x8000000000000000, 0x7FFFFFFFFFFFFFFF),
    "uint64": (0, 0xFFFFFFFFFFFFFFFF),
}

_FIELD_RULE = "lower-case letters, digits and single underscores, a letter first, no underscore last"
_CONSTANT_RULE = "capitals, digits and single underscores, a letter first, no underscore last"


def is_word(name: str) -> bool:
    """Letters, digits and underscores of ASCII, beginning with a letter."""
    return name.isascii() and name.isidentifier() and name[0] != "_"


def _is_snake(name: str) -> bool:
    return is_word(name) and name == name.lower() and "__" not in name and name[-1] != "_"


def package_problem(name: str, dialect: Dialect) -> str:
    """Why this is no package name; empty if it is one."""
    if dialect == "ros1":
        # Packages of ROS 1 may carry a dash, though no message in them can then be named from another
        # package.
        if is_word(name.replace("-", "_")):
            return ""
        return "package names are made of letters, digits and underscores and begin with a letter"
    return "" if _is_snake(name) else "package names are made of " + _FIELD_RULE


def interface_problem(name: str, dialect: Dialect) -> str:
    """Why this is no name for a message, service or action; empty if it is one."""
    if dialect == "ros1":
        if is_word(name):
            return ""
        return "type names are made of letters, digits and underscores and begin with a letter"
    if name.isascii() and name.isalnum() and "A" <= name[0] <= "Z":
        return ""
    return "type names are made of letters and digits and begin with a capital"


def field_problem(name: str, dialect: Dialect) -> str:
    """Why this is no field name; empty if it is one."""
    if dialect == "ros1":
        if is_word(name):
            return ""
        return "field names are made of letters, digits and underscores and begin with a letter"
    return "" if _is_snake(name) else "field names are made of " + _FIELD_RULE


def constant_problem(name: str, dialect: Dialect) -> str:
    """Why this is no constant name; empty if it is one."""
    if dialect == "ros1":
        if is_word(name):
            return ""
        return "constant names are made of letters, digits and underscores and begin with a letter"
    if is_word(name) and name == name.upper() and "__" not in name and name[-1] != "_":
        return ""
    return "constant names are made of " + _CONSTANT_RULE


def parse_type_name(text: str, kind: Kind = "msg") -> TypeName:
    """The name that `pkg/Name` (then of `kind`) or `pkg/msg/Name` spells.

    Raises InvalidName for anything else. Both dialects' names pass; whether such a type exists is the
    registry's matter.
    """
    parts = text.split("/")
    if len(parts) == 3 and parts[1] in KINDS:
        kind = KINDS[KINDS.index(parts[1])]
    elif len(parts) != 2:
        raise InvalidName(f"{text!r} is no type name: expected package/Name or package/msg/Name")
    if not is_word(parts[0].replace("-", "_")) or not is_word(parts[-1]):
        raise InvalidName(f"{text!r} is no type name: packages and names are letters, digits and underscores")
    return TypeName(parts[0], kind, parts[-1])


def split_full_text(name: TypeName, text: str) -> dict[TypeName, str]:
    """The definitions that a ROS 1 full text holds: that of `name`, then those it names.

    Raises DefinitionError (with the line) where a section does not begin with `MSG: package/Name`,
    InvalidName for a wrong name.
    """
    sections: dict[TypeName, list[str]] = {name: []}
    lines = sections[name]
    expected = False
    for number, line in enumerate(text.split("\n"), 1):
        if expected:
            word, _, rest = line.partition(":")
            if word.strip() != "MSG" or not rest.strip():
                raise DefinitionError(f"expected MSG: package/Name, got {line!r}", "<full text>", number, 1)
            lines = []
            sections.setdefault(parse_type_name(rest.strip()), lines)
            expected = False
        elif len(line) >= RULE_LENGTH and not line.strip("= \r"):
            expected = True
        else:
            lines.append(line)
    return {name: "\n".join(lines) for name, lines in sections.items()}
