"""The reasons that occur in the sources, and what must hold of the table that explains them."""

from __future__ import annotations

import ast
import pathlib
import re

SOURCE = pathlib.Path(__file__).resolve().parents[1] / "src" / "roslet"


def used(*folders: str) -> set[str]:
    """Text that looks like a reason, lower-case words joined by hyphens, in the modules of these folders."""
    found: set[str] = set()
    for folder in folders:
        for path in (SOURCE / folder).glob("*.py"):
            if path.name != "reasons.py":
                for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                    text = node.value if isinstance(node, ast.Constant) else None
                    if isinstance(text, str) and re.fullmatch(r"[a-z][a-z0-9]*(-[a-z0-9]+)+", text):
                        found.add(text)
    return found


def check(reasons: dict[str, str], *folders: str) -> None:
    """Every reason is explained by a sentence, and every explanation is used."""
    assert used(*folders) == set(reasons)
    for reason, sentence in reasons.items():
        assert sentence and not sentence.endswith("."), reason
