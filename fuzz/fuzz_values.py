"""Invariant: the arguments of `roslet topic pub` make a message or are refused with CommandError or InvalidMessage, with
PyYAML and without; what was made serialises, or is refused with InvalidMessage.

    python fuzz/fuzz_values.py [libFuzzer options] [corpus]     coverage-guided; needs atheris, better with PyYAML
    python fuzz/fuzz_values.py --smoke N                        N seeded random inputs; needs nothing
"""

from __future__ import annotations

import pathlib
import random
import sys
from contextlib import suppress
from typing import Any

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "src"))

from roslet.cli.options import CommandError
from roslet.cli.values import build, read_document, yaml_module
from roslet.errors import InvalidMessage
from roslet.gen.runtime import message_class
from roslet.wire.time import Time

KINDS: list[Any] = [
    message_class("ros1", name)
    for name in (
        "std_msgs/String",
        "std_msgs/Header",
        "std_msgs/Duration",
        "std_msgs/UInt8MultiArray",
        "nav_msgs/Path",
        "sensor_msgs/Imu",
        "diagnostic_msgs/DiagnosticArray",
    )
]
YAML = yaml_module()

# What the smoke mode strings together; a coverage-guided fuzzer finds these by itself. A NUL is between two arguments.
PIECES = (
    b"data|:=|header|stamp|.secs|.nsecs|poses|status|values|frame_id|covariance"
    b"|: |, |[|]|{|}|'|\"|\n|- |1|-1|1e400|.inf|nan|0x|99999999999"
    b"|true|null|now|auto|2020-13-45|!!int x|!!timestamp x|!!binary x|!!set|&a|*a|<<: |x|\0|\xc3\xa4|\xff"
).split(b"|")


def check(data: bytes) -> None:
    """Raises if the invariant does not hold; the first byte chooses the type, and whether there is PyYAML."""
    if not data:
        return
    kind = KINDS[data[0] % len(KINDS)]
    text = data[1:].decode("utf-8", "replace")
    sys.modules["yaml"] = YAML if data[0] & 0x80 else None  # type: ignore[assignment]
    with suppress(CommandError, InvalidMessage):
        build(kind, text.split("\0"), lambda: Time(1, 2)).serialize()
    try:
        read_document(text, "file")
    except CommandError as error:
        if not str(error).startswith("file: "):
            raise AssertionError(f"{text!r}: the error does not name the file: {error}") from error


def smoke(count: int) -> None:
    """`count` random inputs, always the same."""
    source = random.Random(0)
    for _ in range(count):
        data = bytes([source.randrange(256)])
        check(data + b"".join(source.choice(PIECES) for _ in range(source.randrange(12))))
    print(f"{count} inputs, no finding")


def main() -> None:
    """The command."""
    if sys.argv[1:2] == ["--smoke"]:
        smoke(int(sys.argv[2]))
        return
    import atheris

    atheris.instrument_all()
    atheris.Setup(sys.argv, check)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
