"""IGMP version 2, a host's side: says which groups are joined. RFC 2236."""

from __future__ import annotations

from collections.abc import Mapping

from amaranth.hdl import Array, Cat, Const, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from roslet.gateware import multicast
from roslet.gateware.checksum import SerialSum
from roslet.gateware.header import wire_order
from roslet.gateware.igmp_rx import IgmpRx
from roslet.gateware.meta import ADDRESSES, ETHERNET_TX, HOP, IPV4_RX
from roslet.gateware.octets import octets, pick
from roslet.gateware.stream import FrameSignature
from roslet.wire.fields import Field
from roslet.wire.net import ethernet, igmp, ipv4

TICKS = 160
"""A second: 16 to the tenth of a second in which delays are given, so that they differ more finely than that."""

RESPONSE = 100
"""Tenths of a second: Unsolicited Report Interval (RFC 2236, 8.10), Query Response Interval of version 1 (8.3, and 4)."""

REPEATS = 2
"""How often the first report of a group is repeated, lest it was lost: "once or twice", RFC 2236, 3."""

ROUTER_ALERT = bytes((0x94, 0x04, 0x00, 0x00))
"""RFC 2113, 2.1."""

_TAPS = 0xB400
"""x^16 + x^14 + x^13 + x^11 + 1, which is primitive: all states but 0 follow one another."""

_CYCLE_TAPS = 0xE10000
"""x^24 + x^23 + x^22 + x^17 + 1, likewise: it counts cycles without a carry."""

HEADER = ipv4.SIZE + len(ROUTER_ALERT)
_IPV4 = {
    "version_ihl": 4 << 4 | HEADER // 4,
    "dscp_ecn": 0,
    "total_length": HEADER + igmp.SIZE,
    "identification": 0,
    "flags_fragment": ipv4.DONT_FRAGMENT,
    "ttl": 1,  # RFC 2236, 2
    "protocol": ipv4.IGMP,
}
_SOURCE = next(field.offset for field in ipv4.FIELDS if field.name == "source")
_CHECKSUMS = 5
"""Bits 3 to 1 of the places of both checksums, 10 and 26, and of no other."""

_IGMP = {"type": igmp.REPORT, "max_response": 0}


def _fields(table: tuple[Field, ...], values: Mapping[str, int | Value]) -> list[Value]:
    """The fields of a header, as they lie on the wire."""
    return [
        wire_order(field, Const(value, field.bits) if isinstance(value, int) else value)
        for field in table
        for value in (values[field.name],)
    ]


def _next(state: Value, taps: int) -> Value:
    """What follows a state of a shift register with feedback."""
    return (state >> 1) ^ Mux(state[0], taps, 0)


