"""Truncated, lying and random bytes: MalformedMessage, in bounded time and memory."""

from __future__ import annotations

import pathlib
import random
import time
import tracemalloc
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from definitions import classes
from random_values import Values, fill
from roslet.errors import MalformedMessage
from roslet.gen import runtime

TYPES = [
    ("ros1", "std_msgs/String"),
    ("ros1", "sensor_msgs/JointState"),
    ("ros1", "nav_msgs/Odometry"),
    ("ros1", "sensor_msgs/PointCloud2"),
    ("ros1", "tf2_msgs/TFMessage"),
    ("ros1", "visualization_msgs/MarkerArray"),
    ("ros1", "diagnostic_msgs/DiagnosticArray"),
    ("ros2", "std_msgs/msg/String"),
    ("ros2", "sensor_msgs/msg/JointState"),
    ("ros2", "sensor_msgs/msg/PointCloud2"),
    ("ros2", "rcl_interfaces/msg/ParameterEvent"),
    ("ros2", "rmw_dds_common/msg/ParticipantEntitiesInfo"),
    ("ros2", "type_description_interfaces/msg/TypeDescription"),
    ("ros2", "visualization_msgs/msg/MarkerArray"),
]


def sample(dialect: Any, name: str, style: str = "foreign") -> tuple[Any, bytes]:
    registry = runtime.registry(dialect)
    kind = runtime.message_class(dialect, name)
    value = Values(registry.message, 7, style).message(registry.message(name))
    return kind, fill(kind, value).serialize()


def read(kind: Any, data: bytes) -> MalformedMessage | None:
    """Read `data` in the middle of a larger buffer; the error, checked to be sensible."""
    buffer = memoryview(b"\x01\0\0" + data + b"\x01\0\0\0" * 8)
    try:
        kind.deserialize_from(buffer, 3, 3 + len(data))
    except MalformedMessage as error:
        assert 0 <= error.offset <= len(data)
        return error
    return None


@pytest.mark.parametrize(("dialect", "name"), TYPES)
def test_a_message_truncated_at_any_byte_is_malformed(dialect: Any, name: str) -> None:
    kind, data = sample(dialect, name)
    assert len(data) > 4
    for size in range(len(data)):
        assert read(kind, data[:size]) is not None, size
        with pytest.raises(MalformedMessage):
            kind.deserialize(data[:size])
    assert read(kind, data) is None


@pytest.mark.parametrize(("dialect", "name"), TYPES)
def test_a_lying_count_anywhere_allocates_no_more_than_the_input_justifies(dialect: Any, name: str) -> None:
    kind, data = sample(dialect, name)
    assert read(kind, data) is None  # which compiles the reader
    tracemalloc.start()
    places = random.Random(3).sample(range(len(data) - 4), min(len(data) - 4, 100))
    for at in [*range(min(len(data) - 4, 40)), *places]:
        for lie in (b"\xff\xff\xff\xff", b"\xff\xff\xff\x7f", b"\x00\x00\x01\x00"):
            tracemalloc.reset_peak()
            before = tracemalloc.get_traced_memory()[0]
            read(kind, data[:at] + lie + data[at + 4 :])
            assert tracemalloc.get_traced_memory()[1] - before < 200_000 + 100 * len(data)
    tracemalloc.stop()


@pytest.mark.parametrize(("dialect", "name"), TYPES)
@settings(max_examples=60, deadline=2000)
@given(data=st.binary(max_size=300))
def test_random_bytes_are_read_or_malformed(dialect: Any, name: str, data: bytes) -> None:
    kind = runtime.message_class(dialect, name)
    if dialect == "ros2":
        read(kind, b"\0\1\0\0" + data)
        read(kind, b"\0\0\0\0" + data)
        read(kind, b"\0\7\0\0" + data)
    error = read(kind, data)
    assert error is None or error.message


@pytest.mark.parametrize(("dialect", "name"), TYPES)
@settings(max_examples=40, deadline=2000)
@given(st.data())
def test_a_damaged_message_is_read_or_malformed(dialect: Any, name: str, data: st.DataObject) -> None:
    kind, good = sample(dialect, name)
    bad = bytearray(good)
    for _ in range(data.draw(st.integers(1, 4))):
        bad[data.draw(st.integers(0, len(bad) - 1))] = data.draw(st.integers(0, 255))
    error = read(kind, bytes(bad))
    assert error is None or error.message


def test_a_million_hostile_bytes_take_no_longer_than_good_ones() -> None:
    kind = runtime.message_class("ros1", "tf2_msgs/TFMessage")
    started = time.perf_counter()
    for filler in (b"\0", b"\1", b"\xff"):
        with pytest.raises(MalformedMessage):
            kind.deserialize(b"\x00\x10\x00\x00" + filler * 1_000_000)
    assert time.perf_counter() - started < 5


def test_elements_without_bytes_are_bounded() -> None:
    with classes("ros1", {"pkg/Nothing": "", "pkg/Holder": "Nothing[] many\nNothing[3] three\n"}) as (
        _,
        holder,
    ):
        assert len(holder.deserialize(b"\x00\x04\x00\x00").many) == 1024
        assert len(holder.deserialize(b"\x00\x00\x00\x00").three) == 3
        with pytest.raises(MalformedMessage) as caught:
            holder.deserialize(b"\x01\x04\x00\x00")
        assert caught.value.path == "many"


def test_the_error_of_generated_code_names_offset_and_path() -> None:
    kind = runtime.message_class("ros1", "nav_msgs/Path")
    message: Any = kind()
    pose = runtime.message_class("ros1", "geometry_msgs/PoseStamped")
    message.poses = [pose(), pose()]
    message.poses[0].header.frame_id = "x" * 8  # so that the count alone gives nothing away
    data = message.serialize()
    with pytest.raises(MalformedMessage) as caught:
        kind.deserialize(data[:-8])
    assert caught.value.path == "poses[1].pose.orientation.w"
    assert caught.value.offset == len(data) - 8
    assert caught.value.message == "8 bytes needed, 0 left"


def test_the_fuzz_target_passes_its_smoke_run() -> None:
    import subprocess
    import sys

    program = pathlib.Path(__file__).resolve().parents[2] / "fuzz" / "fuzz_messages.py"
    done = subprocess.run(
        [sys.executable, str(program), "--smoke", "300"],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "300" in done.stdout
