"""Microseconds to write and to read a message: roslet, genpy, rosbags, rclpy and rosless side by side, on one machine.

    python benchmarks/serialization.py [--budget SECONDS] [--rounds N] [--json] [--only TEXT]

genpy is run by Debian's Python, rclpy by that of the ROS 2 wheels (`make peers`), rosless by $PEERS_PIP_PYTHON; what is
absent is left out. Of each library the quickest documented way is taken: roslet writes into a buffer that is reused
(`into`) or to new bytes (`write`), and reads from bytes (`read`); genpy writes into a BytesIO that is reused. `use` is to
read, and then to look at every field once: some libraries do the work of reading only then. A figure is the median of
five batches, and the best of the rounds; the collector runs as it does in a program.
"""

from __future__ import annotations

import argparse
import array
import importlib
import io
import json
import math
import os
import pathlib
import statistics
import subprocess
import sys
import time
from functools import partial

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from typing import Any

HERE = pathlib.Path(__file__).resolve()
GENPY_PYTHON = "/usr/bin/python3"
CACHE = pathlib.Path(os.environ.get("ROSLET_PEERS") or pathlib.Path.home() / ".cache/roslet/peers")

# The paper's Coordinate is in no standard package: its definition for each system, for the libraries that take one.
COORDINATE = "mros_comm_measure/Coordinate"
COORDINATE_TEXT = {
    "ros1": "float32 x\nfloat32 y\nfloat32 z\ntime time\n",
    "ros2": "float32 x\nfloat32 y\nfloat32 z\nbuiltin_interfaces/Time time\n",
}

STAMP = {"sec": 1700000000, "nanosec": 123456789}
HEADER = {"stamp": STAMP, "frame_id": "base_link"}
VECTOR = {"x": 0.1, "y": -0.2, "z": 9.81}
QUATERNION = {"x": 0.0, "y": 0.0, "z": 0.6, "w": 0.8}


def numbers(code: str, count: int) -> Any:
    return array.array(code, [math.sin(at * 0.01) * 5 + 6 for at in range(count)])


def cases() -> dict[str, tuple[str, dict[str, Any]]]:
    """name -> (type, values); field names are those of ROS 2."""
    pose = {"position": VECTOR, "orientation": QUATERNION}
    twist = {"linear": VECTOR, "angular": VECTOR}
    fields = [
        {"name": name, "offset": 4 * at, "datatype": 7, "count": 1}
        for at, name in enumerate(["x", "y", "z", "intensity"])
    ]
    transforms = [
        {
            "header": HEADER,
            "child_frame_id": f"link_{at}",
            "transform": {"translation": VECTOR, "rotation": QUATERNION},
        }
        for at in range(20)
    ]
    return {
        "String(11)": ("std_msgs/String", {"data": "hello world"}),
        "Coordinate": (COORDINATE, {"x": 0.5, "y": -0.25, "z": 1000.125, "time": STAMP}),
        "PointStamped": ("geometry_msgs/PointStamped", {"header": HEADER, "point": VECTOR}),
        "Imu": (
            "sensor_msgs/Imu",
            {
                "header": HEADER,
                "orientation": QUATERNION,
                "orientation_covariance": numbers("d", 9),
                "angular_velocity": VECTOR,
                "angular_velocity_covariance": numbers("d", 9),
                "linear_acceleration": VECTOR,
                "linear_acceleration_covariance": numbers("d", 9),
            },
        ),
        "Odometry": (
            "nav_msgs/Odometry",
            {
                "header": HEADER,
                "child_frame_id": "odom",
                "pose": {"pose": pose, "covariance": numbers("d", 36)},
                "twist": {"twist": twist, "covariance": numbers("d", 36)},
            },
        ),
        "LaserScan(720)": (
            "sensor_msgs/LaserScan",
            {
                "header": HEADER,
                "angle_min": -1.5,
                "angle_max": 1.5,
                "scan_time": 0.125,
                "range_max": 30.0,
                "ranges": numbers("f", 720),
                "intensities": numbers("f", 0),
            },
        ),
        "JointState(7)": (
            "sensor_msgs/JointState",
            {
                "header": HEADER,
                "name": [f"joint_{at}" for at in range(7)],
                "position": numbers("d", 7),
                "velocity": numbers("d", 7),
                "effort": numbers("d", 7),
            },
        ),
        "TFMessage(20)": ("tf2_msgs/TFMessage", {"transforms": transforms}),
        "PointCloud2(100k)": (
            "sensor_msgs/PointCloud2",
            {
                "header": HEADER,
                "height": 1,
                "width": 100000,
                "fields": fields,
                "point_step": 16,
                "row_step": 1600000,
                "data": bytes(1600000),
                "is_dense": True,
            },
        ),
    }


