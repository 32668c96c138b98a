"""IGMP version 2, a host's side: says which groups are joined. RFC 2236."""

from __future__ import annotations

from collections.abc import Mapping

from amaranth.hdl import Array, C, Cat, Module, Mux, Signal, Value
from amaranth.lib import data, memory, wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from roslet.gateware import multicast
from roslet.gateware.checksum import SerialSum
from roslet.gateware.igmp_rx import IgmpRx
from roslet.gateware.meta import ADDRESSES, ETHERNET_TX, IPV4_RX
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
_IGMP = {"type": igmp.REPORT, "max_response": 0}

_ROW = data.StructLayout(
    {"octet": 8, "own": 1, "group": 1, "low": 1, "place": 2, "spell": 1, "add": 1, "clear": 1}
    | {"valid": 1, "end": 1}
)
"""What is done with one octet of a report, which is `octet`, or number `place` of our address or of that of the group, the
latter without its highest bit where `low`. The sum is `spell`ed out in place of it, or `clear`ed, or it is `add`ed. It is
sent where `valid`; `end` is the last row."""
_DEPTH = 64


def _octets(table: tuple[Field, ...], values: Mapping[str, int]) -> list[dict[str, int]]:
    """The rows of a header."""
    rows: list[dict[str, int]] = []
    for field in table:
        for n in range(field.bits // 8):
            if field.name in values:
                rows.append({"octet": values[field.name].to_bytes(field.bits // 8, "big")[n]})
            elif field.name == "checksum":
                rows.append({"spell": 1})
            else:
                rows.append({"own" if field.name == "source" else "group": 1, "place": n})
    return rows


def _program() -> list[dict[str, int]]:
    """The rows of a report. What comes behind the header's checksum is summed before the packet begins, and the group, which
    is in the message as well, to the message's sum as it passes as the destination: so all is summed when a checksum's turn
    has come, whose own octets are zeros to it."""
    header = _octets(ipv4.FIELDS, _IPV4)
    source, group, alert = header[12:16], header[16:], [{"octet": octet} for octet in ROUTER_ALERT]
    hop = [*({"octet": octet} for octet in multicast.PREFIX), {**group[1], "low": 1}, *group[2:]]
    message = _octets(igmp.FIELDS, _IGMP)
    add, clear, valid = {"add": 1}, {"clear": 1}, {"valid": 1}
    sent = [
        *hop,
        *(row | add for row in header[:12]),
        *(row | clear for row in source),
        *(row | add for row in group),
        *alert,
        *(row | add for row in message),
        {"end": 1},
    ]
    return [*(row | add for row in (*source, *group, *alert)), *(row | valid for row in sent)]


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

    `i` is always ready. A report begins 15 cycles after its time has come. `drop_igmp`: see `IgmpRx`.
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

        # When: in `left` ticks, or now where that is negative. While `choosing`, it is any number until it is one that is
        # allowed.
        cycle, noise = Signal(24, init=1), Signal(16, init=1)
        tick = cycle == self._last
        m.d.sync += cycle.eq(Mux(tick, 1, _next(cycle, _CYCLE_TAPS)))
        m.d.sync += noise.eq(_next(noise, _TAPS))
        choosing, over = Signal(), Signal()
        limit = Signal(8, init=RESPONSE)
        left = Signal(13, init=-1)
        repeats = Signal(range(REPEATS + 1))
        m.d.comb += over.eq(left[-1] & ~choosing)
        with m.If(choosing & (left[4:] < limit)):
            m.d.sync += choosing.eq(0)
        with m.Elif(choosing):
            m.d.sync += left.eq((noise ^ self.addresses.mac[-12:])[:12])
        with m.Elif(tick & ~left[-1]):
            m.d.sync += left.eq(left - 1)
        asked = rx.query & self.enable
        again = over & (due == 0) & (repeats != 0)
        m.d.comb += more.eq(Mux(asked, rx.named, valid & again.replicate(self._count)))
        with m.If(again):
            m.d.sync += repeats.eq(repeats - 1)
        with m.If(asked):
            m.d.sync += limit.eq(rx.max_response)
        with m.If(again | (asked & (rx.max_response == 0))):
            m.d.sync += limit.eq(RESPONSE)
        with m.If(asked | again):
            m.d.sync += choosing.eq(1)
        with m.If(joining.any() | (asked & choosing)):
            m.d.sync += [choosing.eq(0), left.eq(-1)]
        with m.If(joining.any()):
            m.d.sync += repeats.eq(REPEATS)

        self._compose(m, over, due, sent)
        return m

    def _compose(self, m: Module, over: Value, due: Value, sent: Value) -> None:
        """Send a report of each group that is `due`, when it is `over`."""
        o = self.o.stream
        m.submodules.sum = total = SerialSum()
        rows = _program()
        m.submodules.program = program = memory.Memory(
            shape=_ROW, depth=_DEPTH, init=rows, attrs={"ram_style": "block"}
        )
        read = program.read_port()
        row, at = Signal(_ROW), Signal(range(_DEPTH))  # that is done, and the number of that which is read
        busy, advance = Signal(), Signal()
        m.d.comb += [
            read.addr.eq(at),
            read.en.eq(advance),
            advance.eq(busy & (~row.valid | o.ready)),
        ]
        with m.If(advance):  # behind the last row there are some that do nothing
            m.d.sync += [at.eq(at + 1), row.eq(read.data)]

        which = Signal(range(self._count))
        group = Array(group.ip for group in self.groups)[which] if self._count > 1 else self.groups[0].ip
        of_group = pick(octets(group), row.place) & Cat(C(-1, 7), ~row.low)
        address = Mux(row.own, pick(octets(Value.cast(self.addresses.ip)), row.place), 0)
        octet = row.octet | address | Mux(row.group, of_group, 0)
        m.d.comb += [
            total.data.eq(octet),
            total.add.eq(advance & row.add),
            total.clear.eq(~busy | row.clear),
            o.payload.data.eq(Mux(row.spell, ~total.result, octet)),
            o.payload.end.eq(row.end),
            o.valid.eq(row.valid),
            self.o.meta.type.eq(ethernet.IPV4),
            sent.eq(Cat(which == n for n in range(len(due))) & (o.ready & row.end).replicate(len(due))),
        ]
        with m.If(busy):
            m.d.sync += busy.eq(~(o.ready & row.end))
        with m.Else():
            m.d.sync += [busy.eq(over & due.any()), at.eq(0), row.eq(0)]
            for n in reversed(range(self._count)):
                with m.If(due[n]):
                    m.d.sync += which.eq(n)
