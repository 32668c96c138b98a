"""What strings came to is kept for the next message: it must never be seen."""

from __future__ import annotations

import random
from typing import Any

import pytest

from roslet.gen import runtime
from roslet.gen.python_write import KEPT_LENGTH, KEPT_TEXTS
from roslet.wire.message import BufferTooSmall


def fresh(dialect: Any) -> Any:
    """A class that has kept nothing."""
    return runtime.message_class(dialect, "sensor_msgs/JointState")


@pytest.mark.parametrize("dialect", ["ros1", "ros2"])
def test_lists_that_come_again_or_change_are_read_back_as_they_were(dialect: Any) -> None:
    rng = random.Random(5)
    kind = fresh(dialect)
    lists: list[list[str]] = [
        [],
        ["a"],
        ["", "", ""],
        ["joint_%d" % n for n in range(7)],
        ["joint_%d" % n for n in range(6)] + ["Gelenk_ä"],
        ["x" * 200, "y"],
        ["x" * KEPT_LENGTH],
        ["x" * 20000, "y" * 20000],
        ["n%d" % n for n in range(KEPT_TEXTS)],
        ["n%d" % n for n in range(KEPT_TEXTS + 1)],
    ]
    for _ in range(300):
        names = rng.choice(lists)
        message = kind(name=list(names), position=[1.5] * rng.randrange(3))
        message.header.frame_id = "f" * rng.randrange(5)
        for _ in range(rng.randrange(1, 4)):
            assert kind.deserialize(message.serialize()) == message
        parts: list[Any] = []
        buffer = memoryview(bytearray(100_000))
        end = message.serialize_into(buffer, 0, parts)
        if not parts:
            assert bytes(buffer[:end]) == message.serialize()


@pytest.mark.parametrize("dialect", ["ros1", "ros2"])
def test_wrong_values_are_still_refused_and_a_list_that_is_changed_in_place_is_seen(dialect: Any) -> None:
    kind = fresh(dialect)
    message = kind(name=["a", "b"])
    for _ in range(3):
        message.serialize()
    message.name[1] = "c"
    assert kind.deserialize(message.serialize()).name == ["a", "c"]
    message.name = ("a", "c")
    assert kind.deserialize(message.serialize()).name == ["a", "c"]
    for wrong in (["a", 1], "ac", ["a", None]):
        message.name = wrong
        with pytest.raises(Exception, match="name"):
            message.serialize()
    message.name = ["a", "c"]
    with pytest.raises(BufferTooSmall):
        message.serialize_into(memoryview(bytearray(20)))
