"""Writes ARP messages. RFC 826."""

from __future__ import annotations

from amaranth.hdl import C, Cat, Module, Mux, Signal
from amaranth.lib import memory, wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.arp_rx import IP_SIZE, MAC_SIZE, SENDER_SIZE, fixed
from roslet.gateware.compare import above
from roslet.gateware.meta import ADDRESSES, ETHERNET_TX, HOP
from roslet.gateware.multicast import BROADCAST
from roslet.gateware.octets import octets, pick
from roslet.gateware.stream import FrameSignature
from roslet.wire.net import arp, ethernet

_FIXED, _SENDER, _TARGET = 8, 16, 32
"""Where in `ArpTx` the parts of a message are, behind the destination at 0: what is before the addresses, and these. There
are gaps, so that the octets of the target are numbered like those of the destination, which are the same."""


def _literals(operation: int) -> bytes:
    """A message to all without its addresses, for which there are zeros."""
    begin = BROADCAST.ljust(_FIXED, b"\0") + bytes((*fixed()[:-1], operation))
    return begin.ljust(64, b"\0")


class ArpTx(wiring.Component):
    """Writes requests, replies and announcements, one at a time.

    Ports: while `ready` is high one of three is taken, in the cycle in which it is high. `reply`: to whose addresses were
    written last. `request`: for `ip`, which stays while `requesting` is high. `announce`: a request for our own address,
    which nobody answers (RFC 5227, 2.3).
    With `write` the octet `octet` is number `place` of ten, of the hardware and then the IP address of somebody who may be
    replied to; not in the cycle of `reply`. There are two places for these ten, so what is written later is no matter to a
    reply that is being sent.
    Then `o` gives the destination and the message without padding, from the second cycle on: an octet each cycle, without a
    pause, and the end after 34.

    Block RAM has all octets, in place of multiplexers, but our addresses and `ip`: these are put over zeros.
    """

    def __init__(self) -> None:
        super().__init__(
            {
                "addresses": In(ADDRESSES),
                "ready": Out(1),
                "reply": In(1),
                "request": In(1),
                "announce": In(1),
                "requesting": Out(1),
                "write": In(1),
                "place": In(range(SENDER_SIZE)),
                "octet": In(8),
                "ip": In(32),
                "o": Out(FrameSignature(ETHERNET_TX)),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        o = self.o.stream
        replying, page = Signal(), Signal()  # the page that is written; a reply is read from the other
        init = bytes(2 * 64) + _literals(arp.REQUEST) + _literals(arp.REPLY)
        block = {"ram_style": "block"}
        m.submodules.rows = rows = memory.Memory(shape=8, depth=len(init), init=init, attrs=block)
        write, read = rows.write_port(), rows.read_port()

        at = Signal(6)  # what is read next
        place, in_sender, in_target = at[:4], at[4], at[5]
        in_ip = above(place, MAC_SIZE - 1)
        of_peer = replying & ~in_sender & (in_target | ~at[3])
        advance, over = Signal(), Signal()
        m.d.comb += [
            write.addr.eq(Cat(self.place, C(0, 2), page)),
            write.data.eq(self.octet),
            write.en.eq(self.write),
            read.addr.eq(Cat(at[:5], in_target & ~of_peer, Mux(of_peer, ~page, replying), ~of_peer)),
            read.en.eq(advance),
        ]

        own = pick(octets(Cat(self.addresses.mac, self.addresses.ip)), place)
        ip = pick(octets(self.ip), place[:2] ^ MAC_SIZE % IP_SIZE)
        own_octet, ip_octet = Signal(8), Signal(8)  # zero where neither is to be sent
        with m.If(advance):
            m.d.sync += [
                at.eq(at + 1),
                over.eq(at == _TARGET + SENDER_SIZE),
                own_octet.eq(own),
                ip_octet.eq(ip),
            ]
            with m.If(at == HOP - 1):
                m.d.sync += at.eq(_FIXED)
            with m.If(at == _SENDER + SENDER_SIZE - 1):
                m.d.sync += at.eq(_TARGET)
            with m.If(~in_sender & (replying | self.requesting | ~in_target | ~in_ip)):
                m.d.sync += own_octet.eq(0)
            with m.If(~self.requesting | ~in_target | ~in_ip):
                m.d.sync += ip_octet.eq(0)
        m.d.comb += [
            self.o.meta.type.eq(ethernet.ARP),
            o.payload.data.eq(read.data | own_octet | ip_octet),
            o.payload.end.eq(over),
        ]
        with m.FSM() as fsm:
            with m.State("IDLE"):
                m.d.comb += self.ready.eq(1)
                m.d.sync += [replying.eq(self.reply), self.requesting.eq(self.request)]
                with m.If(self.reply):
                    m.d.sync += page.eq(~page)
                with m.If(self.reply | self.request | self.announce):
                    m.next = "FETCH"
            with m.State("FETCH"):
                m.d.comb += advance.eq(1)
                m.next = "SEND"
            with m.State("SEND"):
                m.d.comb += [o.valid.eq(1), advance.eq(o.ready)]
                with m.If(o.ready & over):
                    m.next = "IDLE"
        with m.If(fsm.ongoing("IDLE")):
            m.d.sync += at.eq(0)
        return m
