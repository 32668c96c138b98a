"""The two halves of a MAC, their frames' limits scaled down so that whole frames and the gap between them fit a proof, and
the frame check sequence.

What goes over the pins is followed by a count of the octets. The check sequence is proved by itself, bit by bit.
"""

from __future__ import annotations

from types import MappingProxyType, SimpleNamespace
from typing import Any

from amaranth.hdl import Assert, Assume, Cat, Const, Cover, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from gateware.formal import Bug, Spec
from roslet.gateware import crc, receiver, transmitter

MIN, MAX, FCS, GAP, PREAMBLE_SIZE = 8, 12, 4, 4, 2
SMALL = SimpleNamespace(
    PREAMBLE=0x55,
    PREAMBLE_SIZE=PREAMBLE_SIZE,
    SFD=0xD5,
    FCS_SIZE=FCS,
    MIN_SIZE=MIN,
    MAX_SIZE=MAX,
    GAP_SIZE=GAP,
)


def saturating(m: Module, count: Signal) -> None:
    """One more in `count`, which stays at its highest."""
    m.d.sync += count.eq(count + ~count.all())


class FrameCheckSpec(Spec):
    """The division of IEEE 802.3, 3.2.9, a) to e), bit by bit, with the coefficients as they are written there."""

    module = crc
    quick, deep = 7, 9
    width = 8
    bugs = (
        Bug("fcs", "0xEDB88320", "0xEDB88321"),
        Bug("match", "0x2144DF1C", "0x2144DF1D"),
    )
    EXPONENTS = (26, 23, 22, 16, 12, 11, 10, 8, 7, 5, 4, 2, 1, 0)

    def block(self) -> Any:
        return self.gates.FrameCheck(self.width)

    def properties(self, m: Module) -> None:
        remainder = Signal(
            32, init=0xFFFF_FFFF
        )  # the highest power in the highest bit; a) by the first 32 bits complemented
        after: list[Value] = list(remainder)
        for n in range(self.width):
            out = after[31] ^ self.dut.data[n]
            shifted = [Const(0), *after[:31]]
            after = [bit ^ out if at in self.EXPONENTS else bit for at, bit in enumerate(shifted)]
        m.d.sync += remainder.eq(Mux(self.dut.clear, 0xFFFF_FFFF, Cat(after)))
        m.d.comb += [
            Assert(self.dut.fcs == Cat(~remainder[31 - n] for n in range(32)), "fcs"),  # e) x^31 goes first
            # The remainder of any frame with its sequence: RFC 1662, C.3, of the same polynomial.
            Assert(self.dut.match == (remainder == 0xC704DD7B), "match"),
            Cover(self.dut.fcs[0], "other"),
        ]


