"""A header by hand (the well-known example of its checksum), then scapy's."""

from __future__ import annotations

import pytest
from scapy.layers.inet import IP, IPOption_RR, IPOption_Timestamp

from gateware.frames import STALLS, Bad, Bench
from gateware.internet import (
    OWN,
    PEER,
    datagram,
    ethernet_rx,
    fields,
    ipv4_rx,
    noise,
    octets,
    own_addresses,
)
from roslet.gateware.ipv4_rx import Ipv4Rx, ProtocolSwitch

DROPS = ("drop_version", "drop_header_length", "drop_checksum", "drop_length", "drop_address")
BROADCAST, LIMITED, GROUP = "192.168.7.255", "255.255.255.255", "239.255.0.1"
FULL_OPTIONS = IPOption_RR(routers=["10.0.0.1"] * 9)  # a header of 60 octets


class Run:
    """What became of frames: `whole` and `fragments` as (octets, fields of meta), and the drops that were not 0."""

    def __init__(
        self,
        frames: list[bytes],
        groups: list[int] | None = None,
        stalls: int = 0,
        ip: str = OWN,
        mask: str = "255.255.255.0",
        cycles: int = 20_000,
    ) -> None:
        bench = Bench(Ipv4Rx(), stalls)
        bench.drive(own_addresses(bench.dut, ip, mask))
        bench.send("i", frames, [ethernet_rx(group) for group in groups or [0] * len(frames)])
        whole, fragments = bench.receive("o"), bench.receive("fragments")
        bench.count(*DROPS)
        bench.run(cycles=cycles)
        self.whole = [(frame, fields(meta)) for frame, meta in whole]
        self.fragments = [(frame, fields(meta)) for frame, meta in fragments]
        self.drops = {name: count for name, count in bench.counts.items() if count}

    @property
    def nothing(self) -> bool:
        return not self.whole and not self.fragments


def changed(frame: bytes, at: int, octet: int) -> bytes:
    """With an octet changed, and a checksum that is right for it."""
    header = IP(frame[:at] + bytes([octet]) + frame[at + 1 :])
    del header.chksum
    return bytes(header)


@pytest.mark.parametrize("stalls", STALLS)
def test_the_header_is_taken_off_and_its_fields_stand_beside_the_payload(stalls: int) -> None:
    by_hand = bytes.fromhex("4500 0073 0000 4000 4011 b861 c0a8 0001 c0a8 00c7") + noise(95)
    bench = Run([by_hand], ip="192.168.0.199", stalls=stalls)
    assert bench.whole == [(noise(95), ipv4_rx(95, source="192.168.0.1", destination="192.168.0.199"))]
    assert not bench.drops


@pytest.mark.parametrize("stalls", STALLS)
def test_padding_and_options_are_left_off(stalls: int) -> None:
    frames = [datagram(noise(n)) + bytes(26 - n) for n in (0, 1, 2, 25, 26)] + [
        datagram(noise(n), options=options)
        for n in (0, 9)
        for options in ([FULL_OPTIONS], [IPOption_Timestamp(), IPOption_RR(routers=["10.0.0.1"])])
    ]
    run = Run(frames, stalls=stalls)
    lengths = [0, 1, 2, 25, 26, 0, 0, 9, 9]
    assert run.whole == [(noise(n), ipv4_rx(n)) for n in lengths]
    assert not run.drops


@pytest.mark.parametrize("stalls", STALLS)
def test_fragments_go_apart(stalls: int) -> None:
    sent = [(0, 1), (185, 0), (185, 1), (8191, 0)]
    run = Run(
        [datagram(noise(24), frag=offset, flags=more, id=0xBEEF) for offset, more in sent], stalls=stalls
    )
    assert run.fragments == [
        (noise(24), ipv4_rx(24) | {"identification": 0xBEEF, "offset": offset, "more": more})
        for offset, more in sent
    ]
    assert not run.whole
    assert not run.drops


