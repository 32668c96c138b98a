"""The same bytes and values where numpy is absent; and numpy is not imported before it is needed."""

from __future__ import annotations

import json
import pathlib
import subprocess
import sys
from typing import Any

from roslet.gen import runtime

HERE = pathlib.Path(__file__).resolve().parent
SOURCE = str(HERE.parents[1] / "src")


def run(*arguments: str) -> str:
    done = subprocess.run(
        [sys.executable, *arguments],
        capture_output=True,
        text=True,
        env={"PYTHONPATH": SOURCE},
        timeout=60,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_without_numpy_bytes_are_the_same_and_arrays_are_memoryviews() -> None:
    seen = json.loads(run(str(HERE / "without_numpy.py")))
    assert seen["numpy"] is False
    dialect: Any
    for dialect in ("ros1", "ros2"):
        kind: Any = runtime.message_class(dialect, "sensor_msgs/JointState")
        made = kind(name=["a"], position=[1.0, 2.0], velocity=[3.0], effort=(4, 5))
        found = seen[dialect]
        assert found["data"] == made.serialize().hex()
        assert found["type"] == "memoryview"
        assert found["values"] == [[1.0, 2.0], [3.0], [4.0, 5.0]]
        assert found["equal"] and found["again"] and found["copy"] and found["imu"]
        assert found["zeros"] == [0.0] * 9
        assert found["error"] == "orientation_covariance: expected exactly 9 elements, got 8"
    assert seen["big"] == [1.0, 2.0]


def test_numpy_is_imported_with_the_first_numeric_array_and_not_before() -> None:
    program = (
        "import sys, roslet\n"
        "from roslet.gen import runtime\n"
        "kind = runtime.message_class('ros1', 'std_msgs/String')\n"
        "kind.deserialize(kind('a').serialize())\n"
        "runtime.message_class('ros1', 'sensor_msgs/Imu')\n"
        "print('numpy' in sys.modules)\n"
        "runtime.message_class('ros1', 'sensor_msgs/Imu')()\n"
        "print('numpy' in sys.modules)\n"
    )
    assert run("-c", program).split() == ["False", "True"]


def test_making_messages_imports_nothing_heavy() -> None:
    program = (
        "import sys\nbefore = set(sys.modules)\n"
        "from roslet.gen import runtime\n"
        "kind = runtime.message_class('ros1', 'std_msgs/String')\n"
        "kind.deserialize(kind('a').serialize())\n"
        "print(' '.join(sorted(set(sys.modules) - before)))\n"
    )
    loaded = set(run("-c", program).split())
    assert not loaded & {
        "dataclasses",
        "inspect",
        "re",
        "json",
        "typing",
        "enum",
        "numpy",
        "array",
        "pathlib",
    }
