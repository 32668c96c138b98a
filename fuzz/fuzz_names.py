"""Invariant: an argument, a name, a URI and a network are taken or refused with InvalidName (a network also with
Unsupported); a name that was resolved resolves to itself, and a network that was completed is completed to itself.

    python fuzz/fuzz_names.py [libFuzzer options] [corpus]     coverage-guided; needs atheris
    python fuzz/fuzz_names.py --smoke N                        N seeded random inputs; needs nothing
"""

from __future__ import annotations

import pathlib
import random
import sys
from collections.abc import Callable
from contextlib import suppress

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "src"))

from roslet.errors import InvalidName, Unsupported
from roslet.names import Arguments, check_base_name, check_name, parse_host_port, parse_network, resolve

NODE = "/robot/node"

# What the smoke mode strings together; a coverage-guided fuzzer finds these by itself. A NUL is between two arguments.
PIECES = (
    b"a|B_9|/|//|~|:=|__name|__ns|_p|ros1://|ros2://|http://|rosrpc://|localhost|[::1]"
    b"|:11311|:0|:65536|:|\0| |-|.|=|\xc3\xa4|\xff"
).split(b"|")


def check(data: bytes) -> None:
    """Raises if the invariant does not hold."""
    words = data.decode("utf-8", "surrogateescape").split("\0")
    arguments = Arguments(words)
    sorted_out = len(arguments.rest) + len(arguments.remappings) + len(arguments.parameters)
    if sorted_out + len(arguments.specials) > len(words):
        raise AssertionError(f"{words!r}: more arguments than there were")
    with suppress(InvalidName):
        for name in (*(table := arguments.resolved(NODE)), *table.values()):
            check_full(name)
    for word in words:
        with suppress(InvalidName):
            check_full(resolve(word, NODE))
        with suppress(InvalidName):
            if resolve(check_base_name(word), NODE) != "/robot/" + word:
                raise AssertionError(f"{word!r} is not taken for a relative name")
        with suppress(InvalidName):
            host, port = parse_host_port(word)
            if not host or not 0 < port < 65536 or any(char <= " " for char in host):
                raise AssertionError(f"{word!r}: host {host!r}, port {port}")
        with suppress(InvalidName, Unsupported):
            check_network(lambda word=word: parse_network(word))  # type: ignore[misc]
        with suppress(InvalidName):
            check_network(lambda word=word: parse_network("ros1://", word))  # type: ignore[misc]


def check_full(name: str) -> None:
    """A full name is global, legal, and stays what it is."""
    if name[:1] != "/" or check_name(name) != name or resolve(name, NODE) != name:
        raise AssertionError(f"{name!r} is no full name")


def check_network(complete: Callable[[], tuple[str, str]]) -> None:
    """A network in full stays what it is."""
    network, master = complete()
    if parse_network(network) != (network, master) or parse_network("ros1://", master) != (network, master):
        raise AssertionError(f"{network!r} is completed differently the second time")


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
