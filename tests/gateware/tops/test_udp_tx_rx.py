"""The whole UDP half, from the pins to user logic and back; scapy makes what comes by a hostile wire."""

from __future__ import annotations

import random
from collections.abc import Iterator
from typing import Any

import pytest
from scapy.layers.inet import ICMP, IP, UDP, defragment, fragment
from scapy.layers.l2 import ARP, Ether
from scapy.packet import Raw

from gateware.tops.udp_node import OUR_MAC, OURS, PORT, THEIR_MAC, THEIRS, UdpNode, take
from roslet.sim.mii import PREAMBLE, SFD, fcs, symbols_of

pytestmark = pytest.mark.timeout(300)  # the first test compiles the design


@pytest.fixture
def node() -> Iterator[UdpNode]:
    with UdpNode() as made:
        yield made


def ether(payload: Any, destination: str = OUR_MAC) -> bytes:
    return bytes(Ether(src=THEIR_MAC, dst=destination) / payload)


def datagram(data: bytes, **fields: Any) -> bytes:
    return ether(IP(src=THEIRS, dst=OURS, **fields) / UDP(sport=5000, dport=PORT) / Raw(data))


# with a host


def test_a_text_is_sent_in_every_period_once_the_address_has_been_found(node: UdpNode) -> None:
    endpoint = node.host.open(PORT)
    node.wire.run(0.0105)
    got = list(iter(endpoint.receive, None))
    assert got == [(b"UDP Send Test\n", (OURS, PORT))] * 10
    assert (node.gates.faults, node.drops()) == ({}, {})


def test_the_leds_show_how_long_a_datagram_was(node: UdpNode) -> None:
    endpoint = node.host.open(PORT)
    leds = {}
    for size in (0, 1, 4, 5, 9, 10, 14, 15, 248, 1, 0):
        assert endpoint.send(bytes(size), (OURS, PORT), node.wire.now)
        node.wire.run(0.0005)
        leds[size] = node.model.get("led")
    assert leds == {0: 0, 1: 1, 4: 1, 5: 3, 9: 3, 10: 7, 14: 7, 15: 15, 248: 15}
    endpoint.send(bytes(249), (OURS, PORT), node.wire.now)
    endpoint.send(bytes(5), (OURS, PORT + 1), node.wire.now)
    node.wire.run(0.0005)
    assert node.model.get("led") == 0
    assert node.drops() == {"udp_rxbuf_oversize": 1, "udp_rxbuf_port": 1}


@pytest.mark.parametrize("size", [0, 1, 17, 18, 19, 56, 1471, 1472, 1473, 2000, 2952])
def test_pings_of_all_sizes_are_answered_those_in_fragments_too(node: UdpNode, size: int) -> None:
    data = random.Random(size).randbytes(size)
    assert node.ping(data) == data
    assert (node.gates.faults, node.drops()) == ({}, {})


def test_a_ping_of_more_than_the_memory_takes_is_dropped_and_counted(node: UdpNode) -> None:
    assert node.ping(bytes(2953)) is None
    assert sum(node.drops().values()) > 0
    assert node.ping() is not None


# at the pins, with scapy as the host


def answers(node: UdpNode, *frames: bytes) -> list[Any]:
    """What the node sends when these come, apart from its own texts and questions; every checksum is right."""
    node.mii.receive()
    for frame in frames:
        node.mii.send(frame)
    node.model.run(len(frames) * 0.00013 + 0.0003)
    found = []
    for frame in take(node.mii.receive()):
        packet = Ether(frame)
        if packet.dst != THEIR_MAC or (UDP in packet):
            continue
        for layer in (IP, ICMP):
            if layer in packet and not packet[IP].flags.MF and not packet[IP].frag:
                again = packet.copy()
                del again[layer].chksum
                assert Ether(bytes(again))[layer].chksum == packet[layer].chksum
        found.append(packet)
    return found


