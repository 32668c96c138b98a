"""Serialiser and deserialiser: bytes by hand, then those of rosbags, then our own codec's."""

from __future__ import annotations

from functools import cache
from typing import Any

import pytest

from gateware.frames import Bench
from gateware.typed.messages import (
    REGISTRY,
    bits,
    known,
    receive_values,
    receive_words,
    reference,
    seen,
    send_values,
    send_words,
)
from random_values import Values, fill
from roslet.gateware.typed.deserializer import Deserializer
from roslet.gateware.typed.layout import message_layout
from roslet.gateware.typed.serializer import Serializer
from roslet.gen import runtime
from roslet.gen.gateware import Bounds, plan

DROPS = ("drop_bound", "drop_text", "drop_short")

TYPES = {  # and what is odd in them
    "std_msgs/msg/Empty": Bounds(),
    "std_msgs/msg/Bool": Bounds(),
    "std_msgs/msg/Char": Bounds(),
    "std_msgs/msg/Int16": Bounds(),
    "std_msgs/msg/Float64": Bounds(),
    "std_msgs/msg/ColorRGBA": Bounds(),
    "std_msgs/msg/String": Bounds(48),
    "std_msgs/msg/Header": Bounds(48),
    "std_msgs/msg/ByteMultiArray": Bounds(48, 6),
    "std_msgs/msg/Int16MultiArray": Bounds(48, 6),
    "std_msgs/msg/Int64MultiArray": Bounds(48, 6),
    "geometry_msgs/msg/Twist": Bounds(),
    "geometry_msgs/msg/PoseStamped": Bounds(48),
    "geometry_msgs/msg/Polygon": Bounds(48, 6),
    "sensor_msgs/msg/Imu": Bounds(48),
    "sensor_msgs/msg/Image": Bounds(48, 6),  # uint8 behind a string, uint32 behind it
    "sensor_msgs/msg/JointState": Bounds(48, 3),
    "sensor_msgs/msg/NavSatFix": Bounds(48),
    "sensor_msgs/msg/RegionOfInterest": Bounds(),
    "sensor_msgs/msg/Joy": Bounds(48, 6),
    "sensor_msgs/msg/PointField": Bounds(48),
    "sensor_msgs/msg/BatteryState": Bounds(48, 6),
    "diagnostic_msgs/msg/DiagnosticStatus": Bounds(48, 3),
    "rcl_interfaces/msg/ParameterValue": Bounds(48, 3),
    "action_msgs/msg/GoalStatus": Bounds(),
    "unique_identifier_msgs/msg/UUID": Bounds(),
    "shape_msgs/msg/SolidPrimitive": Bounds(48, 3),
}


@cache
def _kind(name: str) -> Any:
    return plan(name, TYPES[name], REGISTRY)


def _fits(value: Any, bounds: Bounds) -> bool:
    if isinstance(value, dict):
        return all(_fits(one, bounds) for one in value.values())
    if isinstance(value, str):
        return len(value.encode()) <= (bounds.string or 0)
    if isinstance(value, list):
        fixed = len(value) in (9, 16, 36) or (
            all(isinstance(one, float) for one in value) and len(value) == 12
        )
        return (fixed or len(value) <= (bounds.sequence or 0)) and all(_fits(one, bounds) for one in value)
    return True


def _values(name: str, many: int = 1) -> list[dict[str, Any]]:
    """The empty, the greatest, and random values that fit the bounds."""
    message = REGISTRY.message(name)
    made: list[dict[str, Any]] = []
    for style in ("empty", "maximal", *["random", "foreign"] * many):
        for seed in range(20):
            value = Values(REGISTRY.message, f"{len(made)} {seed}", style).message(message)
            if _fits(value, TYPES[name]):
                made.append(value)
                break
    assert len(made) > many
    return made


def _bits_of(name: str, value: dict[str, Any]) -> int:
    layout = message_layout(_kind(name))
    return int(layout.const(bits(REGISTRY.message(name), value)).as_value().value)


