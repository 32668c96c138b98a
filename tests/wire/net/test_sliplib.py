"""sliplib, which shares nothing with us, reads what we write, and we read what it writes."""

from __future__ import annotations

import random

import sliplib

from roslet.wire.net.slip import Decoder, emit


def packets(seed: int) -> list[bytes]:
    """Of the octets that matter and a few others."""
    chance = random.Random(seed)
    return [bytes(chance.choices(b"\xc0\xdb\xdc\xdd\x00a", k=chance.randrange(1, 60))) for _ in range(50)]


def test_what_we_emit_is_octet_for_octet_that_of_sliplib() -> None:
    for packet in packets(1):
        assert emit(packet) == b"\xc0" + sliplib.encode(packet) + b"\xc0"
        assert sliplib.decode(emit(packet).strip(b"\xc0")) == packet


def test_we_read_a_stream_of_sliplibs_in_pieces() -> None:
    chance = random.Random(2)
    sent = packets(3)
    driver = sliplib.Driver()
    stream = b"".join(driver.send(packet) for packet in sent)
    faults: list[str] = []
    decoder = Decoder(1500, faults.append)
    got: list[bytes] = []
    while stream:
        size = chance.randrange(1, 9)
        got += decoder.receive_data(stream[:size])
        stream = stream[size:]
    assert got == sent and faults == []


def test_we_agree_with_sliplib_on_what_is_wrong() -> None:
    chance = random.Random(4)
    for _ in range(500):
        body = bytes(chance.choices(b"\xdb\xdc\xdd\x00a", k=chance.randrange(1, 6)))
        faults: list[str] = []
        got = Decoder(1500, faults.append).receive_data(body + b"\xc0")
        try:
            assert got == [sliplib.decode(body)]
        except sliplib.ProtocolError:
            assert got == [] and faults == ["slip-escape"]
