"""UDP, received and sent. RFC 768.

The checksum runs over a pseudo-header (addresses, protocol, length), the header and the data. It is summed here octet by
octet in two columns, one of even octets and one of odd: the carry out of one belongs to the other, whose turn comes next, so
that eight bits of adder do for sixteen of sum.
"""

from __future__ import annotations

from collections.abc import Sequence

from amaranth.hdl import C, Cat, Module, Mux, Signal, Value
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.meta import ADDRESSES, IPV4_RX, UDP_RX, UDP_TX, lead
from roslet.gateware.octets import octets, pick
from roslet.gateware.stream import FrameSignature
from roslet.wire.net import ipv4, udp

_NUMBERS = [field for field in udp.FIELDS if field.name != "checksum"]
"""The header's fields before the checksum: two ports and the length, in the order of the wire."""


def _add(left: Value, right: Value, carry: Value) -> Value:
    """The sum with a carry in, and the carry out above it; as one adder, which three summands would not be."""
    return (Cat(C(1, 1), left) + Cat(carry, right))[1:]


class UdpRx(wiring.Component):
    """Takes the UDP header off each datagram, and judges it.

    Ports: `i`, what IPv4 datagrams of protocol UDP carry; `o`, the data of UDP datagrams; `turn`, as `Ipv4Rx` has it.

    Throughput one octet a cycle: `i` waits only for `o`. The eight octets of the header give nothing; data pass without a
    register, in the cycle in which they come. Octets beyond the length in the header are taken and give nothing. Holds the
    numbers of the header and the sum.

    A bad end is passed on, as a bad end. So is a good end where

    - `drop_length`: fewer octets came than the header's length says,
    - `drop_checksum`: there is a checksum (it is not zero) and it is wrong;

    a datagram that ends within its header, or whose length is less than the header's, gives nothing at all, and is counted
    by `drop_length` if its end is good.
    """

    def __init__(self) -> None:
        super().__init__(
            {
                "i": In(FrameSignature(IPV4_RX)),
                "o": Out(FrameSignature(UDP_RX)),
                "turn": Out(1),
                "drop_length": Out(1),
                "drop_checksum": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        i, o = self.i.stream, self.o.stream
        octet = i.payload.data
        taken = Signal()  # an octet of the header, or of data within the length
        ended = Signal()
        m.d.comb += ended.eq(i.valid & i.ready & i.payload.end)

        # The last octet shifted in is the lowest, so the first field is the highest.
        numbers = Signal(data.StructLayout({field.name: field.bits for field in reversed(_NUMBERS)}))
        at = Signal(range(udp.SIZE))
        length = Signal(16)
        m.d.comb += length.eq(Cat(numbers.length[:3], numbers.length[3:] - 1))  # less udp.SIZE, 8
        count = Signal(16, init=udp.SIZE)  # octets, of header and data
        following = Signal(16)
        m.d.comb += following.eq(count + 1)
        full = Signal()  # all octets within the length have come

        in_header = Signal()
        any_checksum = Signal()
        right = self._sum(m, octet, taken, ended, in_header, count[0])
        m.d.comb += self.turn.eq(taken & in_header)

        m.d.comb += [
            self.o.meta.mac.eq(self.i.meta.mac),
            self.o.meta.source.eq(self.i.meta.source),
            self.o.meta.destination.eq(self.i.meta.destination),
            self.o.meta.group.eq(self.i.meta.group),
            self.o.meta.source_port.eq(numbers.source_port),
            self.o.meta.destination_port.eq(numbers.destination_port),
            self.o.meta.length.eq(length),
            o.payload.data.eq(octet),
            o.payload.end.eq(i.payload.end),
        ]
        checksum = next(field.offset for field in udp.FIELDS if field.name == "checksum")
        with m.FSM():
            with m.State("HEADER"):
                m.d.comb += [i.ready.eq(1), in_header.eq(1), taken.eq(i.valid & ~i.payload.end)]
                m.d.comb += self.drop_length.eq(ended & ~i.payload.bad)
                with m.If(taken):
                    m.d.sync += at.eq(at + 1)
                    with m.If(at < checksum):
                        m.d.sync += numbers.eq(Cat(octet, numbers))
                    with m.Elif(octet != 0):
                        m.d.sync += any_checksum.eq(1)
                    with m.If(at == udp.SIZE - 1):
                        m.next = "DATA"
                        m.d.sync += full.eq(numbers.length == udp.SIZE)
                        with m.If(numbers.length[3:] == 0):
                            m.next = "DROP"
            with m.State("DATA"):
                m.d.comb += taken.eq(i.valid & i.ready & ~i.payload.end & ~full)
                with m.If(i.payload.end):
                    wrong = any_checksum & ~right
                    m.d.comb += [
                        o.valid.eq(i.valid),
                        i.ready.eq(o.ready),
                        o.payload.bad.eq(i.payload.bad | ~full | wrong),
                        self.drop_length.eq(ended & ~i.payload.bad & ~full),
                        self.drop_checksum.eq(ended & ~i.payload.bad & full & wrong),
                    ]
                with m.Else():
                    m.d.comb += [o.valid.eq(i.valid & ~full), i.ready.eq(o.ready | full)]
                with m.If(taken):
                    m.d.sync += [count.eq(following), full.eq(following == numbers.length)]
                with m.If(ended):
                    m.next = "HEADER"
            with m.State("DROP"):
                m.d.comb += [i.ready.eq(1), self.drop_length.eq(ended & ~i.payload.bad)]
                with m.If(ended):
                    m.next = "HEADER"
        with m.If(ended):
            m.d.sync += [at.eq(0), count.eq(udp.SIZE), any_checksum.eq(0)]
        return m

    def _sum(
        self, m: Module, octet: Value, taken: Value, ended: Value, in_header: Value, odd: Value
    ) -> Value:
        """Whether the sum over pseudo-header, header and data taken is right.

        Beside each octet of the header goes one of the addresses, which turn. The length of the pseudo-header is the number
        of octets if the datagram is right, so it need not wait to be known: it is counted, 1 an octet of data, in the odd
        column.
        """
        column, other = Signal(8), Signal(8, init=ipv4.UDP + udp.SIZE)  # even, odd at the beginning
        carry, carry_beside = Signal(), Signal()
        beside = Mux(in_header, self.i.meta.source[:8], Cat(C(0, 1), odd))
        with_beside = _add(octet, beside, carry_beside)
        total = _add(column, with_beside[:8], carry)
        with m.If(ended):
            m.d.sync += [
                signal.eq(Value.cast(signal.init)) for signal in (column, other, carry, carry_beside)
            ]
        with m.Elif(taken):
            m.d.sync += [column.eq(other), Cat(other, carry).eq(total), carry_beside.eq(with_beside[8])]
        # All ones, once the carries have been added, and the 1 for an odd last octet, whose column's turn it is.
        right: Value = (other == 0xFF) & (column[2:] == 0x3F)
        return right & ((column[:2] + carry + carry_beside + odd)[:3] == 3)


class UdpTx(wiring.Component):
    """Puts a UDP header before each datagram.

    Ports: `i`, the data of UDP datagrams; `o`, what IPv4 datagrams carry, behind its lead (see `meta.lead`); `addresses`, of
    which `ip` goes into the checksum.

    A checksum is always sent, never zero. The lead begins with the first item of `i`, which then waits until the header is
    out: this begins 6 cycles behind the lead, and pauses for 4 before its checksum; the data pass without a register, one
    octet a cycle. `i.meta.length` and `i.meta.sum` are taken as they are: who sends octets that they do not fit sends a
    datagram that its receiver will drop. A frame whose end is bad has a bad end. Holds sum and length; drops nothing.
    """

    def __init__(self) -> None:
        super().__init__(
            {
                "i": In(FrameSignature(UDP_TX)),
                "o": Out(FrameSignature()),
                "addresses": In(ADDRESSES),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        i, o = self.i.stream, self.o.stream
        meta = self.i.meta
        length = Signal(16)  # from the second cycle of a frame on
        m.d.sync += length.eq(Cat(meta.length[:3], meta.length[3:] + 1))  # and udp.SIZE, 8
        numbers = {**{name: meta[name] for name in ("source_port", "destination_port")}, "length": length}
        header = [octet for field in _NUMBERS for octet in (numbers[field.name][8:], numbers[field.name][:8])]

        # What goes out and what is summed, in one row: behind the lead, which is the end of the pseudo-header, what is only
        # summed; the header's numbers; all ones, so that the carries come to rest; and at the beginning the checksum, as the
        # row begins anew with it.
        column, other = Signal(8), Signal(8)
        front = lead(meta.mac, meta.destination, ipv4.UDP, length)
        silent = [*octets(self.addresses.ip), meta.sum[8:], meta.sum[:8]]
        row = [column, column, *front, *silent, *header, *[C(0xFF, 8)] * 4]
        begin = 2
        at = Signal(range(len(row)), init=begin)
        octet = Signal(8)
        m.d.comb += octet.eq(pick(row, at))
        assert (begin + len(front), len(row) - 4 - len(header), len(row)) == (16, 22, 32)
        given = ~at[4] | Mux(at[3], ~at[2], at[2] & at[1])  # goes out: 0 to 15, 22 to 27

        # Complements are summed, of all behind the hardware address: so the sum is the checksum. Once not all zeros, as from
        # the first of a zero on, it never becomes so, and a checksum of zero is sent as all ones by itself.
        carry = Signal()
        step = Signal()
        m.d.comb += [
            o.payload.data.eq(octet),
            step.eq(i.valid & (o.ready | ~given)),
        ]
        with m.FSM() as fsm:
            with m.State("HEADER"):
                m.d.comb += o.valid.eq(i.valid & given)
                with m.If(step):
                    m.d.sync += at.eq(at + 1)
                    m.d.sync += [column.eq(other), Cat(other, carry).eq(_add(column, ~octet, carry))]
                    with m.If(at == begin - 1):
                        m.next = "DATA"
            with m.State("DATA"):
                m.d.comb += [o.payload.eq(i.payload), o.valid.eq(i.valid), i.ready.eq(o.ready)]
                with m.If(i.valid & o.ready & i.payload.end):
                    m.next = "HEADER"
        with m.If(fsm.ongoing("DATA") | (at[1:].any() & ~at[3:].any())):  # before and in the hardware address
            m.d.sync += [column.eq(0), other.eq(0), carry.eq(0)]
        return m


class PortSwitch(wiring.Component):
    """Gives each datagram to the output of its destination port.

    Port n goes to output `outputs[n]`, or, where `outputs` is a number, to output n of so many. Ports: `i`; `port0` ..,
    steady port numbers; `o0` ... Of equal ports the first gets all.

    Throughput one octet a cycle, without a register; each datagram waits one cycle, in which its port is compared. One to
    no such port is dropped whole, with no output waited for, and counted by `drop_port` if its end is good.
    """

    def __init__(self, outputs: int | Sequence[int]) -> None:
        self._outputs = list(range(outputs)) if isinstance(outputs, int) else list(outputs)
        if sorted(set(self._outputs)) != list(range(max(self._outputs, default=-1) + 1)) or not self._outputs:
            raise ValueError(f"a switch has at least one output, and each a port, not {outputs}")
        super().__init__(
            {
                "i": In(FrameSignature(UDP_RX)),
                **{f"port{n}": In(16) for n in range(len(self._outputs))},
                **{f"o{n}": Out(FrameSignature(UDP_RX)) for n in set(self._outputs)},
                "drop_port": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        i = self.i.stream
        compared = Signal()
        taken: Value = ~compared  # or by an output before
        with m.If(~compared):
            m.d.sync += compared.eq(i.valid)
        with m.Elif(i.valid & i.ready & i.payload.end):
            m.d.sync += compared.eq(0)
        for n in sorted(set(self._outputs)):
            o = getattr(self, f"o{n}")
            ports = [getattr(self, f"port{k}") for k, output in enumerate(self._outputs) if output == n]
            same = Signal(name=f"same{n}")
            m.d.sync += same.eq(Cat(self.i.meta.destination_port == port for port in ports).any())
            here = same & ~taken
            m.d.comb += [
                o.stream.payload.eq(i.payload),
                o.meta.eq(self.i.meta),
                o.stream.valid.eq(i.valid & here),
            ]
            with m.If(here):
                m.d.comb += i.ready.eq(o.stream.ready)
            taken = taken | here
        with m.If(~taken):  # DROP
            m.d.comb += [i.ready.eq(1), self.drop_port.eq(i.valid & i.payload.end & ~i.payload.bad)]
        return m
