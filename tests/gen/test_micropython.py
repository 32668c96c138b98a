"""Generated code runs unmodified under MicroPython, and makes and reads the same bytes there."""

from __future__ import annotations

import json
import os
import pathlib
import subprocess
from typing import Any

import pytest

from peers import require
from random_values import Values, fill
from roslet.gen import runtime
from roslet.gen.python_package import write_package
from roslet.idl import Message

HERE = pathlib.Path(__file__).resolve().parent
SOURCE = HERE.parents[1] / "src"

TYPES: dict[Any, list[str]] = {
    "ros1": [
        "std_msgs/String",
        "std_msgs/Empty",
        "std_msgs/UInt64",
        "std_msgs/ByteMultiArray",
        "std_msgs/UInt8MultiArray",
        "geometry_msgs/PoseStamped",
        "sensor_msgs/Imu",
        "sensor_msgs/Image",
        "sensor_msgs/JointState",
        "sensor_msgs/PointCloud2",
        "tf2_msgs/TFMessage",
        "trajectory_msgs/JointTrajectory",
        "diagnostic_msgs/DiagnosticArray",
        "std_srvs/srv/SetBoolRequest",
    ],
    "ros2": [
        "std_msgs/msg/String",
        "std_msgs/msg/Empty",
        "std_msgs/msg/UInt64",
        "std_msgs/msg/ByteMultiArray",
        "geometry_msgs/msg/PoseStamped",
        "sensor_msgs/msg/JointState",
        "sensor_msgs/msg/PointCloud2",
        "rcl_interfaces/msg/ParameterEvent",
        "rmw_dds_common/msg/ParticipantEntitiesInfo",
        "example_interfaces/msg/WString",
        "tf2_msgs/msg/TFMessage",
        "example_interfaces/srv/AddTwoInts_Request",
    ],
}
STYLES = ("empty", "random", "foreign", "long")


def cases(dialect: Any) -> list[str]:
    registry = runtime.registry(dialect)
    lines = []
    for name in TYPES[dialect]:
        message = registry.interface(name)
        assert isinstance(message, Message)
        for seed, style in enumerate(STYLES):
            value = Values(registry.message, seed, style).message(message)
            data = fill(runtime.message_class(dialect, message.name), value).serialize()
            parts = [dialect, message.name.package, message.name.kind, message.name.name, value, data.hex()]
            lines.append(json.dumps(parts, ensure_ascii=False))
    return lines


@pytest.mark.parametrize("dialect", ["ros1", "ros2"])
def test_a_generated_package_round_trips_under_micropython(dialect: Any, tmp_path: pathlib.Path) -> None:
    micropython = require("micropython")
    write_package(tmp_path / f"{dialect}_types", runtime.registry(dialect), TYPES[dialect])
    lines = cases(dialect)
    (tmp_path / "cases.jsonl").write_text("\n".join(lines) + "\n", encoding="utf-8")
    done = subprocess.run(
        [
            str(micropython),
            "-X",
            "heapsize=16m",
            str(HERE / "micropython_round_trip.py"),
            str(tmp_path),
            str(tmp_path / "cases.jsonl"),
        ],
        capture_output=True,
        text=True,
        timeout=60,
        env={**os.environ, "MICROPYPATH": str(SOURCE)},
        check=False,
    )
    assert done.returncode == 0, done.stderr + done.stdout
    assert done.stdout.split() == [str(len(lines))]
