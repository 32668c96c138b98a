"""Seeded random values of any type, in a neutral form: dictionaries, lists, numbers and text, fit for JSON.

A uint8 array is a list of integers, a ROS 1 time {"secs", "nsecs"}. Styles: "empty" (every variable part empty, every
number zero), "maximal" (bounded parts full, numbers at their limits), "random", and "foreign" (random, with text far
from ASCII).
"""

from __future__ import annotations

import random
import struct
from typing import Any

from roslet.gen.python_names import attribute
from roslet.idl.records import FieldType, Message
from roslet.wire.message import Message as MessageBase
from roslet.wire.time import Duration, Time

STYLES = ("empty", "maximal", "random", "foreign", "long")

LIMITS = {
    f"{sign}int{bits}": (0, (1 << bits) - 1) if sign else (-(1 << (bits - 1)), (1 << (bits - 1)) - 1)
    for sign in ("", "u")
    for bits in (8, 16, 32, 64)
}

_ALPHABETS = {
    "random": "abcdefghijklmnopqrstuvwxyz_/0123456789 ",
    "foreign": "äß€ελλάδα漢字仮名\U0001f916\U00010348é\u0301",
    "maximal": "x",
    "long": "abcä",
}

# A bound in bytes holds a quarter as many characters of any script.
_WIDEST = 4


class Values:
    """Random values; `resolve` gives the definition of a nested type."""

    def __init__(self, resolve: Any, seed: object, style: str) -> None:
        self.resolve = resolve
        self.random = random.Random(f"{seed} {style}")
        self.style = style

    def message(self, message: Message, depth: int = 0) -> dict[str, Any]:
        return {field.name: self.field(field.type, depth) for field in message.fields}

    def field(self, kind: FieldType, depth: int) -> Any:
        array = kind.array
        if array is None:
            return self.one(kind, depth)
        if array.kind == "fixed":
            count = array.size or 0
        else:
            limit = 6 if depth < 2 else 2
            if array.size is not None and (self.style == "maximal" or array.size < limit):
                limit = min(array.size, 64)
            count = 0 if self.style == "empty" else limit
            if self.style in ("random", "foreign", "long"):
                count = self.random.randint(0, limit)
        return [self.one(kind, depth) for _ in range(count)]

    def one(self, kind: FieldType, depth: int) -> Any:
        primitive = kind.primitive
        if primitive is None:
            return self.message(self.resolve(kind.message), depth + 1)
        if primitive in ("string", "wstring"):
            return self.text(kind.string_bound)
        if primitive == "time":
            return {"secs": self.number("uint32"), "nsecs": self.nanoseconds()}
        if primitive == "duration":
            return {"secs": self.number("int32"), "nsecs": self.nanoseconds()}
        return self.number(primitive)

    def nanoseconds(self) -> int:
        return {"empty": 0, "maximal": 999_999_999}.get(self.style, self.random.randrange(1_000_000_000))

    def text(self, bound: int | None) -> str:
        if self.style == "empty":
            return ""
        if self.style == "maximal":
            return "x" * (20 if bound is None else bound)
        limit = 12 if bound is None else min(12, bound // _WIDEST)
        alphabet = _ALPHABETS[self.style]
        shortest = 0
        if self.style == "long" and bound is None:  # about as long as what is treated in another way
            shortest, limit = 100, 140
        return "".join(self.random.choice(alphabet) for _ in range(self.random.randint(shortest, limit)))

    def number(self, primitive: str) -> bool | int | float:
        if primitive == "bool":
            return False if self.style == "empty" else self.style == "maximal" or self.random.random() < 0.5
        if primitive in ("float32", "float64"):
            if self.style == "empty":
                return 0.0
            if self.style == "maximal":
                return float("inf") if self.random.random() < 0.2 else -1.5
            value = self.random.uniform(-1e6, 1e6)
            return (
                float(struct.unpack("<f", struct.pack("<f", value))[0]) if primitive == "float32" else value
            )
        low, high = LIMITS[primitive]
        if self.style == "empty":
            return 0
        if self.style == "maximal":
            return self.random.choice((low, high))
        return self.random.randint(low, high)


def fill(kind: type[MessageBase], fields: dict[str, Any]) -> MessageBase:
    """A message of class `kind` with the neutral values `fields`."""
    message = kind()
    for name, value in fields.items():
        spec = {row[0]: row for row in kind._spec}[attribute(name)]
        base = spec[1]
        if spec[2] == 0:
            made = _filled(base, value)
        elif base == "uint8":
            made = bytes(value)  # which classes that rclpy's programs have changed take, too
        else:
            made = [_filled(base, one) for one in value]
        setattr(message, attribute(name), made)
    return message


def _filled(base: Any, value: Any) -> Any:
    if base == "time":
        return Time(value["secs"], value["nsecs"])
    if base == "duration":
        return Duration(value["secs"], value["nsecs"])
    return value if isinstance(base, str) else fill(base, value)


def plain(message: MessageBase) -> dict[str, Any]:
    """The neutral values of a message."""
    found = {}
    for (name, _), (slot, base, array, *_rest) in zip(message._fields_and_types, message._spec, strict=True):
        value = getattr(message, slot)
        found[name] = [_plain(base, one) for one in value] if array else _plain(base, value)
    return found


def _plain(base: Any, value: Any) -> Any:
    if base in ("time", "duration"):
        return {"secs": value.secs, "nsecs": value.nsecs}
    if not isinstance(base, str):
        return plain(value)
    return value.item() if hasattr(value, "item") else value
