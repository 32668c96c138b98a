"""IPv4 from Ethernet: headers are judged and taken off, datagrams go to their protocols. RFC 791, RFC 1122."""

from __future__ import annotations

from collections.abc import Sequence

from amaranth.hdl import Cat, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.checksum import SerialSum
from roslet.gateware.meta import ADDRESSES, ETHERNET_RX, IPV4_FRAGMENT, IPV4_RX
from roslet.gateware.stream import FrameSignature
from roslet.wire.net import ethernet
from roslet.wire.net import ipv4 as table

VERSION = 4
MIN_WORDS = table.SIZE // 4
"""The least header length. RFC 791, 3.1."""

CLASS_D = 0b1110
"""The first four bits of a multicast address. RFC 1112, 4. 0b111, of three, are multicast, reserved or broadcast."""

LENGTH_BITS = ethernet.MTU.bit_length()
"""What is longer than these bits can say came in no Ethernet frame."""

_FIELD = {field.name: field for field in table.FIELDS}


class Ipv4Rx(wiring.Component):
    """Judges IPv4 headers and takes them off; options are skipped, Ethernet's padding is left off.

    Ports: `i`, what follows an Ethernet header of type IPv4; `o`, what follows the headers of whole datagrams; `fragments`,
    that of fragments (more of them to come, or an offset that is not 0). `meta.length` is the number of octets in every
    frame of these that ends well; it is right from the first item on. `addresses` are the node's own. While a frame
    is at `o` or `fragments`, `meta.source` and behind it `meta.destination`, as a ring of 8 octets, move on to the next
    octet with each cycle of `turn`: who needs one after another has them without a multiplexer.

    Throughput an octet a cycle. Headers are taken without stalling, and judged in a cycle in which nothing is; what
    follows passes without a register, and stalls as `o` or `fragments` does. Holds the fields of one header.

    A datagram is taken that is for the node's own address, in a frame that was for it alone (RFC 1122, 3.3.6); for any
    multicast group, since Ethernet's filter knows which; for 255.255.255.255, or the subnet's broadcast address (none in a
    subnet of /31 or /32, RFC 3021). Its source must not be the node's own address, a broadcast address, multicast or
    reserved (RFC 1122, 3.2.1.3); 0.0.0.0 may be, as queries of IGMP have it.

    Dropped whole, and counted when their end has come, unless that is bad: `drop_version`, not 4; `drop_header_length`, less
    than 5 words; `drop_checksum`, of the header; `drop_length`, the frame is shorter than the header or the total length
    says, or this less than the header; `drop_address`. A frame that is shorter than its total length ends badly where it
    ends, since what came was passed on; every other drop gives nothing.
    """

    def __init__(self) -> None:
        super().__init__(
            {
                "i": In(FrameSignature(ETHERNET_RX)),
                "o": Out(FrameSignature(IPV4_RX)),
                "fragments": Out(FrameSignature(IPV4_FRAGMENT)),
                "addresses": In(ADDRESSES),
                "turn": In(1),
                "drop_version": Out(1),
                "drop_header_length": Out(1),
                "drop_checksum": Out(1),
                "drop_length": Out(1),
                "drop_address": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.sum = header_sum = SerialSum()
        i = self.i.stream
        data = i.payload.data

        at = Signal(LENGTH_BITS)
        following = Signal(LENGTH_BITS)
        word, octet = at[2:6], at[:2]  # within a header, which has 60 octets at most
        ihl = Signal(4)
        total = Signal(LENGTH_BITS)
        words = Signal(LENGTH_BITS - 2)
        identification, flags_fragment = Signal(16), Signal(16)
        protocol = Signal(8)
        ring = Signal(64)
        source, destination = ring[:32], ring[32:]
        bad_version, bad_ihl, too_long, too_short, bad_source = (
            Signal(name=name) for name in ("bad_version", "bad_ihl", "too_long", "too_short", "bad_source")
        )
        m.d.comb += following.eq(at + 1)

        # -- fields, shifted in as they pass

        taken = Signal()
        m.d.comb += [header_sum.data.eq(data), header_sum.add.eq(taken)]

        def passing(name: str) -> Value:
            """Whether the octet at hand is in a field: fields are aligned to their size."""
            field = _FIELD[name]
            bits = (field.bits // 8).bit_length() - 1
            return taken & (at[bits:6] == field.offset >> bits)

        for name, register in [
            ("total_length", total),
            ("identification", identification),
            ("flags_fragment", flags_fragment),
            ("protocol", protocol),
        ]:
            with m.If(passing(name)):
                m.d.sync += register.eq(Cat(data, register)[: len(register)])
        in_header = Signal()
        with m.If(passing("source") | passing("destination") | self.turn):
            m.d.sync += ring.eq(Cat(ring[8:], Mux(in_header, data, ring[:8])))
        with m.If(passing("version_ihl")):
            m.d.sync += [
                ihl.eq(data[:4]),
                bad_version.eq(data[4:] != VERSION),
                bad_ihl.eq(data[:4] < MIN_WORDS),
            ]
        with m.If(passing("total_length") & (octet == 2)):
            m.d.sync += too_long.eq(data[LENGTH_BITS - 8 :].any())
        with m.If(taken & (word == 1)):  # the total length is there
            m.d.sync += Cat(words, too_short).eq(total[2:] - ihl)

        # -- addresses, octet by octet

        own_octet = self.addresses.ip.word_select(octet, 8)
        mask_octet = self.addresses.mask.word_select(octet, 8)
        has_broadcast = ~self.addresses.mask[25]  # bit 1 of its last octet: clear up to /30
        alike = {
            "own": data == own_octet,
            "subnet": (data == (own_octet | ~mask_octet)[:8]) & has_broadcast,
            "limited": data.all(),
        }
        same = {name: Signal(name=f"same_{name}") for name in alike}
        still = {name: alike[name] & (same[name] | (octet == 0)) for name in alike}
        with m.If(passing("source") | passing("destination")):
            m.d.sync += [same[name].eq(still[name]) for name in alike]
        with m.If(passing("source") & (octet == 0)):
            m.d.sync += bad_source.eq(data[5:].all())
        to_multicast, to_group = Signal(), Signal()
        with m.If(passing("destination") & (octet == 0)):
            m.d.sync += bad_source.eq(bad_source | same["own"] | same["subnet"])  # the source was
            m.d.sync += to_multicast.eq(data[4:] == CLASS_D)
        m.d.comb += to_group.eq(to_multicast | same["limited"] | same["subnet"])
        to_us = to_group | (same["own"] & ~self.i.meta.group)

        # -- what comes after

        is_fragment = Signal()  # known long before the header is over
        m.d.sync += is_fragment.eq(flags_fragment[:14].any())  # MORE_FRAGMENTS, and the offset
        ready = Mux(is_fragment, self.fragments.stream.ready, self.o.stream.ready)
        valid = Signal()
        over = at == total
        bad_length, bad_address, fault = Signal(), Signal(), Signal()
        m.d.comb += [
            bad_length.eq(too_long | too_short),
            bad_address.eq(bad_source | ~to_us),
        ]
        m.d.sync += fault.eq(~header_sum.right | bad_length | bad_address)
        dropping, cut, ended = Signal(), Signal(), Signal()
        m.d.comb += [
            ended.eq(i.valid & i.ready & i.payload.end),
            header_sum.clear.eq(ended),
        ]
        with m.If(ended):
            m.d.sync += at.eq(0)
        with m.FSM():
            with m.State("HEADER"):
                m.d.comb += [
                    in_header.eq(1),
                    i.ready.eq(1),
                    taken.eq(i.valid & ~i.payload.end),
                    cut.eq(i.payload.end),
                ]
                with m.If(taken):
                    m.d.sync += at.eq(following)
                    with m.If(passing("version_ihl") & ((data[4:] != VERSION) | (data[:4] < MIN_WORDS))):
                        m.next = "DROP"
                    with m.Elif((following[2:6] == ihl) & (octet == 3)):
                        m.next = "JUDGE"
            with m.State("JUDGE"):
                m.next = "BODY"
            with m.State("BODY"):
                with m.If(fault):
                    m.d.comb += [i.ready.eq(1), dropping.eq(1)]
                    with m.If(i.valid):
                        m.next = "DROP"
                with m.Elif(over & ~i.payload.end):
                    m.d.comb += i.ready.eq(1)
                with m.Else():
                    m.d.comb += [valid.eq(i.valid), i.ready.eq(ready), cut.eq(i.payload.end & ~over)]
                    with m.If(i.valid & ready & ~i.payload.end):
                        m.d.sync += at.eq(following)
                with m.If(ended):
                    m.next = "HEADER"
            with m.State("DROP"):
                m.d.comb += [i.ready.eq(1), dropping.eq(1)]
                with m.If(ended):
                    m.next = "HEADER"
        with m.If(ended & ~i.payload.bad):
            with m.If(cut):
                m.d.comb += self.drop_length.eq(1)
            with m.Elif(dropping):
                with m.If(bad_version):
                    m.d.comb += self.drop_version.eq(1)
                with m.Elif(bad_ihl):
                    m.d.comb += self.drop_header_length.eq(1)
                with m.Elif(~header_sum.right):
                    m.d.comb += self.drop_checksum.eq(1)
                with m.Elif(bad_length):
                    m.d.comb += self.drop_length.eq(1)
                with m.Else():
                    m.d.comb += self.drop_address.eq(1)

        for port, wanted in [(self.o, ~is_fragment), (self.fragments, is_fragment)]:
            m.d.comb += [
                port.stream.valid.eq(valid & wanted),
                port.stream.payload.data.eq(data),
                port.stream.payload.end.eq(i.payload.end),
                port.stream.payload.bad.eq(i.payload.bad | cut),
                port.meta.mac.eq(self.i.meta.source),
                port.meta.source.eq(source),
                port.meta.destination.eq(destination),
                port.meta.protocol.eq(protocol),
                port.meta.length.eq(Cat(total[:2], words)),
                port.meta.group.eq(to_group),
            ]
        m.d.comb += [
            self.fragments.meta.identification.eq(identification),
            self.fragments.meta.offset.eq(flags_fragment[:13]),
            self.fragments.meta.more.eq(flags_fragment[13]),
        ]
        return m


class ProtocolSwitch(wiring.Component):
    """Sends datagrams where their protocols are wanted.

    Ports: `i`, datagrams; `o0`, `o1`, ..., those of `protocols[0]`, ...; `drop_protocol`, a good one of none of them.

    Passes an octet a cycle without a register, and holds nothing.
    """

    def __init__(self, protocols: Sequence[int]) -> None:
        self._protocols = tuple(protocols)
        if not self._protocols or len(set(self._protocols)) != len(self._protocols):
            raise ValueError(f"protocols must be some, and distinct: {list(protocols)}")
        if not all(0 <= protocol <= 255 for protocol in self._protocols):
            raise ValueError(f"a protocol is a number of 8 bits: {list(protocols)}")
        super().__init__(
            {
                "i": In(FrameSignature(IPV4_RX)),
                **{f"o{n}": Out(FrameSignature(IPV4_RX)) for n in range(len(self._protocols))},
                "drop_protocol": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        i = self.i.stream
        with m.Switch(self.i.meta.protocol):
            for n, protocol in enumerate(self._protocols):
                port = getattr(self, f"o{n}")
                m.d.comb += [port.stream.payload.eq(i.payload), port.meta.eq(self.i.meta)]
                with m.Case(protocol):
                    m.d.comb += [port.stream.valid.eq(i.valid), i.ready.eq(port.stream.ready)]
            with m.Default():
                m.d.comb += [
                    i.ready.eq(1),
                    self.drop_protocol.eq(i.valid & i.payload.end & ~i.payload.bad),
                ]
        return m
