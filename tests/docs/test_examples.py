"""Every example is listed where people look for it, and run by a test."""

from __future__ import annotations

from docs.pages import ROOT

EXAMPLES = sorted(path.name for path in (ROOT / "examples").glob("*.py"))


def test_every_example_is_listed_and_run() -> None:
    page = (ROOT / "examples" / "README.md").read_text(encoding="utf-8")
    test = (ROOT / "tests" / "examples" / "test_examples.py").read_text(encoding="utf-8")
    assert EXAMPLES
    assert [name for name in EXAMPLES if name not in page] == []
    assert [name for name in EXAMPLES if name not in test and name.removesuffix(".py") not in test] == []
