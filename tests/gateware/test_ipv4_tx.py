"""Scapy takes the packets apart, and puts fragments together."""

from __future__ import annotations

import random
from typing import Any

import pytest
from scapy.layers.inet import IP, defragment

from gateware.frames import STALLS, Bad, Bench
from gateware.internet import OWN, PEER, PEER_MAC, fields, lead, noise, own_addresses
from roslet.gateware.ipv4_tx import Ipv4Tx


def lead_of(length: int, destination: str = PEER, protocol: int = 17) -> bytes:
    return lead(destination, protocol, length)


def behind(payload: bytes, begin: bytes) -> bytes:
    """The payload with its lead, ending as it does."""
    return type(payload)(begin + payload)


def packets(
    block: Ipv4Tx, payloads: list[bytes], leads: list[bytes], count: int, stalls: int = 0
) -> list[bytes]:
    """What the block makes of payloads: `count` packets, each with the right meta."""
    bench = Bench(block, stalls)
    bench.drive(own_addresses(bench.dut))
    bench.send("i", list(map(behind, payloads, leads)))
    got = bench.receive("o")
    bench.run(lambda: len(got) >= count, cycles=40_000)
    assert len(got) == count
    assert all(fields(beside) == {"type": 0x0800} for _, beside in got)
    assert all(packet[:6] == PEER_MAC for packet, _ in got)
    return [type(packet)(packet[6:]) for packet, _ in got]


def judged(packet: bytes, identification: int, **expected: Any) -> bytes:
    """The payload of a packet that scapy would have made just so."""
    payload = packet[20:]
    assert packet[:20] == bytes(IP(src=OWN, id=identification, **expected, len=len(packet)))
    return payload


@pytest.mark.parametrize("stalls", STALLS)
def test_each_payload_gets_a_header_and_each_header_the_next_identification(stalls: int) -> None:
    rng = random.Random(1)
    sizes = [0, 1, 2, 26, 100, 3, 8]
    peers = [
        f"{rng.randrange(1, 224)}.{rng.randrange(256)}.{rng.randrange(256)}.{rng.randrange(256)}"
        for _ in sizes
    ]
    protocols = [1, 2, 17, 0, 254, 6, 89]
    leads = [lead_of(size, peer, number) for size, peer, number in zip(sizes, peers, protocols, strict=True)]
    got = packets(Ipv4Tx(), [noise(size) for size in sizes], leads, len(sizes), stalls)
    for n, packet in enumerate(got):
        assert judged(packet, n, dst=peers[n], proto=protocols[n], ttl=64) == noise(sizes[n])


def test_checksums_of_many_headers_are_right() -> None:
    rng = random.Random(2)
    peers = [
        ".".join(str(rng.choice([0, 1, 127, 254, 255, rng.randrange(256)])) for _ in range(4))
        for _ in range(150)
    ]
    leads = [lead_of(1, peer, rng.randrange(255)) for peer in peers]
    got = packets(Ipv4Tx(max_length=1480), [b"x"] * len(peers), leads, len(peers))
    for n, packet in enumerate(got):
        assert judged(packet, n, dst=peers[n], proto=leads[n][11], ttl=64) == b"x"


@pytest.mark.parametrize("stalls", [0, 30])
def test_what_is_longer_than_the_mtu_is_cut_into_fragments_of_one_identification(stalls: int) -> None:
    sizes = [
        80,
        86,
        87,
        160,
        166,
        167,
        500,
        5,
    ]  # 86 fit into a packet, 80 into a fragment that is not the last
    counts = [1, 1, 2, 2, 2, 3, 7, 1]
    block = Ipv4Tx(mtu=106, ttl=9)
    got = packets(
        block, [noise(size) for size in sizes], [lead_of(size) for size in sizes], sum(counts), stalls
    )
    for n, (size, count) in enumerate(zip(sizes, counts, strict=True)):
        mine = [IP(packet) for packet in got if IP(packet).id == n]
        assert len(mine) == count
        for k, packet in enumerate(mine):
            judged(bytes(packet), n, dst=PEER, proto=17, ttl=9, frag=10 * k, flags=int(k < count - 1))
            assert len(packet) <= 106
        whole = defragment(mine)  # type: ignore[no-untyped-call]
        assert bytes(whole[0].payload) == noise(size)


