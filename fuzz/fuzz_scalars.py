"""Invariant: a string is spelled as PyYAML, with which rospy prints messages, spells it.

python fuzz/fuzz_scalars.py [libFuzzer options] [corpus]     coverage-guided; needs atheris and PyYAML
python fuzz/fuzz_scalars.py --smoke N                        N seeded random inputs; needs PyYAML
"""

from __future__ import annotations

import pathlib
import random
import sys

import yaml

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "src"))

from roslet.compat.scalars import double_quoted, plain_or_quoted

# What the smoke mode strings together; a coverage-guided fuzzer finds these by itself.
PIECES = (
    b"word|12|1.5|0x|1:20|yes|null|2020-01-01|long-without-a-blank-of-thirty-c"
    b"| | |  |\n|\n\n|\t|\r|:|#|-|'|\"|\\|[|{|&|*|!|%|@|`|?|,"
    b"|\xc3\xa9|\xf0\x9f\x98\x80|\xe2\x80\xa8|\xef\xbb\xbf|\0|\x7f"
).split(b"|")


def check(data: bytes) -> None:
    """Raises if the invariant does not hold."""
    text = data.decode("utf-8", "replace")
    alone = yaml.dump(text, default_style='"').rstrip("\n")
    if double_quoted(text) != alone:
        raise AssertionError(f"{text!r}: {double_quoted(text)!r}, not {alone!r}")
    in_list = yaml.dump([text], default_flow_style=False)[2:].rstrip("\n")
    if plain_or_quoted(text) != in_list:
        raise AssertionError(f"{text!r} in a list: {plain_or_quoted(text)!r}, not {in_list!r}")


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
