"""Invariant: whatever a datagram holds, parsing it gives values or ProtocolError, every value emits bytes that parse to the
same value, and nothing of a value is larger than the datagram.

    python fuzz/fuzz_rtps.py [libFuzzer options] [corpus]     coverage-guided; needs atheris
    python fuzz/fuzz_rtps.py --smoke N                        N seeded random inputs; needs nothing
"""

from __future__ import annotations

import contextlib
import pathlib
import random
import sys
from typing import Any

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "src"))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tests"))

from roslet.errors import ProtocolError
from roslet.wire.rtps import endpoint_data, inline_qos, message, participant_data, participant_message
from roslet.wire.rtps.data import Data
from roslet.wire.rtps.data_frag import DataFrag
from roslet.wire.rtps.info_reply import InfoReply

ROOT = pathlib.Path(__file__).resolve().parent.parent
HEADER = b"RTPS\2\3\1\x0f" + bytes(12)


def same(value: Any) -> None:
    """Raises if the value is not what its own bytes say."""
    emitted = bytes(value.emit())
    try:
        _, found = message.parse(HEADER + emitted)
    except ProtocolError as error:
        raise AssertionError(f"{value!r} emits what we refuse") from error
    if isinstance(value, Data | DataFrag):
        (other,) = found
        if isinstance(value, DataFrag) and bytes(other.payload) != bytes(value.payload):
            raise AssertionError(f"{value!r} changed")
        if not bytes(other.payload).startswith(bytes(value.payload)) or other.sequence != value.sequence:
            raise AssertionError(f"{value!r} changed")
    elif repr(found) != repr([value]) and not isinstance(value, InfoReply):
        raise AssertionError(f"{value!r} became {found!r}")


def deep(payload: bytes | memoryview) -> None:
    """Every reader of payloads that discovery has."""
    readers = (
        participant_data.parse,
        endpoint_data.parse,
        endpoint_data.parse_key,
        participant_message.parse,
    )
    for read in readers:
        try:
            value: Any = read(payload)
        except ProtocolError:
            continue
        if not isinstance(value, bytes):
            for little in (True, False):
                if read(value.emit(little)) != value:
                    raise AssertionError(f"{value!r} changed")


def check(data: bytes) -> None:
    """Raises if the invariant does not hold."""
    view = memoryview(data)
    try:
        message.header.parse(view)
        for value in message.submessages(view):
            same(value)
            if isinstance(value, Data | DataFrag):
                if len(value.payload) + len(value.inline_qos) > len(data):
                    raise AssertionError("more than there is")
                with contextlib.suppress(ProtocolError):
                    inline_qos.parse(value.inline_qos, value.little)
                deep(value.payload)
    except ProtocolError:
        pass
    deep(view)


def corpus() -> list[bytes]:
    """Datagrams of the recorded peers."""
    import pcap

    found = []
    for path in sorted((ROOT / "tests/captures/rtps").glob("*.pcap")):
        found += [payload for _, _, payload in pcap.read(path)]
    return found


def smoke(count: int) -> None:
    """`count` inputs, always the same: recorded datagrams with a few octets changed, cut, doubled or made up."""
    source = random.Random(0)
    seeds = [one for one in corpus() if len(one) < 2000]
    for _ in range(count):
        data = bytearray(source.choice(seeds))
        for _ in range(source.randrange(6)):
            if not data:
                break
            at = source.randrange(len(data))
            what = source.randrange(5)
            if what == 0:
                data[at] = source.randrange(256)
            elif what == 1:
                data[at] = source.choice((0, 1, 2, 0x7F, 0x80, 0xFF))
            elif what == 2:
                del data[at:]
            elif what == 3:
                del data[at : at + source.randrange(8)]
            else:
                data[at:at] = data[at : at + source.randrange(40)]
        check(bytes(data))
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
