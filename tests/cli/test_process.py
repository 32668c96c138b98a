"""Programs as processes: what they say is read in time or not at all, and none outlives its block."""

from __future__ import annotations

import signal
import sys
import time

import pytest

from roslet.cli import process
from roslet.cli.process import Failed, Process


def python(text: str, stop: signal.Signals | None = None) -> Process:
    return Process("it", [sys.executable, "-c", text], stop=stop)


def test_its_lines_and_its_facts_come_in_order_and_then_its_end() -> None:
    with python("print('a'); print('noise'); print('[1]'); print('{\"n\": 1}')") as it:
        assert it.line(10) == "a"
        assert it.fact(10) == {"n": 1}
        assert it.line_or_end(10) is None
        with pytest.raises(Failed, match=r"it has ended$"):
            it.line(10)
        assert it.end(10) == 0 and not it.running


def test_its_last_words_say_why_it_ended() -> None:
    with python("import sys; print('first', file=sys.stderr); sys.exit('out of order')") as it:
        with pytest.raises(Failed, match="it has ended: out of order"):
            it.line(10)
        assert it.end(10) == 1
        assert it.last_words() == ": out of order"


def test_one_that_says_nothing_is_not_waited_for() -> None:
    with python("import sys; sys.stdin.read()") as it:
        with pytest.raises(Failed, match=r"it says nothing for 0\.1 s"):
            it.line(0.1)
        assert it.end(0.1) is None and it.running


def test_lines_that_nobody_waits_for_are_taken_as_they_are() -> None:
    with python("print('a'); print('b')") as it:
        assert it.end(10) == 0
        assert list(it.lines()) == ["a", "b"]
        assert list(it.lines()) == []
        assert it.line_or_end(0) is None


@pytest.mark.parametrize(
    ("text", "stop", "code"),
    [
        ("import sys; print(); sys.stdin.read(); sys.exit(3)", None, 3),
        ("import time; print(flush=True); time.sleep(60)", signal.SIGTERM, -signal.SIGTERM),
        (
            "import signal, time; signal.signal(signal.SIGINT, signal.SIG_IGN); print(flush=True); time.sleep(60)",
            signal.SIGINT,
            -signal.SIGKILL,
        ),
    ],
)
def test_it_ends_with_its_block(
    monkeypatch: pytest.MonkeyPatch, text: str, stop: signal.Signals | None, code: int
) -> None:
    monkeypatch.setattr(process, "PATIENCE", 1.0)
    began = time.monotonic()
    with python(text.replace("print()", "print(flush=True)"), stop) as it:
        it.line(10)
        assert (it.memory() or 1) > 0
    assert it.process.returncode == code
    assert time.monotonic() - began < 10
