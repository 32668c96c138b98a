"""A second opinion on both encodings: rosbags, which shares no code with ROS."""

from __future__ import annotations

from typing import Any

import numpy
import pytest
from rosbags.typesys import Stores, get_typestore

from random_values import STYLES, Values, fill
from roslet.gen import runtime
from roslet.idl import Registry

CASES = (("ros1", Stores.ROS1_NOETIC), ("ros2", Stores.ROS2_JAZZY))


def _types(store: Any, registry: Registry) -> list[str]:
    """The message types that both know with the same fields: rosbags has its own idea of a few newer ones."""
    both = []
    for name in registry.names("msg"):
        text = f"{name.package}/msg/{name.name}"
        if text in store.fielddefs and _fields_agree(store, registry, text):
            both.append(text)
    return both


def _fields_agree(store: Any, registry: Registry, name: str) -> bool:
    message = registry.message(name)
    if [field.name for field in message.fields] != [field[0] for field in store.fielddefs[name][1]]:
        return False
    nested = [field.type.message for field in message.fields if field.type.message is not None]
    return all(
        str(inner) in store.fielddefs and _fields_agree(store, registry, str(inner)) for inner in nested
    )


def _build(store: Any, name: str, value: dict[str, Any]) -> Any:
    made = {}
    for field, (kind, detail) in store.fielddefs[name][1]:
        made[field] = _one(store, int(kind), detail, value[field])
    return store.types[name](**made)


def _one(store: Any, kind: int, detail: Any, value: Any) -> Any:
    if kind == 1:
        # To rosbags a byte is signed in both dialects.
        return value - 256 if detail[0] == "byte" and value > 127 else value
    if kind == 2:
        if detail in ("builtin_interfaces/msg/Time", "builtin_interfaces/msg/Duration") and "secs" in value:
            seconds = value["secs"]  # to rosbags they are signed, as in ROS 2
            value = {"sec": seconds - (1 << 32) if seconds >> 31 > 0 else seconds, "nanosec": value["nsecs"]}
        return _build(store, detail, value)
    (element, inner), _size = detail
    if int(element) == 1 and inner[0] != "string":
        if inner[0] == "byte":
            return numpy.array(value, "int64").astype("uint8")
        return numpy.array(value, {"char": "uint8"}.get(inner[0], inner[0]))
    return [_one(store, int(element), inner, one) for one in value]


@pytest.mark.parametrize(("dialect", "version"), CASES)
def test_every_bundled_type_has_the_bytes_of_rosbags(dialect: Any, version: Stores) -> None:
    store = get_typestore(version)
    registry = runtime.registry(dialect)
    names = _types(store, registry)
    assert len(names) > 120
    for name in names:
        kind = runtime.message_class(dialect, name)
        for seed, style in enumerate(STYLES):
            reproducer = f"Values(registry.message, {seed}, {style!r}).message(registry.message({name!r}))"
            value = Values(registry.message, seed, style).message(registry.message(name))
            write = store.serialize_ros1 if dialect == "ros1" else store.serialize_cdr
            theirs = bytes(write(_build(store, name, value), name))
            ours = fill(kind, value).serialize()
            assert ours == theirs, reproducer
            if dialect == "ros2":
                big = bytes(store.serialize_cdr(_build(store, name, value), name, little_endian=False))
                assert big[:2] == b"\0\0"
                assert kind.deserialize(big) == fill(kind, value), reproducer