def serialize(dut: Serializer, values: list[int], stalls: int = 30) -> tuple[list[bytes], int]:
    bench = Bench(dut, stalls)
    send_values(bench, "i", values)
    got = receive_words(bench, "o")
    bench.count("drop_bound")
    bench.run(lambda: len(got) == len(values))
    return got, bench.counts["drop_bound"]


def deserialize(
    dut: Deserializer, bodies: list[bytes], big: int | list[int] = 0, stalls: int = 30
) -> tuple[list[Any], dict[str, int]]:
    bench = Bench(dut, stalls)
    send_words(bench, "i", bodies, [big] * len(bodies) if isinstance(big, int) else big)
    got = receive_values(bench, "o")
    bench.count(*DROPS)
    bench.run(rest=30)
    return got, bench.counts


# -- by hand: OMG CORBA 3.0 15.3

HELLO = bytes.fromhex("06000000 68656c6c6f 00")
HELLO_BIG = bytes.fromhex("00000006 68656c6c6f 00")
COLOUR = bytes.fromhex("0000803f 00000040 000000bf 00000000")  # 1.0, 2.0, -0.5, 0.0
COLOUR_BIG = bytes.fromhex("3f800000 40000000 bf000000 00000000")


def test_a_string_by_hand_has_its_length_with_the_nul_and_no_octet_more() -> None:
    dut = Serializer("std_msgs/String", Bounds(11))
    value = int.from_bytes(b"hello garbage"[:11], "little") << 4 | 5
    assert len(dut.i.payload.as_value()) == 4 + 88
    assert serialize(dut, [value, 0]) == ([HELLO, bytes.fromhex("01000000 00")], 0)


def test_floats_by_hand_are_their_bits() -> None:
    value = int.from_bytes(COLOUR, "little")
    assert serialize(Serializer("std_msgs/ColorRGBA"), [value]) == ([COLOUR], 0)
    got, counts = deserialize(Deserializer("std_msgs/ColorRGBA"), [COLOUR, COLOUR_BIG], [0, 1])
    assert [one.as_value().value for one in got] == [value] * 2
    assert not any(counts.values())


@pytest.mark.parametrize(("body", "big"), [(HELLO, 0), (HELLO_BIG, 1)])
def test_a_string_by_hand_is_read_in_both_byte_orders(body: bytes, big: int) -> None:
    got, counts = deserialize(Deserializer("std_msgs/String", Bounds(11)), [body, body + b"more"], big)
    assert [seen(REGISTRY.message("std_msgs/String"), one)["data"] for one in got] == [
        {"length": 5, "data": list(b"hello")}
    ] * 2
    assert not any(counts.values())


# -- by rosbags, and by our own codec


@pytest.mark.parametrize("name", TYPES)
def test_values_become_the_bytes_of_rosbags(name: str) -> None:
    values = _values(name)
    got, drops = serialize(Serializer(_kind(name)), [_bits_of(name, value) for value in values])
    assert drops == 0
    own = runtime.message_class("ros2", name)
    for value, body in zip(values, got, strict=True):
        if known(name):
            assert body == reference(name, value)
        assert body == fill(own, value).serialize()[4:]
        assert len(body) <= _kind(name).maximum


@pytest.mark.parametrize("name", TYPES)
def test_bytes_of_both_orders_become_the_values(name: str) -> None:
    values = _values(name)
    message = REGISTRY.message(name)
    bodies, big = [], []
    for value in values:
        for order in (0, 1):
            if order == 0:
                bodies.append(fill(runtime.message_class("ros2", name), value).serialize()[4:])
            elif known(name):
                bodies.append(reference(name, value, big=True))
            else:
                continue
            big.append(order)
    got, counts = deserialize(Deserializer(_kind(name)), bodies, big)
    assert not any(counts.values())
    expected = [bits(message, value) for value in values for _ in range(2 if known(name) else 1)]
    assert [seen(message, one) for one in got] == expected


def test_most_types_are_judged_by_rosbags() -> None:
    assert sum(map(known, TYPES)) >= len(TYPES) - 3
