"""UDP: octets by hand, then scapy's. Checksums are computed here from RFC 768, by integers."""

from __future__ import annotations

import gc
import random
from ipaddress import IPv4Address
from typing import Any

import pytest
from scapy.layers.inet import IP, UDP

from gateware.frames import STALLS, Bad, Bench
from gateware.internet import lead, turning
from roslet.gateware.udp import PortSwitch, UdpRx, UdpTx

HERE, THERE = "192.168.1.100", "192.168.1.10"
HOP = bytes([1, 2, 3, 4, 5, 6])
MAC = int.from_bytes(HOP, "little")

# From 192.168.1.10:4660 to 192.168.1.100:1234, "abc", with the checksum worked out by hand:
# c0a8+010a+c0a8+0164 + 0011+000b + 1234+04d2+000b + 6162+6300 = 25f4d -> 5f4f, whose complement is a0b0.
BY_HAND = bytes.fromhex("1234 04d2 000b a0b0 616263")


def address(text: str) -> int:
    """As gateware holds addresses: the first octet in the lowest bits."""
    return int.from_bytes(bytes(map(int, text.split("."))), "little")


def datagram(
    payload: bytes, sport: int = 4660, dport: int = 1234, src: str = THERE, dst: str = HERE
) -> bytes:
    """The UDP datagram as scapy makes it."""
    return bytes(IP(src=src, dst=dst) / UDP(sport=sport, dport=dport) / payload)[20:]


def received(octets: bytes, src: str = THERE, dst: str = HERE) -> dict[str, int]:
    """What is known of a datagram below UDP."""
    return {
        "mac": MAC,
        "source": address(src),
        "destination": address(dst),
        "protocol": 17,
        "length": len(octets),
        "group": 0,
    }


def receive(
    frames: list[bytes], stalls: int, metas: list[dict[str, int]] | None = None, **run: Any
) -> tuple[list[tuple[bytes, Any]], dict[str, int]]:
    """What UdpRx gave for the frames, and its counters. The last frame must be one that is given."""
    bench = Bench(UdpRx(), stalls)
    last = datagram(b"the last one")
    bench.watch(turning(bench.dut))
    bench.send("i", [*frames, last], [*(metas or map(received, frames)), received(last)])
    got = bench.receive("o")
    bench.count("drop_length", "drop_checksum")
    bench.run(lambda: bool(got) and got[-1][0] == b"the last one", **run)
    assert type(got[-1][0]) is bytes
    return got[:-1], bench.counts


@pytest.mark.parametrize("stalls", STALLS)
def test_a_datagram_by_hand_gives_its_data_and_what_is_known_of_it(stalls: int) -> None:
    got, counts = receive([BY_HAND], stalls)
    ((frame, meta),) = got
    assert (type(frame), frame) == (bytes, b"abc")
    assert (meta.mac, meta.source, meta.destination, meta.group) == (MAC, 0x0A01A8C0, 0x6401A8C0, 0)
    assert (meta.source_port, meta.destination_port, meta.length) == (0x1234, 1234, 3)
    assert counts == {"drop_length": 0, "drop_checksum": 0}


@pytest.mark.parametrize("stalls", STALLS)
def test_data_of_all_lengths_and_values_pass(stalls: int) -> None:
    rng = random.Random(stalls)
    payloads = [rng.randbytes(n) for n in range(20)] + [b"\xff" * n for n in (1, 2, 31, 32)] + [bytes(9)]
    got, counts = receive([datagram(payload) for payload in payloads], stalls)
    assert [frame for frame, _ in got] == payloads
    assert not [frame for frame, _ in got if isinstance(frame, Bad)]
    assert [meta.length for _, meta in got] == [len(payload) for payload in payloads]
    assert counts == {"drop_length": 0, "drop_checksum": 0}


def test_sums_with_every_carry_are_right() -> None:
    """Octets of 0xFF and 0x00 make the carries that random ones do not."""
    rng = random.Random(0)
    frames, metas = [], []
    for _ in range(150):
        src, dst = (".".join(str(rng.choice([0, 255, 254, 1])) for _ in range(4)) for _ in range(2))
        payload = bytes(rng.choice([0, 255, 255, 254, 1]) for _ in range(rng.randrange(12)))
        frames.append(
            datagram(payload, rng.choice([0xFFFF, 0xFF, 1]), rng.choice([0xFFFF, 0xFF00]), src, dst)
        )
        metas.append(received(frames[-1], src, dst))
    got, counts = receive(frames, 0, metas)
    assert counts == {"drop_length": 0, "drop_checksum": 0}
    assert [frame for frame, _ in got] == [frame[8:] for frame in frames]


@pytest.mark.parametrize("stalls", STALLS)
def test_a_checksum_of_zero_is_none(stalls: int) -> None:
    got, counts = receive([BY_HAND, BY_HAND[:6] + b"\0\0" + BY_HAND[8:]], stalls)
    assert [(type(frame), frame) for frame, _ in got] == [(bytes, b"abc")] * 2
    assert counts == {"drop_length": 0, "drop_checksum": 0}


