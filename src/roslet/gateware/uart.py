"""Octets over a serial line of two wires: 8 data bits, no parity, 1 stop bit, the lowest bit first, idle high."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Signal
from amaranth.lib import data, stream, wiring
from amaranth.lib.cdc import FFSynchronizer
from amaranth.lib.wiring import In, Out

BITS = 10
"""Of an octet on the line: start, 8 of data, stop."""

MIN_DIVISOR = 8
"""Cycles of a bit: three samples in the middle of it must be apart, and not near its edges."""

UART_RX = data.StructLayout({"data": 8, "bad": 1})
"""An octet that was received. With `bad` nothing is known of it, nor of how many were there before it."""


def _check(divisor: int) -> None:
    if divisor < MIN_DIVISOR:
        raise ValueError(f"a bit takes {MIN_DIVISOR} cycles at least, not {divisor}")


class UartRx(wiring.Component):
    """Receives octets, each bit in `divisor` cycles.

    Ports: `rx`, the pin, of any clock; `o`, what was received. Each bit is what two of three samples say, one in the middle
    of the bit and one an eighth of it to either side; what is low for less than that is no start bit. The phase is that of
    each start bit's edge, so that the sender's clock may be off by 2.5 %. The next start bit may begin soon after the middle
    of the stop bit.

    An octet is valid a few cycles after the middle of its stop bit, and waits for `o` until the next one is there, one
    octet's time. Held are that and the one that comes.

    Dropped: `drop_framing`, an octet without stop bit, or a break, which is one however long; `drop_overrun`, an octet that
    `o` did not take in time, in whose place the next one stands. In either case the item at `o` is `bad`.
    """

    def __init__(self, divisor: int) -> None:
        _check(divisor)
        self._divisor = divisor
        super().__init__(
            {
                "rx": In(1, init=1),
                "o": Out(stream.Signature(UART_RX)),
                "drop_framing": Out(1),
                "drop_overrun": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        o = self.o
        line = Signal(init=1)
        m.submodules.synchroniser = FFSynchronizer(self.rx, line, init=1)

        middle, apart = self._divisor // 2, self._divisor // 8
        cycle = Signal(range(self._divisor))  # of the bit
        last = Signal()
        m.d.comb += last.eq(cycle == self._divisor - 1)
        m.d.sync += cycle.eq(cycle + 1)
        with m.If(last):
            m.d.sync += cycle.eq(0)

        first, second = Signal(), Signal()
        bit, decided = Signal(), Signal()
        with m.If(cycle == middle - apart):
            m.d.sync += first.eq(line)
        with m.If(cycle == middle):
            m.d.sync += second.eq(line)
        m.d.comb += [
            decided.eq(cycle == middle + apart),
            bit.eq((first & second) | (line & (first | second))),
        ]

        # The start bit goes in first: when it has arrived at the lowest place, the octet is behind it.
        shifted = Signal(BITS - 1)
        with m.If(o.ready):
            m.d.sync += o.valid.eq(0)
        with m.FSM():
            with m.State("IDLE"):
                m.d.sync += [cycle.eq(1), shifted.eq(-1)]
                with m.If(~line):
                    m.next = "BITS"
            with m.State("BITS"), m.If(decided):
                m.d.sync += shifted.eq(Cat(shifted[1:], bit))
                with m.If(~shifted[0]):  # this is the stop bit
                    m.d.sync += [
                        o.valid.eq(1),
                        o.payload.data.eq(shifted[1:]),
                        o.payload.bad.eq(~bit | (o.valid & ~o.ready)),
                    ]
                    m.d.comb += [self.drop_framing.eq(~bit), self.drop_overrun.eq(o.valid & ~o.ready)]
                    m.next = "IDLE"
                    with m.If(~bit):
                        m.next = "BREAK"
                with m.Elif(shifted.all() & bit):  # so it was no start bit
                    m.next = "IDLE"
            with m.State("BREAK"), m.If(line):
                m.next = "IDLE"
        return m


class UartTx(wiring.Component):
    """Sends octets, each bit in `divisor` cycles.

    Ports: `i`, octets; `tx`, the pin, from a register. An octet is taken in the first cycle of its start bit, and the next
    one 10 bits later, so that they go without a gap where they come so. Holds the octet that is being sent.
    """

    def __init__(self, divisor: int) -> None:
        _check(divisor)
        self._divisor = divisor
        super().__init__({"i": In(stream.Signature(8)), "tx": Out(1, init=1)})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        i = self.i
        cycle = Signal(range(self._divisor), init=self._divisor - 1)  # of the bit; idle, it stays at the last
        last = Signal()
        # What is to follow; the stop bit is the only 1 at last, so that none are left when it is out.
        left = Signal(BITS - 1)
        m.d.comb += [last.eq(cycle == self._divisor - 1), i.ready.eq(last & ~left.any())]
        with m.If(~last):
            m.d.sync += cycle.eq(cycle + 1)
        with m.Elif(left.any()):
            m.d.sync += [cycle.eq(0), Cat(self.tx, left).eq(left)]
        with m.Elif(i.valid):
            m.d.sync += [cycle.eq(0), self.tx.eq(0), left.eq(Cat(i.payload, 1))]
        return m
