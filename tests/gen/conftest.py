"""The tests here share registries that nobody loads anything into; those of `load` have their own."""

from __future__ import annotations

from typing import Any

import pytest

from roslet.gen import runtime

_REGISTRIES: dict[str, Any] = {}
_CLASSES: dict[tuple[str, str], Any] = {}


@pytest.fixture(autouse=True)
def separate_registries(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    loads = request.path.name == "test_load.py"
    monkeypatch.setattr(runtime, "_registries", {} if loads else _REGISTRIES)
    monkeypatch.setattr(runtime, "_classes", {} if loads else _CLASSES)
