"""scapy, which shares nothing with us, reads what we write, and we read what it writes."""

from __future__ import annotations

import random

import pytest
from scapy.layers.igmp import IGMP
from scapy.layers.inet import ICMP, IP, UDP, IPOption_Router_Alert, fragment
from scapy.layers.l2 import ARP, Ether
from scapy.packet import Raw

from roslet.wire.net import arp, ethernet, icmp, igmp, ipv4, udp
from roslet.wire.net.arp import Arp
from roslet.wire.net.ethernet import Frame
from roslet.wire.net.icmp import Echo
from roslet.wire.net.igmp import Igmp
from roslet.wire.net.ipv4 import Packet
from roslet.wire.net.udp import Datagram

MACS = ("02:00:00:00:00:01", "02:00:00:00:00:02")
IPS = ("192.168.1.2", "192.168.1.10")
A_MAC, B_MAC = bytes((2, 0, 0, 0, 0, 1)), bytes((2, 0, 0, 0, 0, 2))
A, B = bytes((192, 168, 1, 2)), bytes((192, 168, 1, 10))


@pytest.mark.parametrize("size", [0, 1, 17, 18, 1400, 1472])
def test_a_udp_frame_is_octet_for_octet_that_of_scapy(size: int) -> None:
    data = random.Random(size).randbytes(size)
    theirs = bytes(
        Ether(src=MACS[0], dst=MACS[1])
        / IP(src=IPS[0], dst=IPS[1], id=7, ttl=64)
        / UDP(sport=1234, dport=7400)
        / Raw(data)
    )
    packet = Packet(A, B, ipv4.UDP, Datagram(1234, 7400, data).emit(A, B), 7)
    ours = Frame(B_MAC, A_MAC, ethernet.IPV4, packet.emit()).emit()
    assert ours == theirs.ljust(60, b"\0")
    back = ipv4.parse(ethernet.parse(theirs).payload)
    assert udp.parse(back.payload, back.source, back.destination) == Datagram(1234, 7400, data)


def test_arp_is_that_of_scapy() -> None:
    for operation, target in ((arp.REQUEST, "00:00:00:00:00:00"), (arp.REPLY, MACS[1])):
        theirs = bytes(ARP(op=operation, hwsrc=MACS[0], psrc=IPS[0], hwdst=target, pdst=IPS[1]))
        ours = Arp(operation, A_MAC, A, ethernet.octets_of(target), B)
        assert bytes(ours.emit()) == theirs
        assert arp.parse(theirs) == ours


@pytest.mark.parametrize("size", [0, 1, 56, 1001])
def test_echoes_are_those_of_scapy(size: int) -> None:
    data = random.Random(size).randbytes(size)
    for kind in (icmp.ECHO_REQUEST, icmp.ECHO_REPLY):
        theirs = bytes(ICMP(type=kind, id=0xBEEF, seq=3) / Raw(data))
        assert bytes(Echo(kind, 0xBEEF, 3, data).emit()) == theirs
        assert icmp.parse(theirs) == Echo(kind, 0xBEEF, 3, data)


def test_igmp_with_router_alert_is_that_of_scapy() -> None:
    for kind, group in ((igmp.REPORT, "239.255.0.1"), (igmp.LEAVE, "239.255.0.1"), (igmp.QUERY, "0.0.0.0")):
        theirs = bytes(
            IP(src=IPS[0], dst="224.0.0.1", ttl=1, id=0, tos=0, options=[IPOption_Router_Alert()])
            / IGMP(type=kind, mrcode=100 if kind == igmp.QUERY else 0, gaddr=group)
        )
        message = Igmp(kind, 100 if kind == igmp.QUERY else 0, ipv4.octets_of(group))
        ours = Packet(A, igmp.ALL_HOSTS, ipv4.IGMP, message.emit(), ttl=1, options=igmp.ROUTER_ALERT)
        assert bytes(ours.emit()) == theirs
        assert igmp.parse(ipv4.parse(theirs).payload) == message


@pytest.mark.parametrize("size", [100, 1473, 4000, 65507])
def test_fragments_are_those_of_scapy(size: int) -> None:
    data = random.Random(size).randbytes(size)
    whole = Packet(A, B, ipv4.UDP, Datagram(5, 6, data).emit(A, B), 99)
    sent = IP(src=IPS[0], dst=IPS[1], id=99, ttl=64) / UDP(sport=5, dport=6) / Raw(data)
    theirs = fragment(sent, 1480)  # type: ignore[no-untyped-call]
    assert [bytes(one.emit()) for one in ipv4.fragments(whole, 1500)] == [bytes(one) for one in theirs]
