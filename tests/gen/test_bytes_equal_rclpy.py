"""Every ROS 2 type of the wheels, byte for byte as rclpy with Fast DDS has it, padding apart.

Fast DDS leaves padding as it finds it in memory, and rclpy returns as many bytes as it estimated, which may
be more than it wrote; so the comparison masks padding (what it masks must be zero in our bytes) and ends with
our bytes.
"""

from __future__ import annotations

import pathlib
from collections.abc import Iterator
from typing import Any

import pytest

from oracle import Oracle
from peers import find, require
from random_values import STYLES, Values, fill, plain
from roslet.gen import runtime
from roslet.idl import Registry
from roslet.wire import cdr
from roslet.wire.cursor import Writer

DISTRIBUTIONS = ("kilted", "jazzy")

# Everything that rosidl makes of an interface; nothing is left out.
_PARTS = {
    "msg": ("",),
    "srv": ("_Request", "_Response", "_Event"),
    "action": (
        "_Goal",
        "_Result",
        "_Feedback",
        "_FeedbackMessage",
        "_SendGoal_Request",
        "_SendGoal_Response",
        "_SendGoal_Event",
        "_GetResult_Request",
        "_GetResult_Response",
        "_GetResult_Event",
    ),
}


def _share(distribution: str) -> pathlib.Path | None:
    python = find(distribution)
    return None if python is None else python.parent.parent / "share"


def _packages() -> list[tuple[str, str]]:
    found = []
    for distribution in DISTRIBUTIONS:
        share = _share(distribution)
        if share is None:
            found.append(
                (distribution, "absent")
            )  # the test asks for the peer, and so says that it is not there
        else:
            names = {path.parent.parent.name for kind in _PARTS for path in share.glob(f"*/{kind}/*.{kind}")}
            found += [(distribution, name) for name in sorted(names)]
    return found


def _types(share: pathlib.Path, package: str) -> list[str]:
    return sorted(
        f"{package}/{kind}/{path.stem}{part}"
        for kind, parts in _PARTS.items()
        for path in (share / package / kind).glob("*." + kind)
        for part in parts
    )


class _Masking(Writer):
    """A writer that remembers where it padded."""

    def __init__(self) -> None:
        super().__init__("<", 8, 1)
        self.padding: list[int] = []

    def align(self, size: int) -> None:
        before = self.position
        super().align(size)
        self.padding += range(before, self.position)


def masked(message: Any, data: bytes) -> bytes:
    """`data` with zeros where `message` has padding."""
    writer = _Masking()
    writer.message(message, message._spec, "")
    made = bytearray(data)
    for at in writer.padding:
        if at + cdr.HEADER_SIZE < len(made):
            made[at + cdr.HEADER_SIZE] = 0
    return bytes(made)


@pytest.fixture(scope="module")
def oracles() -> Iterator[dict[str, Oracle]]:
    made: dict[str, Oracle] = {}
    yield made
    for oracle in made.values():
        oracle.close()


@pytest.mark.parametrize(("distribution", "package"), _packages())
def test_every_type_of_the_wheels_has_the_bytes_and_values_of_rclpy(
    oracles: dict[str, Oracle], distribution: str, package: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    python = require(distribution)
    share = python.parent.parent / "share"
    registry = Registry("ros2", {"AMENT_PREFIX_PATH": str(share.parent)})
    monkeypatch.setattr(runtime, "_scopes", {"ros2": runtime._Scope(registry)})
    if distribution not in oracles:
        oracles[distribution] = Oracle(python, "rclpy_messages.py")
    compared = 0
    for name in _types(share, package):
        kind = runtime.message_class("ros2", name)
        for seed, style in enumerate(STYLES):
            reproducer = f"Values(registry.message, {seed}, {style!r}).message(registry.message({name!r}))"
            value = Values(registry.message, seed, style).message(registry.message(name))
            message = fill(kind, value)
            data = message.serialize()
            answer = oracles[distribution].ask(type=name, value=value, data=data.hex())
            assert "error" not in answer, (reproducer, answer)
            theirs = bytes.fromhex(answer["data"])
            assert len(theirs) >= len(data), reproducer
            assert masked(message, theirs)[: len(data)] == data, reproducer
            assert answer["value"] == value, reproducer
            assert kind.deserialize(data) == message, reproducer
            assert plain(kind.deserialize(theirs)) == value, reproducer
            assert bytes(cdr.write(message)) == data, reproducer
            assert cdr.read(kind, memoryview(theirs), 0, len(theirs)) == message, reproducer
            assert message.serialized_size() == len(data), reproducer
            compared += 1
    assert compared


@pytest.mark.parametrize("distribution", DISTRIBUTIONS)
def test_there_are_types_to_compare(distribution: str) -> None:
    share = require(distribution).parent.parent / "share"
    assert sum(len(_types(share, package)) for name, package in _packages() if name == distribution) > 200
