"""The PHY's side of MII and GMII pins: frames to and from nibbles or octets. IEEE 802.3, 22.2 and 35.2.

The pins themselves are driven and sampled in `driver.cc`, at every clock edge: what the PHY sends changes behind the rising
edge of `rx_clk`, so that the design sees it at the next one; what the design sends is taken at the rising edge of `tx_clk`,
as it stands before that edge.
"""

from __future__ import annotations

import ctypes
import zlib
from collections.abc import Sequence

from roslet.record import Record
from roslet.sim.model import PICOSECONDS, Model
from roslet.wire.net.ethernet import MIN_SIZE

VALID, ERROR = 0x100, 0x200
"""Bits of a symbol beside the data: rx_dv or tx_en, rx_er or tx_er."""

PREAMBLE, SFD = 0x55, 0xD5  # 3.2.1, 3.2.2
PREAMBLE_SIZE = 7
FCS_SIZE = 4
MAX_SIZE = 1514  # 4.2.7.1: maxFrameSize without the FCS
GAP_BITS = 96  # 4.4.2: interPacketGap
# Octets of a frame from the design that are looked at: some jumbo frames' worth. What does not end is cut there.
MAX_OCTETS = 1 << 14


class Pins(Record):
    """Names of the pins in the design; `rx_er` and `tx_er` may be missing there. The clocks must have been started, and
    with GMII `tx_clk` is the clock that the design sends by."""

    _fields = ("rx_clk", "rxd", "rx_dv", "rx_er", "tx_clk", "txd", "tx_en", "tx_er")
    __slots__ = _fields

    def __init__(
        self,
        rx_clk: str = "phy_rx_clk",
        rxd: str = "phy_rxd",
        rx_dv: str = "phy_rx_dv",
        rx_er: str = "phy_rx_er",
        tx_clk: str = "phy_tx_clk",
        txd: str = "phy_txd",
        tx_en: str = "phy_tx_en",
        tx_er: str = "phy_tx_er",
    ) -> None:
        self.rx_clk = rx_clk
        self.rxd = rxd
        self.rx_dv = rx_dv
        self.rx_er = rx_er
        self.tx_clk = tx_clk
        self.txd = txd
        self.tx_en = tx_en
        self.tx_er = tx_er


class Sent(Record):
    """What the design sent: the frame without its FCS, `faults` of it by name, and when it began (with the preamble) and
    ended, in seconds; `gap`: bit times since the frame before, or since the start; `symbols` as they were on the pins."""

    _fields = ("frame", "faults", "start", "end", "gap", "symbols")
    __slots__ = _fields

    def __init__(
        self,
        frame: bytes,
        faults: tuple[str, ...],
        start: float,
        end: float,
        gap: int,
        symbols: tuple[int, ...],
    ) -> None:
        self.frame = frame
        self.faults = faults
        self.start = start
        self.end = end
        self.gap = gap
        self.symbols = symbols


FAULTS = {
    "preamble-short": "fewer than seven octets of preamble",
    "sfd-missing": "no start of frame delimiter behind the preamble",
    "nibbles-odd": "an odd number of nibbles",
    "fcs-wrong": "the frame check sequence is not that of the frame",
    "error-raised": "tx_er was high",
    "too-short": "a frame of fewer than 64 octets",
    "too-long": "a frame of more than 1,518 octets",
    "gap-short": "fewer than 96 bit times since the frame before",
}


def fcs(frame: bytes) -> bytes:
    """3.2.9, in the order of the wire."""
    return zlib.crc32(frame).to_bytes(4, "little")


def symbols_of(octets: bytes, width: int) -> list[int]:
    """Octets as symbols of `width` bits of data: nibbles go with the lower one first."""
    if width == 8:
        return [VALID | octet for octet in octets]
    return [VALID | nibble for octet in octets for nibble in (octet & 15, octet >> 4)]


def octets_of(symbols: Sequence[int], width: int) -> bytes:
    """The reverse; an odd nibble at the end is left out."""
    if width == 8:
        return bytes([symbol & 0xFF for symbol in symbols])
    pairs = zip(symbols[0::2], symbols[1::2], strict=False)
    return bytes([low & 15 | (high & 15) << 4 for low, high in pairs])