def test_dont_fragment_and_the_reserved_flag_make_no_fragment() -> None:
    assert len(Run([datagram(b"x", flags=flags) for flags in ("DF", "evil")]).whole) == 2


def test_what_is_for_us_or_for_a_group_is_taken() -> None:
    sent = [
        (OWN, 0, 0), (BROADCAST, 1, 1), (LIMITED, 1, 1), (GROUP, 1, 1), ("224.0.0.1", 1, 1), (GROUP, 0, 1),
        ("239.255.255.255", 1, 1), (OWN, 0, 0),
    ]  # fmt: skip
    run = Run(
        [datagram(b"hello", dst=to) for to, _, _ in sent], [frame_to_group for _, frame_to_group, _ in sent]
    )
    assert run.whole == [(b"hello", ipv4_rx(5, destination=to, group=group)) for to, _, group in sent]
    assert not run.drops


def test_what_is_for_others_is_dropped() -> None:
    sent = [
        ("192.168.7.3", 0), ("192.168.6.2", 0), ("192.169.7.2", 0), ("10.168.7.2", 0), ("192.168.6.255", 1),
        ("0.0.0.0", 0), ("240.0.0.1", 0), ("192.168.7.0", 1), (OWN, 1), ("127.0.0.1", 0), ("255.255.255.2", 0),
        ("223.255.0.1", 0),
    ]  # fmt: skip
    run = Run([datagram(b"hello", dst=to) for to, _ in sent], [frame_to_group for _, frame_to_group in sent])
    assert run.nothing
    assert run.drops == {"drop_address": len(sent)}


def test_a_source_that_cannot_be_is_dropped_and_any_other_is_taken() -> None:
    wrong = [OWN, BROADCAST, LIMITED, GROUP, "224.0.0.1", "240.1.2.3"]
    right = ["0.0.0.0", "192.168.6.255", "10.0.0.255", "192.168.7.0", "223.255.255.255", PEER]
    run = Run([datagram(b"hello", src=source) for source in [*wrong, *right]])
    assert run.whole == [(b"hello", ipv4_rx(5, source=source)) for source in right]
    assert run.drops == {"drop_address": len(wrong)}


@pytest.mark.parametrize(
    ("mask", "source", "taken"),
    [
        ("255.255.255.252", "192.168.7.3", 0),
        ("255.255.255.254", "192.168.7.3", 1),  # RFC 3021: the other end
        ("255.255.255.255", "192.168.7.3", 1),
        ("255.255.0.0", "192.168.255.255", 0),
        ("255.255.0.0", "192.168.7.255", 1),
        ("0.0.0.0", "192.168.7.255", 1),
    ],
)
def test_the_broadcast_address_is_that_of_the_mask(mask: str, source: str, taken: int) -> None:
    assert len(Run([datagram(b"hello", src=source)], mask=mask).whole) == taken


def test_each_malformed_header_is_dropped_for_its_reason_and_the_next_datagram_is_taken() -> None:
    good = datagram(noise(30))
    wrong = [
        ("drop_version", changed(good, 0, 0x65)),
        ("drop_version", changed(good, 0, 0x05)),
        *(("drop_header_length", changed(good, 0, 0x40 + words)) for words in range(5)),
        *(("drop_checksum", good[:at] + bytes([good[at] ^ 0x10]) + good[at + 1 :]) for at in range(1, 20)),
        ("drop_checksum", good[:10] + bytes([good[10] ^ 0x80]) + good[11:]),
        ("drop_length", changed(good, 3, 19)),
        ("drop_length", changed(good, 3, 0)),
        ("drop_length", changed(good, 2, 8)),
        ("drop_length", changed(good, 2, 0xFF)),
        ("drop_length", good[:19]),
        ("drop_length", datagram(b"", options=[FULL_OPTIONS])[:59]),
        ("drop_length", b""),
    ]
    frames = []
    for _, frame in wrong:
        frames += [frame, Bad(frame), good]
    run = Run(frames, stalls=30, cycles=40_000)
    expected: dict[str, int] = {}
    for reason, _ in wrong:
        expected[reason] = expected.get(reason, 0) + 1
    assert run.drops == expected
    assert [frame for frame, _ in run.whole] == [noise(30)] * len(wrong)


