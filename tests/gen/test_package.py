"""A package of generated classes on disk."""

from __future__ import annotations

import importlib
import pathlib
import subprocess
import sys
from typing import Any

import pytest

from roslet.errors import UnknownType
from roslet.gen import runtime
from roslet.gen.lines import render
from roslet.gen.python_package import write_package

ROOT = pathlib.Path(__file__).resolve().parents[2]
NAMES: dict[Any, list[str]] = {
    "ros1": ["sensor_msgs/Imu", "std_srvs/SetBool", "actionlib/Test"],
    "ros2": [
        "sensor_msgs/msg/Imu",
        "example_interfaces/srv/AddTwoInts",
        "example_interfaces/action/Fibonacci",
    ],
}


def texts(folder: pathlib.Path) -> dict[str, str]:
    return {str(path.relative_to(folder)): path.read_text() for path in folder.rglob("*.py*")}


@pytest.mark.parametrize("dialect", ["ros1", "ros2"])
def test_the_text_is_the_same_every_time_and_written_only_if_it_changed(
    dialect: Any, tmp_path: pathlib.Path
) -> None:
    first = write_package(tmp_path / "one", runtime.registry(dialect), NAMES[dialect])
    assert first and write_package(tmp_path / "one", runtime.registry(dialect), NAMES[dialect]) == []
    write_package(tmp_path / "two", runtime.registry(dialect), reversed(NAMES[dialect]))
    assert texts(tmp_path / "one") == texts(tmp_path / "two")
    changed = tmp_path / "one" / "sensor_msgs" / "msg" / "_Imu.py"
    changed.write_text("# damaged")
    assert write_package(tmp_path / "one", runtime.registry(dialect), NAMES[dialect]) == [str(changed)]


@pytest.mark.parametrize("dialect", ["ros1", "ros2"])
def test_classes_on_disk_are_those_made_at_run_time(
    dialect: Any, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_package(tmp_path / f"types_{dialect}", runtime.registry(dialect), NAMES[dialect])
    monkeypatch.syspath_prepend(str(tmp_path))
    module = importlib.import_module(f"types_{dialect}.sensor_msgs.msg")
    made, live = module.Imu, runtime.message_class(dialect, "sensor_msgs/Imu")
    for fact in ("_type", "_md5sum", "_full_text", "_type_hash", "_views", "_fixed_size", "_minimum_size"):
        assert getattr(made, fact) == getattr(live, fact), fact
    assert (made._maximum_size, made._fields_and_types) == (live._maximum_size, live._fields_and_types)
    assert made().serialize() == live().serialize()
    assert module.__all__ == ["Imu"]
    with pytest.raises(AttributeError):
        _ = module.Image
    if dialect == "ros2":
        services = importlib.import_module("types_ros2.example_interfaces.srv")
        assert services.AddTwoInts.Request(a=1, b=2).a == 1
        actions = importlib.import_module("types_ros2.example_interfaces.action")
        assert actions.Fibonacci.SendGoal.Request().goal.order == 0


def test_what_is_generated_passes_the_type_checker(tmp_path: pathlib.Path) -> None:
    write_package(tmp_path / "some_types", runtime.registry("ros2"), NAMES["ros2"])
    (tmp_path / "user.py").write_text(
        "from some_types.sensor_msgs.msg import Imu\n"
        "from some_types.example_interfaces.srv import AddTwoInts\n"
        "name: str = Imu().header.frame_id\n"
        "Imu.deserialize(b'').header.stamp.sec += 1\n"
        "AddTwoInts.Request(a=1)\n"
        "Imu().header.frame_id = 5\n"
        "Imu(haeder=None)\n"
    )
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--cache-dir", str(tmp_path / "cache"), "user.py"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=100,
        env={"MYPYPATH": f"{ROOT / 'src'}:{tmp_path}", "PATH": ""},
        check=False,
    )
    lines = [line for line in done.stdout.splitlines() if ": error:" in line]
    assert len(lines) == 2, done.stdout + done.stderr
    assert lines[0].startswith("user.py:6") and lines[1].startswith("user.py:7")


def test_an_unknown_name_writes_nothing(tmp_path: pathlib.Path) -> None:
    with pytest.raises(UnknownType):
        write_package(tmp_path / "none", runtime.registry("ros1"), ["std_msgs/String", "no_pkg/Thing"])
    assert not (tmp_path / "none").exists()


def test_lines_are_indented_by_nesting() -> None:
    assert render(["if a:", ["b", ["c"], ""], "d"]) == "if a:\n    b\n        c\n\nd\n"
