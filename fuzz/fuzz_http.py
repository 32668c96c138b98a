"""Invariant: a stream gives the same messages and the same fault however it is cut, and a parser never holds more
than its bounds and the piece it was given.

    python fuzz/fuzz_http.py [libFuzzer options] [corpus]     coverage-guided; needs atheris
    python fuzz/fuzz_http.py --smoke N                        N seeded random inputs; needs nothing
"""

from __future__ import annotations

import pathlib
import random
import sys
from typing import Any

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "src"))

from roslet.wire import http

MAX_HEADER = 200
MAX_BODY = 100

# What the smoke mode strings together; a coverage-guided fuzzer finds these by itself.
PIECES = (
    b"POST|GET| |/|/RPC2| HTTP/1.1\r\n| HTTP/1.0\r\n|HTTP/1.1 200 OK\r\n|HTTP/1.0 404\r\n|HTTP/1.1 100 Continue\r\n\r\n"
    b"|HTTP/1.1 204 None\r\n|Content-Length: 3\r\n|content-length:0\n|Content-Length: 101\r\n|Content-Length: x\r\n"
    b"|Transfer-Encoding: chunked\r\n|Expect: 100-continue\r\n|Connection: close\r\n|Connection: Keep-Alive\r\n"
    b"|Content-Encoding: gzip\r\n|X: y\r\n|\r\n|\n|\r|\r\n\r\n|3\r\nabc\r\n|0\r\n\r\n|ff\r\n|5;x=y\r\n|abc|: |\xff|\0"
).split(b"|")


def run(kind: str, pieces: list[bytes]) -> list[Any]:
    """What a parser makes of the pieces: the messages, then the reason of its fault."""
    found: list[Any] = []
    parser = (http.RequestParser if kind == "request" else http.ResponseParser)(MAX_HEADER, MAX_BODY)
    for piece in pieces:
        for message in parser.feed(piece):
            found.append((type(message).__name__, message.headers, message.keep_alive, message.body))
        held = len(parser._buffer) + len(parser._chunks)
        if held > MAX_HEADER + 2 * MAX_BODY + http.MAX_CHUNK_LINE:
            raise AssertionError(f"{held} bytes held")
    if isinstance(parser, http.ResponseParser):
        found.extend((message.headers, message.body) for message in parser.end())
    found.append(parser.error.reason if parser.error is not None else None)
    return found


def check(data: bytes) -> None:
    """Raises if the invariant does not hold; the first byte chooses the cuts."""
    if not data:
        return
    source = random.Random(data[0])
    stream = data[1:]
    bytewise = [stream[at : at + 1] for at in range(len(stream))]
    cut = []
    rest = stream
    while rest:
        length = source.randrange(1, 60)
        cut.append(rest[:length])
        rest = rest[length:]
    for kind in ("request", "response"):
        whole = run(kind, bytewise)
        if run(kind, cut) != whole:
            raise AssertionError(f"{kind} {stream!r} depends on its cuts {list(map(len, cut))}")


def smoke(count: int) -> None:
    """`count` random inputs, always the same."""
    source = random.Random(0)
    for _ in range(count):
        data = bytes([source.randrange(256)])
        data += b"".join(source.choice(PIECES) for _ in range(source.randrange(25)))
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
