"""Definitions out of ROS 2 type descriptions (REP-2016), for types that only a peer knows.

Constants, default values and comments are in no description; layout and hash are complete.
"""

from __future__ import annotations

from roslet.errors import DefinitionError
from roslet.idl import rihs
from roslet.idl.spelling import RULE_LENGTH

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

# Types that one description may refer to; real ones have some dozens.
MAX_TYPES = 1000


def definition_text(description: dict[str, Any]) -> str:
    """The text that `Registry.load_full_text` reads: of the type described, then of each type that it refers to.

    `description` has the keys of type_description_interfaces/msg/TypeDescription. It may be a peer's: raises DefinitionError
    where it is no description of a message; names and bounds are for the parser to check.
    """
    parts = [_fields(description["type_description"])]
    referenced = description["referenced_type_descriptions"]
    if len(referenced) > MAX_TYPES:
        raise DefinitionError(f"a description of {len(referenced)} types; at most {MAX_TYPES} are taken")
    for one in referenced:
        parts.append(f"{'=' * RULE_LENGTH}\nMSG: {_line(one['type_name'])}\n{_fields(one)}")
    return "\n".join(parts)


def _fields(one: dict[str, Any]) -> str:
    return "\n".join([f"{_spelled(field['type'])} {_line(field['name'])}" for field in one["fields"]])


def _line(text: str) -> str:
    if not text.isprintable():
        raise DefinitionError(f"{text!r} is no name")
    return text


def _spelled(kind: dict[str, Any]) -> str:
    """A field's type as a definition has it."""
    number, capacity = kind["type_id"], kind["capacity"]
    step = number - number % rihs.ARRAY_OFFSETS["fixed"]
    if step == 0:
        suffix = ""
    elif step == rihs.ARRAY_OFFSETS["fixed"]:
        suffix = f"[{capacity}]"
    elif step == rihs.ARRAY_OFFSETS["bounded"]:
        suffix = f"[<={capacity}]"
    else:
        suffix = "[]"
    single = number - step
    if single == rihs.NESTED:
        return _line(kind["nested_type_name"]).replace("/msg/", "/", 1) + suffix
    if single in _BOUNDED:
        return f"{_BOUNDED[single]}<={kind['string_capacity']}{suffix}"
    if single not in _SINGLE or step > rihs.ARRAY_OFFSETS["unbounded"]:
        raise DefinitionError(f"a field of type id {number} has no spelling in a .msg file")
    return _SINGLE[single] + suffix


_SINGLE = {number: name for name, number in rihs.TYPE_IDS.items()}
_BOUNDED = {number: name for name, number in rihs.BOUNDED_TYPE_IDS.items()}
