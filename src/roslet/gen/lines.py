"""Generators yield lines; this indents them."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable
    from typing import TypeAlias

    Block: TypeAlias = Iterable[str | "Block"]
else:
    Block = object

INDENT = "    "


def render(block: Block, depth: int = 0) -> str:
    """The text of `block`: a string is one line, anything else is a block of lines one level deeper."""
    out: list[str] = []
    _render(block, INDENT * depth, out)
    return "".join(out)


def _render(block: Block, margin: str, out: list[str]) -> None:
    for line in block:
        if not isinstance(line, str):
            _render(line, margin + INDENT, out)
        elif line:
            out.append(margin + line + "\n")
        else:
            out.append("\n")
