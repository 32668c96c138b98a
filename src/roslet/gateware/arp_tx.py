"""Writes ARP messages. RFC 826."""

from __future__ import annotations

from amaranth.hdl import Cat, Const, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.arp_rx import FIXED_SIZE, IP_SIZE, MAC_SIZE, SENDER_SIZE, fixed
from roslet.gateware.meta import ADDRESSES, ETHERNET_TX, HOP
from roslet.gateware.multicast import BROADCAST
from roslet.gateware.octets import octets, pick
from roslet.gateware.stream import FrameSignature
from roslet.wire.net import arp, ethernet


class ArpTx(wiring.Component):
    """Writes requests, replies and announcements, one at a time.

    Ports: while `ready` is high one of three is taken, in the cycle in which it is high. `reply`: to whom `octet` says, an
    octet in each of the next 10 cycles, in which `rotate` is high: the hardware address, then the IP address. `request`: for
    `ip`, which stays until `loading`, high for the same 10 cycles, is over. `announce`: a request for our own address, which
    nobody answers (RFC 5227, 2.3).
    Then `o` gives the destination and the message without padding: an octet each cycle, without a pause, and the end after
    34.

    Two shift registers, in place of multiplexers, hold the target: one for the header, one for the message.
    """

    def __init__(self) -> None:
        super().__init__(
            {
                "addresses": In(ADDRESSES),
                "ready": Out(1),
                "reply": In(1),
                "request": In(1),
                "announce": In(1),
                "loading": Out(1),
                "rotate": Out(1),
                "octet": In(8),
                "ip": In(32),
                "o": Out(FrameSignature(ETHERNET_TX)),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        o = self.o.stream
        replying, announcing = Signal(), Signal()
        hop = Signal(8 * HOP)
        target = Signal(8 * SENDER_SIZE)
        at = Signal(range(SENDER_SIZE))
        last = at == SENDER_SIZE - 1
        in_ip = at[3] | (at[2] & at[1])  # MAC_SIZE or more
        m.d.comb += self.o.meta.type.eq(ethernet.ARP)

        own = Cat(self.addresses.mac, self.addresses.ip)
        own_octet = pick(octets(own), at)
        ip_octet = pick(octets(self.ip), at[:2] ^ MAC_SIZE % IP_SIZE)
        octet = Signal(8)
        with m.If(replying):
            m.d.comb += octet.eq(self.octet)
        with m.Elif(
            in_ip
        ):  # a request says nothing of its target's hardware address, which is written as zeros
            m.d.comb += octet.eq(Mux(announcing, own_octet, ip_octet))

        shift, shift_hop = Signal(), Signal()
        with m.If(shift):
            m.d.sync += target.eq(Cat(target[8:], octet))
        with m.If(shift_hop):
            m.d.sync += hop.eq(Cat(hop[8:], Mux(replying, octet, BROADCAST[0])))

        def counted(size: int, then: str) -> None:
            with m.If(o.ready):
                m.d.sync += at.eq(at + 1)
                with m.If(at == size - 1):
                    m.d.sync += at.eq(0)
                    m.next = then

        with m.FSM():
            with m.State("IDLE"):
                m.d.comb += self.ready.eq(1)
                m.d.sync += [replying.eq(self.reply), announcing.eq(self.announce)]
                with m.If(self.reply | self.request | self.announce):
                    m.next = "LOAD"
            with m.State("LOAD"):
                m.d.comb += [self.loading.eq(1), self.rotate.eq(replying)]
                m.d.comb += shift.eq(1)
                m.d.sync += at.eq(at + 1)
                m.d.comb += shift_hop.eq(~in_ip)
                with m.If(last):
                    m.d.sync += at.eq(0)
                    m.next = "DESTINATION"
            with m.State("DESTINATION"):
                m.d.comb += [o.valid.eq(1), o.payload.data.eq(hop[:8]), shift_hop.eq(o.ready)]
                counted(HOP, "FIXED")
            with m.State("FIXED"):
                operation = Mux(replying, arp.REPLY, arp.REQUEST)
                m.d.comb += [
                    o.valid.eq(1),
                    o.payload.data.eq(
                        pick([*(Const(octet, 8) for octet in fixed()[:-1]), operation], at[:3])
                    ),
                ]
                counted(FIXED_SIZE, "SENDER")
            with m.State("SENDER"):
                m.d.comb += [o.valid.eq(1), o.payload.data.eq(own_octet)]
                counted(SENDER_SIZE, "TARGET")
            with m.State("TARGET"):
                m.d.comb += [o.valid.eq(1), o.payload.data.eq(target[:8])]
                m.d.comb += shift.eq(o.ready)
                counted(SENDER_SIZE, "END")
            with m.State("END"):
                m.d.comb += [o.valid.eq(1), o.payload.end.eq(1)]
                with m.If(o.ready):
                    m.next = "IDLE"
        return m