def microseconds(function: Callable[[], object], budget: float) -> float:
    """The median of five batches, each of a fifth of `budget` seconds."""
    function()
    started = time.perf_counter()
    function()
    once = max(time.perf_counter() - started, 1e-7)
    count = max(1, int(budget / 5 / once))
    batches = []
    for _ in range(5):
        started = time.perf_counter()
        for _ in range(count):
            function()
        batches.append((time.perf_counter() - started) / count * 1e6)
    return statistics.median(batches)


def renamed(value: Any) -> Any:
    """ROS 1's names for the parts of a time."""
    if isinstance(value, dict):
        if set(value) == {"sec", "nanosec"}:
            return {"secs": value["sec"], "nsecs": value["nanosec"]}
        return {key: renamed(part) for key, part in value.items()}
    return [renamed(part) for part in value] if isinstance(value, list) else value


Case = tuple[str, dict[str, "Callable[[], object]"]]


def reading(values: dict[str, Any], read: Callable[[], Any]) -> dict[str, Callable[[], object]]:
    """`read`, and `use`: what it returns is looked at, field by field, all that `values` name."""
    lines = ["def use():", "    m = read()"]

    def look(at: str, part: dict[str, Any], depth: int) -> None:
        for name, value in part.items():
            if isinstance(value, dict):
                look(f"{at}.{name}", value, depth)
            elif isinstance(value, list) and isinstance(value[0], dict):
                lines.append("    " * depth + f"for m{depth} in {at}.{name}:")
                look(f"m{depth}", value[0], depth + 1)
            else:
                lines.append("    " * depth + f"{at}.{name}")

    look("m", values, 1)
    made: dict[str, Any] = {"read": read}
    exec("\n".join(lines), made)
    return {"read": read, "use": made["use"]}


def roslet_cases(dialect: Any) -> Iterator[Case]:
    sys.path.insert(0, str(HERE.parents[1] / "src"))
    import numpy

    from roslet.gen.runtime import message_class, registry

    registry(dialect).load_full_text(COORDINATE, COORDINATE_TEXT[dialect])

    def build(kind: Any, values: dict[str, Any]) -> Any:
        message = kind()
        bases = {row[0]: row[1] for row in kind._spec}
        for name, value in values.items():
            if isinstance(value, dict):
                if "secs" in value:
                    getattr(message, name).set(value["secs"], value["nsecs"])
                    continue
                value = build(bases[name], value)
            elif isinstance(value, list) and isinstance(value[0], dict):
                value = [build(bases[name], part) for part in value]
            elif isinstance(value, array.array):
                value = numpy.array(value)
            setattr(message, name, value)
        return message

    buffer = memoryview(bytearray(2_000_000))
    for name, (type_name, values) in cases().items():
        kind = message_class(dialect, type_name)
        named = renamed(values) if dialect == "ros1" else values
        message = build(kind, named)
        data = message.serialize()
        if kind.deserialize(data) != message:
            raise AssertionError(name)
        yield (
            name,
            {
                "into": partial(message.serialize_into, buffer),
                "write": message.serialize,
                **reading(named, partial(kind.deserialize, data)),
            },
        )


