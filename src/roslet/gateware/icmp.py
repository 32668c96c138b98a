"""ICMP: pings are answered. RFC 792, RFC 1122, 3.2.2.6."""

from __future__ import annotations

from amaranth.hdl import C, Cat, Module, Signal
from amaranth.lib import data, memory, wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.checksum import SerialSum
from roslet.gateware.compare import above
from roslet.gateware.meta import HOP, IPV4_RX, LEAD, lead
from roslet.gateware.octets import pick
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

    Ports: `i`, datagrams of ICMP; `turn`, as `Ipv4Rx` has it; `o`, replies behind their leads (see `meta.lead`), to the
    hosts that asked, by the hardware addresses that the requests came from.

    A reply repeats up to `max_data` octets of data; its checksum is the request's with the type taken out of it (RFC 1624),
    so a wrong request cannot become a right reply. Two requests are held: while one is answered another is taken, so pings
    may come back to back. The first octet of a request waits for the 14 of the reply's lead to be written; throughput then
    an octet a cycle both ways. A reply begins 4 cycles after the end of its request, or after the end of the reply before
    it. The memory has two slots of 2**n octets, the least that is more than lead and longest message, and a bit beside each
    octet.

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
                "turn": Out(1),
                "o": Out(FrameSignature()),
                **{f"drop_{reason}": Out(1) for reason in _DROPS},
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        longest = icmp.SIZE + self._max_data
        slot_bits = (LEAD + longest).bit_length()
        word = data.StructLayout({"octet": 8, "last": 1})
        m.submodules.messages = messages = memory.Memory(shape=word, depth=2 << slot_bits, init=[])
        is_waiting, is_answered = Signal(), Signal()
        with m.If(is_waiting & ~is_answered):
            m.d.sync += [is_answered.eq(1), is_waiting.eq(0)]

        # -- requests: each octet is written, as the reply has it, when the next item is there

        m.submodules.sum = message_sum = SerialSum()
        i, meta, write = self.i.stream, self.i.meta, messages.write_port()
        octet, end = i.payload.data, i.payload.end
        slot = Signal()
        nowhere = (1 << slot_bits) - 1
        at = Signal(slot_bits, init=nowhere)  # where the octet before goes
        before = Signal(8)
        is_type, is_upper, is_lower = Signal(), Signal(), Signal()  # which is the octet before
        # The type goes from 8 to 0, so 8 is added to the upper octet of the checksum (RFC 1624); a carry out of that is
        # one in the lower, and a carry out of this one in the upper again.
        overflows = before[3:].all()
        carry = Signal()
        one = (is_upper & overflows & octet.all()) | (is_lower & carry)
        keep, step, ended = Signal(), Signal(), Signal()
        m.d.sync += [
            write.en.eq(keep),
            write.addr.eq(Cat(at, slot)),
            write.data.octet.eq(before + Cat(one, C(0, 2), is_type | is_upper, is_type.replicate(4))),
            write.data.last.eq(end),
        ]
        m.d.comb += message_sum.data.eq(octet)
        too_short, too_long = Signal(), Signal()  # from the second cycle on
        m.d.sync += [too_short.eq(~meta.length[_SIZE_BITS:].any()), too_long.eq(above(meta.length, longest))]
        other_type, busy = Signal(), Signal()

        # While the destination turns by, in its place what stands behind the source in the lead.
        front = lead(meta.mac, meta.source[:8].replicate(4), ipv4.ICMP, meta.length)
        lead_octet = pick([*front[1:], front[0], front[0]], at[:4])  # of the octet behind that before
        with m.If(step):
            m.d.sync += [
                at.eq(at + 1),
                before.eq(octet),
                carry.eq(is_upper & overflows),
                is_type.eq(at == LEAD + _TYPE - 1),
                is_upper.eq(at == LEAD + _CHECKSUM - 1),
                is_lower.eq(is_upper),
            ]
        m.d.comb += [step.eq(i.valid & i.ready & ~end), message_sum.add.eq(step)]
        full = is_waiting & is_answered
        with m.FSM():
            with m.State("LEAD"), m.If(i.valid):
                m.d.sync += [before.eq(lead_octet), busy.eq(full)]
                with m.If(meta.group | full):
                    m.next = "TYPE"
                with m.Else():
                    m.d.comb += [keep.eq(1), self.turn.eq((at[:4] >= HOP - 1) & ~at[:4].all())]
                    m.d.sync += at.eq(at + 1)
                    with m.If(at == LEAD - 2):
                        m.next = "TYPE"
            with m.State("TYPE"):
                m.d.comb += [i.ready.eq(1), keep.eq(i.valid & ~meta.group & ~busy)]
                with m.If(step):
                    m.d.sync += other_type.eq(octet != icmp.ECHO_REQUEST)
                    m.next = "REQUEST"
                    with m.If(meta.group | busy):
                        m.next = "DROP"
                with m.If(ended):
                    m.next = "LEAD"
            with m.State("REQUEST"):
                m.d.comb += [i.ready.eq(1), keep.eq(i.valid)]
                with m.If(step):
                    with m.If(too_short | too_long | other_type):
                        m.next = "DROP"
                    with m.Elif(is_type & (octet != 0)):  # a code
                        m.d.sync += other_type.eq(1)
                with m.If(ended):
                    m.next = "LEAD"
            with m.State("DROP"):
                m.d.comb += i.ready.eq(1)
                with m.If(ended):
                    m.next = "LEAD"
        m.d.comb += [ended.eq(i.valid & i.ready & end), message_sum.clear.eq(ended)]
        with m.If(ended):
            m.d.sync += at.eq(nowhere)
            m.d.sync += [signal.eq(0) for signal in (is_type, is_upper, is_lower, other_type)]
            with m.If(i.payload.bad):
                pass
            with m.Elif(other_type):
                m.d.comb += self.drop_type.eq(1)
            with m.Elif(meta.group):
                m.d.comb += self.drop_group.eq(1)
            with m.Elif(too_short):
                m.d.comb += self.drop_length.eq(1)
            with m.Elif(too_long):
                m.d.comb += self.drop_size.eq(1)
            with m.Elif(busy):
                m.d.comb += self.drop_busy.eq(1)
            with m.Elif(~message_sum.right):
                m.d.comb += self.drop_checksum.eq(1)
            with m.Else():
                m.d.sync += [is_waiting.eq(1), slot.eq(~slot)]

        # -- replies

        o, read = self.o.stream, messages.read_port()
        reply_slot = Signal()
        following = Signal(slot_bits)
        item = Signal(word)  # since block RAM is slow to show what it has
        m.d.comb += [
            read.addr.eq(Cat(following, reply_slot)),
            read.en.eq(0),
            o.payload.data.eq(item.octet),
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
