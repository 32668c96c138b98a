"""Every ROS 1 type of Debian's packages, byte for byte as ROS 1's own Python has it."""

from __future__ import annotations

import pathlib
from collections.abc import Iterator

import pytest

from oracle import Oracle
from peers import require
from random_values import STYLES, Values, fill, plain
from roslet.gen import runtime
from roslet.idl import Registry
from roslet.wire import ros1

SHARE = pathlib.Path("/usr/share")


def _types() -> list[str]:
    found = [f"{path.parent.parent.name}/{path.stem}" for path in SHARE.glob("*/msg/*.msg")]
    for path in SHARE.glob("*/srv/*.srv"):
        found += [f"{path.parent.parent.name}/{path.stem}{part}" for part in ("Request", "Response")]
    return sorted(found)


def _packages() -> list[str]:
    return sorted({name.split("/")[0] for name in _types()})


@pytest.fixture(scope="module")
def genpy() -> Iterator[Oracle]:
    require("genpy")
    oracle = Oracle(pathlib.Path("/usr/bin/python3"), "genpy_messages.py")
    yield oracle
    oracle.close()


@pytest.fixture(autouse=True)
def debian_definitions(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(runtime, "_registries", {"ros1": Registry("ros1", {"ROS_PACKAGE_PATH": str(SHARE)})})
    monkeypatch.setattr(runtime, "_classes", {})


@pytest.mark.parametrize("package", _packages())
def test_every_debian_type_has_the_bytes_and_values_of_genpy(genpy: Oracle, package: str) -> None:
    registry = runtime.registry("ros1")
    for name in [name for name in _types() if name.startswith(package + "/")]:
        kind = runtime.message_class("ros1", name)
        for seed, style in enumerate(STYLES):
            reproducer = f"Values(registry.message, {seed}, {style!r}).message(registry.message({name!r}))"
            value = Values(registry.message, seed, style).message(registry.message(name))
            message = fill(kind, value)
            data = message.serialize()
            answer = genpy.ask(type=name, value=value, data=data.hex())
            assert "error" not in answer, (reproducer, answer)
            assert data.hex() == answer["data"], reproducer
            assert answer["value"] == value, reproducer
            assert kind.deserialize(data) == message, reproducer
            assert plain(kind.deserialize(data)) == value, reproducer
            assert bytes(ros1.write(message)) == data, reproducer
            assert ros1.read(kind, memoryview(data), 0, len(data)) == message, reproducer
            assert message.serialized_size() == len(data), reproducer


def test_there_are_types_to_compare() -> None:
    if not SHARE.joinpath("std_msgs").exists():
        require("genpy")
    assert len(_types()) > 150
