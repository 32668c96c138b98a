"""Invariant: `parse` answers any text of any kind and dialect with records or a DefinitionError whose place
lies inside the text, and what it read once it reads again to equal records.

    python fuzz/fuzz_idl.py [libFuzzer options] [corpus]     coverage-guided; needs atheris
    python fuzz/fuzz_idl.py --smoke N                        N seeded random inputs; needs nothing
"""

from __future__ import annotations

import pathlib
import random
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "src"))

from roslet.errors import DefinitionError
from roslet.idl import Dialect, Kind, TypeName, parse

DIALECTS: tuple[Dialect, ...] = ("ros1", "ros2")
KINDS: tuple[Kind, ...] = ("msg", "srv", "action")

# What the smoke mode strings together; a coverage-guided fuzzer finds these by itself.
PIECES = (
    b"int8 uint8 int64 uint64 float32 float64 bool string wstring byte char time duration Header pkg/Name Name "
    b"[] [3] [<=3] [0] <=5 [ ] < = x y z X Y 1 -1 0x1F 1e400 nan true ' \" \\ \\x41 \\u00e9 , / # --- \xc3\xa9 \xff \0"
).split(b" ")
BLANKS = (b" ", b" ", b"  ", b"\t", b"\n", b"\n", b"\r\n", b"")


def check(data: bytes) -> None:
    """Raises if the invariant does not hold; the first byte chooses the dialect and the kind."""
    if not data:
        return
    name = TypeName("pkg", KINDS[data[0] % 3], "Thing")
    dialect = DIALECTS[data[0] // 3 % 2]
    text = data[1:].decode("utf-8", "surrogateescape")
    try:
        interface = parse(text, name, dialect)
    except DefinitionError as error:
        lines = text.split("\n")
        if not (1 <= error.line <= len(lines) and 1 <= error.column <= len(lines[error.line - 1]) + 1):
            raise AssertionError(f"{error.line}:{error.column} is no place in {text!r}") from error
        return
    # Not ==: a default may be NaN.
    if repr(parse(text, name, dialect)) != repr(interface):
        raise AssertionError(f"read differently the second time: {text!r}")


def smoke(count: int) -> None:
    """`count` random inputs, always the same."""
    source = random.Random(0)
    for _ in range(count):
        data = bytes([source.randrange(256)])
        for _ in range(source.randrange(30)):
            data += source.choice(PIECES) + source.choice(BLANKS)
        check(data)
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
