"""Sends a text by UDP now and then, and shows by LEDs how long a datagram it received.

This is the user's part, with the two memories: its ports are those that the node has for them, seen from the other side. The
manual's example udp-tx-rx does the same.
"""

from __future__ import annotations

from amaranth.hdl import Module, Signal
from amaranth.lib import memory, wiring
from amaranth.lib.wiring import In, Out

TEXT = b"UDP Send Test\n"
LENGTHS = (1, 5, 10, 15)
"""Each LED shines for a datagram of at least so many octets. On the Arty A7 they are LD4 to LD7."""


def datagram(address: str, source_port: int, destination_port: int, text: bytes) -> list[int]:
    """The words of a memory from which it is sent."""
    octets = bytes(map(int, address.split(".")))
    octets += b"".join(n.to_bytes(2, "little") for n in (destination_port, source_port, len(text), 0)) + text
    return [int.from_bytes(octets[n : n + 4], "little") for n in range(0, len(octets), 4)]


class UdpTxRx(wiring.Component):
    """Sends TEXT to port 1234 of 192.168.1.10, from port 1234, every `period` cycles; `led` as LENGTHS says.

    What is due while an earlier one is on its way is sent once, when that has gone.
    """

    def __init__(self, period: int, address_width: int = 6) -> None:
        self._period = period
        self._words = 1 << address_width
        super().__init__(
            {
                "udp_txbuf_addr": In(address_width),
                "udp_txbuf_ce": In(1),
                "udp_txbuf_rdata": Out(32),
                "udp_txbuf_rel": Out(1),
                "udp_txbuf_grant": In(1),
                "udp_rxbuf_addr": In(address_width),
                "udp_rxbuf_ce": In(1),
                "udp_rxbuf_we": In(1),
                "udp_rxbuf_wdata": In(32),
                "udp_rxbuf_rel": Out(1),
                "udp_rxbuf_grant": In(1),
                "led": Out(len(LENGTHS)),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        self._send(m)
        self._receive(m)
        return m

    def _send(self, m: Module) -> None:
        words = datagram("192.168.1.10", 1234, 1234, TEXT)
        m.submodules.txbuf = txbuf = memory.Memory(shape=32, depth=self._words, init=words)
        read = txbuf.read_port()
        m.d.comb += [
            read.addr.eq(self.udp_txbuf_addr),
            read.en.eq(self.udp_txbuf_ce),
            self.udp_txbuf_rdata.eq(read.data),
        ]
        cycles = Signal(range(self._period))
        due = Signal()
        m.d.comb += self.udp_txbuf_rel.eq(due & self.udp_txbuf_grant)
        with m.If(self.udp_txbuf_rel):
            m.d.sync += due.eq(0)
        m.d.sync += cycles.eq(cycles + 1)
        with m.If(cycles == self._period - 1):
            m.d.sync += [cycles.eq(0), due.eq(1)]

    def _receive(self, m: Module) -> None:
        m.submodules.rxbuf = rxbuf = memory.Memory(shape=32, depth=self._words, init=[])
        write, read = rxbuf.write_port(), rxbuf.read_port()
        length = Signal(16)  # block RAM is slow: what it gives is not compared in the same cycle
        m.d.comb += [
            write.addr.eq(self.udp_rxbuf_addr),
            write.data.eq(self.udp_rxbuf_wdata),
            write.en.eq(self.udp_rxbuf_ce & self.udp_rxbuf_we),
            read.addr.eq(1),  # of the length
            read.en.eq(self.udp_rxbuf_grant),
        ]
        with m.FSM():
            with m.State("WAIT"), m.If(self.udp_rxbuf_grant):
                m.next = "READ"
            with m.State("READ"):
                m.d.sync += length.eq(read.data[16:])
                m.next = "SHOW"
            with m.State("SHOW"):
                m.d.comb += self.udp_rxbuf_rel.eq(1)
                m.d.sync += [self.led[n].eq(length >= least) for n, least in enumerate(LENGTHS)]
                m.next = "WAIT"
