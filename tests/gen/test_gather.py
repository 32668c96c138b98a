"""Large payloads are handed out instead of copied."""

from __future__ import annotations

from typing import Any

import numpy
import pytest

from definitions import classes
from roslet.gen import runtime
from roslet.wire.message import GATHER_MINIMUM

LARGE = GATHER_MINIMUM


def joined(buffer: bytearray, end: int, parts: list[tuple[int, Any]]) -> bytes:
    out = b""
    done = 0
    for at, payload in parts:
        out += bytes(buffer[done:at]) + bytes(payload)
        done = at
    return out + bytes(buffer[done:end])


def copied(message: Any) -> bytes:
    buffer = bytearray(1 << 20)
    return bytes(buffer[: message.serialize_into(buffer)])


@pytest.mark.parametrize("dialect", ["ros1", "ros2"])
def test_gathered_parts_join_to_what_copying_gives(dialect: Any) -> None:
    text = "string s\nuint8[] a\nfloat64[] b\nuint8 c\nfloat64[] d\nstring[] e\nuint8[] f\nint16 g\n"
    with classes(dialect, {"pkg/Large": text}) as (kind,):
        for a, b, d, f in [
            (LARGE, LARGE, 0, 3),
            (LARGE + 1, 5, LARGE, LARGE),
            (7, LARGE, LARGE, 0),
            (1, 2, 3, 4),
        ]:
            for s in ("x", "y" * LARGE, "z" * (LARGE + 3)):
                message = kind(
                    s, bytes(a), numpy.ones(b), 1, numpy.ones(d) * 2, ["p", "q" * LARGE], b"f" * f, -3
                )
                buffer = bytearray(4096)
                parts: list[tuple[int, Any]] = []
                end = message.serialize_into(buffer, 0, parts)
                assert joined(buffer, end, parts) == copied(message) == message.serialize()
                assert len(message.serialize()) == message.serialized_size()
                assert kind.deserialize(message.serialize()) == message
                expected = sum(size >= LARGE for size in (len(s), a, 8 * b, 8 * d, f)) + 1
                assert len(parts) == expected


def test_a_gathered_payload_is_the_users_own_memory() -> None:
    kind: Any = runtime.message_class("ros1", "sensor_msgs/Image")
    data = bytearray(LARGE)
    parts: list[tuple[int, Any]] = []
    kind(data=data).serialize_into(bytearray(200), 0, parts)
    assert len(parts) == 1
    data[0] = 9
    assert parts[0][1][0] == 9


def test_a_message_that_fails_leaves_no_parts() -> None:
    kind: Any = runtime.message_class("ros1", "sensor_msgs/PointCloud2")
    parts: list[tuple[int, Any]] = []
    message = kind(data=bytes(LARGE), is_dense=5)
    with pytest.raises(Exception, match="is_dense"):
        message.serialize_into(bytearray(4096), 0, parts)
    assert parts == []


@pytest.mark.parametrize("dialect", ["ros1", "ros2"])
def test_an_array_that_is_received_is_a_view_on_the_buffer(dialect: Any) -> None:
    with classes(
        dialect, {"pkg/Views": "float32[3] a\nint16[] b\nuint8[] c\nuint8[100] d\nuint8[4] e\n"}
    ) as (kind,):
        assert kind._views
        data = bytearray(kind([1, 2, 3], [4, 5], b"xy", bytes(100), b"abcd").serialize())
        message = kind.deserialize(data)
        kept = message.copy()
        assert isinstance(message.a, numpy.ndarray) and message.a.dtype == "float32"
        assert isinstance(message.b, numpy.ndarray) and message.b.dtype == "int16"
        assert isinstance(message.c, memoryview) and isinstance(message.d, memoryview)
        assert message.e == b"abcd" and isinstance(message.e, bytes)
        for at in range(len(data)):
            data[at] ^= 255
        assert list(message.a) != [1, 2, 3] and bytes(message.c) != b"xy"
        assert list(kept.a) == [1, 2, 3] and list(kept.b) == [4, 5] and kept.c == b"xy"


def test_types_without_arrays_need_no_views() -> None:
    assert not runtime.message_class("ros1", "tf2_msgs/TFMessage")._views
    assert runtime.message_class("ros1", "nav_msgs/Odometry")._views
