"""Every reason that a host and its wire formats count is explained, and nothing else is."""

from __future__ import annotations

import ast
import pathlib
import re

from roslet.engine.net.reasons import REASONS

SOURCE = pathlib.Path(__file__).resolve().parents[3] / "src" / "roslet"


def used() -> set[str]:
    """Text that looks like a reason: lower-case words joined by hyphens."""
    found: set[str] = set()
    for folder in ("engine/net", "wire/net"):
        for path in (SOURCE / folder).glob("*.py"):
            if path.name != "reasons.py":
                for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                    text = node.value if isinstance(node, ast.Constant) else None
                    if isinstance(text, str) and re.fullmatch(r"[a-z][a-z0-9]*(-[a-z0-9]+)+", text):
                        found.add(text)
    return found


def test_every_reason_is_explained_and_every_explanation_is_used() -> None:
    assert used() == set(REASONS)


def test_every_reason_has_a_sentence() -> None:
    for reason, sentence in REASONS.items():
        assert sentence and not sentence.endswith("."), reason