def genpy_cases() -> Iterator[Case]:
    sys.path.insert(0, str(CACHE / "ros1/python"))  # the modules that genpy's generator made of our messages
    import genpy.message  # type: ignore[import-not-found]

    def read_new(kind: Any, data: bytes) -> object:
        return kind().deserialize(data)  # a new message each time, as rospy's subscribers do

    for name, (type_name, values) in cases().items():
        kind = genpy.message.get_message_class(type_name)
        values = renamed(values)
        payload = values.pop("data") if type_name.endswith("2") else None
        message = kind()
        genpy.message.fill_message_args(message, [listed(values)])
        if payload is not None:
            message.data = payload
        stream = io.BytesIO()
        message.serialize(stream)
        data = stream.getvalue()

        def write(message: Any = message, stream: Any = stream) -> bytes:
            stream.seek(0)
            stream.truncate(0)
            message.serialize(stream)
            return stream.getvalue()  # type: ignore[no-any-return]

        yield name, {"write": write, **reading(values, partial(read_new, kind, data))}


def listed(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: listed(part) for key, part in value.items()}
    if isinstance(value, array.array):
        return list(value)
    return [listed(part) for part in value] if isinstance(value, list) else value


def rclpy_cases() -> Iterator[Case]:
    from rclpy.serialization import deserialize_message, serialize_message  # type: ignore[import-not-found]

    def class_of(type_name: str) -> Any:
        package, name = type_name.split("/")
        return getattr(importlib.import_module(package + ".msg"), name)

    def fill(message: Any, values: dict[str, Any]) -> Any:
        types = message.get_fields_and_field_types()
        for name, value in values.items():
            if isinstance(value, dict):
                fill(getattr(message, name), value)
            elif isinstance(value, list) and isinstance(value[0], dict):
                element = class_of(types[name][len("sequence<") : -1])
                setattr(message, name, [fill(element(), part) for part in value])
            elif isinstance(value, array.array) and "[" in types[name]:
                getattr(message, name)[:] = value
            else:
                setattr(message, name, array.array("B", value) if isinstance(value, bytes) else value)
        return message

    for name, (type_name, values) in cases().items():
        try:
            kind = class_of(type_name)
        except ImportError:
            continue
        message = fill(kind(), values)
        data = serialize_message(message)
        yield (
            name,
            {
                "write": partial(serialize_message, message),
                **reading(values, partial(deserialize_message, data, kind)),
            },
        )


def rosbags_cases(dialect: str) -> Iterator[Case]:
    import numpy
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC if dialect == "ros1" else Stores.ROS2_JAZZY)
    store.register(get_types_from_msg(COORDINATE_TEXT[dialect], COORDINATE.replace("/", "/msg/")))

    def build(type_name: str, values: dict[str, Any]) -> Any:
        made = {}
        for name, (kind, detail) in store.fielddefs[type_name][1]:
            value = values.get(name, 0 if int(kind) == 1 else [])
            if isinstance(value, dict):
                value = build(str(detail), value)
            elif isinstance(value, list) and value and isinstance(value[0], dict):
                value = [build(str(detail[0][1]), part) for part in value]
            elif isinstance(value, array.array):
                value = numpy.array(value)
            elif isinstance(value, bytes):
                value = numpy.frombuffer(value, numpy.uint8)
            made[name] = value
        return store.types[type_name](**made)

    write: Any = store.serialize_ros1 if dialect == "ros1" else store.serialize_cdr
    read: Any = store.deserialize_ros1 if dialect == "ros1" else store.deserialize_cdr
    for name, (type_name, values) in cases().items():
        full = type_name.replace("/", "/msg/")
        if full in store.types:
            message = build(full, values)
            data = bytes(write(message, full))
            yield (
                name,
                {
                    "write": partial(write, message, full),
                    **reading(values, partial(read, data, full)),
                },
            )


