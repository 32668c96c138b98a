"""The blocks as one stack, on frames of scapy's."""

from __future__ import annotations

from scapy.layers.inet import ICMP, IP, UDP
from scapy.layers.l2 import ARP, Ether

from gateware.frames import Bench
from gateware.network import configure
from roslet.gateware.stack import UdpStack

HERE, THERE = "192.168.1.100", "192.168.1.10"
MAC, PEER_MAC = "02:00:00:00:00:02", "02:00:00:00:0a:0b"
WIRE = 8 + 64 + 12
"""Octet times of the smallest frame: preamble, frame, gap. IEEE 802.3, 3.1.1 and 4.4.2."""


def test_the_smallest_frames_pass_as_fast_as_gmii_brings_them() -> None:
    bench = Bench(UdpStack(125_000_000), stalls=0)
    configure(bench, enable=1, retry_count=3, retry_interval=1000, timeout=100_000, expiration=10_000)
    to_us, from_there = Ether(src=PEER_MAC, dst=MAC), IP(src=THERE, dst=HERE)
    question = Ether(src=PEER_MAC, dst="ff:ff:ff:ff:ff:ff") / ARP(hwsrc=PEER_MAC, psrc=THERE, pdst=HERE)
    ping = to_us / from_there / ICMP(seq=7) / bytes(18)
    texts = [bytes([n]) * 18 for n in range(20)]
    datagrams = [to_us / from_there / UDP(sport=5, dport=1234) / text for text in texts]
    frames = [bytes(frame).ljust(60, b"\0") for frame in (question, ping, *datagrams)]
    bench.send("rx", frames)
    received, sent = bench.receive("udp_rx"), bench.receive("tx")
    bench.run(lambda: len(received) == len(texts), cycles=WIRE * len(frames))
    assert [text for text, _ in received] == texts
    answers = [Ether(frame) for frame, _ in sent]
    assert [one[ARP].op for one in answers if ARP in one and one[ARP].pdst == THERE] == [2]
    assert [(one[ICMP].type, one[ICMP].seq) for one in answers if ICMP in one] == [(0, 7)]
