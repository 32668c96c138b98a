"""The header's octets by hand: Ethernet's and UDP's."""

from __future__ import annotations

import pytest

from gateware.frames import STALLS, Bad, Bench
from roslet.gateware.header import HeaderReader, header_layout
from roslet.wire.net import ethernet, udp

DESTINATION, SOURCE = bytes.fromhex("0100 5e7f 0001"), bytes.fromhex("0200 0000 0002")
HEADER = DESTINATION + SOURCE + b"\x08\x06"


def number(octets: bytes) -> int:
    """As gateware holds octets: the first in the lowest bits."""
    return int.from_bytes(octets, "little")


@pytest.mark.parametrize("stalls", STALLS)
def test_a_reader_takes_the_header_off_and_shows_the_fields_that_were_asked_for(stalls: int) -> None:
    bench = Bench(HeaderReader(ethernet.FIELDS, ("source", "type")), stalls)
    bench.send("i", [HEADER + b"first", HEADER[:6] + b"abcdef\x12\x34" + b"x" * 40, HEADER])
    got = bench.receive("o")
    bench.run(lambda: len(got) == 3)
    assert [frame for frame, _ in got] == [b"first", b"x" * 40, b""]
    assert [(meta.header.source, meta.header.type) for _, meta in got] == [
        (number(SOURCE), 0x0806),
        (number(b"abcdef"), 0x1234),
        (number(SOURCE), 0x0806),
    ]


@pytest.mark.parametrize("stalls", STALLS)
def test_a_frame_that_ends_within_its_header_gives_nothing_and_is_counted_unless_it_is_bad(
    stalls: int,
) -> None:
    bench = Bench(HeaderReader(udp.FIELDS, ("length",)), stalls)
    short = [b"", b"1", b"1234567"]
    bench.send("i", [*short, *map(Bad, short), b"\0\1\0\2\0\x0d\0\0hello", Bad(b"\0\1\0\2\0\x0e\0\0bye")])
    got = bench.receive("o")
    bench.count("drop_short")
    bench.run(lambda: len(got) == 2)
    assert [(frame, type(frame), meta.header.length) for frame, meta in got] == [
        (b"hello", bytes, 13),
        (b"bye", Bad, 14),
    ]
    assert bench.counts == {"drop_short": 3}


def test_a_reader_passes_the_meta_of_the_layers_below() -> None:
    bench = Bench(HeaderReader(udp.FIELDS, ("length",), below=header_layout(ethernet.FIELDS, ("type",))))
    bench.send("i", [b"\0\1\0\2\0\x0d\0\0hello", b"\0\1\0\2\0\x0e\0\0bye"], [{"type": 5}, {"type": 6}])
    got = bench.receive("o")
    bench.run(lambda: len(got) == 2)
    assert [meta.below.type for _, meta in got] == [5, 6]


def test_an_octet_passes_every_cycle() -> None:
    bench = Bench(HeaderReader(udp.FIELDS, ("length",)), stalls=0)
    bench.send("i", [bytes(100)] * 10)
    got = bench.receive("o")
    bench.run(lambda: len(got) == 10, cycles=10 * 109 + 10)


def test_an_unknown_field_is_refused() -> None:
    with pytest.raises(ValueError, match="no such fields: sauce"):
        header_layout(udp.FIELDS, ("sauce",))