def test_a_datagram_cut_at_any_octet_gives_nothing_or_ends_badly() -> None:
    whole = datagram(noise(40), options=[IPOption_RR(routers=["10.0.0.1"])])
    run = Run([whole[:size] for size in range(len(whole))] + [whole], cycles=30_000)
    header = 28
    assert run.drops == {"drop_length": len(whole)}
    assert [(frame, type(frame)) for frame, _ in run.whole] == [
        (noise(40)[:size], Bad) for size in range(40)
    ] + [(noise(40), bytes)]
    assert len(whole) == header + 40


def test_a_frame_that_ends_badly_does_so_behind_the_header_too_and_is_not_counted() -> None:
    frame = datagram(noise(10))
    run = Run([Bad(frame), Bad(frame + bytes(16)), Bad(frame[:25]), Bad(frame[:10]), frame])
    assert [(frame, type(frame)) for frame, _ in run.whole] == [
        (noise(10), Bad), (noise(10), Bad), (noise(10)[:5], Bad), (noise(10), bytes)
    ]  # fmt: skip
    assert not run.drops


def test_the_longest_datagram_of_an_ethernet_is_taken_and_one_octet_more_is_not() -> None:
    run = Run([datagram(noise(1480)), changed(datagram(noise(1480)), 3, 0xDD)])
    assert [(frame, type(frame)) for frame, _ in run.whole] == [(noise(1480), bytes), (noise(1480), Bad)]
    assert run.drops == {"drop_length": 1}


def test_a_header_stalls_a_frame_for_the_one_cycle_in_which_it_is_judged() -> None:
    bench = Bench(Ipv4Rx(), stalls=0)
    bench.drive(own_addresses(bench.dut))
    good = datagram(noise(26))
    frames = [
        good,
        good[:12] + b"\1" + good[13:],
        datagram(noise(26), dst="10.0.0.1"),
        b"\x60" + good[1:],
    ] * 5
    bench.send("i", frames, [ethernet_rx()] * len(frames))
    bench.receive("o")
    judged = 3 * 5  # a wrong version needs no more
    bench.run(cycles=sum(len(frame) + 1 for frame in frames) + judged + 2)


@pytest.mark.parametrize("stalls", STALLS)
def test_datagrams_go_to_their_protocols_and_others_are_counted(stalls: int) -> None:
    bench = Bench(ProtocolSwitch([1, 17]), stalls)
    protocols = [1, 17, 6, 17, 0, 255, 1, 6]
    frames: list[bytes] = [noise(5 + n) for n in range(8)]
    frames[6], frames[7] = Bad(frames[6]), Bad(frames[7])
    metas = [ipv4_rx(5 + n, protocol) for n, protocol in enumerate(protocols)]
    bench.send("i", frames, metas)
    icmp, udp = bench.receive("o0"), bench.receive("o1")
    bench.count("drop_protocol")
    bench.run()
    assert [(frame, type(frame), fields(meta)) for frame, meta in icmp] == [
        (noise(5), bytes, metas[0]), (noise(11), Bad, metas[6])
    ]  # fmt: skip
    assert [(frame, fields(meta)) for frame, meta in udp] == [(noise(6), metas[1]), (noise(8), metas[3])]
    assert bench.counts == {"drop_protocol": 3}


@pytest.mark.parametrize(
    ("protocols", "sentence"),
    [
        ([], "must be some"),
        ([17, 17], "distinct"),
        ([256], "a number of 8 bits"),
        ([-1], "a number of 8 bits"),
    ],
)
def test_a_switch_refuses_protocols_that_cannot_be(protocols: list[int], sentence: str) -> None:
    with pytest.raises(ValueError, match=sentence):
        ProtocolSwitch(protocols)


def test_the_metas_of_the_bench_are_in_the_order_of_the_wire() -> None:
    assert octets("1.2.3.4") == 0x04030201