def test_an_ethernet_carries_1480_octets_whole_and_one_more_in_two() -> None:
    got = packets(
        Ipv4Tx(), [noise(1480), noise(1481), noise(2960)], [lead_of(1480), lead_of(1481), lead_of(2960)], 5
    )
    assert [(len(packet), IP(packet).id, IP(packet).frag, int(IP(packet).flags)) for packet in got] == [
        (1500, 0, 0, 0),
        (1500, 1, 0, 1),
        (21, 1, 185, 0),
        (1500, 2, 0, 1),
        (1500, 2, 185, 0),
    ]
    assert got[3][20:] + got[4][20:] == noise(2960)


def test_offsets_count_in_units_of_8_octets() -> None:
    got = packets(Ipv4Tx(mtu=420), [noise(1300)], [lead_of(1300)], 4)
    assert [IP(packet).frag for packet in got] == [0, 50, 100, 150]
    assert b"".join(packet[20:] for packet in got) == noise(1300)


@pytest.mark.parametrize("block", [Ipv4Tx(mtu=106), Ipv4Tx(max_length=1480)])
def test_a_payload_that_ends_badly_or_is_not_as_long_as_was_said_ends_badly(block: Ipv4Tx) -> None:
    payloads = [noise(9), Bad(noise(9)), Bad(), noise(8), noise(10), b"", noise(9)]
    got = packets(block, payloads, [lead_of(9)] * 7, 7)
    assert [type(packet) for packet in got] == [bytes, Bad, Bad, Bad, Bad, Bad, bytes]
    assert [packet[20:] for packet in got] == payloads
    assert judged(got[-1], 6, dst=PEER, proto=17, ttl=64) == noise(9)


@pytest.mark.parametrize("block", [Ipv4Tx(), Ipv4Tx(max_length=1480)])
@pytest.mark.parametrize("more", [1024, 2048, 4096])
def test_a_payload_that_is_longer_by_a_power_of_two_ends_badly(block: Ipv4Tx, more: int) -> None:
    got = packets(block, [noise(8 + more), noise(8)], [lead_of(8)] * 2, 2)
    assert [type(packet) for packet in got] == [Bad, bytes]


def test_of_a_datagram_that_ends_badly_the_last_fragment_does() -> None:
    got = packets(
        Ipv4Tx(mtu=106),
        [Bad(noise(100)), Bad(noise(80)), noise(5)],
        [lead_of(200), lead_of(200), lead_of(5)],
        5,
    )
    assert [(len(packet), type(packet)) for packet in got] == [
        (100, bytes), (40, Bad), (100, bytes), (20, Bad), (25, bytes),
    ]  # fmt: skip


def test_a_packet_costs_34_cycles_and_its_octets_and_passes_as_it_comes_but_for_8() -> None:
    bench = Bench(Ipv4Tx(), stalls=0)
    bench.drive(own_addresses(bench.dut))
    bench.send("i", [lead_of(64) + bytes(64)] * 10)
    got = bench.receive("o")
    first: list[int] = []

    async def watch(ctx: Any) -> None:
        for cycle in range(14 + 20 + 64):
            (_, _, valid) = await ctx.tick().sample(bench.dut.o.stream.valid)
            if not valid:
                first.append(cycle)

    bench.drive(watch)
    bench.run(lambda: len(got) == 10, cycles=10 * (34 + 65) + 5)
    assert first == list(range(first[0], first[0] + 8))


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({"ttl": 0}, "a time to live is 1 to 255, not 0"),
        ({"ttl": 256}, "a time to live"),
        ({"mtu": 67}, r"an MTU is 68 \(RFC 791\) to 65535, not 67"),
        ({"max_length": 0}, "a payload has 1 to 65515 octets"),
        ({"max_length": 65516}, "a payload has 1 to 65515 octets"),
    ],
)
def test_arguments_that_cannot_be_are_refused(arguments: dict[str, Any], sentence: str) -> None:
    with pytest.raises(ValueError, match=sentence):
        Ipv4Tx(**arguments)
