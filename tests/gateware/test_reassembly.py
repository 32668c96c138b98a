"""A naive model, and scapy's fragments."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import permutations
from typing import Any

import pytest
from amaranth.hdl import Elaboratable, Module, Mux, Signal
from amaranth.lib import memory, wiring
from scapy.layers.inet import ICMP, IP, defragment, fragment
from scapy.packet import Raw

from gateware.frames import STALLS, Bad, Bench
from gateware.internet import (
    OWN,
    PEER,
    PEER_MAC,
    addresses,
    ethernet_rx,
    fields,
    ipv4_rx,
    noise,
    pieces,
)
from roslet.gateware.icmp import IcmpEcho
from roslet.gateware.ipv4_rx import Ipv4Rx
from roslet.gateware.ipv4_tx import Ipv4Tx
from roslet.gateware.reassembly import Reassembly

REASONS = ("overlap", "size", "slots", "expired", "fragments", "duplicate", "given_up")
FOREVER = 0xFFFF_FFFF


class WithMemory(Elaboratable):
    """Reassembly and a memory that does no more than the manual says: what it shows without `ce`, or while it is written,
    is nonsense. `stray` is high when it is asked for an octet that it has not."""

    def __init__(self, reassembly: Reassembly) -> None:
        self.inner = reassembly
        self.i, self.o, self.expiration = reassembly.i, reassembly.o, reassembly.expiration
        self.stray = Signal()
        for reason in REASONS:
            setattr(self, f"drop_{reason}", getattr(reassembly, f"drop_{reason}"))

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.inner = self.inner
        port = self.inner.ip_payloadsmem
        m.submodules.memory = octets = memory.Memory(shape=8, depth=self.inner.depth, init=[])
        write, read = octets.write_port(), octets.read_port()
        shown = Signal()
        m.d.sync += shown.eq(port.ce & ~port.we)
        m.d.comb += [
            write.addr.eq(port.addr), write.data.eq(port.wdata), write.en.eq(port.ce & port.we),
            read.addr.eq(port.addr), port.rdata.eq(Mux(shown, read.data, 0xA5)),
            self.stray.eq(port.ce & (port.addr >= self.inner.depth)),
        ]  # fmt: skip
        return m


@dataclass
class Fragment:
    """A fragment on its way: offset in octets."""

    offset: int
    data: bytes
    more: bool
    identification: int = 1
    source: str = PEER
    protocol: int = 17
    destination: str = OWN
    bad: bool = False

    @property
    def meta(self) -> dict[str, int]:
        return ipv4_rx(len(self.data), self.protocol, self.source, self.destination) | {
            "identification": self.identification,
            "offset": self.offset // 8,
            "more": int(self.more),
        }

    @property
    def key(self) -> tuple[str, str, int, int]:
        return self.source, self.destination, self.protocol, self.identification


def cut(payload: bytes, *starts: int, **of: Any) -> list[Fragment]:
    return [Fragment(offset, data, more, **of) for offset, data, more in pieces(payload, *starts)]


@dataclass
class Place:
    """A slot of the model."""

    key: Any = None
    busy: bool = False
    given_up: bool = False
    suspect: bool = False
    pieces: list[Fragment] = field(default_factory=list)

    def opened(self, key: Any) -> None:
        self.suspect = self.key == key
        self.key, self.busy, self.given_up, self.pieces = key, True, False, []


class Model:
    """What should become of fragments, octet sets instead of comparators, where nothing expires."""

    def __init__(self, pendings: int, fragments: int, payload: int) -> None:
        self.places = [Place() for _ in range(pendings)]
        self.fragments, self.room = fragments, fragments * payload
        self.whole: list[bytes] = []
        self.drops: dict[str, int] = {}

    def place(self, key: Any) -> Place | None:
        for wanted in (
            lambda place: place.busy and place.key == key,
            lambda place: not place.busy and place.key == key,
            lambda place: not place.busy,
            lambda place: place.given_up or place.suspect,
        ):
            for place in self.places:
                if wanted(place):
                    return place
        return None

    def fault(self, new: Fragment, place: Place | None, known: bool) -> str | None:
        if place and known and place.given_up:
            return "given_up"
        if new.offset + len(new.data) > self.room or not new.data or (new.more and len(new.data) % 8):
            return "size"
        if not place:
            return "slots"
        if not known:
            return None
        for other in place.pieces:
            if (other.offset, len(other.data), other.more) == (new.offset, len(new.data), new.more):
                return "duplicate"

        def reach(piece: Fragment) -> set[int]:
            return set(range(piece.offset, piece.offset + len(piece.data) if piece.more else self.room + 1))

        if any(reach(other) & reach(new) for other in place.pieces):
            return "overlap"
        return "fragments" if len(place.pieces) == self.fragments else None

    def take(self, new: Fragment) -> None:
        place = self.place(new.key)
        known = place is not None and place.busy and place.key == new.key
        fault = self.fault(new, place, known)
        if fault is None and place and not known:
            place.busy = False
        if new.bad:
            return
        if fault:
            self.drops[fault] = self.drops.get(fault, 0) + 1
        if not place or fault in ("given_up", "duplicate", "slots"):
            return
        if not known:
            place.opened(new.key)
        if fault:
            place.given_up = True
            return
        place.pieces.append(new)
        data = b"".join(piece.data for piece in sorted(place.pieces, key=lambda piece: piece.offset))
        last = [piece for piece in place.pieces if not piece.more]
        if last and len(data) == last[0].offset + len(last[0].data):
            self.whole.append(data)
            place.busy = False


def reassembled(
    block: Reassembly,
    sent: Sequence[Fragment],
    stalls: int = 0,
    seed: int = 0,
    whole: int = 0,
    cycles: int = 40_000,
) -> tuple[list[tuple[bytes, dict[str, int]]], dict[str, int]]:
    """(datagram, meta) of all that came out, and the drops that are not 0."""
    dut = WithMemory(block)
    bench = Bench(dut, stalls, seed)

    async def expiration(ctx: Any) -> None:
        ctx.set(dut.expiration, FOREVER)

    bench.drive(expiration)
    bench.send("i", [Bad(one.data) if one.bad else one.data for one in sent], [one.meta for one in sent])
    got = bench.receive("o")
    bench.count(*(f"drop_{reason}" for reason in REASONS), "stray")
    bench.run(lambda: len(got) >= whole, cycles=cycles, rest=20)
    assert bench.counts.pop("stray") == 0
    assert not any(isinstance(frame, Bad) for frame, _ in got)
    return [(frame, fields(meta)) for frame, meta in got], {
        name.removeprefix("drop_"): count for name, count in bench.counts.items() if count
    }


@pytest.mark.parametrize("stalls", STALLS)
def test_a_datagram_is_put_together_in_any_order(stalls: int) -> None:
    first, second = cut(noise(150), 80)
    third, fourth = cut(noise(160), 80, identification=2)
    got, drops = reassembled(Reassembly(max_payload=80), [first, second, fourth, third], stalls)
    assert got == [(noise(150), ipv4_rx(150)), (noise(160), ipv4_rx(160))]
    assert not drops


def test_each_order_of_four_fragments_gives_the_datagram() -> None:
    payload = noise(61)
    sent = []
    for n, order in enumerate(permutations(cut(payload, 8, 32, 48))):
        sent += [Fragment(one.offset, one.data, one.more, identification=n) for one in order]
    got, drops = reassembled(Reassembly(max_fragments=4, max_payload=16), sent)
    assert [frame for frame, _ in got] == [payload] * 24
    assert not drops


def test_no_part_of_the_key_may_differ() -> None:
    first, last = cut(noise(30), 16)
    others = [
        Fragment(16, last.data, False, **other)
        for other in (
            {"identification": 2}, {"identification": 0x8001}, {"source": "192.168.7.8"}, {"source": "192.168.6.9"},
            {"protocol": 1}, {"destination": "192.168.7.255"},
        )
    ]  # fmt: skip
    got, drops = reassembled(Reassembly(max_payload=16), [first, *others, last])
    assert [frame for frame, _ in got] == [noise(30)]
    assert drops == {"slots": len(others)}


def test_a_gap_is_never_passed() -> None:
    first, middle, last = cut(noise(40), 16, 32)
    got, drops = reassembled(Reassembly(max_fragments=3, max_payload=16), [first, last])
    assert not got
    assert not drops
    got, _ = reassembled(Reassembly(max_fragments=3, max_payload=16), [first, middle])
    assert not got
    got, _ = reassembled(Reassembly(max_fragments=3, max_payload=16), [middle, last])
    assert not got


def test_a_duplicate_does_no_harm_even_with_other_data_in_it() -> None:
    first, last = cut(noise(30), 16)
    forged = Fragment(0, bytes(16), True)
    got, drops = reassembled(Reassembly(max_payload=16), [first, forged, first, last])
    assert [frame for frame, _ in got] == [noise(30)]
    assert drops == {"duplicate": 2}


def test_late_duplicates_keep_no_slot_from_others() -> None:
    first, last = cut(noise(30), 16)
    other = cut(noise(25), 8, identification=2)
    got, drops = reassembled(Reassembly(max_payload=16), [first, last, first, *other])
    assert [frame for frame, _ in got] == [noise(30), noise(25)]
    assert not drops


def test_a_peer_whose_identification_never_changes_is_understood() -> None:
    got, drops = reassembled(Reassembly(max_payload=16), cut(noise(30), 16) * 3)
    assert [frame for frame, _ in got] == [noise(30)] * 3
    assert not drops


@pytest.mark.parametrize(
    "overlapping",
    [
        Fragment(8, noise(8), True), Fragment(0, noise(16), True), Fragment(16, noise(24), True),
        Fragment(8, noise(40), True), Fragment(16, noise(3), False), Fragment(8, noise(3), False),
        Fragment(0, noise(16), False),
    ],
)  # fmt: skip
def test_an_overlap_gives_the_datagram_up_with_all_that_comes_of_it_and_the_slot_is_free(
    overlapping: Fragment,
) -> None:
    first, middle, last = cut(noise(40), 8, 24)
    other = cut(noise(25), 8, identification=2)
    sent = [middle, overlapping, last, first, *other]
    got, drops = reassembled(Reassembly(max_fragments=3, max_payload=16), sent)
    assert [frame for frame, _ in got] == [noise(25)]
    assert drops == {"overlap": 1, "given_up": 2}


def test_what_lies_behind_the_last_fragment_overlaps_it() -> None:
    for sent in (
        [Fragment(16, b"end", False), Fragment(24, bytes(8), True)],
        [Fragment(24, bytes(8), True), Fragment(16, b"end", False)],
        [Fragment(16, b"end", False), Fragment(16, b"an end", False)],
        [Fragment(16, b"end", False), Fragment(24, b"end", False)],
    ):
        got, drops = reassembled(Reassembly(max_fragments=3, max_payload=16), sent)
        assert not got
        assert drops == {"overlap": 1}


@pytest.mark.parametrize(
    "wrong",
    [
        Fragment(0, b"", True), Fragment(16, b"", False), Fragment(0, noise(9), True), Fragment(0, noise(7), True),
        Fragment(32, noise(8), True), Fragment(32, noise(1), False), Fragment(24, noise(9), False),
        Fragment(24, noise(16), True), Fragment(65528, noise(8), False), Fragment(4096, noise(1), False),
    ],
)  # fmt: skip
def test_a_size_that_cannot_be_is_refused_and_its_datagram_given_up(wrong: Fragment) -> None:
    first, last = cut(noise(32), 16)
    other = cut(noise(25), 8, identification=2)
    got, drops = reassembled(Reassembly(max_payload=16), [first, wrong, last, wrong, *other, wrong, *other])
    assert [frame for frame, _ in got] == [noise(25), noise(25)]
    assert drops == {"size": 2, "given_up": 2}


def test_more_fragments_than_there_may_be_are_refused() -> None:
    many = cut(noise(32), 8, 16, 24)
    got, drops = reassembled(Reassembly(max_payload=16), [*many, *cut(noise(32), 16, identification=2)])
    assert [frame for frame, _ in got] == [noise(32)]
    assert drops == {"fragments": 1, "given_up": 1}


def test_a_fragment_that_ends_badly_does_not_count() -> None:
    first, last = cut(noise(30), 16)
    cut_off = Fragment(16, last.data, False, bad=True)
    overlapping = Fragment(8, noise(16), True, bad=True)
    stranger = Fragment(0, noise(16), True, identification=7, bad=True)
    too_large = Fragment(32, noise(16), False, bad=True)
    sent = [stranger, first, cut_off, overlapping, too_large, stranger, last]
    got, drops = reassembled(Reassembly(max_payload=16), sent)
    assert [frame for frame, _ in got] == [noise(30)]
    assert not drops


@pytest.mark.parametrize("pendings", [1, 2])
def test_a_datagram_is_forgotten_when_it_expires_and_not_before(pendings: int) -> None:
    dut = WithMemory(Reassembly(pendings, max_payload=16))
    bench = Bench(dut, stalls=0)
    got = bench.receive("o")
    bench.count(*(f"drop_{reason}" for reason in REASONS))

    async def bring(ctx: Any, one: Fragment) -> None:
        stream = dut.i.stream
        ctx.set(dut.i.meta, one.meta)
        ctx.set(stream.valid, 1)
        for item in [
            *({"data": octet, "end": 0, "bad": 0} for octet in one.data),
            {"data": 0, "end": 1, "bad": 0},
        ]:
            ctx.set(stream.payload, item)
            await ctx.tick().until(stream.ready)
        ctx.set(stream.valid, 0)

    async def process(ctx: Any) -> None:
        ctx.set(dut.expiration, 200)
        old = [cut(noise(30, n), 16, identification=n) for n in range(pendings)]
        for first, _ in old:
            await bring(ctx, first)
        await ctx.tick().repeat(199 - 40 * pendings)
        new = cut(noise(20), 8, identification=9)
        await bring(ctx, new[0])  # too early: dropped
        assert bench.counts["drop_expired"] == 0
        assert bench.counts["drop_slots"] == 1
        await ctx.tick().repeat(40 * pendings + 16)
        assert bench.counts["drop_expired"] == pendings
        await bring(ctx, new[1])
        await bring(ctx, new[0])
        await bring(ctx, old[0][1])

    bench.drive(process)
    bench.run(lambda: len(got) == 1)
    assert [frame for frame, _ in got] == [noise(20)]
    assert bench.counts["drop_expired"] == pendings  # of 2, the third has a slot


@pytest.mark.parametrize(
    ("pendings", "fragments", "stalls"), [(1, 2, 30), (1, 3, 0), (2, 2, 30), (2, 4, 0), (3, 3, 10)]
)
def test_random_fragments_fare_as_in_the_naive_model(
    pendings: int, fragments: int, stalls: int, seed: int = 1
) -> None:
    rng = random.Random(seed)
    payload = 16
    model = Model(pendings, fragments, payload)
    sent: list[Fragment] = []
    while len(sent) < 120:
        batch: list[Fragment] = []
        for _ in range(rng.randrange(1, pendings + 2)):
            size = rng.randrange(9, fragments * payload + 3)
            starts = sorted(
                rng.sample(range(8, size, 8), min(rng.randrange(1, fragments + 1), len(range(8, size, 8))))
            )
            batch += cut(rng.randbytes(size), *starts, identification=rng.randrange(20))
        for _ in range(rng.randrange(3)):
            one = rng.choice(batch)
            batch.append(Fragment(one.offset, rng.randbytes(len(one.data)), one.more, one.identification))
        if rng.random() < 0.3:
            one = rng.choice(batch)
            moved = 8 * rng.randrange(fragments * 2 + 1)
            batch.append(Fragment(moved, noise(rng.randrange(20)), rng.random() < 0.5, one.identification))
        if rng.random() < 0.3:
            one = rng.choice(batch)
            batch.append(Fragment(one.offset, one.data, one.more, one.identification, bad=True))
        if rng.random() < 0.5:
            rng.shuffle(batch)
        for one in batch:
            model.take(one)
        sent += batch
        for place in model.places:  # what would wait for ever is given up, most often
            if place.busy and not place.given_up and rng.random() < 0.7:
                sent.append(Fragment(0, b"overlaps", False, place.key[3]))
                model.take(sent[-1])
    got, drops = reassembled(Reassembly(pendings, fragments, payload), sent, stalls, seed)
    assert [frame for frame, _ in got] == model.whole
    assert drops == model.drops
    assert len(got) > 8


def test_the_largest_datagram_fills_the_memory_and_a_fragment_stalls_for_a_check_and_a_datagram_for_its_octets() -> (
    None
):
    first, last = cut(noise(2960), 1480)
    got, _ = reassembled(Reassembly(), [first, last], whole=1, cycles=2 * (1480 + 1 + 5) + 2960 + 4 + 5)
    assert got == [(noise(2960), ipv4_rx(2960))]


class Pinged(Elaboratable):
    """From Ethernet's payload to Ethernet's payload, for what comes in fragments."""

    def __init__(self) -> None:
        self.rx, self.fragments, self.echo, self.tx = (
            Ipv4Rx(),
            WithMemory(Reassembly()),
            IcmpEcho(2952),
            Ipv4Tx(),
        )
        self.i, self.o = self.rx.i, self.tx.o

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules += [self.rx, self.fragments, self.echo, self.tx]
        wiring.connect(m, self.rx.fragments, self.fragments.i)
        wiring.connect(m, self.fragments.o, self.echo.i)
        wiring.connect(m, self.echo.o, self.tx.i)
        m.d.comb += [
            self.tx.addresses.eq(self.rx.addresses),
            self.rx.o.stream.ready.eq(1),
            self.rx.turn.eq(self.echo.turn),
        ]
        return m


def test_a_ping_in_fragments_is_answered_in_fragments() -> None:
    asked = IP(src=PEER, dst=OWN, id=77, ttl=3) / ICMP(id=5, seq=6) / Raw(noise(2500))
    sent = [bytes(packet) for packet in fragment(asked, fragsize=1480)]  # type: ignore[no-untyped-call]
    assert len(sent) == 2
    dut = Pinged()
    bench = Bench(dut, stalls=0)

    async def configure(ctx: Any) -> None:
        ctx.set(dut.rx.addresses, addresses())
        ctx.set(dut.fragments.expiration, FOREVER)

    bench.drive(configure)
    bench.send("i", sent[::-1], [ethernet_rx()] * 2)
    got = bench.receive("o")
    bench.run(lambda: len(got) == 2)
    answer = defragment([IP(packet[6:]) for packet, _ in got])[0]  # type: ignore[no-untyped-call]
    assert [(packet[:6], fields(meta)) for packet, meta in got] == [(PEER_MAC, {"type": 0x0800})] * 2
    assert (answer.src, answer.dst, answer.ttl) == (OWN, PEER, 64)
    assert (answer[ICMP].type, answer[ICMP].id, answer[ICMP].seq) == (0, 5, 6)
    assert bytes(answer[ICMP].payload) == noise(2500)
    before = bytes(answer[ICMP])
    del answer[ICMP].chksum
    assert bytes(answer[ICMP]) == before


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({"max_pendings": 0}, "max_pendings is 1 at least, not 0"),
        ({"max_fragments": 1}, "max_fragments is 2 at least, not 1"),
        ({"max_payload": 1481}, "a multiple of 8 octets"),
        ({"max_payload": 0}, "a multiple of 8 octets"),
        ({"max_fragments": 45}, "65535 octets at most, not 66600"),
    ],
)
def test_arguments_that_cannot_be_are_refused(arguments: dict[str, int], sentence: str) -> None:
    with pytest.raises(ValueError, match=sentence):
        Reassembly(**arguments)


def test_the_default_memory_is_that_of_the_manual() -> None:
    block = Reassembly()
    assert (block.depth, len(block.ip_payloadsmem.addr)) == (2960, 12)
