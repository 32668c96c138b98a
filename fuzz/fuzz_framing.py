"""Invariant: a byte stream gives the same frames, and the same refusal at the same frame, however it is cut, and no more
is allocated than the bounds and what has come allow.

    python fuzz/fuzz_framing.py [libFuzzer options] [corpus]     coverage-guided; needs atheris
    python fuzz/fuzz_framing.py --smoke N                        N seeded random inputs; needs nothing
"""

from __future__ import annotations

import pathlib
import random
import sys
from struct import pack

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "src"))

from roslet.engine.ros1 import framing
from roslet.engine.ros1.framing import FrameReceiver
from roslet.errors import ProtocolError

CHUNK = 64
MAXIMUM = 500


def run(pieces: list[bytes], prefix: int, copies: bool) -> list[object]:
    """What a receiver makes of the pieces: the frames' bodies, then the reason why it stopped."""
    found: list[object] = []

    def deliver(view: memoryview, start: int, end: int) -> None:
        if not 0 <= start <= end <= len(view):
            raise AssertionError(f"a frame from {start} to {end} in {len(view)} bytes")
        found.append(bytes(view[start:end]))

    receiver = FrameReceiver(deliver, MAXIMUM, prefix, CHUNK, copies)
    try:
        for piece in pieces:
            receiver.feed(piece)
            if not receiver.writable():
                raise AssertionError("no room for the next byte")
            held = len(receiver._chunk_view) + len(receiver._large or b"") + len(receiver._spare or b"")
            if held > CHUNK + 2 * (MAXIMUM + 5):
                raise AssertionError(f"{held} bytes held")
    except ProtocolError as error:
        found.append(error.reason)
    return found


def reference(stream: bytes, prefix: int) -> list[object]:
    """The same, plainly."""
    found: list[object] = []
    at = 0
    while len(stream) - at >= 4 + prefix:
        size = int.from_bytes(stream[at + prefix : at + prefix + 4], "little")
        if size > MAXIMUM:
            found.append("frame-too-large")
            break
        body = at + prefix + 4
        if len(stream) - body < size:
            break
        found.append(stream[body : body + size])
        at = body + size
    return found


def check(data: bytes) -> None:
    """Raises if the invariant does not hold; the first byte chooses the cuts."""
    if not data:
        return
    source = random.Random(data[0])
    prefix, copies = source.randrange(2), bool(source.randrange(2))
    stream = data[1:]
    expected = reference(stream, prefix)
    cut = []
    rest = stream
    while rest:
        length = source.randrange(1, 100)
        cut.append(rest[:length])
        rest = rest[length:]
    for pieces in ([stream], cut, [stream[at : at + 1] for at in range(len(stream))]):
        if run(pieces, prefix, copies) != expected:
            raise AssertionError(f"{stream!r}, prefix {prefix}, depends on its cuts {list(map(len, pieces))}")


def smoke(count: int) -> None:
    """`count` random inputs, always the same."""
    source = random.Random(0)
    for _ in range(count):
        data = bytes([source.randrange(256)])
        for _ in range(source.randrange(8)):
            size = source.choice(
                [0, 1, 4, 59, 60, 61, 64, 100, MAXIMUM, MAXIMUM + 1, source.randrange(1 << 32)]
            )
            data += source.choice([b"", b"\x01"]) + pack("<I", size) + source.randbytes(min(size, 600))
        check(data[: source.randrange(1, len(data) + 1)])
    print(f"{count} inputs, no finding")


def main() -> None:
    """The command."""
    framing.FIRST_LARGE = 32  # so that growing is seen
    if sys.argv[1:2] == ["--smoke"]:
        smoke(int(sys.argv[2]))
        return
    import atheris

    atheris.instrument_all()
    atheris.Setup(sys.argv, check)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
