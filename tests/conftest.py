"""What holds for every test: markers, an isolated ROS environment, a summary of absent peers, no skip in CI."""

from __future__ import annotations

import os
import tempfile

import pytest

from beside import Beside

# Helpers that assert, beside the test modules. Here, since a helper of one folder may be imported by the tests of another.
pytest.register_assert_rewrite("compat", "docs", "engine", "interop", "oracle")


def pytest_configure(config: pytest.Config) -> None:
    config.pluginmanager.register(Beside())
    config.addinivalue_line(
        "markers", "micropython: a module whose tests also run under MicroPython (tests/micropython)"
    )
    config.addinivalue_line("markers", "cpython: a test of such a module that needs CPython")
    # No test may reach a master, a discovery domain or a home of the person who runs it.
    for name in list(os.environ):
        if name.startswith("ROS_") or name in (
            "AMENT_PREFIX_PATH",
            "CMAKE_PREFIX_PATH",
            "RMW_IMPLEMENTATION",
        ):
            del os.environ[name]
    home = tempfile.mkdtemp(prefix="roslet-tests-")
    config.add_cleanup(lambda: _remove(home))
    os.environ.update(
        ROS_MASTER_URI="http://127.0.0.1:1",  # nobody listens there: a test that needs a master starts one
        ROS_IP="127.0.0.1",
        ROS_HOME=home,
        ROS_LOG_DIR=home + "/log",
        ROS_AUTOMATIC_DISCOVERY_RANGE="LOCALHOST",
    )


def _remove(folder: str) -> None:
    import shutil

    shutil.rmtree(folder, ignore_errors=True)


def _skipped(config: pytest.Config) -> list[str]:
    """The tests and modules that were skipped, each once, where none may be: where CI is set."""
    reporter = config.pluginmanager.get_plugin("terminalreporter")
    if reporter is None or not os.environ.get("CI"):
        return []
    return sorted({report.nodeid for report in reporter.stats.get("skipped", [])})


def pytest_sessionfinish(session: pytest.Session) -> None:
    if _skipped(session.config) and session.exitstatus == pytest.ExitCode.OK:
        session.exitstatus = pytest.ExitCode.TESTS_FAILED


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    skipped = _skipped(terminalreporter.config)
    if skipped:
        line = f"FAILED: CI is set, and nothing may be skipped there: {', '.join(skipped)}"
        terminalreporter.write_line(line, red=True, bold=True)
    absent = {
        str(report.longrepr[2])
        for report in terminalreporter.stats.get("skipped", [])
        if isinstance(report.longrepr, tuple) and "make peers" in str(report.longrepr[2])
    }
    for line in sorted(absent):
        terminalreporter.write_line(f"NOT JUDGED: {line}", yellow=True, bold=True)