def rosless_cases() -> Iterator[Case]:
    import rosless  # type: ignore[import-not-found]

    rosless.register_type(COORDINATE.replace("/", "/msg/"), COORDINATE_TEXT["ros2"])
    for name, (type_name, values) in cases().items():
        full = type_name.replace("/", "/msg/")
        message = rosless.Message(full, **listed(values))
        data = rosless.encode(full, message)
        yield (
            name,
            {
                "write": partial(rosless.encode, full, message),
                **reading(values, partial(rosless.decode, full, data)),
            },
        )


LIBRARIES: dict[str, tuple[str, Callable[[], Iterator[Case]]]] = {
    "roslet/ros1": (sys.executable, lambda: roslet_cases("ros1")),
    "genpy": (GENPY_PYTHON, genpy_cases),
    "rosbags/ros1": (sys.executable, lambda: rosbags_cases("ros1")),
    "roslet/cdr": (sys.executable, lambda: roslet_cases("ros2")),
    "rclpy": (str(CACHE / "kilted/bin/python"), rclpy_cases),
    "rosbags/cdr": (sys.executable, lambda: rosbags_cases("ros2")),
    "rosless": (os.environ.get("PEERS_PIP_PYTHON", sys.executable), rosless_cases),
}


def measure(library: str, budget: float) -> dict[str, dict[str, float]]:
    """Run by the library's own interpreter."""
    return {
        name: {what: round(microseconds(function, budget), 3) for what, function in functions.items()}
        for name, functions in LIBRARIES[library][1]()
    }


def run(library: str, budget: float) -> dict[str, dict[str, float]] | None:
    """The measurements of a library in a process of its own; None where it is absent."""
    python = LIBRARIES[library][0]
    if not pathlib.Path(python).exists():
        return None
    command = [python, str(HERE), "--child", library, "--budget", str(budget)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    if done.returncode:
        print(f"{library} left out: {done.stderr.strip().splitlines()[-1]}", file=sys.stderr)
        return None
    found: dict[str, dict[str, float]] = json.loads(done.stdout)
    return found


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(
        description="write and read messages with roslet and others, microseconds"
    )
    parser.add_argument("--budget", type=float, default=0.5, help="seconds for each figure")
    parser.add_argument("--rounds", type=int, default=3, help="how often each library has its turn")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument("--only", default="", help="libraries whose name contains this")
    parser.add_argument("--child", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.child:
        print(json.dumps(measure(options.child, options.budget)))
        return
    found: dict[str, dict[str, dict[str, float]]] = {}
    for _ in range(options.rounds):  # in turn, so that what else the machine does falls on all of them
        for library in LIBRARIES:
            figures = run(library, options.budget) if options.only in library else None
            for name, times in (figures or {}).items():
                best = found.setdefault(library, {}).setdefault(name, times)
                best.update({what: min(best[what], value) for what, value in times.items()})
    if options.json:
        print(json.dumps(found, indent=1))
        return
    for family in (
        ("roslet/ros1", "genpy", "rosbags/ros1"),
        ("roslet/cdr", "rclpy", "rosbags/cdr", "rosless"),
    ):
        print_table([library for library in family if library in found], found)


def print_table(libraries: list[str], found: dict[str, dict[str, dict[str, float]]]) -> None:
    if not libraries:
        return
    columns = [
        (library, what)
        for library in libraries
        for what in ("into", "write", "read", "use")
        if what in found[library]["Imu"]
    ]
    print(f"{'us':18s}" + "".join(f"{library + ' ' + what:>19s}" for library, what in columns))
    for name in cases():
        cells = [found[library].get(name, {}).get(what) for library, what in columns]
        print(
            f"{name:18s}" + "".join(f"{'-' if cell is None else format(cell, '.2f'):>19s}" for cell in cells)
        )
    print()


if __name__ == "__main__":
    main()