class TransmitterSpec(Spec):
    """Frames on the pins have preamble, legal sizes and gaps, the octets that came, and padding; or they are spoilt."""

    module = transmitter
    constants = MappingProxyType({"ieee802_3": SMALL})
    scale = (("count[:6] == MIN_OCTETS", "count[:3] == MIN_OCTETS"),)
    quick, deep = 26, 44
    width = 8
    bugs = (
        Bug("gap", "ieee802_3.GAP_SIZE - (2 if", "ieee802_3.GAP_SIZE - (3 if"),
        Bug("preamble", "octet.eq(ieee802_3.SFD)", "octet.eq(ieee802_3.PREAMBLE)"),
        Bug(
            "octets",
            "octet.eq(i.payload.data)\n                    with m.If(filled)",
            "octet.eq(i.payload.data | 1)\n                    with m.If(filled)",
        ),
        Bug("padding", "[octet.eq(0), spoilt.eq(i.payload.bad)]", "spoilt.eq(i.payload.bad)"),
        Bug("long_enough", "with m.If(done & filled):", "with m.If(done):"),
        Bug("not_too_long", "count == MAX_OCTETS - 1", "count == MAX_OCTETS"),
        Bug("spoilt", "[octet.eq(0), spoilt.eq(i.payload.bad)]", "[octet.eq(0), spoilt.eq(0)]"),
        Bug("not_spoilt", "[octet.eq(0), spoilt.eq(i.payload.bad)]", "[octet.eq(0), spoilt.eq(1)]"),
        Bug(
            "stops",
            "self.drop_underrun.eq(1)\n                        m.d.sync += [spoilt.eq(1), remains.eq(1)]\n"
            '                        begin("FCS")',
            "self.drop_underrun.eq(1)\n                        m.d.sync += [spoilt.eq(1), remains.eq(1)]",
        ),
        Bug("tx_er", "self.tx_er.eq(checking & spoilt)", "self.tx_er.eq(spoilt)"),
        Bug(
            "whole",
            'with m.If(remains):\n                        m.next = "DROP"',
            'with m.If(0):\n                        m.next = "DROP"',
        ),
    )

    def block(self) -> Any:
        return self.gates.Transmitter(self.width)

    def properties(self, m: Module) -> None:
        i_rules = self.assume(m, "i")
        i, dut = self.dut.i.stream, self.dut

        # What was taken for the frame that is on the pins; the nth octet of it, for any n.
        n = self.steady(m, 4, "n")
        taken, nth, have, ended, wrong = Signal(5), Signal(8), Signal(), Signal(), Signal()
        before, idle, at = Signal(), Signal(4, init=15), Signal(5)
        error = dut.drop_underrun | dut.drop_giant
        with m.If(i_rules.transfer):
            with m.If(i.payload.end):
                m.d.sync += [ended.eq(1), wrong.eq(wrong | i.payload.bad)]
            with m.Else():
                saturating(m, taken)
                with m.If((taken == n) & ~error):
                    m.d.sync += [nth.eq(i.payload.data), have.eq(1)]
        with m.If(error):
            m.d.sync += wrong.eq(1)

        m.d.sync += before.eq(dut.tx_en)
        start, stop = dut.tx_en & ~before, before & ~dut.tx_en
        spoilt, since = Signal(), Signal(4)
        place = at - (PREAMBLE_SIZE + 1)  # in the frame
        inside = dut.tx_en & (at > PREAMBLE_SIZE)
        with m.If(dut.tx_en):
            m.d.sync += [idle.eq(1), spoilt.eq(spoilt | dut.tx_er)]
            saturating(m, at)
            with m.If(wrong):
                saturating(m, since)
        with m.Else():
            saturating(m, idle)
            m.d.sync += [
                at.eq(0),
                taken.eq(0),
                have.eq(0),
                ended.eq(0),
                wrong.eq(0),
                spoilt.eq(0),
                since.eq(0),
            ]
        size = place
        with m.If(start):
            m.d.comb += Assert(idle > GAP, "gap")
        with m.If(dut.tx_en & (at <= PREAMBLE_SIZE)):
            m.d.comb += Assert(dut.txd == Mux(at == PREAMBLE_SIZE, 0xD5, 0x55), "preamble")
        with m.If(inside & (place == n) & have):
            m.d.comb += Assert(dut.txd == nth, "octets")
        with m.If(inside & (place == n) & ended & ~have & ~wrong & (n < MIN - FCS)):
            m.d.comb += Assert(dut.txd == 0, "padding")
        with m.If(stop):
            m.d.comb += [
                Assert(spoilt | (size >= MIN), "long_enough"),
                Assert(spoilt | (size <= MAX), "not_too_long"),
                Assert(~wrong | spoilt, "spoilt"),
                Assert(~spoilt | wrong, "not_spoilt"),
                Assert(since <= FCS + 1, "stops"),
            ]
        m.d.comb += Assert(~dut.tx_er | dut.tx_en, "tx_er")
        # An octet behind a preamble is the first one of a frame, never what is left of one that was spoilt.
        fresh = Signal(init=1)
        with m.If(i_rules.transfer):
            m.d.sync += fresh.eq(i.payload.end)
        with m.If(i_rules.transfer & ~i.payload.end & (taken == 0) & dut.tx_en & (at == PREAMBLE_SIZE - 1)):
            m.d.comb += Assert(fresh, "whole")
        m.d.comb += [
            Cover(stop & ~spoilt & (size == MIN), "shortest"),
            Cover(stop & ~spoilt & (size == MAX), "longest"),
            Cover(stop & spoilt & dut.i.stream.ready, "spoilt_one"),
        ]


class OctetParity(wiring.Component):
    """In the place of FrameCheck, whose proof is apart: how octets are fed to it is to be seen, and that is soon done."""

    def __init__(self, width: int) -> None:
        super().__init__({"clear": In(1), "data": In(8), "fcs": Out(8), "match": Out(1)})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.d.sync += self.fcs.eq(Mux(self.clear, 0, self.fcs ^ self.data))
        m.d.comb += self.match.eq(self.fcs == 0)
        return m