def test_scapy_asks_by_arp_and_is_told() -> None:
    with UdpNode(host=False) as node:
        node.model.run(0.00004)
        question = ARP(op="who-has", hwsrc=THEIR_MAC, psrc=THEIRS, pdst=OURS)
        (reply,) = answers(node, ether(question, "ff:ff:ff:ff:ff:ff"))
        assert (reply.src, reply.dst) == (OUR_MAC, THEIR_MAC)
        told = reply[ARP]
        assert (told.op, told.hwsrc, told.psrc, told.hwdst, told.pdst) == (
            2,
            OUR_MAC,
            OURS,
            THEIR_MAC,
            THEIRS,
        )
        # A probe is answered; a question for another's address is not.
        assert (
            len(
                answers(
                    node, ether(ARP(op=1, hwsrc=THEIR_MAC, psrc="0.0.0.0", pdst=OURS), "ff:ff:ff:ff:ff:ff")
                )
            )
            == 1
        )
        assert (
            answers(
                node,
                ether(ARP(op=1, hwsrc=THEIR_MAC, psrc=THEIRS, pdst="192.168.1.101"), "ff:ff:ff:ff:ff:ff"),
            )
            == []
        )


@pytest.mark.parametrize("size", [0, 1, 18, 19, 700, 1472, 1473, 2952])
def test_scapy_pings_and_puts_the_reply_together(size: int) -> None:
    with UdpNode(host=False) as node:
        node.model.run(0.00004)
        data = random.Random(size).randbytes(size)
        request = IP(src=THEIRS, dst=OURS, id=77) / ICMP(type=8, id=5, seq=6) / Raw(data)
        pieces = fragment(request, 1480)  # type: ignore[no-untyped-call]
        got = answers(node, *(ether(piece) for piece in pieces))
        (whole,) = defragment([packet[IP] for packet in got])  # type: ignore[no-untyped-call]
        reply = IP(bytes(whole))[ICMP]
        assert (reply.type, reply.id, reply.seq) == (0, 5, 6)
        assert bytes(reply.payload)[:size] == data
        assert max(len(packet[IP]) for packet in got) <= 1500


# at the pins


@pytest.mark.parametrize(("phy", "clk_hz"), [("mii", 50e6), ("mii", 12.5e6), ("gmii", 125e6)])
def test_the_smallest_frames_back_to_back_are_all_answered(phy: str, clk_hz: float) -> None:
    count = 300
    with UdpNode(phy, clk_hz, host=False) as node:
        node.model.run(0.00004)
        node.mii.receive()
        for number in range(count):
            request = ICMP(type=8, id=1, seq=number) / Raw(bytes(18))
            node.mii.send(ether(IP(src=THEIRS, dst=OURS) / request))
        line = count * (64 + 20) * 8 / (100e6 if phy == "mii" else 1e9)
        node.model.run(line + 0.00005)
        sent = [one for one in node.mii.receive() if not one.frame.startswith(b"\xff")]
        assert node.drops() == {}
        replies = [Ether(frame) for frame in take(sent)]
        assert [reply[ICMP].seq for reply in replies] == list(range(count))
        assert sent[-1].end - sent[0].start < line + 0.00001


def test_latency_is_what_the_documents_say(node: UdpNode) -> None:
    """At 100 MHz: from `rel` to the first nibble of the preamble, for the text, so that 64 octets have room below 2 us; and
    from the last nibble of the FCS to `grant`, for 64 octets."""
    with UdpNode("mii", 100e6) as quick:
        quick.wire.run(0.0025)  # the address is known
        quick.mii.receive()
        model = quick.model
        while not model.get("user udp_txbuf_rel"):
            model.run_cycles("clk", 1)
        released = model.now
        while not model.get("phy_tx_en"):
            model.run_cycles("clk", 1)
        assert model.now - released < 1e-6
        quick.mii.send(datagram(bytes(64)))
        while not model.get("phy_rx_dv"):
            model.run_cycles("clk", 1)
        while model.get("phy_rx_dv"):
            model.run_cycles("clk", 1)
        ended = model.now
        while not model.get("user udp_rxbuf_grant"):
            model.run_cycles("clk", 1)
        assert model.now - ended < 0.5e-6


