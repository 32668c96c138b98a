"""What ROS 2's own Python and Fast DDS make of values. Runs under the Python of the ROS 2 wheels, knows
nothing of roslet.

Each line of standard input is JSON: {"type": "pkg/kind/Name", "value": fields, "data": hex}. The answer, one line:
{"data": what rclpy serialises of the value, in hex, "value": what it reads from the data given} or {"error": text}.
An array is a list; a byte is an integer. A service's request is `pkg/srv/Name_Request`.
"""

# mypy: ignore-errors

import importlib
import json
import sys

from rclpy.serialization import deserialize_message, serialize_message
from rosidl_parser.definition import AbstractNestedType, BasicType, NamespacedType


def find_class(name):
    package, kind, short = name.split("/")
    found = getattr(importlib.import_module(package + "." + kind), short.split("_")[0])
    for part in short.split("_")[1:]:
        inner = getattr(found, part, None)
        if inner is None:
            inner = getattr(
                found.Impl, {"SendGoal": "SendGoalService", "GetResult": "GetResultService"}.get(part, part)
            )
        found = inner
    return found


def class_of(kind):
    return find_class("/".join([*kind.namespaces, kind.name]))


def build(kind, fields):
    message = kind()
    for slot, slot_type in zip(message.__slots__, kind.SLOT_TYPES, strict=False):
        name = slot.lstrip("_")
        if name in fields:
            setattr(message, name, build_one(slot_type, fields[name]))
    return message


def build_one(kind, value):
    if isinstance(kind, AbstractNestedType):
        return [build_one(kind.value_type, element) for element in value]
    if isinstance(kind, NamespacedType):
        return build(class_of(kind), value)
    if isinstance(kind, BasicType) and kind.typename == "octet":
        return bytes([value])
    return value


def plain(kind, value):
    if isinstance(kind, AbstractNestedType):
        return [plain(kind.value_type, element) for element in value]
    if isinstance(kind, NamespacedType):
        return plain_message(value)
    if isinstance(kind, BasicType) and kind.typename == "octet":
        return value[0]
    return value.item() if hasattr(value, "item") else value


def plain_message(message):
    found = {}
    for slot, slot_type in zip(message.__slots__, message.SLOT_TYPES, strict=False):
        name = slot.lstrip("_")
        if name != "check_fields":
            found[name] = plain(slot_type, getattr(message, name))
    return found


def main():
    for line in sys.stdin:
        case = json.loads(line)
        try:
            kind = find_class(case["type"])
            answer = {"data": bytes(serialize_message(build(kind, case["value"]))).hex()}
            answer["value"] = plain_message(deserialize_message(bytes.fromhex(case["data"]), kind))
        except Exception as error:  # whatever the reference raises is its verdict
            answer = {"error": "%s: %s" % (type(error).__name__, error)}
        sys.stdout.write(json.dumps(answer) + "\n")
        sys.stdout.flush()


main()
