"""Headers by hand: IEEE 802.3, 3.1.1; RFC 1112, 6.4."""

from __future__ import annotations

import pytest

from gateware.frames import STALLS, Bad, Bench
from gateware.network import BROADCAST, MAC, configure, number
from roslet.gateware.ethernet import EthernetRx, EthernetTx
from roslet.gateware.multicast import hardware_address

SOURCE = bytes.fromhex("0200 0000 0003")
ARP, IPV4, IPV6 = b"\x08\x06", b"\x08\x00", b"\x86\xdd"
ALL_HOSTS = bytes.fromhex("0100 5e00 0001")
DISCOVERY = bytes((239, 255, 0, 1))  # RTPS's, whose highest 9 bits are not in the hardware address
DISCOVERY_MAC = bytes.fromhex("0100 5e7f 0001")


@pytest.mark.parametrize("stalls", STALLS)
def test_frames_for_us_go_by_type_to_arp_or_ipv4_with_their_sender(stalls: int) -> None:
    bench = Bench(EthernetRx(), stalls)
    configure(bench)
    bench.send(
        "i",
        [
            BROADCAST + SOURCE + ARP + b"who",
            MAC + SOURCE + IPV4 + b"datagram",
            Bad(MAC + SOURCE + IPV4 + b"spoilt"),
            ALL_HOSTS + MAC + IPV4 + b"to all",
            MAC + SOURCE + ARP,
        ],
    )
    arp, ipv4 = bench.receive("arp"), bench.receive("ipv4")
    bench.count("drop_short", "drop_address", "drop_type")
    bench.run(lambda: len(arp) == 2 and len(ipv4) == 3)
    assert [(frame, meta.source, meta.group) for frame, meta in arp] == [
        (b"who", number(SOURCE), 1),
        (b"", number(SOURCE), 0),
    ]
    assert [(frame, type(frame), meta.source, meta.group) for frame, meta in ipv4] == [
        (b"datagram", bytes, number(SOURCE), 0),
        (b"spoilt", Bad, number(SOURCE), 0),
        (b"to all", bytes, number(MAC), 1),
    ]
    assert bench.counts == {"drop_short": 0, "drop_address": 0, "drop_type": 0}


@pytest.mark.parametrize("stalls", STALLS)
def test_frames_for_others_of_other_types_and_cut_off_are_dropped_whole_each_with_its_counter(
    stalls: int,
) -> None:
    bench = Bench(EthernetRx(), stalls)
    configure(bench)
    others = [bytes([*MAC[:n], MAC[n] ^ 1 << n, *MAC[n + 1 :]]) for n in range(6)]
    frames = [other + SOURCE + IPV4 + b"not for us" for other in [*others, DISCOVERY_MAC]]
    frames += [MAC + SOURCE + IPV6 + b"six", BROADCAST + SOURCE + b"\x08\x01x", MAC + SOURCE + b"\x00\x06"]
    frames += [(MAC + SOURCE + IPV4)[:size] for size in range(14)]
    frames += [Bad(frame) for frame in frames]
    bench.send("i", [*frames, MAC + SOURCE + IPV4 + b"us"])
    arp, ipv4 = bench.receive("arp"), bench.receive("ipv4")
    bench.count("drop_short", "drop_address", "drop_type")
    bench.run(lambda: bool(ipv4))
    assert [frame for frame, _ in ipv4] == [b"us"]
    assert arp == []
    assert bench.counts == {"drop_short": 14, "drop_address": 7, "drop_type": 3}


def test_the_groups_that_are_joined_are_heard_and_no_others() -> None:
    bench = Bench(EthernetRx(2))
    configure(
        bench,
        groups=[{"valid": 1, "ip": number(DISCOVERY)}, {"valid": 0, "ip": number(bytes((224, 1, 2, 3)))}],
    )
    bench.send(
        "i",
        [
            DISCOVERY_MAC + SOURCE + IPV4 + b"joined",
            bytes.fromhex("0100 5e01 0203") + SOURCE + IPV4 + b"not valid",
            bytes.fromhex("0100 5eff 0001") + SOURCE + IPV4 + b"the bit that is always 0",
            ALL_HOSTS + SOURCE + IPV4 + b"all",
        ],
    )
    ipv4 = bench.receive("ipv4")
    bench.count("drop_address")
    bench.run(lambda: len(ipv4) == 2)
    assert [frame for frame, _ in ipv4] == [b"joined", b"all"]
    assert bench.counts == {"drop_address": 2}


def test_an_octet_is_received_every_cycle_whatever_becomes_of_it() -> None:
    bench = Bench(EthernetRx(), stalls=0)
    configure(bench)
    frames = [MAC + SOURCE + IPV4, BROADCAST + SOURCE + ARP, SOURCE + MAC + ARP, MAC + SOURCE + IPV6]
    bench.send("i", [frame + bytes(46) for frame in frames] * 4)
    arp, ipv4 = bench.receive("arp"), bench.receive("ipv4")
    bench.run(lambda: len(arp) == len(ipv4) == 4, cycles=16 * 61 + 5)


@pytest.mark.parametrize("stalls", STALLS)
def test_frames_to_be_sent_get_their_header(stalls: int) -> None:
    bench = Bench(EthernetTx(), stalls)
    configure(bench)
    bench.send(
        "i",
        [BROADCAST + b"question", SOURCE, Bad(SOURCE + b"spoilt")],
        [{"type": 0x0806}, {"type": 0x0800}, {"type": 0x0800}],
    )
    got = bench.receive("o")
    bench.run(lambda: len(got) == 3)
    assert [(frame, type(frame)) for frame, _ in got] == [
        (BROADCAST + MAC + ARP + b"question", bytes),
        (SOURCE + MAC + IPV4, bytes),
        (SOURCE + MAC + IPV4 + b"spoilt", Bad),
    ]


def test_a_negative_count_of_groups_is_refused() -> None:
    with pytest.raises(ValueError, match="there cannot be -1 groups"):
        EthernetRx(-1)


def test_a_group_maps_to_a_hardware_address_of_its_lowest_23_bits() -> None:
    from amaranth.hdl import Module, Signal
    from amaranth.sim import Simulator

    ip, mac = Signal(32), Signal(48)
    m = Module()
    m.d.comb += mac.eq(hardware_address(ip))
    seen = []

    async def process(ctx: object) -> None:
        for group in ((239, 255, 0, 1), (224, 0, 0, 251), (232, 128, 255, 255)):
            ctx.set(ip, number(bytes(group)))  # type: ignore[attr-defined]
            seen.append(ctx.get(mac))  # type: ignore[attr-defined]

    simulator = Simulator(m)
    simulator.add_testbench(process)
    simulator.run()
    assert seen == [
        number(bytes.fromhex(text)) for text in ("0100 5e7f 0001", "0100 5e00 00fb", "0100 5e00 ffff")
    ]
