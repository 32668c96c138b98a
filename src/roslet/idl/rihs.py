"""ROS 2: type descriptions and the RIHS01 type hash (REP-2011, REP-2016)."""

from __future__ import annotations

from roslet.errors import Unsupported
from roslet.idl.records import Array, Field, FieldType, Message, Service, TypeName

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from roslet.idl.records import Interface, Value
    from roslet.idl.registry import Registry

# type_description_interfaces/msg/FieldType: the id of a single value; arrays of it add an offset.
NESTED = 1
TYPE_IDS = {
    "int8": 2,
    "uint8": 3,
    "int16": 4,
    "uint16": 5,
    "int32": 6,
    "uint32": 7,
    "int64": 8,
    "uint64": 9,
    "float32": 10,
    "float64": 11,
    "bool": 15,
    "byte": 16,  # `char` is described as uint8, `byte` is not
    "string": 17,
    "wstring": 18,
}
BOUNDED_TYPE_IDS = {"string": 21, "wstring": 22}
ARRAY_OFFSETS = {"fixed": 48, "bounded": 96, "unbounded": 144}

# IDL has no empty structure; this member stands in a message without fields, on the wire and in the
# description.
_PLACEHOLDER = Field("structure_needs_at_least_one_member", FieldType("uint8", None, "uint8"))


def type_hash(registry: Registry, name: TypeName | str) -> str:
    """The RIHS01 hash of a ROS 2 message, service or action, or of a derived type: `RIHS01_` and 64 digits.

    Raises Unsupported for ROS 1, and what `Registry.interface` raises.
    """
    import hashlib  # see md5.py

    text = _json(type_description(registry, name))
    return "RIHS01_" + hashlib.sha256(text.encode("ascii")).hexdigest()


def type_description(registry: Registry, name: TypeName | str, *, defaults: bool = False) -> dict[str, Any]:
    """The type description whose canonical JSON is hashed, its keys in canonical order.

    With `defaults`, each field also has its `default_value` text, as
    type_description_interfaces/msg/TypeDescription carries it; the hash leaves it out. Raises as `type_hash`
    does.
    """
    if registry.dialect != "ros2":
        raise Unsupported("type descriptions and hashes belong to ROS 2: ROS 1 types have an MD5 sum")
    interface = registry.interface(name)
    described: dict[str, dict[str, Any]] = {}
    waiting: list[Interface] = [interface]
    while waiting:
        current = waiting.pop()
        key = str(current.name)
        if key in described:
            continue
        members = _members(current)
        described[key] = {"type_name": key, "fields": [_field(member, defaults) for member in members]}
        for member in members:
            if member.type.message is not None:
                waiting.append(registry.interface(member.type.message))
    own = described.pop(str(interface.name))
    return {
        "type_description": own,
        "referenced_type_descriptions": [described[key] for key in sorted(described)],
    }


def _members(interface: Interface) -> list[Field]:
    """The fields that describe the interface; a service or action is described as if its parts were
    fields."""
    if isinstance(interface, Message):
        return list(interface.fields) or [_PLACEHOLDER]
    if isinstance(interface, Service):
        parts = {"request_message": interface.request, "response_message": interface.response}
        if interface.event is not None:
            parts["event_message"] = interface.event
        return [_part(name, part.name) for name, part in parts.items()]
    send_goal, get_result = interface.services
    return [
        _part("goal", interface.goal.name),
        _part("result", interface.result.name),
        _part("feedback", interface.feedback.name),
        _part("send_goal_service", send_goal.name),
        _part("get_result_service", get_result.name),
        _part("feedback_message", interface.messages[-1].name),
    ]


def _part(name: str, type_name: TypeName) -> Field:
    return Field(name, FieldType(None, type_name, str(type_name)))


def _field(field: Field, defaults: bool) -> dict[str, Any]:
    type_ = field.type
    array = type_.array
    if type_.primitive == "wstring" and type_.string_bound is not None and array == Array("unbounded"):
        # Up to Kilted, rosidl takes the bound of a wstring for that of the sequence as well, so that peers
        # describe, and hash, wstring<=9[] as wstring<=9[<=9].
        array = Array("bounded", type_.string_bound)
    described: dict[str, Any] = {
        "name": field.name,
        "type": {
            "type_id": _type_id(type_, array),
            "capacity": 0 if array is None else array.size or 0,
            "string_capacity": type_.string_bound or 0,
            "nested_type_name": "" if type_.message is None else str(type_.message),
        },
    }
    if defaults:
        described["default_value"] = "" if field.default is None else _default_text(field.default)
    return described


def _type_id(type_: FieldType, array: Array | None) -> int:
    if type_.primitive is None:
        type_id = NESTED
    elif type_.string_bound is not None:
        type_id = BOUNDED_TYPE_IDS[type_.primitive]
    else:
        type_id = TYPE_IDS["byte" if type_.spelled == "byte" else type_.primitive]
    return type_id if array is None else type_id + ARRAY_OFFSETS[array.kind]


def _default_text(value: Value) -> str:
    return str(value)


def _json(value: object) -> str:
    """JSON as REP-2016 fixes it: `, ` and `: ` between, keys in the order given.

    The texts here are legal names, so that nothing needs escaping, and the json module need not be imported.
    """
    if isinstance(value, dict):
        return "{{{}}}".format(", ".join([f'"{key}": {_json(item)}' for key, item in value.items()]))
    if isinstance(value, list):
        return "[{}]".format(", ".join([_json(item) for item in value]))
    if isinstance(value, str):
        return f'"{value}"'
    return str(value)
