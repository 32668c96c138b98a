"""The tables of docs/robustness.md are those of the code."""

from __future__ import annotations

import ast
import importlib
import pathlib
import re
from collections.abc import Iterator

from docs.pages import ROOT, code, table_rows
from roslet.engine.net import limits as host
from roslet.engine.rtps.limits import Limits

PAGE = "docs/robustness.md"
SOURCE = ROOT / "src" / "roslet"
ROOMS = ("names", "wire", "engine", "io", "node", "master")

UNITS = {"KiB": 1 << 10, "MiB": 1 << 20, "s": 1, "": 1}

# Text with hyphens that is no reason.
OTHER = {
    # what --enable- and --disable- stand before
    "external-lib-logs",
    "rosout-logs",
    "stdout-logs",
    "content-encoding",
    "content-length",
    "keep-alive",
    "transfer-encoding",
    "roslet-close",
    "roslet-lookup",
    "utf-8",
    "utf-16-be",
    "utf-32-be",
    "utf-32-le",
    "utf-16-le",
}
# Reasons of one word.
WORDS = {"idle", "truncated"}


def modules() -> Iterator[tuple[str, ast.Module]]:
    for room in ROOMS:
        for path in [SOURCE / room] if room.endswith(".py") else sorted((SOURCE / room).rglob("*.py")):
            within = path.relative_to(SOURCE).as_posix()
            name = "roslet." + within.removesuffix(".py").removesuffix("/__init__").replace("/", ".")
            yield name, ast.parse(pathlib.Path(path).read_text(encoding="utf-8"))


def bounds() -> dict[str, int | float]:
    found: dict[str, int | float] = {}
    for name, tree in modules():
        for node in tree.body:
            target = node.targets[0] if isinstance(node, ast.Assign) else None
            if isinstance(target, ast.Name) and re.fullmatch(r"MAX_(?!SLEEP|VAIN)\w+|\w+_TIMEOUT", target.id):
                found[f"{name}.{target.id}"] = getattr(importlib.import_module(name), target.id)
    return found


def test_every_bound_is_listed_with_its_value() -> None:
    listed: dict[str, float] = {}
    limits: dict[str, float] = {}
    for constant, value, reason in table_rows(PAGE, "## Bounds"):
        if constant not in ("constant", "limit"):
            number, _, unit = value.partition(" ")
            table = listed if "." in constant else limits
            table[code(constant)[0]] = float(number) * UNITS[unit]
            assert reason, constant
    assert limits == {name: float(getattr(Limits(), name)) for name in Limits._fields}
    of_host = {f"Host.{name}": getattr(host.Limits(), name) for name in host.Limits._fields}
    assert listed == {name: float(value) for name, value in {**bounds(), **of_host}.items()}


def reasons() -> set[str]:
    found = set()
    for _, tree in modules():
        for node in ast.walk(tree):
            text = node.value if isinstance(node, ast.Constant) else None
            if isinstance(text, str) and re.fullmatch(r"[a-z][a-z0-9]*(-[a-z0-9]+)+", text):
                found.add(text)
    return (found - OTHER) | WORDS


def test_every_reason_is_listed_once() -> None:
    listed = [
        reason for row in table_rows(PAGE, "## Reasons") if row[0] != "reason" for reason in code(row[0])
    ]
    assert len(listed) == len(set(listed))
    assert set(listed) == reasons()
