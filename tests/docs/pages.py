"""Loads tools/check_docs.py, which is no package."""

from __future__ import annotations

import importlib.util
import pathlib
import sys
from typing import Any

ROOT = pathlib.Path(__file__).resolve().parents[2]


def checker() -> Any:
    """The module."""
    if "check_docs" not in sys.modules:
        spec = importlib.util.spec_from_file_location("check_docs", ROOT / "tools" / "check_docs.py")
        assert spec is not None and spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        sys.modules["check_docs"] = module
        spec.loader.exec_module(module)
    return sys.modules["check_docs"]


def table_rows(page: str, heading: str) -> list[list[str]]:
    """The cells of the tables below `heading` (a line of the page) up to the next heading of its level or above."""
    lines = (ROOT / page).read_text(encoding="utf-8").splitlines()
    level = len(heading) - len(heading.lstrip("#"))
    rows: list[list[str]] = []
    for line in lines[lines.index(heading) + 1 :]:
        if line.startswith("#") and len(line) - len(line.lstrip("#")) <= level:
            break
        if line.startswith("|") and not set(line) <= set("|-: "):
            rows.append([cell.strip() for cell in line.strip("|").replace("\\|", "\x00").split("|")])
    return [[cell.replace("\x00", "|") for cell in row] for row in rows]


def code(cell: str) -> list[str]:
    """What stands in backquotes."""
    return cell.split("`")[1::2]