class Igmp(wiring.Component):
    """Reports the `groups` that are joined, `count` of them, when they are and when a router asks.

    Ports: `i`, messages that came (IPV4_RX of protocol IGMP); `o`, whole IPv4 packets, for EthernetTx, to the group itself,
    with the router alert option and a TTL of 1, without a pause within one; `groups`, each steady while it is valid;
    `addresses`, steady while `enable` is high.

    A group is reported at once when it becomes valid, or `enable` rises, and again twice, each time some random time later,
    up to 10 s. A query, of all or of one, is answered after a random time up to what it allows, or 10 s where it says 0 as
    those of version 1 do; a later query while one waits takes another only if what is left is more than it allows (RFC
    2236, 3), and one that comes while a time is being chosen, which takes as many cycles as numbers that are too large come
    before, is answered at once. One time is kept for all groups: those that are to be reported then go out one after
    another. Random times are by a shift register and the last octets of the hardware address, in steps of 1/160 s of
    `clock_hz`.

    224.0.0.1 must not be among the groups: nobody reports it. Not there: suppression of a report when another host's is
    heard, which IGMPv3 gave up (RFC 3376, A.2) and switches that snoop do without; leave messages, as `enable` and `valid`
    stay high; and the older and newer versions: a query of either is answered with a report of version 2.

    `i` is always ready. A report begins 13 cycles after its time has come. `drop_igmp`: see `IgmpRx`.
    """

    def __init__(self, clock_hz: int, count: int = 1) -> None:
        if clock_hz < TICKS:
            raise ValueError(f"a clock has at least {TICKS} Hz here, not {clock_hz}")
        if count < 1:
            raise ValueError(f"IGMP is for at least one group, not {count}")
        if clock_hz // TICKS >= 1 << 24:
            raise ValueError(f"a clock has less than {TICKS << 24} Hz here, not {clock_hz}")
        self._last = 1  # what `cycle` is in the last cycle of a tick
        for _ in range(clock_hz // TICKS - 1):
            self._last = self._last >> 1 ^ (_CYCLE_TAPS if self._last & 1 else 0)
        self._count = count
        super().__init__(
            {
                "i": In(FrameSignature(IPV4_RX)),
                "o": Out(FrameSignature(ETHERNET_TX)),
                "addresses": In(ADDRESSES),
                "groups": In(multicast.groups(count)),
                "enable": In(1),
                "drop_igmp": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.rx = rx = IgmpRx(self._count)
        connect(m, flipped(self.i), rx.i)
        m.d.comb += [rx.groups.eq(self.groups), self.drop_igmp.eq(rx.drop_igmp)]

        due, joined = Signal(self._count), Signal(self._count)
        sent = Signal(self._count)  # high for one cycle
        more = Signal(self._count)
        valid = Cat(group.valid & self.enable for group in self.groups)
        joining = valid & ~joined
        m.d.sync += [joined.eq(valid), due.eq((due & ~sent | more | joining) & valid)]

        # When: `left` ticks from now while `running`. `choosing` takes a random number of those that are allowed.
        cycle, noise = Signal(24, init=1), Signal(16, init=1)
        tick = cycle == self._last
        m.d.sync += cycle.eq(Mux(tick, 1, _next(cycle, _CYCLE_TAPS)))
        m.d.sync += noise.eq(_next(noise, _TAPS))
        running, choosing = Signal(), Signal()
        limit = Signal(8)
        delay = Signal(12)
        left = Signal(12)
        repeats = Signal(range(REPEATS + 1))
        m.d.comb += delay.eq(noise ^ self.addresses.mac[-12:])
        with m.If(running & tick & (left != 0)):
            m.d.sync += left.eq(left - 1)
        with m.If(choosing):
            within = Mux(running, left, delay)[4:] < limit
            m.d.sync += [running.eq(within), choosing.eq(~within)]
            with m.If(~running):
                m.d.sync += left.eq(delay)
        over = running & (left == 0)
        asked = rx.query & self.enable
        again = over & (due == 0) & (repeats != 0)
        with m.If(over & (due == 0)):
            m.d.sync += running.eq(0)
        with m.If(again):
            m.d.sync += repeats.eq(repeats - 1)
        m.d.comb += more.eq(Mux(asked, rx.named, valid & again.replicate(self._count)))
        with m.If(asked | again):
            m.d.sync += choosing.eq(1)
            m.d.sync += limit.eq(Mux(asked & (rx.max_response != 0), rx.max_response, RESPONSE))
        with m.If(joining.any() | (asked & choosing)):
            m.d.sync += [running.eq(1), left.eq(0)]
        with m.If(joining.any()):
            m.d.sync += repeats.eq(REPEATS)

        self._compose(m, over, due, sent)
        return m

    def _compose(self, m: Module, over: Value, due: Value, sent: Value) -> None:
        """Send a report of each group that is `due`, when it is `over`."""
        o = self.o.stream
        m.submodules.sum = total = SerialSum()
        which = Signal(range(self._count))
        group = Array(group.ip for group in self.groups)[which] if self._count > 1 else self.groups[0].ip
        at = Signal(range(HEADER + igmp.SIZE + HOP))  # the destination of the frame is last, and sent first

        # The checksums' own octets are summed as zeros. The group is added to the message's sum as it passes as the
        # destination: so all is summed when that checksum's turn has come.
        fields = [
            *_fields(
                ipv4.FIELDS,
                {**_IPV4, "checksum": 0, "source": Value.cast(self.addresses.ip), "destination": group},
            ),
            Const(multicast.number(ROUTER_ALERT), 32),
            *_fields(igmp.FIELDS, {**_IGMP, "checksum": 0, "group": group}),
            multicast.hardware_address(group),
        ]
        octet = pick(octets(Cat(fields)), at)
        spelling = (at[1:4] == _CHECKSUMS) & ~at[5]
        in_source, in_alert = (at[2:] == n // 4 for n in (_SOURCE, ipv4.SIZE))
        m.d.comb += [
            total.data.eq(octet),
            o.payload.data.eq(Mux(spelling, ~total.result, octet)),
            self.o.meta.type.eq(ethernet.IPV4),
        ]
        with m.FSM():
            with m.State("IDLE"):
                m.d.comb += total.clear.eq(1)
                m.d.sync += at.eq(_SOURCE)
                for n in reversed(range(self._count)):
                    with m.If(due[n]):
                        m.d.sync += which.eq(n)
                with m.If(over & due.any()):
                    m.next = "ADDRESSES"
            # What comes after the header's checksum is summed before the packet begins.
            with m.State("ADDRESSES"):
                m.d.comb += total.add.eq(1)
                m.d.sync += at.eq(at + 1)
                with m.If(at == HEADER - 1):
                    m.d.sync += at.eq(HEADER + igmp.SIZE)
                    m.next = "SEND"
            with m.State("SEND"):
                m.d.comb += [o.valid.eq(1), total.clear.eq(in_source)]
                m.d.comb += total.add.eq(o.ready & ~in_alert & ~at[5])
                with m.If(o.ready):
                    m.d.sync += at.eq(at + 1)
                    with m.If(at == HEADER + igmp.SIZE + HOP - 1):
                        m.d.sync += at.eq(0)
                    with m.If(at == HEADER + igmp.SIZE - 1):
                        m.next = "END"
            with m.State("END"):
                m.d.comb += [
                    o.valid.eq(1),
                    o.payload.end.eq(1),
                    sent.eq(Cat(which == n for n in range(len(due))) & o.ready.replicate(len(due))),
                ]
                with m.If(o.ready):
                    m.next = "IDLE"
