"""Messages that are not as they should be: dropped whole, for a named reason, and the next one is right."""

from __future__ import annotations

import random
from typing import Any

import pytest

from gateware.frames import STALLS, Bad
from gateware.typed.messages import REGISTRY, bits, reference, seen
from gateware.typed.test_codec import _bits_of, _kind, _values, deserialize, serialize
from roslet.gateware.typed.deserializer import Deserializer
from roslet.gateware.typed.layout import message_layout
from roslet.gateware.typed.serializer import Serializer
from roslet.gen.gateware import Bounds, plan

STRING = "std_msgs/msg/String"
NONE = {"drop_bound": 0, "drop_text": 0, "drop_short": 0}


def text(data: bytes, length: int | None = None) -> bytes:
    return (len(data) if length is None else length).to_bytes(4, "little") + data


def read(bodies: list[bytes], bound: int = 10, stalls: int = 30) -> tuple[list[bytes], dict[str, int]]:
    """The strings that are given."""
    got, counts = deserialize(Deserializer(STRING, Bounds(bound)), bodies, 0, stalls)
    return [bytes(seen(REGISTRY.message(STRING), one)["data"]["data"]) for one in got], counts


@pytest.mark.parametrize("stalls", STALLS)
@pytest.mark.parametrize("bound", [1, 3, 4, 7, 8, 10])
def test_strings_of_all_lengths_up_to_the_bound_pass_and_longer_ones_are_dropped(
    bound: int, stalls: int
) -> None:
    strings = [bytes(range(1, n + 1)) for n in range(bound + 4)]
    got, counts = read([text(one + b"\0") for one in strings], bound, stalls)
    assert got == strings[: bound + 1]
    assert counts == {**NONE, "drop_bound": 3}


@pytest.mark.parametrize("length", [12, 16, 0x100, 0x8000_0000, 0x7FFF_FFFF, 0xFFFF_FFFF, 0x0100_0003])
def test_a_hostile_length_is_dropped_whole(length: int) -> None:
    got, counts = read([text(b"abcdefghijk\0", length), text(b"", length), text(b"yes\0")])
    assert got == [b"yes"]
    assert counts == {**NONE, "drop_bound": 2}


def test_a_string_of_no_octet_and_one_without_nul_are_dropped() -> None:
    wrong = [text(b""), *(text(b"x" * n) for n in range(1, 12))]
    got, counts = read([one for body in wrong for one in (body, text(b"yes\0"))])
    assert got == [b"yes"] * len(wrong)
    assert counts == {**NONE, "drop_text": len(wrong)}


def test_a_message_with_a_bad_end_is_forgotten_and_not_counted() -> None:
    wrong = [Bad(text(b"no\0")), Bad(b""), Bad(text(b"no", 99)), Bad(text(b"no\0")[:4]), Bad(text(b"no"))]
    got, counts = read([*wrong, text(b"yes\0")])
    assert (got, counts) == ([b"yes"], NONE)


@pytest.mark.parametrize(
    "name",
    [
        "std_msgs/msg/Empty",
        "std_msgs/msg/Bool",
        "geometry_msgs/msg/Twist",
        "std_msgs/msg/Header",
        "sensor_msgs/msg/Image",
        "sensor_msgs/msg/PointField",
        "sensor_msgs/msg/JointState",
        "diagnostic_msgs/msg/DiagnosticStatus",
    ],
)
def test_a_message_cut_anywhere_is_dropped_and_octets_behind_it_are_not_looked_at(name: str) -> None:
    value = _values(name)[-1]
    whole = reference(name, value)
    cut = [whole[:n] for n in range(len(whole)) if n % 4 == 0 or len(whole) < 80]
    words = sum(len(body) % 4 == 0 for body in cut)
    longer = [whole + bytes(n) for n in range(6)]
    got, counts = deserialize(Deserializer(_kind(name)), [*cut, *longer], 0, 0)
    assert [seen(REGISTRY.message(name), one) for one in got] == [_expected(name)] * len(longer)
    assert sum(counts.values()) == len(cut)
    # A length or a string that is cut within a word may look wrong before it is seen to be short.
    assert counts["drop_short"] >= words


def test_random_octets_never_stop_it() -> None:
    rng = random.Random(5)
    for name in ("sensor_msgs/msg/Image", "diagnostic_msgs/msg/DiagnosticStatus"):
        whole = reference(name, _values(name)[-1])
        hostile = []
        for _ in range(40):
            octets = bytearray(whole)
            for _ in range(rng.randrange(1, 5)):
                at = rng.randrange(len(octets))
                octets[at] = rng.choice([0, 1, 255, rng.randrange(256)])
            hostile.append(bytes(octets[: rng.randrange(len(octets) + 1)]))
        got, counts = deserialize(Deserializer(_kind(name)), [*hostile, whole], 0, 0)
        assert len(got) + sum(counts.values()) == 41
        assert seen(REGISTRY.message(name), got[-1]) == _expected(name)


def _expected(name: str) -> Any:
    return bits(REGISTRY.message(name), _values(name)[-1])


def test_a_length_beyond_the_bound_ends_the_message_badly_and_is_counted() -> None:
    dut = Serializer(STRING, Bounds(10))  # whose length has four bits
    values = [0x6261 << 4 | length for length in (2, 11, 15, 10, 2)]
    got, drops = serialize(dut, values)
    assert [isinstance(body, Bad) for body in got] == [False, True, True, False, False]
    assert got[0] == got[4] == bytes.fromhex("03000000 616200")
    assert got[1] == got[2] == b""
    assert drops == 2


def test_what_is_behind_a_length_is_not_sent() -> None:
    for name in (STRING, "sensor_msgs/msg/Image", "std_msgs/msg/Int16MultiArray"):
        kind = _kind(name)
        width = message_layout(kind).size
        rng = random.Random(name)
        values = _values(name)
        dirty = [_bits_of(name, one) | (_behind(name, one) & rng.getrandbits(width)) for one in values]
        got, drops = serialize(Serializer(kind), dirty)
        assert (got, drops) == ([reference(name, one) for one in values], 0)


def _behind(name: str, value: dict[str, Any]) -> int:
    """The bits of elements behind the lengths at the top of a message."""
    layout = message_layout(_kind(name))
    mask = 0
    for field, place in layout:
        if not hasattr(place.shape, "members") or set(place.shape.members) != {"length", "data"}:
            continue
        used = len(value[field].encode() if isinstance(value[field], str) else value[field])
        data = place.shape["data"]
        width = data.shape.size // data.shape.length
        for index in range(used, data.shape.length):
            mask |= ((1 << width) - 1) << (place.offset + data.offset + width * index)
    return mask


def test_one_message_waits_until_it_is_taken_and_none_is_lost() -> None:
    strings = [bytes([65 + n % 26]) * (n % 11) for n in range(40)]
    for stalls in STALLS:
        got, counts = read([text(one + b"\0") for one in strings], stalls=stalls)
        assert (got, counts) == (strings, NONE)


def test_a_plan_is_the_same_every_time() -> None:
    bounds = Bounds(16, 4)
    assert plan("sensor_msgs/JointState", bounds) == plan("sensor_msgs/JointState", bounds)
