"""IPv4 to Ethernet: headers are put before datagrams, and long ones are cut. RFC 791."""

from __future__ import annotations

from amaranth.hdl import C, Cat, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.checksum import SerialSum
from roslet.gateware.header import wire_order
from roslet.gateware.meta import ADDRESSES, ETHERNET_TX, HOP, IPV4_TX
from roslet.gateware.octets import octets, pick
from roslet.gateware.stream import FrameSignature
from roslet.wire.net import ethernet
from roslet.wire.net import ipv4 as table

VERSION_IHL = 0x45
"""Version 4, 5 words: no options."""

TTL = 64
"""RFC 1122, 3.2.1.7, and the assigned numbers."""

LONGEST = 0xFFFF - table.SIZE
"""What the 16 bits of a total length leave to the payload."""

MINIMUM_MTU = 68
"""What every network must carry. RFC 791, 3.2."""

_OFFSET = {field.name: field.offset for field in table.FIELDS}


class Ipv4Tx(wiring.Component):
    """Puts an IPv4 header before each payload, or several where it is longer than the `mtu` allows.

    Ports: `i`, payloads, `meta.length` being the number of their octets, `max_length` at most; `o`, IPv4 packets, with `hop`
    each behind the hardware address `meta.mac`; `addresses`, of which the source is. `ttl` is the time to live.

    A datagram's fragments have the same identification, the next one's is one more. DF is clear. Where `max_length` fits
    into one packet, there is no logic to cut. Protocol 255, which is reserved, must not be asked for (see SerialSum).

    The first octet stands at `o` 8 cycles after the first item at `i`, which waits for the header, of 20 octets; the rest
    passes without a register. So a packet costs 28 cycles and its payload, with `hop` 6 more. Holds nothing.

    A payload that ends badly does so behind its header. One that ends before `length`, or after it, is made to end badly;
    fragments of it that are out already are good, and the receiver waits for the last in vain.
    """

    def __init__(
        self, ttl: int = TTL, mtu: int = ethernet.MTU, max_length: int = LONGEST, hop: bool = True
    ) -> None:
        if not 1 <= ttl <= 255:
            raise ValueError(f"a time to live is 1 to 255, not {ttl}")
        if not MINIMUM_MTU <= mtu <= 0xFFFF:
            raise ValueError(f"an MTU is {MINIMUM_MTU} (RFC 791) to 65535, not {mtu}")
        if not 1 <= max_length <= LONGEST:
            raise ValueError(f"a payload has 1 to {LONGEST} octets at most, not {max_length}")
        self._ttl = ttl
        self._max_length = max_length
        self._hop = hop
        room = mtu - table.SIZE
        self._piece = room & ~7  # what is not last has a multiple of 8 octets: RFC 791, 3.1
        self._whole = room
        self._cuts = max_length > room
        super().__init__(
            {
                "i": In(FrameSignature(IPV4_TX)),
                "o": Out(FrameSignature(ETHERNET_TX)),
                "addresses": In(ADDRESSES),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.sum = header_sum = SerialSum()
        i, o = self.i.stream, self.o.stream
        meta = self.i.meta

        # -- what goes into this packet

        position = Signal(range(self._max_length + 1))  # octets of the datagram that are out
        left = Signal.like(position)
        total = Signal(range(table.SIZE + min(self._whole, self._max_length) + 1))
        more, boundary = Signal(), Signal()
        identification = Signal(16)
        packet_done, datagram_done, passed = Signal(), Signal(), Signal()
        length = Signal.like(meta.length)  # right from the second cycle of ADDRESSES on
        m.d.sync += length.eq(meta.length)
        m.d.comb += left.eq(length - position)
        with m.If(datagram_done):
            m.d.sync += [position.eq(0), identification.eq(identification + 1)]
        with m.Elif(passed):
            m.d.sync += position.eq(position + 1)
        if self._cuts:
            sent = Signal(range(self._piece))  # octets of this packet's payload that are out
            with m.If(packet_done):
                m.d.sync += [sent.eq(0), boundary.eq(0)]
            with m.Elif(passed):
                m.d.sync += [sent.eq(sent + 1), boundary.eq(more & (sent == self._piece - 1))]

        # -- the header

        first, last = _OFFSET["source"], table.SIZE - 1
        at = Signal(range(table.SIZE), init=first)
        octet = Signal(8)
        offset = Signal(13)
        if self._cuts:
            m.d.comb += offset.eq(position[3:])  # in units of 8 octets: RFC 791, 3.1
        numbers: dict[str, Value] = {
            "version_ihl": C(VERSION_IHL, 8),
            "dscp_ecn": C(0, 8),
            "total_length": total | C(0, 16),
            "identification": identification,
            "flags_fragment": Cat(offset, more, C(0, 2)),
            "ttl": C(self._ttl, 8),
            "protocol": meta.protocol,
            "checksum": C(0, 16),  # as it is summed
            "source": self.addresses.ip,
            "destination": meta.destination,
        }
        header = octets(Cat(wire_order(field, numbers[field.name]) for field in table.FIELDS))
        m.d.comb += octet.eq(pick(header, at))
        spelling = (at == _OFFSET["checksum"]) | (at == _OFFSET["checksum"] + 1)

        m.d.comb += [
            header_sum.data.eq(octet),
            header_sum.clear.eq(packet_done),
            self.o.meta.type.eq(ethernet.IPV4),
        ]

        with m.FSM():
            # Addresses are summed before the packet begins, as they come after the checksum.
            with m.State("ADDRESSES"), m.If(i.valid):
                m.d.comb += header_sum.add.eq(1)
                m.d.sync += at.eq(at + 1)
                if self._cuts:
                    m.d.sync += [
                        more.eq(left > self._whole),
                        total.eq(table.SIZE + Mux(more, self._piece, left)),
                    ]
                else:
                    m.d.sync += total.eq(table.SIZE + meta.length)
                with m.If(at == last):
                    m.d.sync += at.eq(0)
                    m.next = "HOP" if self._hop else "HEADER"
            with m.State("HOP"):
                m.d.comb += [o.valid.eq(1), o.payload.data.eq(pick(octets(meta.mac), at))]
                with m.If(o.ready):
                    m.d.sync += at.eq(at + 1)
                    with m.If(at == HOP - 1):
                        m.d.sync += at.eq(0)
                        m.next = "HEADER"
            with m.State("HEADER"):
                m.d.comb += [
                    o.valid.eq(1),
                    o.payload.data.eq(Mux(spelling, ~header_sum.result, octet)),
                    header_sum.add.eq(o.ready),
                ]
                with m.If(o.ready):
                    m.d.sync += at.eq(at + 1)
                    with m.If(at == last):
                        m.d.sync += at.eq(first)
                        m.next = "PAYLOAD"
            with m.State("PAYLOAD"):
                with m.If(boundary):
                    m.d.comb += [o.valid.eq(1), o.payload.end.eq(1), packet_done.eq(o.ready)]
                with m.Else():
                    m.d.comb += [
                        o.valid.eq(i.valid),
                        i.ready.eq(o.ready),
                        o.payload.data.eq(i.payload.data),
                        o.payload.end.eq(i.payload.end),
                        o.payload.bad.eq(i.payload.end & (i.payload.bad | left.any())),
                        passed.eq(i.valid & o.ready & ~i.payload.end),
                        datagram_done.eq(i.valid & o.ready & i.payload.end),
                        packet_done.eq(datagram_done),
                    ]
                with m.If(packet_done):
                    m.next = "ADDRESSES"
        return m
