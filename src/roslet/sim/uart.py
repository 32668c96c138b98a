"""The other end of a serial line: octets to and from two pins, 8N1, driven and sampled in `driver.cc` at each clock edge."""

from __future__ import annotations

import ctypes

from roslet.sim.model import PICOSECONDS, Model

ROOM = 4096
"""Octets that are taken from the driver in one go."""


class Uart:
    """A serial line of `baud` bits a second of the design's own time, at the pins `rx` and `tx` of a model, which are looked
    at with each edge of `clock`. The clock must have been started."""

    def __init__(
        self, model: Model, baud: float, clock: str = "clk", rx: str = "uart_rx", tx: str = "uart_tx"
    ) -> None:
        if baud <= 0:
            raise ValueError(f"a line has more than 0 bits a second, not {baud:g}")
        self.model = model
        pins = [model.signal(name).number for name in (rx, tx)]
        self._number = model.call["uart"](
            model.handle, model.clock_number(clock), *pins, round(PICOSECONDS / baud)
        )

    def send(self, octets: bytes) -> None:
        """Let octets into the design, behind those that wait."""
        self.model.call["uart_send"](self.model.handle, self._number, octets, len(octets))

    @property
    def waiting(self) -> int:
        """Octets that have not begun to go into the design."""
        count: int = self.model.call["uart_waiting"](self.model.handle, self._number)
        return count

    @property
    def framing(self) -> int:
        """Octets from the design that had no stop bit."""
        count: int = self.model.call["uart_framing"](self.model.handle, self._number)
        return count

    def receive(self) -> bytes:
        """What the design sent since the last time."""
        found = b""
        room = ctypes.create_string_buffer(ROOM)
        while count := self.model.call["uart_receive"](self.model.handle, self._number, room, ROOM):
            found += room.raw[:count]
        return found
