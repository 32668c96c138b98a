"""Classes from definitions written in a test: `classes("ros1", {"pkg/Name": "int32 x"})`."""

from __future__ import annotations

import os
import pathlib
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from roslet.gen import runtime
from roslet.idl import Registry


@contextmanager
def classes(dialect: Any, texts: dict[str, str]) -> Iterator[list[Any]]:
    """The classes of the definitions `texts` (`pkg/Name` or `pkg/srv/Name` to text), in a registry of their own."""
    before = runtime._scopes
    with tempfile.TemporaryDirectory() as folder:
        for name, text in texts.items():
            package, _, rest = name.partition("/")
            kind, _, short = rest.rpartition("/")
            kind = kind or "msg"
            path = pathlib.Path(folder, package, kind, f"{short}.{kind}")
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        registry = Registry(dialect, None)
        registry.load(os.fspath(folder))
        runtime._scopes = {dialect: runtime._Scope(registry)}
        try:
            found = [runtime.interface_class(dialect, name) for name in texts]
            yield found
        finally:
            runtime._scopes = before