@pytest.mark.parametrize("stalls", STALLS)
def test_a_wrong_checksum_ends_badly_and_is_counted(stalls: int) -> None:
    wrong = [
        bytes(BY_HAND[:n]) + bytes([BY_HAND[n] ^ 1 << n % 8]) + BY_HAND[n + 1 :] for n in (0, 1, 2, 3, 6, 7)
    ]
    wrong += [
        BY_HAND[:-1] + bytes([BY_HAND[-1] ^ 0x80]),
        BY_HAND[:-3] + bytes([BY_HAND[-3] ^ 1]) + BY_HAND[-2:],
    ]
    got, counts = receive(wrong, stalls)
    assert [type(frame) for frame, _ in got] == [Bad] * 8
    assert counts == {"drop_length": 0, "drop_checksum": 8}


def test_addresses_and_length_of_the_pseudo_header_are_in_the_checksum() -> None:
    metas = [received(BY_HAND) for _ in range(8)]
    for n in range(4):
        metas[n]["source"] ^= 0x10 << 8 * n
        metas[4 + n]["destination"] ^= 0x10 << 8 * n
    shorter = (
        BY_HAND[:5] + b"\x0a\xa1\xae" + BY_HAND[8:]
    )  # right, but for the length of the pseudo-header and the "c"
    got, counts = receive([BY_HAND] * 8 + [shorter], 0, [*metas, received(shorter)])
    assert [type(frame) for frame, _ in got] == [Bad] * 9
    assert counts == {"drop_length": 0, "drop_checksum": 9}


@pytest.mark.parametrize("stalls", STALLS)
def test_what_follows_the_length_is_dropped(stalls: int) -> None:
    got, counts = receive([BY_HAND + b"padding", datagram(b"") + b"x"], stalls)
    assert [(frame, type(frame), meta.length) for frame, meta in got] == [(b"abc", bytes, 3), (b"", bytes, 0)]
    assert counts == {"drop_length": 0, "drop_checksum": 0}


@pytest.mark.parametrize("stalls", STALLS)
def test_a_length_of_more_than_came_ends_badly_and_is_counted(stalls: int) -> None:
    longer = [BY_HAND[:4] + length + b"\0\0abc" for length in (b"\0\x0c", b"\1\x0b", b"\xff\xff")]
    got, counts = receive([*longer, *(BY_HAND[:n] for n in range(8, 11))], stalls)
    assert [type(frame) for frame, _ in got] == [Bad] * 6
    assert counts == {"drop_length": 6, "drop_checksum": 0}


@pytest.mark.parametrize("stalls", STALLS)
def test_a_length_of_less_than_the_header_gives_nothing_and_is_counted(stalls: int) -> None:
    short = [BY_HAND[:5] + bytes([length]) + b"\0\0abc" for length in range(8)]
    got, counts = receive([*short, *map(Bad, short)], stalls)
    assert got == []
    assert counts == {"drop_length": 8, "drop_checksum": 0}


@pytest.mark.parametrize("stalls", STALLS)
def test_a_datagram_that_ends_within_its_header_gives_nothing_and_is_counted(stalls: int) -> None:
    got, counts = receive([BY_HAND[:n] for n in range(8)] + [Bad(BY_HAND[:n]) for n in range(8)], stalls)
    assert got == []
    assert counts == {"drop_length": 8, "drop_checksum": 0}


@pytest.mark.parametrize("stalls", STALLS)
def test_a_bad_end_is_passed_on_and_not_counted(stalls: int) -> None:
    got, counts = receive(
        [Bad(BY_HAND), Bad(BY_HAND[:9]), Bad(BY_HAND[:-1] + b"d"), Bad(BY_HAND + b"x")], stalls
    )
    assert [type(frame) for frame, _ in got] == [Bad] * 4
    assert counts == {"drop_length": 0, "drop_checksum": 0}


def test_an_octet_is_received_every_cycle_whatever_comes() -> None:
    frames = [
        BY_HAND,
        Bad(BY_HAND),
        BY_HAND[:9],
        BY_HAND[:3],
        BY_HAND[:5] + b"\x02\0\0abc",
        BY_HAND + b"pad",
    ] * 5
    items = sum(len(frame) + 1 for frame in [*frames, datagram(b"the last one")])
    receive(frames, 0, cycles=items + 1)


# -- what is sent


def ones_sum(octets: bytes) -> int:
    """The ones' complement sum of 16-bit words. RFC 1071."""
    total = sum(int.from_bytes(octets[n : n + 2].ljust(2, b"\0"), "big") for n in range(0, len(octets), 2))
    while total >> 16:
        total = (total & 0xFFFF) + (total >> 16)
    return total


def to_send(payload: bytes, sport: int = 1234, dport: int = 4660, dst: str = THERE) -> dict[str, int]:
    return {
        "mac": MAC,
        "destination": address(dst),
        "source_port": sport,
        "destination_port": dport,
        "length": len(payload),
        "sum": ones_sum(payload),
    }