WRONG: dict[str, tuple[bytes, str]] = {
    "for somebody else": (ether(IP(dst=OURS) / ICMP(), "02:00:00:00:00:77"), "ethernet_address"),
    "of an unknown type": (
        bytes(Ether(src=THEIR_MAC, dst=OUR_MAC, type=0x86DD) / Raw(bytes(60))),
        "ethernet_type",
    ),
    "an answer to nobody's question of a wrong kind": (
        ether(ARP(op=2, hwtype=6, psrc=THEIRS, pdst=OURS)),
        "arp_arp",
    ),
    "IPv6 in IPv4's type": (ether(IP(src=THEIRS, dst=OURS, version=6) / UDP()), "ipv4_version"),
    "a header of four words": (ether(IP(src=THEIRS, dst=OURS, ihl=4) / UDP()), "ipv4_header_length"),
    "a wrong header checksum": (datagram(b"x", chksum=1), "ipv4_checksum"),
    "a total length beyond the frame": (datagram(bytes(40), len=200), "ipv4_length"),
    "a total length within the header": (datagram(bytes(40), len=19), "ipv4_length"),
    "for another address": (
        ether(IP(src=THEIRS, dst="192.168.1.101") / UDP(sport=1, dport=PORT) / Raw(b"x")),
        "ipv4_address",
    ),
    "from a group": (ether(IP(src="239.1.2.3", dst=OURS) / UDP(dport=PORT) / Raw(b"x")), "ipv4_address"),
    "of an unknown protocol": (
        ether(IP(src=THEIRS, dst=OURS, proto=6) / Raw(bytes(40))),
        "protocol_protocol",
    ),
    "a ping with a wrong checksum": (ether(IP(src=THEIRS, dst=OURS) / ICMP(chksum=1)), "icmp_checksum"),
    "an echo reply": (ether(IP(src=THEIRS, dst=OURS) / ICMP(type=0)), "icmp_type"),
    "a UDP length beyond the datagram": (
        ether(IP(src=THEIRS, dst=OURS) / UDP(dport=PORT, len=100) / Raw(bytes(30))),
        "udp_length",
    ),
    "a UDP length of seven": (
        ether(IP(src=THEIRS, dst=OURS) / UDP(dport=PORT, len=7) / Raw(bytes(30))),
        "udp_length",
    ),
    "a wrong UDP checksum": (
        ether(IP(src=THEIRS, dst=OURS) / UDP(dport=PORT, chksum=0x1234) / Raw(bytes(30))),
        "udp_checksum",
    ),
}


@pytest.mark.parametrize("what", WRONG)
def test_what_is_wrong_is_dropped_for_its_reason_and_the_node_lives(node: UdpNode, what: str) -> None:
    frame, reason = WRONG[what]
    node.wire.run(0.0005)
    node.mii.send(frame)
    node.wire.run(0.0002)
    assert node.drops() == {reason: 1}
    assert node.model.get("led") == 0
    assert node.ping() is not None


@pytest.mark.parametrize(
    ("fault", "reason"),
    [
        ({"check": b"\0\0\0\0"}, "mac_fcs"),
        ({"errors": [20]}, "mac_rx_er"),
    ],
)
def test_what_the_line_spoils_is_dropped_whole(node: UdpNode, fault: dict[str, Any], reason: str) -> None:
    node.wire.run(0.0005)
    node.mii.send(datagram(bytes(30)), **fault)
    node.wire.run(0.0002)
    assert node.drops() == {reason: 1}
    assert node.model.get("led") == 0
    assert node.ping() is not None


def test_runts_and_giants_are_dropped(node: UdpNode) -> None:
    node.wire.run(0.0005)
    node.mii.send(datagram(b"")[:59], pad=False)
    node.mii.send(datagram(bytes(1480)))
    node.wire.run(0.0005)
    assert node.drops() == {"mac_runt": 1, "mac_giant": 1}
    assert node.ping() is not None


