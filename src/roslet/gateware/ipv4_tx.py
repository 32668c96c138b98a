"""IPv4 to Ethernet: headers are put before datagrams, and long ones are cut. RFC 791."""

from __future__ import annotations

from amaranth.hdl import C, Cat, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.checksum import SerialSum
from roslet.gateware.compare import above
from roslet.gateware.header import wire_order
from roslet.gateware.meta import ADDRESSES, ETHERNET_TX, HOP, LEAD
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

    Ports: `i`, payloads of `max_length` octets at most, each behind its lead (see `meta.lead`); `o`, IPv4 packets, with
    `hop` each behind the hardware address that it goes to; `addresses`, of which the source is. `ttl` is the time to live.

    A datagram's fragments have the same identification, the next one's is one more. DF is clear. Where `max_length` fits
    into one packet, there is no logic to cut. Protocol 255, which is reserved, must not be asked for (see SerialSum).

    With `hop` the hardware address passes in the cycles in which it comes; the other 8 octets of the lead are kept, and give
    nothing; then the payload waits for the header, of 20 octets, and passes without a register. So a packet costs 34 cycles
    and its payload. Holds the lead.

    A payload that ends badly does so behind its header. One that ends before its length, or after it, is made to end badly;
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
        self._whole = mtu - table.SIZE
        self._cuts = max_length > self._whole
        self._piece = self._whole & ~7  # what is not last has a multiple of 8 octets: RFC 791, 3.1
        self._packets = -(-max(0, max_length - self._whole) // self._piece) + 1
        super().__init__(
            {
                "i": In(FrameSignature()),
                "o": Out(FrameSignature(ETHERNET_TX)),
                "addresses": In(ADDRESSES),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.sum = header_sum = SerialSum()
        i, o = self.i.stream, self.o.stream

        # Which octet of the header. In the lead, whose destination stands where the header has it, it begins before and ends
        # behind: so the own address is at hand, to be summed, while the hardware address passes.
        begin, end_of_lead = _OFFSET["destination"] - HOP, _OFFSET["destination"] + LEAD - HOP - 1
        at = Signal(range(end_of_lead + 1), init=begin)
        assert (begin, end_of_lead) == (10, 23)
        in_hop, in_rest = ~at[4], at[4] & at[2]  # of the lead: before the destination, and behind it
        step = Signal()  # an octet of lead or header is done

        # -- what goes into this packet

        left = Signal(range(self._max_length + 1))  # octets of the datagram, without the packets before
        total = Signal(range(table.SIZE + min(self._whole, self._max_length) + 1))
        count = Signal(
            range(self._whole + 2)
        )  # octets of this packet's payload that are out; or more than it may have
        number = Signal(range(self._packets))  # of the packet within its datagram
        more, boundary = Signal(), Signal()  # there is another behind it; all of this one's are out
        identification = Signal(16)
        packet_done, datagram_done, passed = Signal(), Signal(), Signal()
        again = number.any()
        with m.If(packet_done):
            m.d.sync += [count.eq(0), boundary.eq(0)]
        with m.Elif(passed):
            m.d.sync += count.eq(count + ~count.all())
            if self._cuts:
                m.d.sync += boundary.eq(more & (count == self._piece - 1))
        with m.If(datagram_done):
            m.d.sync += [identification.eq(identification + 1), number.eq(0)]
        with m.If(step & in_rest & at[1] & ~again):
            m.d.sync += left.eq(Cat(i.payload.data, left[:8]))
        if self._cuts:
            # One adder says how long a packet is, and at its end what is left behind it.
            added = (left + Mux(boundary, -self._piece, table.SIZE))[: len(left)]
            m.d.sync += [
                more.eq(above(left, self._whole)),
                total.eq(Mux(more, table.SIZE + self._piece, added)),
            ]
            with m.If(boundary & packet_done):
                m.d.sync += [number.eq(number + 1), left.eq(added)]
        else:
            m.d.sync += total.eq(left + table.SIZE)

        # -- what is kept of the lead: destination and protocol, and where there are fragments the hardware address before
        # them. It comes round once while the header passes, and once before the next fragment.

        kept = Signal(8 * (HOP + 5 if self._cuts else 5))
        newest = kept[-8:]
        from_i = Signal()
        octet = Mux(from_i, i.payload.data, kept[:8])
        comes_round = at >= _OFFSET["protocol"] if self._cuts else at == _OFFSET["destination"] - 1
        with m.If(step & Mux(at[4], ~at[2] | (at[:2] == 1), comes_round)):
            m.d.sync += kept.eq(Cat(kept[8:], octet))

        # -- the header

        numbers: dict[str, Value] = {
            "version_ihl": C(VERSION_IHL, 8),
            "dscp_ecn": C(0, 8),
            "total_length": total | C(0, 16),
            "identification": identification,
            "flags_fragment": Cat((number * (self._piece >> 3) | C(0, 13))[:13], more, C(0, 2)),
            "ttl": C(self._ttl, 8),
            "protocol": newest,
            "checksum": (~header_sum.result).replicate(2),  # each half in its cycle
            "source": self.addresses.ip,
            "destination": newest.replicate(4),
        }
        header = octets(Cat(wire_order(field, numbers[field.name]) for field in table.FIELDS))
        field_octet = Mux(at[4], newest, pick(header[:16], at[:4]))
        m.d.comb += [
            # In the lead the destination is summed as it is kept. The checksum's two octets change nothing.
            header_sum.data.eq(field_octet),
            header_sum.add.eq(step & (in_hop | (at[2] ^ at[:2].any()))),
            header_sum.clear.eq(packet_done),
            self.o.meta.type.eq(ethernet.IPV4),
            o.payload.data.eq(octet),
        ]

        with m.FSM():
            with m.State("LEAD"):
                passes = in_hop if self._hop else C(0)
                m.d.comb += [
                    from_i.eq(~again),
                    o.valid.eq(passes & (i.valid | again)),
                    step.eq((i.valid | again) & (o.ready | ~passes)),
                    i.ready.eq(~again & (o.ready | ~passes)),
                ]
                with m.If(step):
                    m.d.sync += at.eq(at + 1)
                    with m.If(at == end_of_lead):
                        m.d.sync += at.eq(0)
                        m.next = "HEADER"
            with m.State("HEADER"):
                m.d.comb += [o.payload.data.eq(field_octet), o.valid.eq(1), step.eq(o.ready)]
                with m.If(step):
                    m.d.sync += at.eq(at + 1)
                    with m.If(at == table.SIZE - 1):
                        m.d.sync += at.eq(begin)
                        m.next = "PAYLOAD"
            with m.State("PAYLOAD"):
                m.d.comb += [
                    from_i.eq(1),
                    packet_done.eq(o.valid & o.ready & o.payload.end),
                ]
                with m.If(boundary):
                    m.d.comb += [o.valid.eq(1), o.payload.end.eq(1)]
                with m.Else():
                    m.d.comb += [
                        o.valid.eq(i.valid),
                        i.ready.eq(o.ready),
                        o.payload.end.eq(i.payload.end),
                        o.payload.bad.eq(i.payload.end & (i.payload.bad | more | (count != left))),
                        passed.eq(i.valid & o.ready & ~i.payload.end),
                        datagram_done.eq(packet_done),
                    ]
                with m.If(packet_done):
                    m.next = "LEAD"
        return m
