"""Reads IGMP messages: who is asked for. RFC 2236."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware import multicast
from roslet.gateware.checksum import SerialSum
from roslet.gateware.meta import IPV4_RX
from roslet.gateware.octets import octets, pick
from roslet.gateware.stream import FrameSignature
from roslet.wire.net import igmp

REPORT_V1, REPORT_V3 = 0x12, 0x22
"""RFC 2236, 2.1; RFC 3376, 4.2."""

OTHERS = (REPORT_V1, igmp.REPORT, REPORT_V3, igmp.LEAVE)
"""What other hosts say to routers: well formed, and of no interest."""

_AT = {field.name: field.offset for field in igmp.FIELDS}


class IgmpRx(wiring.Component):
    """Picks the queries out of IGMP messages.

    Ports: `i`, messages, one of which may be longer than IGMPv2's 8 octets, as IGMPv3's queries are; `groups`, of `count`.
    `query` is high for one cycle, that of the end, when a query has come which names at least one of them: `named` has a bit
    for each that it names (a general query names all that are valid), `max_response` its field.

    `i` is always ready, an octet each cycle. Dropped, and counted where they end well: `drop_igmp`: messages shorter than 8
    octets, with a wrong checksum, or of an unknown type. Reports and leave messages of others are ignored.
    """

    def __init__(self, count: int) -> None:
        self._count = count
        super().__init__(
            {
                "i": In(FrameSignature(IPV4_RX)),
                "groups": In(multicast.groups(count)),
                "query": Out(1),
                "named": Out(count),
                "max_response": Out(8),
                "drop_igmp": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        i = self.i.stream
        octet, end = i.payload.data, i.payload.end
        m.submodules.sum = total = SerialSum()
        at = Signal(range(igmp.SIZE + 1))
        is_query, is_other, general = Signal(), Signal(), Signal()
        same = Signal(self._count)
        m.d.comb += [
            i.ready.eq(1),
            total.data.eq(octet),
            total.add.eq(i.valid & ~end),
            total.clear.eq(i.valid & end),
        ]
        in_group = at[2] & ~at[3]  # which begins at 4
        first = at[:2] == 0
        with m.If(i.valid & end):
            m.d.sync += at.eq(0)
            good = ~i.payload.bad
            right = (at == igmp.SIZE) & total.right
            m.d.comb += [
                self.query.eq(good & right & is_query & self.named.any()),
                self.drop_igmp.eq(good & ~(right & (is_query | is_other))),
            ]
        with m.Elif(i.valid):
            with m.If(at != igmp.SIZE):
                m.d.sync += at.eq(at + 1)
            with m.If(at == _AT["type"]):
                m.d.sync += [
                    is_query.eq(octet == igmp.QUERY),
                    is_other.eq(Cat(octet == other for other in OTHERS).any()),
                ]
            with m.If(at == _AT["max_response"]):
                m.d.sync += self.max_response.eq(octet)
            with m.If(in_group):
                m.d.sync += general.eq((octet == 0) & (general | first))
                for n in range(self._count):
                    own = pick(octets(self.groups[n].ip), at[:2])
                    m.d.sync += same[n].eq((octet == own) & (same[n] | first))
        for n in range(self._count):
            m.d.comb += self.named[n].eq(self.groups[n].valid & (general | same[n]))
        return m
