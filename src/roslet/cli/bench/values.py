"""The messages of the validity part: values in the order of the fields, nested as the types are. No library spells them."""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable


class _Any:
    def __repr__(self) -> str:
        return "anything"


ANY = _Any()
"""Matches whatever comes: a header's `seq` belongs to the publisher."""
IMAGE_OCTETS = 32768


@dataclass(frozen=True)
class Stamp:
    """A point in time: two values; one text to roscpp's printers."""

    seconds: int
    nanoseconds: int


def single(value: float) -> float:
    """The float32 that is nearest."""
    return float(struct.unpack("<f", struct.pack("<f", value))[0])


STAMP = Stamp(1_700_000_000, 123456789)


def _header(ros1: bool) -> list[Any]:
    return [ANY, STAMP, "map"] if ros1 else [STAMP, "map"]


def _integers(bits: int, signed: bool) -> list[int]:
    low = -(1 << (bits - 1)) if signed else 0
    high = low + (1 << bits) - 1
    return [low, low + 1, 0, 1, high - 1, high]


def _floats(bits: int) -> list[float]:
    largest = single(3.4028234663852886e38) if bits == 32 else 1.7976931348623157e308
    values = [0.0, -0.0, 1.5, -1.0 / 3.0, math.pi, largest, -largest, math.inf, -math.inf]
    return [single(value) if bits == 32 else value for value in values]


def _array(values: list[Any]) -> list[Any]:
    """A multi-array of one dimension: nested messages in an array, and an array of primitives."""
    count = len(values)
    return [[[["x", count, count], ["y", 1, 1]], 4_294_967_295], values]


def _pose(ros1: bool) -> list[Any]:
    pose = [[1.5, -2.5, 1e300], [0.0, 0.6, -0.8, 1.0]]
    return [_header(ros1), [pose, [index / 7 - 2.0 for index in range(36)]]]


def _image(ros1: bool) -> list[Any]:
    octets = bytes((7 * index + index // 256) % 256 for index in range(IMAGE_OCTETS))
    return [_header(ros1), 128, 256, "mono8", 0, 256, octets]


def messages(ros1: bool) -> dict[str, list[list[Any]]]:
    """The messages of each type."""
    found: dict[str, list[list[Any]]] = {"std_msgs/Bool": [[False], [True]]}
    for bits in (8, 16, 32, 64):
        for signed in (True, False):
            name = f"std_msgs/{'Int' if signed else 'UInt'}{bits}"
            found[name] = [[value] for value in _integers(bits, signed)]
            found[name + "MultiArray"] = [_array(_integers(bits, signed))]
    for bits in (32, 64):
        found[f"std_msgs/Float{bits}"] = [[value] for value in _floats(bits)]
        found[f"std_msgs/Float{bits}MultiArray"] = [_array(_floats(bits))]
    found["std_msgs/Char"] = [[0], [65], [255]]
    # A byte is signed on ROS 1, and an octet on ROS 2.
    found["std_msgs/Byte"] = [[-128], [127]] if ros1 else [[0], [255]]
    found["std_msgs/String"] = [["letters"], ["žluťoučký 日本 🐢"], ["x" * 5000]]
    if ros1:
        found["std_msgs/Time"] = [[STAMP], [Stamp(2**32 - 1, 999999999)]]
        found["std_msgs/Duration"] = [[[1, 500000000]], [[-5, 250000000]]]
    found["geometry_msgs/PointStamped"] = [[_header(ros1), [1.5, -2.5, 1e-300]]]
    found["geometry_msgs/PoseWithCovarianceStamped"] = [_pose(ros1)]
    found["mros_comm_measure/Coordinate"] = [[single(7.899995), single(792.37), single(-237.2), STAMP]]
    found["sensor_msgs/Image"] = [_image(ros1)]
    return found


def flat(value: Any) -> list[Any]:
    """Every value, in order."""
    if isinstance(value, Stamp):
        return [value.seconds, value.nanoseconds]
    if isinstance(value, (list, tuple, bytes)):
        return [leaf for part in value for leaf in flat(part)]
    return [value]


def printed(value: Any) -> list[Any]:
    """The same as roscpp's printers tell it, which have one text for a point in time."""
    if isinstance(value, Stamp):
        return [f"{value.seconds}.{value.nanoseconds:09}"]
    if isinstance(value, (list, tuple, bytes)):
        return [leaf for part in value for leaf in printed(part)]
    return [value]


def same(expected: list[Any], found: list[Any]) -> bool:
    """Whether each value is that which was expected: zeros by their sign too, texts of numbers by their number."""
    return len(expected) == len(found) and all(map(_same, expected, found))


def _same(expected: Any, found: Any) -> bool:
    if expected is ANY:
        return True
    if isinstance(expected, str):
        return bool(expected == found)
    try:
        if isinstance(expected, float):
            value = float(found)
            return value == expected and math.copysign(1.0, value) == math.copysign(1.0, expected)
        return bool(int(found) == expected)
    except (TypeError, ValueError):
        return False


ELEMENTS = {"dim": "std_msgs/MultiArrayDimension"}
"""Types of the fields that are arrays of messages."""


def _names(message: Any) -> tuple[str, ...] | None:
    if hasattr(message, "secs"):  # a time or duration of ROS 1
        return ("secs", "nsecs")
    return getattr(type(message), "__slots__", None)


def fill(message: Any, value: Any, make: Callable[[str], Any]) -> Any:
    """Give one of roslet's messages its values, by the order of its fields; `make` gives an empty message of a type."""
    value = [value.seconds, value.nanoseconds] if isinstance(value, Stamp) else value
    for name, one in zip(_names(message) or (), value, strict=True):
        if one is ANY:
            continue
        if name in ELEMENTS:
            setattr(message, name, [fill(make(ELEMENTS[name]), part, make) for part in one])
        elif _names(getattr(message, name)) is not None:
            fill(getattr(message, name), one, make)
        else:
            setattr(message, name, one)
    return message


def read(message: Any) -> list[Any]:
    """Every value in one of roslet's messages, in order."""
    if isinstance(message, (bool, int, float, str)):
        return [message]
    if isinstance(message, (bytes, bytearray, memoryview)):
        return list(bytes(message))
    if hasattr(message, "tolist"):
        return read(message.tolist())
    parts = message
    if not isinstance(message, (list, tuple)):
        parts = [getattr(message, name) for name in _names(message) or ()]
    return [leaf for part in parts for leaf in read(part)]
