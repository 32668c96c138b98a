"""Every reason that the code counts is explained, and nothing else is."""

from __future__ import annotations

import pathlib
import re

from roslet.engine.ros1.reasons import REASONS

SOURCE = pathlib.Path(__file__).resolve().parents[3] / "src" / "roslet"
TESTS = pathlib.Path(__file__).resolve().parents[2]
ROS2 = {SOURCE / "io/udp.py", SOURCE / "io/ros2.py"}
# In the wire and RPC modules that the docstring of `reasons` refers to.
ELSEWHERE = {"http-status", "bad-reply", "header-too-long"}


def used() -> set[str]:
    """Reasons by the places that count them or raise them to be counted."""
    found: set[str] = set()
    for folder in ("engine/ros1", "io", "node", "node/ros1"):
        for path in (SOURCE / folder).glob("*.py"):
            if path.name == "reasons.py" or path in ROS2:
                continue
            text = path.read_text(encoding="utf-8")
            found.update(re.findall(r'count\(\s*"([^"]+)"', text))
            found.update(re.findall(r'ProtocolError\(\s*"([^"]+)"', text))
            found.update(re.findall(r'^UNREAD = "([^"]+)"', text, re.MULTILINE))
    for name in ("tcpros", "udpros"):
        text = (SOURCE / "wire" / f"{name}.py").read_text(encoding="utf-8")
        found.update(re.findall(r'ProtocolError\(\s*"([^"]+)"', text))
    return found - ELSEWHERE


def test_every_reason_is_explained_and_every_explanation_is_used() -> None:
    assert used() == set(REASONS)


def test_a_reason_is_lower_case_words_joined_by_hyphens() -> None:
    for reason, sentence in REASONS.items():
        assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", reason), reason
        assert sentence and not sentence.endswith(".")


def test_every_reason_is_asserted_in_some_test() -> None:
    texts = "".join(
        path.read_text(encoding="utf-8")
        for path in TESTS.rglob("test_*.py")
        if path.name != "test_reasons.py"
    )
    untested = {reason for reason in REASONS if f'"{reason}"' not in texts and f'"{reason}' not in texts}
    assert untested == set()
