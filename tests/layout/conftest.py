"""The tests here share registries that nobody loads anything into."""

from __future__ import annotations

from typing import Any

import pytest

from roslet.gen import runtime

_SCOPES: dict[str, Any] = {}


@pytest.fixture(autouse=True)
def separate_registries(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(runtime, "_scopes", _SCOPES)
