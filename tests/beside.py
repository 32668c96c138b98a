"""Tests that mostly wait for the processes they have started run beside each other: `pytest.mark.beside`.

When the first such test of a module is called, all of them are started, a few at a time, each in a thread; each is still
reported by itself, in its turn. They take nothing but parameters and `tmp_path`, and share nothing: what they start is in
network namespaces of its own.
"""

from __future__ import annotations

import pathlib
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

import pytest

# At a time: their processes are idle more than half of the time.
WORKERS = 3


class Beside:
    """The plugin."""

    def __init__(self) -> None:
        self._pool = ThreadPoolExecutor(WORKERS, "beside")
        self._running: dict[str, Future[None]] = {}

    def pytest_configure(self, config: pytest.Config) -> None:
        config.addinivalue_line(
            "markers", "beside: a test that runs beside the others of its module (beside.py)"
        )

    @pytest.hookimpl(tryfirst=True)
    def pytest_pyfunc_call(self, pyfuncitem: pytest.Function) -> bool | None:
        if not _is_beside(pyfuncitem):
            return None
        if pyfuncitem.nodeid not in self._running:
            self._start(pyfuncitem)
        self._running.pop(pyfuncitem.nodeid).result()
        return True

    def _start(self, first: pytest.Function) -> None:
        own: Any = first.funcargs["tmp_path"]
        parent: pathlib.Path = own.parent
        items = first.session.items
        for item in items[items.index(first) :]:
            if item.path == first.path and isinstance(item, pytest.Function) and _is_beside(item):
                folder = parent / f"beside-{len(list(parent.glob('beside-*')))}"
                folder.mkdir()
                self._running[item.nodeid] = self._pool.submit(_run, item, folder)

    def pytest_sessionfinish(self) -> None:
        self._pool.shutdown(cancel_futures=True)


def _is_beside(item: pytest.Item) -> bool:
    return item.get_closest_marker("beside") is not None


def _run(item: pytest.Function, folder: pathlib.Path) -> None:
    given: dict[str, Any] = {"tmp_path": folder}
    if hasattr(item, "callspec"):
        given.update(item.callspec.params)
    item.obj(**{name: given[name] for name in item._fixtureinfo.argnames})
