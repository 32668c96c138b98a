"""The example udp-tx-rx behind the UDP blocks, on datagrams of scapy's."""

from __future__ import annotations

import runpy
from pathlib import Path
from typing import Any

from amaranth.hdl import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out
from scapy.layers.inet import IP, UDP

from gateware.frames import Bench
from gateware.internet import lead, turning
from roslet.gateware.meta import ADDRESSES, IPV4_RX
from roslet.gateware.raw_udp import RawUdpRx, RawUdpTx
from roslet.gateware.stream import FrameSignature
from roslet.gateware.udp import UdpRx, UdpTx

EXAMPLE = Path(__file__).parents[2] / "examples" / "gateware" / "udp_tx_rx.py"
HERE, THERE = "192.168.1.100", "192.168.1.10"


class Whole(wiring.Component):
    """The example and UDP, on IPv4; every address is known."""

    def __init__(self, example: Any) -> None:
        self._example = example
        super().__init__(
            {
                "i": In(FrameSignature(IPV4_RX)),
                "turn": Out(1),
                "o": Out(FrameSignature()),
                "addresses": In(ADDRESSES),
                "led": Out(4),
                "sent": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.example = example = self._example
        m.submodules.udp_rx = udp_rx = UdpRx()
        m.submodules.udp_tx = udp_tx = UdpTx()
        m.submodules.raw_rx = raw_rx = RawUdpRx()
        m.submodules.raw_tx = raw_tx = RawUdpTx()
        wiring.connect(m, wiring.flipped(self.i), udp_rx.i)
        wiring.connect(m, udp_rx.o, raw_rx.i)
        wiring.connect(m, raw_tx.o, udp_tx.i)
        wiring.connect(m, udp_tx.o, wiring.flipped(self.o))
        for name in ("addr", "ce", "we", "wdata", "grant"):
            m.d.comb += getattr(example, f"udp_rxbuf_{name}").eq(getattr(raw_rx, name))
        for name in ("addr", "ce", "grant"):
            m.d.comb += getattr(example, f"udp_txbuf_{name}").eq(getattr(raw_tx, name))
        m.d.comb += [
            raw_rx.port.eq(1234),
            raw_rx.rel.eq(example.udp_rxbuf_rel),
            raw_tx.rdata.eq(example.udp_txbuf_rdata),
            raw_tx.rel.eq(example.udp_txbuf_rel),
            raw_tx.lookup.done.eq(raw_tx.lookup.valid),
            raw_tx.lookup.found.eq(1),
            raw_tx.lookup.mac.eq(0x123456),
            self.turn.eq(udp_rx.turn),
            udp_tx.addresses.eq(self.addresses),
            self.led.eq(example.led),
            self.sent.eq(example.udp_txbuf_rel),
        ]
        return m


def test_it_sends_its_text_every_period_and_shows_the_lengths_of_what_it_receives() -> None:
    period = 300
    bench = Bench(Whole(runpy.run_path(str(EXAMPLE))["UdpTxRx"](period)), stalls=0)
    lengths = [0, 1, 4, 5, 9, 10, 14, 15, 248, 249, 3]
    leds, sent = [], []

    def datagram(src: str, dst: str, payload: bytes) -> bytes:
        return bytes(IP(src=src, dst=dst) / UDP(sport=1234, dport=1234) / payload)[20:]

    async def watch(ctx: Any) -> None:
        ctx.set(bench.dut.addresses.ip, int.from_bytes(bytes([192, 168, 1, 100]), "little"))
        last = 0
        for cycle in range(4 * period):
            _, _, led, now = await ctx.tick().sample(bench.dut.led, bench.dut.sent)
            if led != last:
                leds.append(led)
            last = led
            if now:
                sent.append(cycle)

    frames = [datagram(THERE, HERE, bytes(n)) for n in lengths]
    meta = {"mac": 1, "source": 0x0A01A8C0, "destination": 0x6401A8C0, "protocol": 17, "group": 0}
    bench.drive(watch)
    bench.watch(turning(bench.dut))
    bench.send("i", frames, [{**meta, "length": len(frame)} for frame in frames])
    got = bench.receive("o")
    bench.run()
    # 0 shows nothing, 4 what 1 does, and so on; 249 is too long and dropped; 3 is as 1.
    assert leds == [0b0001, 0b0011, 0b0111, 0b1111, 0b0001]
    assert sent == [period, 2 * period, 3 * period]
    told = datagram(HERE, THERE, b"UDP Send Test\n")
    begin = lead(THERE, length=len(told), hop=bytes([0x56, 0x34, 0x12, 0, 0, 0]))
    assert [frame for frame, _ in got] == [begin + told] * 3
