"""Every ROS 1 type of Debian's packages, installed or only unpacked, byte for byte as ROS 1's own Python has it."""

from __future__ import annotations

import pathlib
from collections.abc import Iterator

import pytest

from oracle import Oracle
from peers import CACHE, require
from random_values import STYLES, Values, fill, plain
from roslet import idl
from roslet.gen import runtime
from roslet.idl import Registry
from roslet.wire import ros1

SHARE = pathlib.Path("/usr/share")
UNPACKED = CACHE / "ros1-definitions/usr/share"  # of packages that are not installed
BUNDLED = pathlib.Path(idl.__file__).parent / "definitions/ros1"
# Debian ships its Python classes and not its definitions; ours are bundled.
WITHOUT_DEFINITIONS = "roscpp"


def _types() -> list[str]:
    found: set[str] = set()
    for root in (SHARE, UNPACKED):
        found |= _types_of(root, "*")
    return sorted(found | _types_of(BUNDLED, WITHOUT_DEFINITIONS))


def _types_of(root: pathlib.Path, package: str) -> set[str]:
    found = {f"{path.parent.parent.name}/{path.stem}" for path in root.glob(f"{package}/msg/*.msg")}
    for path in root.glob(f"{package}/srv/*.srv"):
        found |= {f"{path.parent.parent.name}/{path.stem}{part}" for part in ("Request", "Response")}
    return found


def _packages() -> list[str]:
    return sorted({name.split("/")[0] for name in _types()})


@pytest.fixture(scope="module")
def genpy() -> Iterator[Oracle]:
    require("genpy")
    oracle = Oracle(pathlib.Path("/usr/bin/python3"), "genpy_messages.py", str(UNPACKED))
    yield oracle
    oracle.close()


@pytest.fixture(autouse=True)
def debian_definitions(monkeypatch: pytest.MonkeyPatch) -> None:
    registry = Registry("ros1", {"ROS_PACKAGE_PATH": f"{SHARE}:{UNPACKED}"})
    monkeypatch.setattr(runtime, "_scopes", {"ros1": runtime._Scope(registry)})


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
    require("genpy")
    require("ros1-definitions")
    assert len(_types_of(SHARE, "*")) > 150
    assert len(_types_of(UNPACKED, "*")) > 30
    assert {"roscpp/Logger", "roscpp/GetLoggersRequest"} <= set(_types())
