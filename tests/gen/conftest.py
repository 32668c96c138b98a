"""The tests here share registries that nobody loads anything into; those of `load` have their own."""

from __future__ import annotations

from typing import Any

import pytest

from roslet.gen import runtime

_SCOPES: dict[str, Any] = {}


@pytest.fixture(autouse=True)
def separate_registries(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    loads = request.path.name == "test_load.py"
    monkeypatch.setattr(runtime, "_scopes", {} if loads else _SCOPES)
