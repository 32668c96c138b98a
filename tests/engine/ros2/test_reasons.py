"""Every reason that a node counts on ROS 2, apart from those of RTPS, is explained, and nothing else is."""

from __future__ import annotations

import ast
import pathlib

from roslet.engine.ros2.reasons import REASONS
from roslet.engine.rtps import reasons as rtps

SOURCE = pathlib.Path(__file__).resolve().parents[3] / "src" / "roslet"
TESTS = pathlib.Path(__file__).resolve().parents[2]
COUNTING = {"count", "_count", "ProtocolError"}


def used() -> set[str]:
    """Reasons by the calls that count them or raise them to be counted."""
    found: set[str] = set()
    files = [SOURCE / "io/udp.py", SOURCE / "io/ros2.py", SOURCE / "wire/discovery_info.py"]
    for folder in ("engine/ros2", "node", "node/ros2", "compat/rclpy"):
        files += (SOURCE / folder).glob("*.py")
    for path in files:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and node.args and isinstance(node.args[0], ast.Constant):
                called = getattr(node.func, "attr", getattr(node.func, "id", ""))
                if called in COUNTING and isinstance(node.args[0].value, str):
                    found.add(node.args[0].value)
    return found - {"."}  # str.count


def test_every_reason_is_explained_and_every_explanation_is_used() -> None:
    assert used() == set(REASONS)


def test_no_reason_has_two_explanations() -> None:
    assert not set(REASONS) & set(rtps.REASONS)


def test_every_reason_has_a_sentence() -> None:
    for reason, sentence in REASONS.items():
        assert sentence and not sentence.endswith("."), reason


def test_every_reason_is_asserted_in_some_test() -> None:
    texts = "".join(
        path.read_text(encoding="utf-8")
        for path in TESTS.rglob("test_*.py")
        if path.name != "test_reasons.py"
    )
    # One test has a table of what follows the prefix.
    short = {reason: reason.removeprefix("discovery-info-") for reason in REASONS}
    untested = {
        reason for reason in REASONS if f'"{reason}' not in texts and f'"{short[reason]}"' not in texts
    }
    assert untested == set()
