"""The I-th message of each type, as plain data: what every peer sends and what every peer expects.

`sample(TYPE, I, SIZE)` is a dict of field values with the type under "_type", nested the same way. It knows
neither roslet nor genpy: `build` makes either's message from it, `differences` compares either's message with
it. roscpp_peer.cpp spells the same in C++. A `header.seq` belongs to the publisher, so it is in no sample.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

EPOCH = 1_700_000_000
Sample = dict[str, Any]


def _time(seconds: int, nanoseconds: int) -> Sample:
    return {"_type": "time", "secs": seconds, "nsecs": nanoseconds}


def _duration(seconds: int, nanoseconds: int) -> Sample:
    return {"_type": "duration", "secs": seconds, "nsecs": nanoseconds}


def _stamp(i: int) -> Sample:
    return _time(EPOCH + i, 123456789)


def _header(i: int) -> Sample:
    return {"_type": "std_msgs/Header", "stamp": _stamp(i), "frame_id": f"frame {i}"}


def _string(i: int, size: int) -> Sample:
    if size < 0:
        return {"data": f"žluťoučký 日本 🐢 {i}"}
    alphabet = "abcdefghijklmnopqrstuvwxyz"
    start = i % 26
    repeated = alphabet * (size // 26 + 2)
    return {"data": repeated[start : start + size]}


def _coordinate(i: int, size: int = 0) -> Sample:
    x, y, z = i + 0.5, -2.0 * i - 0.25, 1000.125 + i
    return {"_type": "mros_comm_measure/Coordinate", "x": x, "y": y, "z": z, "time": _stamp(i)}


def _leds(red: int, green: int, blue: int) -> Sample:
    return {"_type": "peer_msgs/LEDValues", "red": red, "green": green, "blue": blue}


def _person(first: str, last: str) -> Sample:
    return {"_type": "peer_msgs/PersonName", "first": first, "last": last}


def _user_type_test(i: int, size: int = 0) -> Sample:
    name = _person(f"Grace {i}", "z" * (i % 5))
    return {"_type": "peer_msgs/UserTypeTest", "name": name, "leds": _leds(i % 256, 255 - i % 256, 7)}


def _crowd(i: int, size: int) -> Sample:
    return {
        "header": _header(i),
        "people": [_user_type_test(i + k) for k in range(size)],
        "lamps": [_leds(i % 100 + k, 0, i % 100 + k) for k in range(3)],
        "guests": [_person(f"guest {k}", "") for k in range(2)],
        "path": [_coordinate(i + k) for k in range(size)],
    }


def _stamps(i: int, size: int) -> Sample:
    return {
        "header": _header(i),
        "stamp": _time(0xFFFFFFFF - i, 999999999),
        "span": _duration(-5 - i, 250000000),
        "stamps": [_stamp(i + k) for k in range(size)],
        "spans": [_duration(i, 1), _duration(-1, 999999999)],
    }


def _primitives(i: int, size: int) -> Sample:
    return {
        "truth": bool(i % 2),
        "i8": -128 + i % 100,
        "u8": 255 - i % 100,
        "i16": -32768 + i,
        "u16": 65535 - i,
        "i32": -(2**31) + i,
        "u32": 2**32 - 1 - i,
        "i64": -(2**63) + i,
        "u64": 2**64 - 1 - i,
        "f32": i + 0.5,
        "f64": i + 1 / 1024,
        "text": f"text {i}",
        "truths": [(i + k) % 3 == 0 for k in range(size)],
        "i8s": [-((i + k) % 128) for k in range(size)],
        "u8s": bytes((i + k) % 256 for k in range(size)),
        "i16s": [-(i + k) for k in range(size)],
        "u16s": [65000, 65001, 65002],
        "i32s": [-100000 * k for k in range(size)],
        "u32s": [4_000_000_000 + k for k in range(size)],
        "i64s": [-9_000_000_000_000_000_000, -9_000_000_000_000_000_001],
        "u64s": [18_000_000_000_000_000_000 + k for k in range(size)],
        "f32s": [k + 0.25 for k in range(size)],
        "f64s": [0.0, 0.125, 0.25, 0.375],
        "texts": ["t" * k for k in range(size)],
        "pair": ["left", ""],
    }


def _ramp(start: int, modulus: int, size: int) -> bytes:
    """`size` bytes: (start + k) % modulus."""
    period = bytes((start + k) % modulus for k in range(modulus))
    return (period * (size // modulus + 1))[:size]


def _image(i: int, size: int) -> Sample:
    geometry = {"height": 1, "width": size, "step": size, "encoding": "mono8", "is_bigendian": 0}
    return {"header": _header(i), **geometry, "data": _ramp(i, 251, size)}


def _point_cloud(i: int, size: int) -> Sample:
    names = ("x", "y", "z", "intensity")
    fields = [
        {"_type": "sensor_msgs/PointField", "name": name, "offset": 4 * k, "datatype": 7, "count": 1}
        for k, name in enumerate(names)
    ]
    return {
        "header": _header(i),
        "height": 1,
        "width": size,
        "fields": fields,
        "is_bigendian": False,
        "point_step": 16,
        "row_step": 16 * size,
        "data": _ramp(7 * i, 256, 16 * size),
        "is_dense": True,
    }


_SAMPLES: dict[str, Callable[[int, int], Sample]] = {
    "std_msgs/String": _string,
    "mros_comm_measure/Coordinate": _coordinate,
    "peer_msgs/UserTypeTest": _user_type_test,
    "peer_msgs/Crowd": _crowd,
    "peer_msgs/Stamps": _stamps,
    "peer_msgs/Primitives": _primitives,
    "sensor_msgs/Image": _image,
    "sensor_msgs/PointCloud2": _point_cloud,
}


def sample(type_name: str, i: int, size: int) -> Sample:
    return {**_SAMPLES[type_name](i, size), "_type": type_name}


def scale_request(count: int, factor: float) -> Sample:
    return {"points": [_coordinate(k) for k in range(count)], "factor": factor}


def scale_response(count: int, factor: float) -> Sample:
    points = [_coordinate(k) for k in range(count)]
    for point in points:
        for axis in "xyz":
            point[axis] *= factor
    return {"points": points, "text": f"scaled {count}"}


def build(value: Any, make: Callable[[str], Any]) -> Any:
    """The message of a sample; `make(TYPE)` gives an empty one. Lists and plain values stay what they are."""
    if isinstance(value, list):
        return [build(element, make) for element in value]
    if not isinstance(value, dict):
        return value
    return fill(make(value["_type"]), value, make)


def fill(message: Any, value: Sample, make: Callable[[str], Any]) -> Any:
    for name, field in value.items():
        if name != "_type":
            setattr(message, name, build(field, make))
    return message


def differences(value: Any, message: Any, path: str = "") -> list[str]:
    """Where a message is not what the sample says; empty when it is."""
    if isinstance(value, dict):
        found = []
        for name, field in value.items():
            if name != "_type":
                found += differences(field, getattr(message, name), f"{path}.{name}" if path else name)
        return found
    if isinstance(value, list):
        if len(message) != len(value):
            return [f"{path}: {len(message)} elements, expected {len(value)}"]
        pairs = enumerate(zip(value, message, strict=True))
        return [found for k, pair in pairs for found in differences(*pair, f"{path}[{k}]")]
    if isinstance(value, bytes):
        return [] if bytes(message) == value else [f"{path}: other bytes"]
    return [] if message == value else [f"{path}: {message!r}, expected {value!r}"]
