"""Ethernet II frames in and out: whom they are for, and what is in them. IEEE 802.3, 3.1.1."""

from __future__ import annotations

from amaranth.hdl import Cat, Const, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from roslet.gateware import multicast
from roslet.gateware.compare import above
from roslet.gateware.header import HeaderReader, wire_order
from roslet.gateware.meta import ADDRESSES, ETHERNET_RX, ETHERNET_TX, HOP
from roslet.gateware.octets import octets, pick
from roslet.gateware.stream import FrameSignature
from roslet.wire.net import ethernet

GROUP_BIT = 0
"""Of the first octet: the address is one of a group, or broadcast. IEEE 802.3, 3.2.3."""


class EthernetRx(wiring.Component):
    """Takes the Ethernet header off the frames that are for this node, and sorts them by type.

    Ports: `i`, frames from the destination address on; `arp` and `ipv4`, what follows the header, padding as it came, with
    who sent it beside it. For this node is what goes to `addresses.mac`, to everybody, to 224.0.0.1, or to one of `groups`,
    of which there are `count` (their hardware addresses are compared, which 32 groups share: whoever reads the datagram sees
    the group itself). `addresses` and `groups` are steady while frames come.

    Throughput one octet a cycle, without a pause between frames; `i` is ready whenever the output that the frame goes to is.
    No latency: an octet passes in the cycle in which it comes. Holds the sender's address and nothing else. A bad end is
    passed on.

    Dropped, and counted where they end well: `drop_short`, frames that end within the header; `drop_address`, those for
    somebody else; `drop_type`, those for us that are neither ARP nor IPv4.
    """

    def __init__(self, count: int = 0) -> None:
        self._count = count
        super().__init__(
            {
                "i": In(FrameSignature()),
                "arp": Out(FrameSignature(ETHERNET_RX)),
                "ipv4": Out(FrameSignature(ETHERNET_RX)),
                "addresses": In(ADDRESSES),
                "groups": In(multicast.groups(count)),
                "drop_short": Out(1),
                "drop_address": Out(1),
                "drop_type": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.reader = reader = HeaderReader(ethernet.FIELDS, ("source", "type"))
        connect(m, flipped(self.i), reader.i)
        m.d.comb += self.drop_short.eq(reader.drop_short)

        # The destination is compared as its octets pass; a header is longer than it, so that it is known by the body.
        i = self.i.stream
        at = reader.at
        comparing = i.valid & ~above(at[:4], HOP - 1)
        group = Signal()
        with m.If(i.valid & (at == 0)):
            m.d.sync += group.eq(i.payload.data[GROUP_BIT])
        wanted = [
            (Const(1), Value.cast(self.addresses.mac)),
            (Const(1), Const(multicast.number(multicast.BROADCAST), 48)),
            (Const(1), multicast.hardware_address(Const(multicast.number(multicast.ALL_HOSTS), 32))),
        ]
        for n in range(self._count):
            wanted.append((self.groups[n].valid, multicast.hardware_address(self.groups[n].ip)))
        same = Signal(len(wanted))
        for bit, (valid, address) in zip(same, wanted, strict=True):
            octet = pick(octets(address), at[:3])
            with m.If(comparing):
                m.d.sync += bit.eq((i.payload.data == octet) & Mux(at == 0, valid, bit))

        # Whose frame it is is known with the last octet of the type, of which the other is still in its place.
        o, ours = reader.o, same.any()
        type_ = Cat(i.payload.data, Value.cast(o.meta.header.type)[:8])
        chosen = Signal(2)
        ports = (self.arp, self.ipv4)
        for mine, port, known in zip(chosen, ports, (ethernet.ARP, ethernet.IPV4), strict=True):
            with m.If(at != ethernet.SIZE):
                m.d.sync += mine.eq(ours & (type_ == known))
            m.d.comb += [
                port.meta.source.eq(o.meta.header.source),
                port.meta.group.eq(group),
                port.stream.payload.eq(o.stream.payload),
                port.stream.valid.eq(o.stream.valid & mine),
            ]
        ended = o.stream.valid & o.stream.payload.end & ~o.stream.payload.bad
        m.d.comb += [
            o.stream.ready.eq(~(chosen & ~Cat(port.stream.ready for port in ports)).any()),
            self.drop_address.eq(ended & ~ours),
            self.drop_type.eq(ended & ours & ~chosen.any()),
        ]
        return m


class EthernetTx(wiring.Component):
    """Puts `addresses.mac`, as the sender, and the type behind the destination of each frame; padding is the MAC's.

    Ports: `i`, frames that begin with their destination (HOP), and their type; `o`, frames with the header. Throughput one
    octet a cycle, no latency: what comes behind the destination waits for 8 cycles. A bad end is passed on.
    """

    def __init__(self) -> None:
        super().__init__(
            {
                "i": In(FrameSignature(ETHERNET_TX)),
                "o": Out(FrameSignature()),
                "addresses": In(ADDRESSES),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        i, o = self.i.stream, self.o.stream
        header = [field for field in ethernet.FIELDS if field.name != "destination"]
        values = {"source": self.addresses.mac, "type": self.i.meta.type}
        own = octets(Cat(wire_order(field, Value.cast(values[field.name])) for field in header))
        at = Signal(range(HOP + len(own) + 1))  # which octet of the header; behind it, it stays
        assert len(own) == 8
        inserting = at[3] ^ (at[1] & at[2])  # 6 to 13 of 0 to 14
        m.d.comb += o.valid.eq(i.valid)
        with m.If(inserting):
            m.d.comb += o.payload.data.eq(pick(own[-HOP:] + own[:-HOP], at[:3]))
        with m.Else():
            m.d.comb += [o.payload.eq(i.payload), i.ready.eq(o.ready)]
        with m.If(i.valid & o.ready):
            with m.If(i.payload.end & ~inserting):
                m.d.sync += at.eq(0)
            with m.Elif(at != HOP + len(own)):
                m.d.sync += at.eq(at + 1)
        return m