class ReceiverSpec(Spec):
    """A carrier gives one frame with its octets, good only if nothing was wrong with it; and nothing comes of its own."""

    module = receiver
    constants = MappingProxyType({"ieee802_3": SMALL, "FrameCheck": OctetParity})
    scale = (("taken[6:].any()", "taken[3:].any()"),)
    quick, deep = 18, 30
    width = 8
    bugs = (
        Bug("only_in_carrier", 'with m.State("DROP"), m.If(~valid):', 'with m.State("DROP"), m.If(1):'),
        Bug(
            "one_end",
            'end_badly("rx_er")\n                    m.next = "DROP"\n                with m.Elif(whole)',
            'end_badly("rx_er")\n                with m.Elif(whole)',
        ),
        Bug(
            "an_end",
            'if state == "PREAMBLE":\n                            end_badly("sfd")',
            'if state == "PREAMBLE":\n                            pass',
        ),
        Bug(
            "forgotten",
            'if state == "PREAMBLE":\n                            end_badly("sfd")',
            'if state == "PREAMBLE":\n                            m.d.comb += [give.eq(1), item.end.eq(1)]',
        ),
        Bug(
            "error",
            "                with m.Elif(error):\n"
            '                    end_badly("rx_er")\n                    m.next = "DROP"\n'
            "                with m.Elif(whole)",
            "                with m.Elif(whole)",
        ),
        Bug("size", "with m.Elif(~enough):", "with m.Elif(0):"),
        Bug("check", "with m.Elif(~crc.match):", "with m.Elif(0):"),
        Bug("octets", "octet: Value = data", "octet: Value = self.rxd"),
        Bug(
            "o.bad_only_at_end",
            "item.bad.eq(1), item.data",
            "item.bad.eq(1), item.end.eq(valid & ~error), item.data",
        ),
    )

    def block(self) -> Any:
        return self.gates.Receiver(self.width)

    def properties(self, m: Module) -> None:
        dut, o = self.dut, self.dut.o.stream
        rules = self.check(m, "o", waits=False)
        m.d.comb += Assume(o.ready, "ready")

        # The pins as they were when what leaves now was decided.
        valid, error, data = Signal(init=1), Signal(), Signal(8)
        first = [Signal(init=1), Signal(), Signal(8)]
        m.d.sync += [first[0].eq(dut.rx_dv), first[1].eq(dut.rx_er), first[2].eq(dut.rxd)]
        m.d.sync += [valid.eq(first[0]), error.eq(first[1]), data.eq(first[2])]
        before, skipping = Signal(), Signal(init=1)
        done, erred = Signal(), Signal()  # the carrier's end was given; there was an error in it
        m.d.sync += before.eq(valid & ~skipping)
        with m.If(~valid):
            m.d.sync += skipping.eq(0)

        # Its octets, of which the nth, for any n, is kept.
        n = self.steady(m, 4, "n")
        place, nth, inside = Signal(5), Signal(8), Signal()
        with m.If(~valid):
            m.d.sync += [done.eq(0), erred.eq(0), inside.eq(0), place.eq(0)]
        with m.Else():
            m.d.sync += erred.eq(erred | error)
            with m.If(o.valid & o.payload.end):
                m.d.sync += done.eq(1)
            with m.If(data == 0xD5):
                m.d.sync += inside.eq(1)
            with m.If(inside):
                saturating(m, place)
                with m.If(place == n):
                    m.d.sync += nth.eq(data)

        m.submodules.model = model = OctetParity(8)
        m.d.comb += [model.data.eq(data), model.clear.eq(~(valid & inside))]

        good = o.valid & o.payload.end & ~o.payload.bad
        falls = before & ~valid
        with m.If(o.valid):
            m.d.comb += [
                Assert((valid & ~skipping) | falls, "only_in_carrier"),
                Assert(~done, "one_end"),
            ]
        with m.If(falls):
            m.d.comb += Assert(done | (o.valid & o.payload.end), "an_end")
        with m.If(good):
            m.d.comb += [
                Assert(falls & inside, "forgotten"),
                Assert(~erred, "error"),
                Assert(model.match, "check"),
                Assert((place >= MIN) & (place <= MAX) & (rules.taken + FCS == place), "size"),
            ]
        with m.If(o.valid & ~o.payload.end & (rules.taken == n)):
            m.d.comb += Assert(o.payload.data == nth, "octets")
        m.d.comb += [
            Cover(good & (place == MIN), "shortest"),
            Cover(good & (place == MAX), "longest"),
            Cover(o.valid & o.payload.bad & (place == MAX), "giant"),
        ]


SPECS: tuple[type[Spec], ...] = (FrameCheckSpec, TransmitterSpec, ReceiverSpec)
