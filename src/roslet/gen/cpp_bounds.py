"""The bounds of strings and sequences where memory is laid out beforehand: definitions, with a bound for every variable
part."""

from __future__ import annotations

from roslet.errors import DefinitionError, InvalidName, UnknownType
from roslet.idl import Message, parse_type_name
from roslet.idl.records import Array, Field, FieldType

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping

    from roslet.idl import Registry, TypeName

STRING_BOUND = 64
SEQUENCE_BOUND = 32
"""Octets of a string and elements of a sequence for which neither the definition nor the user has a bound."""

MAXIMUM_BOUND = 0xFFFFFFFF  # a count is a uint32


class Bounds:
    """How much room variable parts have: `string` (octets) and `sequence` (elements) where the definition has no bound,
    and `at` for single ones: (type, field) -> bound, where `field[]` stands for the strings in an array.

    A bound of `at` may be less than the definition's, which peers know; never more. Raises ValueError for one below 1.
    """

    def __init__(
        self,
        string: int = STRING_BOUND,
        sequence: int = SEQUENCE_BOUND,
        at: Mapping[tuple[TypeName, str], int] | None = None,
    ) -> None:
        self.string = string
        self.sequence = sequence
        self.at = dict(at or {})
        named = [(f"{name}.{field}", bound) for (name, field), bound in self.at.items()]
        for what, bound in (("strings", string), ("sequences", sequence), *named):
            if not 1 <= bound <= MAXIMUM_BOUND:
                raise ValueError(f"the bound of {what} is from 1 to {MAXIMUM_BOUND}, not {bound}")

    def message(self, message: Message) -> Message:
        """`message` with a bound for every string and sequence."""
        fields = [self._field(message.name, field) for field in message.fields]
        return message.replace(fields=tuple(fields))

    def _field(self, owner: TypeName, field: Field) -> Field:
        kind = field.type
        array = kind.array
        string_bound = kind.string_bound
        if kind.primitive in ("string", "wstring"):
            key = field.name if array is None else field.name + "[]"
            string_bound = self._bound((owner, key), string_bound, self.string)
        if array is not None and array.kind != "fixed":
            array = Array("bounded", self._bound((owner, field.name), array.size, self.sequence))
        bounded = FieldType(kind.primitive, kind.message, kind.spelled, string_bound, array)
        return Field(field.name, bounded, field.default, field.line)

    def _bound(self, key: tuple[TypeName, str], defined: int | None, default: int) -> int:
        given = self.at.get(key)
        if given is None:
            return default if defined is None else defined
        return given if defined is None else min(given, defined)


def read_bounds(text: str, registry: Registry, file: str) -> dict[tuple[TypeName, str], int]:
    """What `Bounds.at` takes, from lines such as `std_msgs/Header.frame_id 32`; `#` begins a comment.

    Raises DefinitionError, with the place in `file`, for a line that is none, and for a type or field that is not there, or
    has no bound.
    """
    found: dict[tuple[TypeName, str], int] = {}
    for number, line in enumerate(text.split("\n"), 1):
        words = line.partition("#")[0].split()
        if not words:
            continue
        path, dot, field = words[0].rpartition(".")
        if len(words) != 2 or not dot or not words[1].isdecimal():
            raise DefinitionError("expected package/Name.field and a number", file, number, 1)
        try:
            message = registry.interface(parse_type_name(path) if path.count("/") > 1 else path)
        except (InvalidName, UnknownType) as error:
            raise DefinitionError(str(error), file, number, 1) from None
        if not isinstance(message, Message):
            raise DefinitionError(f"{path} is no message; name its parts", file, number, 1)
        if field not in _variable(message):
            raise DefinitionError(f"{path} has no string or sequence {field}", file, number, 1)
        bound = int(words[1])
        if not 1 <= bound <= MAXIMUM_BOUND:
            raise DefinitionError(f"a bound is from 1 to {MAXIMUM_BOUND}", file, number, 1)
        found[message.name, field] = bound
    return found


def _variable(message: Message) -> set[str]:
    """The names in `message` that have bounds."""
    found = set()
    for field in message.fields:
        array = field.type.array
        if array is not None and array.kind != "fixed":
            found.add(field.name)
        if field.type.primitive in ("string", "wstring"):
            found.add(field.name if array is None else field.name + "[]")
    return found
