"""Invariant: bytes are either MalformedMessage, or a message that the field-table reader reads alike and that is
written as bytes that read as the same message again.

    python fuzz/fuzz_messages.py [libFuzzer options] [corpus]     coverage-guided; needs atheris
    python fuzz/fuzz_messages.py --smoke N                        N seeded random inputs; needs nothing
"""

from __future__ import annotations

import pathlib
import random
import sys
from typing import Any

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "src"))

from roslet.errors import MalformedMessage
from roslet.gen import runtime
from roslet.wire import cdr, ros1

# One type for each thing that a layout can hold, in either encoding.
TYPES: tuple[tuple[Any, str], ...] = (
    ("ros1", "std_msgs/String"),
    ("ros1", "sensor_msgs/JointState"),
    ("ros1", "sensor_msgs/CameraInfo"),
    ("ros1", "tf2_msgs/TFMessage"),
    ("ros1", "std_msgs/UInt8MultiArray"),
    ("ros1", "visualization_msgs/MarkerArray"),
    ("ros2", "std_msgs/msg/String"),
    ("ros2", "sensor_msgs/msg/JointState"),
    ("ros2", "rcl_interfaces/msg/ParameterEvent"),
    ("ros2", "rmw_dds_common/msg/ParticipantEntitiesInfo"),
    ("ros2", "type_description_interfaces/msg/TypeDescription"),
    ("ros2", "example_interfaces/msg/WString"),
    ("ros2", "visualization_msgs/msg/MarkerArray"),
)


def read(reader: Any, *arguments: Any) -> Any:
    """The message, or None for MalformedMessage."""
    try:
        return reader(*arguments)
    except MalformedMessage:
        return None


def check(data: bytes) -> None:
    """Raises if the invariant does not hold; the first byte chooses the type."""
    if not data:
        return
    dialect, name = TYPES[data[0] % len(TYPES)]
    kind = runtime.message_class(dialect, name)
    stream = memoryview(data)[1:]
    codec = ros1 if dialect == "ros1" else cdr
    message = read(kind.deserialize_from, stream, 0, len(stream))
    other = read(codec.read, kind, stream, 0, len(stream))
    if (message is None) != (other is None):
        raise AssertionError(f"{name}: one reader took what the other refused")
    if message is None:
        return
    written = message.serialize()
    if written != other.serialize():  # by bytes: a NaN is not equal to itself
        raise AssertionError(f"{name}: the readers disagree")
    if kind.deserialize(written).serialize() != written:
        raise AssertionError(f"{name}: what was written does not read the same")


def smoke(count: int) -> None:
    """Random inputs that look enough like messages to come far."""
    source = random.Random(1)
    taken = 0
    for _ in range(count):
        which = source.randrange(len(TYPES))
        out = bytearray([which])
        if TYPES[which][0] == "ros2":
            out += source.choice((b"\0\1\0\0", b"\0\0\0\0", b"\0\7\0\0", b"\0\1\0\3"))
        for _ in range(source.randrange(1, 40)):
            out += source.choice(
                (
                    bytes(4),
                    bytes(8),
                    source.randrange(5).to_bytes(4, "little"),
                    source.randrange(5).to_bytes(4, "big"),
                    source.randbytes(source.randrange(9)),
                    b"abc\0",
                    b"\xff\xff\xff\xff",
                )
            )
        check(bytes(out))
        taken += 1
    print(f"{taken} inputs, no finding")


def main() -> None:
    if sys.argv[1:2] == ["--smoke"]:
        smoke(int(sys.argv[2]))
        return
    import atheris

    atheris.instrument_all()
    atheris.Setup(sys.argv, check)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