def transmit(
    frames: list[bytes], metas: list[dict[str, int]], stalls: int, src: str = HERE, **run: Any
) -> list[bytes]:
    """The datagrams behind their leads, which are right."""
    bench = Bench(UdpTx(), stalls)

    async def addresses(ctx: Any) -> None:
        ctx.set(bench.dut.addresses.ip, address(src))

    bench.drive(addresses)
    bench.send("i", frames, metas)
    got = bench.receive("o")
    bench.run(lambda: len(got) == len(frames), **run)
    assert [frame[:14] for frame, _ in got] == [
        lead(str(IPv4Address(meta["destination"].to_bytes(4, "little"))), 17, meta["length"] + 8, HOP)
        for meta in metas
    ]
    return [type(frame)(frame[14:]) for frame, _ in got]


@pytest.mark.parametrize("stalls", STALLS)
def test_a_datagram_sent_is_that_of_scapy(stalls: int) -> None:
    rng = random.Random(stalls)
    payloads = [rng.randbytes(n) for n in (0, 1, 2, 3, 14, 61)]
    got = transmit(payloads, [to_send(payload) for payload in payloads], stalls)
    assert got == [datagram(payload, 1234, 4660, HERE, THERE) for payload in payloads]


def test_sums_sent_with_every_carry_are_right_and_never_zero() -> None:
    rng = random.Random(0)
    payloads, metas, right = [], [], []
    src = "255.255.0.255"
    for _ in range(100):
        dst = ".".join(str(rng.choice([0, 255, 254, 1])) for _ in range(4))
        payload = bytes(rng.choice([0, 255, 255, 254, 1]) for _ in range(rng.randrange(6)))
        sport, dport = rng.choice([0xFFFF, 0xFF, 1]), rng.choice([0xFFFF, 0xFF00, 0])
        payloads.append(payload)
        metas.append(to_send(payload, sport, dport, dst))
        right.append(datagram(payload, sport, dport, src, dst))
    zero = to_send(b"\0\0")  # data that make the sum all ones, so that the checksum is zero
    zero["sum"] = ones_sum(bytes.fromhex("c0a8010a ffff00ff 0011 000a 04d2 1234 000a")) ^ 0xFFFF
    payload = zero["sum"].to_bytes(2, "big")
    got = transmit([*payloads, payload], [*metas, zero], 0, src)
    assert got[:-1] == right
    assert got[-1] == bytes.fromhex("04d2 1234 000a ffff") + payload
    assert got[-1] == datagram(payload, 1234, 4660, src, THERE)


@pytest.mark.parametrize("stalls", STALLS)
def test_a_bad_end_stays_bad_and_the_next_datagram_is_whole(stalls: int) -> None:
    payloads = [Bad(b"12"), Bad(b""), b"123"]
    got = transmit(payloads, [to_send(payload) for payload in payloads], stalls)
    assert [type(frame) for frame in got] == [Bad, Bad, bytes]
    assert got[2] == datagram(b"123", 1234, 4660, HERE, THERE)


def test_a_header_takes_18_cycles_behind_the_lead_and_an_octet_is_sent_every_cycle() -> None:
    payloads = [bytes(20)] * 10
    transmit(payloads, [to_send(payload) for payload in payloads], 0, cycles=10 * (14 + 18 + 21) + 2)


# -- the switch


@pytest.mark.parametrize("stalls", STALLS)
def test_datagrams_go_by_their_destination_port_and_others_are_dropped_and_counted(stalls: int) -> None:
    ports = [1234, 7400, 7411]
    bench = Bench(PortSwitch(3), stalls)

    async def listen(ctx: Any) -> None:
        for n, port in enumerate(ports):
            ctx.set(getattr(bench.dut, f"port{n}"), port)

    meta = {"mac": 1, "source": 2, "destination": 3, "source_port": 7400, "length": 1, "group": 0}
    to = [7400, 1234, 1235, 7411, 1234, 0, 7400, 1235]
    frames = [b"a", b"", b"other", b"c", Bad(b"d"), b"", b"the last", Bad(b"other")]
    bench.drive(listen)
    bench.send("i", frames, [{**meta, "destination_port": port} for port in to])
    got = [bench.receive(f"o{n}") for n in range(3)]
    bench.count("drop_port")
    bench.run(lambda: len(got[0]) == len(got[1]) == 2)
    assert [[frame for frame, _ in one] for one in got] == [[b"", b"d"], [b"a", b"the last"], [b"c"]]
    assert isinstance(got[0][1][0], Bad)
    assert [meta.destination_port for one in got for _, meta in one] == [1234, 1234, 7400, 7400, 7411]
    assert bench.counts == {"drop_port": 2}


@pytest.mark.filterwarnings("ignore::amaranth.hdl.UnusedElaboratable")
def test_a_switch_without_outputs_is_refused() -> None:
    with pytest.raises(ValueError, match="at least one output, and each a port, not 0"):
        PortSwitch(0)
    gc.collect()  # while the warning that it was never used is ignored