def test_a_frame_cut_at_any_nibble_leaves_nothing(node: UdpNode) -> None:
    frame = datagram(bytes(30))
    symbols = symbols_of(bytes([PREAMBLE]) * 7 + bytes([SFD]) + frame + fcs(frame), 4)
    node.wire.run(0.0005)
    for cut in range(1, len(symbols)):
        node.mii.send_symbols(symbols[:cut])
    node.wire.run(0.002)
    # Preamble alone is one reason; then there are odd nibbles, frames that are too short and those with a wrong FCS.
    assert sum(node.drops().values()) == len(symbols) - 1
    assert set(node.drops()) <= {"mac_sfd", "mac_odd", "mac_runt", "mac_fcs"}
    assert node.model.get("led") == 0
    assert node.ping() is not None
    node.mii.send_symbols(symbols)
    node.wire.run(0.0002)
    assert node.model.get("led") == 15


def test_a_flood_of_arp_and_of_fragments_that_never_end_does_not_stop_it(node: UdpNode) -> None:
    rng = random.Random(1)
    endpoint = node.host.open(PORT)
    node.wire.run(0.0025)
    for number in range(300):
        if number % 2:
            spoof = f"192.168.1.{rng.randrange(1, 255)}"
            node.mii.send(
                ether(
                    ARP(op=rng.choice((1, 2)), hwsrc="02:00:00:00:66:66", psrc=spoof, pdst=OURS),
                    "ff:ff:ff:ff:ff:ff",
                )
            )
        else:
            piece = IP(src=THEIRS, dst=OURS, proto=17, id=number, flags=1, frag=rng.choice((0, 185)))
            node.mii.send(ether(piece / Raw(bytes(rng.choice((8, 64, 1480))))))
    node.wire.run(0.03)
    while endpoint.receive():
        pass
    assert node.ping() is not None
    # And a datagram in fragments comes through, once those that never ended have been given up for others.
    for piece in fragment(IP(src=THEIRS, dst=OURS, id=9) / UDP(sport=1, dport=PORT) / Raw(bytes(100)), 56):  # type: ignore[no-untyped-call]
        node.mii.send(ether(piece))
    node.wire.run(0.001)
    assert node.ping() is not None


def noise(rng: random.Random) -> bytes:
    """A frame that is nearly right, or not at all."""
    kind = rng.randrange(6)
    if kind == 0:
        return rng.randbytes(rng.randrange(14, 90))
    frame = bytearray(
        (
            ether(ARP(op=rng.choice((1, 2)), psrc=f"192.168.1.{rng.randrange(256)}", pdst=OURS)),
            ether(IP(src=THEIRS, dst=OURS) / ICMP(type=8) / Raw(rng.randbytes(rng.randrange(30)))),
            datagram(rng.randbytes(rng.randrange(30))),
            ether(
                IP(src=THEIRS, dst=OURS, id=rng.randrange(3), flags=1, frag=rng.randrange(6)) / Raw(bytes(24))
            ),
            datagram(b"options", options=[]),
        )[kind - 1]
    )
    for _ in range(rng.randrange(4)):
        frame[rng.randrange(len(frame))] = rng.randrange(256)
    return bytes(frame)


def test_after_100000_frames_of_noise_the_node_answers() -> None:
    rng = random.Random(20261125)
    frames = [noise(rng) for _ in range(2000)]
    with UdpNode("gmii") as node:
        node.wire.run(0.0005)
        for _ in range(50):
            rng.shuffle(frames)
            for frame in frames:
                node.mii.send(frame, pad=len(frame) % 8 != 0)
            while node.mii.waiting:
                node.model.run(0.0001)
            node.mii.receive()
        assert node.mii.sent >= 100_000
        node.gates.start(node.wire.now)
        node.wire.run(0.002)
        # A spoofed address may have displaced the host's: it tells its own again by asking.
        assert node.ping(seconds=0.1) is not None
        assert sum(node.drops().values()) > 10_000
