"""ICMP: pings are answered. RFC 792, RFC 1122, 3.2.2.6."""

from __future__ import annotations

from amaranth.hdl import C, Cat, Module, Signal
from amaranth.lib import data, memory, wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.checksum import SerialSum
from roslet.gateware.meta import IPV4_RX, IPV4_TX
from roslet.gateware.stream import FrameSignature
from roslet.wire.net import ethernet, icmp, ipv4

MAX_DATA = ethernet.MTU - ipv4.SIZE - icmp.SIZE
"""What a packet that is no fragment carries."""

_OFFSET = {field.name: field.offset for field in icmp.FIELDS}
_TYPE, _CHECKSUM = _OFFSET["type"], _OFFSET["checksum"]
_SIZE_BITS = 3  # less than these can say is shorter than the header

_DROPS = ("type", "group", "length", "size", "busy", "checksum")


class IcmpEcho(wiring.Component):
    """Answers echo requests.

    Ports: `i`, datagrams of ICMP; `o`, replies to the hosts that asked, by the hardware addresses that the requests came
    from.

    A reply repeats up to `max_data` octets of data; its checksum is the request's with the type taken out of it (RFC 1624),
    so a wrong request cannot become a right reply. Two requests are held: while one is answered another is taken, so pings
    may come back to back. Throughput an octet a cycle both ways, without stalling at `i`. A reply begins 4 cycles after the
    end of its request, or after the end of the reply before it. The memory has two slots of 2**n octets, the least that is
    more than the longest message, and a bit beside each octet.

    Dropped whole, and counted when a good end has come: `drop_type`, no echo request; `drop_group`, to a group or broadcast
    address; `drop_length`, less than the header's 8 octets; `drop_size`, more than `max_data`; `drop_busy`, two are held;
    `drop_checksum`. A request that ends badly is forgotten.
    """

    def __init__(self, max_data: int = MAX_DATA) -> None:
        if not 0 <= max_data <= 0xFFFF - ipv4.SIZE - icmp.SIZE:
            raise ValueError(f"an echo carries 0 to 65507 octets, not {max_data}")
        self._max_data = max_data
        super().__init__(
            {
                "i": In(FrameSignature(IPV4_RX)),
                "o": Out(FrameSignature(IPV4_TX)),
                **{f"drop_{reason}": Out(1) for reason in _DROPS},
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        longest = icmp.SIZE + self._max_data
        slot_bits = longest.bit_length()
        word = data.StructLayout({"octet": 8, "last": 1})
        m.submodules.messages = messages = memory.Memory(shape=word, depth=2 << slot_bits, init=[])
        kept = data.StructLayout({"mac": 48, "source": 32, "length": 16})
        waiting, answered = Signal(kept), Signal(kept)
        is_waiting, is_answered = Signal(), Signal()
        with m.If(is_waiting & ~is_answered):
            m.d.sync += [answered.eq(waiting), is_answered.eq(1), is_waiting.eq(0)]

        # -- requests: each octet is written, as the reply has it, when the next item is there

        m.submodules.sum = message_sum = SerialSum()
        i, meta, write = self.i.stream, self.i.meta, messages.write_port()
        octet, end = i.payload.data, i.payload.end
        slot = Signal()
        nowhere = (1 << slot_bits) - 1
        at = Signal(slot_bits, init=nowhere)  # where the octet before goes
        before = Signal(8)
        is_type, is_upper, is_lower = (at == _TYPE, at == _CHECKSUM, at == _CHECKSUM + 1)
        # The type goes from 8 to 0, so 8 is added to the upper octet of the checksum (RFC 1624); a carry out of that is
        # one in the lower, and a carry out of this one in the upper again.
        overflows = before[3:].all()
        carry = Signal()
        one = (is_upper & overflows & octet.all()) | (is_lower & carry)
        keep = Signal()
        m.d.sync += [
            write.en.eq(keep),
            write.addr.eq(Cat(at, slot)),
            write.data.octet.eq(before + Cat(one, C(0, 2), is_type | is_upper, is_type.replicate(4))),
            write.data.last.eq(end),
        ]
        m.d.comb += [message_sum.data.eq(octet), i.ready.eq(1)]
        too_short, too_long = Signal(), Signal()  # from the second item on
        m.d.sync += [too_short.eq(~meta.length[_SIZE_BITS:].any()), too_long.eq(meta.length > longest)]
        other_type, busy = Signal(), Signal()
        with m.FSM():
            with m.State("REQUEST"), m.If(i.valid):
                m.d.comb += keep.eq(1)
                with m.If(~end):
                    m.d.comb += message_sum.add.eq(1)
                    m.d.sync += [at.eq(at + 1), before.eq(octet), carry.eq(is_upper & overflows)]
                    with m.If(at == nowhere):
                        m.d.sync += [
                            other_type.eq(octet != icmp.ECHO_REQUEST),
                            busy.eq(is_waiting & is_answered),
                        ]
                        with m.If(meta.group | (is_waiting & is_answered)):
                            m.next = "DROP"
                    with m.Elif(too_short | too_long):
                        m.next = "DROP"
                    with m.Elif(is_type & (octet != 0)):  # a code
                        m.d.sync += other_type.eq(1)
                    with m.If(other_type):
                        m.next = "DROP"
            with m.State("DROP"), m.If(i.valid & end):
                m.next = "REQUEST"
        with m.If(i.valid & end):
            m.d.comb += message_sum.clear.eq(1)
            m.d.sync += [at.eq(nowhere), other_type.eq(0), busy.eq(0)]
            with m.If(i.payload.bad):
                pass
            with m.Elif(other_type):
                m.d.comb += self.drop_type.eq(1)
            with m.Elif(meta.group):
                m.d.comb += self.drop_group.eq(1)
            with m.Elif(too_short | (at == nowhere)):
                m.d.comb += self.drop_length.eq(1)
            with m.Elif(too_long):
                m.d.comb += self.drop_size.eq(1)
            with m.Elif(busy):
                m.d.comb += self.drop_busy.eq(1)
            with m.Elif(~message_sum.right):
                m.d.comb += self.drop_checksum.eq(1)
            with m.Else():
                m.d.sync += [
                    waiting.mac.eq(meta.mac),
                    waiting.source.eq(meta.source),
                    waiting.length.eq(meta.length),
                    is_waiting.eq(1),
                    slot.eq(~slot),
                ]

        # -- replies

        o, read = self.o.stream, messages.read_port()
        reply_slot = Signal()
        following = Signal(slot_bits)
        item = Signal(word)  # since block RAM is slow to show what it has
        m.d.comb += [
            read.addr.eq(Cat(following, reply_slot)),
            read.en.eq(0),
            o.payload.data.eq(item.octet),
            self.o.meta.mac.eq(answered.mac),
            self.o.meta.destination.eq(answered.source),
            self.o.meta.protocol.eq(ipv4.ICMP),
            self.o.meta.length.eq(answered.length),
        ]
        with m.If(read.en):
            m.d.sync += [following.eq(following + 1), item.eq(read.data)]
        with m.FSM():
            with m.State("IDLE"), m.If(is_answered):
                m.d.comb += read.en.eq(1)
                m.next = "FETCH"
            with m.State("FETCH"):
                m.d.comb += read.en.eq(1)
                m.next = "REPLY"
            with m.State("REPLY"):
                m.d.comb += [o.valid.eq(1), read.en.eq(o.ready)]
                with m.If(o.ready & item.last):
                    m.next = "END"
            with m.State("END"):
                m.d.comb += [o.valid.eq(1), o.payload.end.eq(1)]
                with m.If(o.ready):
                    m.d.sync += [following.eq(0), is_answered.eq(0), reply_slot.eq(~reply_slot)]
                    m.next = "IDLE"
        return m
