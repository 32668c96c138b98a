"""Octets at serial pins, through a design that is a wire."""

from __future__ import annotations

import random
from collections.abc import Iterator

import pytest
from amaranth.hdl import ClockDomain, ClockSignal, Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from roslet.sim.model import Model
from roslet.sim.uart import Uart
from roslet.sim.wire import MAX_OCTETS, Wire

CLOCK, BAUD = 8e6, 1e6


class Loop(wiring.Component):
    """What comes goes, but while `hold` is high the line is low."""

    def __init__(self) -> None:
        super().__init__({"clk": In(1), "hold": In(1), "uart_rx": In(1), "uart_tx": Out(1, init=1)})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.domains.sync = ClockDomain("sync", reset_less=True)
        m.d.comb += ClockSignal("sync").eq(self.clk)
        m.d.sync += self.uart_tx.eq(self.uart_rx & ~self.hold)
        return m


@pytest.fixture
def model() -> Iterator[Model]:
    with Model(Loop()) as made:
        made.clock("clk", CLOCK)
        yield made


def test_octets_go_through_the_pins_and_come_back_in_ten_bits_each(model: Model) -> None:
    uart = Uart(model, BAUD)
    octets = bytes(range(256)) + random.Random(1).randbytes(100)
    uart.send(octets[:200])
    uart.send(octets[200:])
    assert uart.waiting == len(octets)
    model.run(10 / BAUD * 100 + 1 / BAUD)
    assert len(uart.receive()) == 100 and uart.waiting == 256 - 1
    model.run(1.0 / BAUD * 10 * 300)
    assert uart.waiting == 0 and uart.framing == 0
    assert uart.receive() == octets[100:]
    assert uart.receive() == b""


def test_an_idle_line_is_high_and_a_start_bit_low(model: Model) -> None:
    uart = Uart(model, BAUD)
    model.run(1e-5)
    assert (model.get("uart_rx"), uart.receive()) == (1, b"")
    uart.send(b"\xff")
    model.run_cycles("clk", 3)
    assert model.get("uart_rx") == 0
    model.run_cycles("clk", 8)
    assert model.get("uart_rx") == 1


def test_a_line_that_stays_low_is_one_octet_without_a_stop_bit(model: Model) -> None:
    uart = Uart(model, BAUD)
    model.run(1e-5)
    model.set("hold", 1)
    model.run(1e-3)
    model.set("hold", 0)
    uart.send(b"a")
    model.run(1e-4)
    assert (uart.framing, uart.receive()) == (1, b"a")


def test_on_a_wire_octets_wait_in_the_link_while_the_pin_has_enough(model: Model) -> None:
    wire = Wire()
    station = wire.serial(model, Uart(model, BAUD))
    end = wire.hub.port()
    octets = random.Random(2).randbytes(4 * MAX_OCTETS)
    for at in range(0, len(octets), MAX_OCTETS):
        end.send(octets[at : at + MAX_OCTETS], wire.now)
        wire.run(1e-5)
    got = bytearray()

    def look() -> bool:
        for piece in end.receive(wire.now):
            got.extend(piece)
        return len(got) == len(octets)

    assert wire.run(10 * len(octets) / BAUD * 1.1, look)
    assert got == octets and station.faults == {}
    wire.close()


def test_what_cannot_be_a_line_is_refused(model: Model) -> None:
    with pytest.raises(ValueError, match="more than 0 bits a second"):
        Uart(model, 0)
    with pytest.raises(KeyError, match="no signal 'nothing'"):
        Uart(model, BAUD, rx="nothing")
    with pytest.raises(ValueError, match="no clock 'hold' was started"):
        Uart(model, BAUD, clock="hold")
