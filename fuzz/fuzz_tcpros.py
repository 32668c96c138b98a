"""Invariant: a connection header that is read and written again reads the same, and anything else is a ProtocolError whose
reason is one of the four that the module names.

    python fuzz/fuzz_tcpros.py [libFuzzer options] [corpus]     coverage-guided; needs atheris
    python fuzz/fuzz_tcpros.py --smoke N                        N seeded random inputs; needs nothing
"""

from __future__ import annotations

import pathlib
import random
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "src"))

from roslet.errors import ProtocolError
from roslet.wire.tcpros import MAX_FIELDS, emit_header, parse_header

REASONS = {"header-truncated", "header-field-without-equals", "header-too-many-fields", "header-not-utf-8"}

# What the smoke mode strings together; a coverage-guided fuzzer finds these by itself.
PIECES = (
    b"\x05\0\0\0a=bcd|\x02\0\0\0a=|\x06\0\0\0topic=|\0\0\0\0|\x01\0\0\0=|\x03\0\0\0abc|\xff\xff\xff\xff|\x04\0\0\0a=\xc3\xa4"
    b"|\x03\0\0\0a=\xff|\x05\0|=|a|\0"
).split(b"|")


def check(data: bytes) -> None:
    """Raises if the invariant does not hold."""
    try:
        fields = parse_header(data)
    except ProtocolError as error:
        if error.reason not in REASONS:
            raise AssertionError(f"{data!r}: an unknown reason, {error.reason}") from error
        return
    if len(fields) > MAX_FIELDS:
        raise AssertionError(f"{data!r}: {len(fields)} fields")
    again = parse_header(emit_header(fields)[4:])
    if again != fields:
        raise AssertionError(f"{data!r}: {fields!r} reads again as {again!r}")


def smoke(count: int) -> None:
    """`count` random inputs, always the same."""
    source = random.Random(0)
    for _ in range(count):
        check(b"".join(source.choice(PIECES) for _ in range(source.randrange(12))))
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