def read(symbols: Sequence[int], width: int, gap: int = GAP_BITS) -> tuple[bytes, tuple[str, ...]]:
    """The frame in what a design sent, and its faults."""
    faults = []
    data = [symbol & 0xFF for symbol in symbols]
    unit, last = (PREAMBLE, SFD) if width == 8 else (PREAMBLE & 15, SFD >> 4)
    at = 0
    while at < len(data) and data[at] == unit:
        at += 1
    if at >= len(data) or data[at] != last:
        faults.append("sfd-missing")
        frame = b""
    else:
        # Of a nibble-wide SFD the lower half looks like preamble.
        if at * width < 8 * PREAMBLE_SIZE + (4 if width == 4 else 0):
            faults.append("preamble-short")
        rest = symbols[at + 1 :]
        if width == 4 and len(rest) & 1:
            faults.append("nibbles-odd")
        octets = octets_of(rest, width)
        frame = octets[:-FCS_SIZE]
        if len(octets) < FCS_SIZE or fcs(frame) != octets[-FCS_SIZE:]:
            faults.append("fcs-wrong")
        if len(frame) < MIN_SIZE:
            faults.append("too-short")
        if len(frame) > MAX_SIZE:
            faults.append("too-long")
    if any(symbol & ERROR for symbol in symbols):
        faults.append("error-raised")
    if gap < GAP_BITS:
        faults.append("gap-short")
    return frame, tuple(faults)


class Mii:
    """A PHY at a model's pins. MII or GMII by the width of `rxd`: 4 or 8 bits. `sent` and `received` count frames, as the
    PHY sees them."""

    def __init__(self, model: Model, pins: Pins | None = None, gap_bits: int = GAP_BITS) -> None:
        pins = pins or Pins()
        self.model = model
        self.width = model.signal(pins.rxd).bits
        if self.width not in (4, 8) or model.signal(pins.txd).bits != self.width:
            raise ValueError(f"{pins.rxd} and {pins.txd} must have 4 bits (MII) or 8 (GMII)")
        numbers = [model.clock_number(pins.rx_clk)]
        numbers += [self._pin(pins.rxd), self._pin(pins.rx_dv), self._pin(pins.rx_er)]
        numbers += [model.clock_number(pins.tx_clk)]
        numbers += [self._pin(pins.txd), self._pin(pins.tx_en), self._pin(pins.tx_er)]
        if -1 in (numbers[2], numbers[6]):
            raise ValueError(f"the design has no {pins.rx_dv} or no {pins.tx_en}")
        self._room = MAX_OCTETS * 8 // self.width
        self._number = model.call["mii"](model.handle, *numbers, gap_bits // self.width, self._room)
        self.sent = 0
        self.received = 0

    def _pin(self, name: str) -> int:
        return self.model.signal(name).number if self.model.has(name) else -1

    def send(
        self,
        frame: bytes,
        check: bytes | None = None,
        preamble: int = PREAMBLE_SIZE,
        errors: Sequence[int] = (),
        pad: bool = True,
    ) -> None:
        """Let a frame into the design, behind those that wait, with its FCS. `check`: another FCS than the right one;
        `preamble`: octets of it; `errors`: octets of the frame, counted from 0, beside which rx_er is high."""
        padded = frame.ljust(MIN_SIZE, b"\0") if pad else frame
        front = bytes([PREAMBLE]) * preamble + bytes([SFD])
        symbols = symbols_of(front + padded + (fcs(padded) if check is None else check), self.width)
        each = 8 // self.width
        for error in errors:
            for at in range(each):
                symbols[(len(front) + error) * each + at] |= ERROR
        self.send_symbols(symbols)

    def send_symbols(self, symbols: Sequence[int]) -> None:
        """Let anything into the design, symbol by symbol; a symbol without VALID is a pause."""
        self.sent += 1
        self.model.call["send"](
            self.model.handle, self._number, (ctypes.c_uint16 * len(symbols))(*symbols), len(symbols)
        )

    @property
    def waiting(self) -> int:
        """Frames that the design has not had in full."""
        count: int = self.model.call["waiting"](self.model.handle, self._number)
        return count

    def receive(self) -> list[Sent]:
        """What the design sent since the last time, in order."""
        found = []
        symbols = (ctypes.c_uint16 * self._room)()
        start, end, gap = ctypes.c_uint64(), ctypes.c_uint64(), ctypes.c_uint32()
        places = (ctypes.byref(start), ctypes.byref(end), ctypes.byref(gap))
        while count := self.model.call["receive"](
            self.model.handle, self._number, symbols, self._room, *places
        ):
            taken = tuple(symbols[:count])
            bits = gap.value * self.width
            frame, faults = read(taken, self.width, bits if self.received else GAP_BITS)
            self.received += 1
            found.append(Sent(frame, faults, start.value / PICOSECONDS, end.value / PICOSECONDS, bits, taken))
        return found
