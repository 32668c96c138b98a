"""IP packets over a line of octets: SLIP, RFC 1055."""

from __future__ import annotations

from typing import Any

from amaranth.hdl import Module, Mux, Signal
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from roslet.gateware.drops import drop_outputs
from roslet.gateware.fifo import FrameStage, WholeFrameFifo
from roslet.gateware.stream import FrameSignature
from roslet.gateware.uart import UART_RX, UartRx, UartTx
from roslet.wire.net import ethernet, slip


class SlipRx(wiring.Component):
    """Takes packets out of octets.

    Ports: `i`, octets of a line; `o`, packets of up to `max_size` octets, of which none is empty.

    Throughput one octet a cycle, without a register: an octet is at `o` in the cycle in which it comes, and `i` waits only
    for `o`. Holds nothing but a count.

    Dropped, and counted when it is seen: `drop_line`, a bad octet; `drop_escape`, an ESC that neither ESC_END nor ESC_ESC
    follows; `drop_too_long`. What `o` has of such a packet ends badly at once, and nothing is taken until END has come.
    """

    def __init__(self, max_size: int = ethernet.MTU) -> None:
        if max_size < 1:
            raise ValueError(f"a packet has at least one octet, so no limit is {max_size}")
        self._max_size = max_size
        super().__init__(
            {
                "i": In(stream.Signature(UART_RX)),
                "o": Out(FrameSignature()),
                "drop_line": Out(1),
                "drop_escape": Out(1),
                "drop_too_long": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        i, o = self.i, self.o.stream
        octet = i.payload.data
        is_end, is_escape = Signal(), Signal()
        m.d.comb += [is_end.eq((octet == slip.END) & ~i.payload.bad), is_escape.eq(octet == slip.ESC)]
        count = Signal(range(self._max_size + 1))  # octets that `o` has of this packet
        begun = count != 0
        moved = Signal()
        m.d.comb += moved.eq(i.valid & i.ready)

        def take() -> None:
            """The octet at hand is one of the packet, or too many."""
            with m.If(count == self._max_size):
                drop(self.drop_too_long)
            with m.Else():
                m.d.comb += [o.valid.eq(i.valid), i.ready.eq(o.ready)]
                with m.If(moved):
                    m.d.sync += count.eq(count + 1)
                    m.next = "DATA"

        def drop(reason: Signal, until: str = "DROP") -> None:
            finish(bad=1)
            m.d.comb += reason.eq(moved)
            with m.If(moved):
                m.next = until

        def finish(bad: int) -> None:
            m.d.comb += [
                o.valid.eq(i.valid & begun),
                i.ready.eq(o.ready | ~begun),
                o.payload.end.eq(1),
                o.payload.bad.eq(bad),
            ]
            with m.If(moved):
                m.d.sync += count.eq(0)

        m.d.comb += o.payload.data.eq(octet)
        with m.FSM(init="DATA"):
            with m.State("DATA"):
                with m.If(i.payload.bad):
                    drop(self.drop_line)
                with m.Elif(is_end):
                    finish(bad=0)
                with m.Elif(is_escape):
                    m.d.comb += i.ready.eq(1)
                    with m.If(moved):
                        m.next = "ESCAPED"
                with m.Else():
                    take()
            with m.State("ESCAPED"):
                m.d.comb += o.payload.data.eq(Mux(octet[0], slip.ESC, slip.END))
                with m.If(i.payload.bad):
                    drop(self.drop_line)
                with m.Elif(is_end):
                    drop(self.drop_escape, until="DATA")
                with m.Elif((octet != slip.ESC_END) & (octet != slip.ESC_ESC)):
                    drop(self.drop_escape)
                with m.Else():
                    take()
            with m.State("DROP"):
                m.d.comb += i.ready.eq(1)
                with m.If(moved & is_end):
                    m.next = "DATA"
        return m


class SlipTx(wiring.Component):
    """Makes octets of packets, each with END on both sides.

    Ports: `i`, packets; `o`, octets of a line.

    A line cannot take back what it has sent, and no octet that would follow makes every receiver forget a packet: what
    spoils its checksum stands in the middle of it, its length may have been reached, and the receiver of RFC 1055 makes data
    of a wrong escape. So only whole packets are sent: they are held until their good end has come, in a memory of `depth`
    items (a power of two), an item being an octet or an end. It is filled in a small part of the time that the line takes,
    and what else wants to send need not wait for the line meanwhile.

    An octet takes two cycles at least. Packets that end badly leave nothing; `drop_too_long`, one of `depth` octets or more.
    """

    def __init__(self, depth: int = 2048) -> None:
        self._queue = WholeFrameFifo(depth)
        super().__init__({"i": In(FrameSignature()), "o": Out(stream.Signature(8)), "drop_too_long": Out(1)})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.queue = queue = self._queue
        connect(m, flipped(self.i), queue.i)
        m.submodules.stage = stage = FrameStage()  # what block RAM gives is late for what is done with it
        connect(m, queue.o, stage.i)
        m.d.comb += self.drop_too_long.eq(queue.drop_too_long)
        item, o = stage.o.stream, self.o
        is_end, is_escape = Signal(), Signal()
        m.d.comb += [
            is_end.eq(item.payload.data == slip.END),
            is_escape.eq(item.payload.data == slip.ESC),
            o.valid.eq(item.valid),
        ]
        with m.FSM():
            with m.State("BEGIN"):
                m.d.comb += o.payload.eq(slip.END)
                with m.If(o.valid & o.ready):
                    m.next = "DATA"
            with m.State("DATA"):
                with m.If(item.payload.end):
                    m.d.comb += [o.payload.eq(slip.END), item.ready.eq(o.ready)]
                    with m.If(o.valid & o.ready):
                        m.next = "BEGIN"
                with m.Elif(is_end | is_escape):
                    m.d.comb += o.payload.eq(slip.ESC)
                    with m.If(o.valid & o.ready):
                        m.next = "ESCAPED"
                with m.Else():
                    m.d.comb += [o.payload.eq(item.payload.data), item.ready.eq(o.ready)]
            with m.State("ESCAPED"):
                m.d.comb += [o.payload.eq(Mux(is_end, slip.ESC_END, slip.ESC_ESC)), item.ready.eq(o.ready)]
                with m.If(o.valid & o.ready):
                    m.next = "DATA"
        return m


class SlipLink(wiring.Component):
    """Packets between `sync` and a serial line, each bit of which takes `divisor` cycles: what a MAC is to Ethernet.

    Ports: `uart_rx` and `uart_tx`, the pins; `rx` gives IP packets of up to `max_size` octets, and `tx` takes those of fewer
    than `tx_depth`: it is held in a memory of so many items until it is whole (see `SlipTx`, and there for packets that end
    badly). `rx` must be taken within one octet's time, 10 * `divisor` cycles, or its packet ends badly. For one cycle are
    high, as `UartRx`, `SlipRx` and `SlipTx` have them: `drop_uart_framing drop_uart_overrun drop_rx_line drop_rx_escape
    drop_rx_too_long drop_tx_too_long`. `drop_rx_line` is the packet that a fault of `drop_uart_*` has spoilt.
    """

    def __init__(self, divisor: int, max_size: int = ethernet.MTU, tx_depth: int = 2048) -> None:
        self._tx_line = UartTx(divisor)
        self._blocks: dict[str, Any] = {
            "uart": UartRx(divisor),
            "rx": SlipRx(max_size),
            "tx": SlipTx(tx_depth),
        }
        self._drops = drop_outputs(self._blocks)
        super().__init__(
            {
                "uart_rx": In(1, init=1),
                "uart_tx": Out(1, init=1),
                "rx": Out(FrameSignature()),
                "tx": In(FrameSignature()),
                **{name: Out(1) for name in self._drops},
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        uart, rx, tx = self._blocks.values()
        m.submodules += [uart, rx, tx, self._tx_line]
        connect(m, uart.o, rx.i)
        connect(m, rx.o, flipped(self.rx))
        connect(m, flipped(self.tx), tx.i)
        connect(m, tx.o, self._tx_line.i)
        m.d.comb += [uart.rx.eq(self.uart_rx), self.uart_tx.eq(self._tx_line.tx)]
        for name, (block, output) in self._drops.items():
            m.d.comb += getattr(self, name).eq(getattr(self._blocks[block], output))
        return m
