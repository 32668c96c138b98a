"""A compiled design in the hand: clocks, pins, time. One shared library serves any number of models."""

from __future__ import annotations

import ctypes
import pathlib
from collections.abc import Callable
from typing import Any

from roslet.record import Record
from roslet.sim.compile import build

PICOSECONDS = 10**12
_FOREVER = (1 << 63) - 1

_P, _I, _U32, _U64, _S = ctypes.c_void_p, ctypes.c_int, ctypes.c_uint32, ctypes.c_uint64, ctypes.c_char_p
_WORDS, _SYMBOLS = ctypes.POINTER(ctypes.c_uint32), ctypes.POINTER(ctypes.c_uint16)
_FUNCTIONS: dict[str, tuple[Any, list[Any]]] = {
    "create": (_P, []),
    "destroy": (None, [_P]),
    "find": (_I, [_P, _S, _WORDS, ctypes.POINTER(_I)]),
    "get": (None, [_P, _I, _WORDS]),
    "set": (None, [_P, _I, _WORDS]),
    "settle": (None, [_P]),
    "clock": (_I, [_P, _S, _I, _U64, _U64, _U64, _I]),
    "cycles": (_U64, [_P, _I]),
    "mii": (_I, [_P, _I, _I, _I, _I, _I, _I, _I, _I, _U32, _U32]),
    "send": (None, [_P, _I, _SYMBOLS, _U32]),
    "waiting": (_U32, [_P, _I]),
    "receive": (_U32, [_P, _I, _SYMBOLS, _U32, ctypes.POINTER(_U64), ctypes.POINTER(_U64), _WORDS]),
    "uart": (_I, [_P, _I, _I, _I, _U64]),
    "uart_send": (None, [_P, _I, _S, _U32]),
    "uart_waiting": (_U32, [_P, _I]),
    "uart_receive": (_U32, [_P, _I, _S, _U32]),
    "uart_framing": (_U32, [_P, _I]),
    "now": (_U64, [_P]),
    "run": (None, [_P, _U64, _I]),
    "vcd": (_I, [_P, _S, _I]),
    "close_vcd": (None, [_P]),
}


def _load(library: pathlib.Path) -> dict[str, Callable[..., Any]]:
    loaded = ctypes.CDLL(str(library))
    functions = {}
    for name, (result, arguments) in _FUNCTIONS.items():
        function = getattr(loaded, "roslet_" + name)
        function.restype, function.argtypes = result, arguments
        functions[name] = function
    return functions


class Signal(Record):
    """A name in the design: its number, `bits` wide; `input`, whether it may be set."""

    _fields = ("name", "number", "bits", "input")
    __slots__ = _fields

    def __init__(self, name: str, number: int, bits: int, input: bool) -> None:  # noqa: A002 - a field's name
        self.name = name
        self.number = number
        self.bits = bits
        self.input = input


class Model:
    """A running design. `top`: an Amaranth component, which is compiled unless it was before; or the path of a library that
    `compile.build` made.

    Names are those of ports, such as "ip_addr" or "o__stream__valid"; signals within have their submodules' names before
    them, with spaces between: "mac rx drop_bad_fcs". Time is in seconds since the model was made. Close it, or use it as
    a context manager.
    """

    def __init__(self, top: Any) -> None:
        library = top if isinstance(top, pathlib.Path) else build(top)
        self.call = _load(library)
        self.handle: int | None = self.call["create"]()
        self._signals: dict[str, Signal] = {}
        self._clocks: dict[str, tuple[int, int]] = {}
        self._stale = True

    def __enter__(self) -> Model:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def close(self) -> None:
        """End it, and its waveform. Closing twice is allowed."""
        if self.handle is not None:
            self.call["destroy"](self.handle)
            self.handle = None

    # -- pins

    def signal(self, name: str) -> Signal:
        """Raises KeyError for a name that the design does not have."""
        found = self._signals.get(name)
        if found is None:
            bits, is_input = ctypes.c_uint32(), ctypes.c_int()
            number = self.call["find"](self.handle, name.encode(), ctypes.byref(bits), ctypes.byref(is_input))
            if number < 0:
                raise KeyError(f"the design has no signal {name!r}")
            found = self._signals[name] = Signal(name, number, bits.value, bool(is_input.value))
        return found

    def has(self, name: str) -> bool:
        """Whether the design has a signal of this name."""
        try:
            self.signal(name)
        except KeyError:
            return False
        return True

    def get(self, name: str) -> int:
        """The value that stands now."""
        signal = self.signal(name)
        if self._stale:
            self.call["settle"](self.handle)
            self._stale = False
        size = (signal.bits + 31) // 32
        words = (ctypes.c_uint32 * size)()
        self.call["get"](self.handle, signal.number, words)
        return int.from_bytes(b"".join(word.to_bytes(4, "little") for word in words), "little")

    def set(self, name: str, value: int) -> None:
        """From now on. Raises ValueError for what is no input, or a value that does not fit."""
        signal = self.signal(name)
        if not signal.input:
            raise ValueError(f"{name} is no input")
        if value < 0 or value >> signal.bits:
            raise ValueError(f"{name} has {signal.bits} bits, which cannot hold {value}")
        size = (signal.bits + 31) // 32
        data = value.to_bytes(4 * size, "little")
        words = [int.from_bytes(data[at : at + 4], "little") for at in range(0, len(data), 4)]
        self.call["set"](self.handle, signal.number, (ctypes.c_uint32 * size)(*words))
        self._stale = True

    # -- clocks and time

    def clock(self, name: str, hz: float, phase: float = 0.0, duty: float = 0.5) -> None:
        """Let an input run as a clock from now on, rising first after `phase` periods, high for `duty` of a period.

        Periods are whole picoseconds.
        """
        if name in self._clocks:
            raise ValueError(f"{name} is a clock already")
        if hz <= 0 or not 0 <= phase < 1 or not 0 < duty < 1:
            raise ValueError(
                "a clock has a frequency above 0, a phase from 0 to below 1, and a duty within 0 and 1"
            )
        signal = self.signal(name)
        if not signal.input or signal.bits != 1:
            raise ValueError(f"{name} is no input of one bit")
        period = round(PICOSECONDS / hz)
        high = round(period * duty)
        if not 0 < high < period:
            raise ValueError(f"a period of {period} ps is too short")
        number = self.call["clock"](
            self.handle, name.encode(), signal.number, period, high, round(period * phase), 1
        )
        self._clocks[name] = number, period

    def clock_number(self, name: str) -> int:
        """Of a clock that was started. Raises ValueError where it was not."""
        if name not in self._clocks:
            raise ValueError(f"no clock {name!r} was started")
        return self._clocks[name][0]

    def cycles(self, clock: str) -> int:
        """Rising edges of a clock so far."""
        count: int = self.call["cycles"](self.handle, self.clock_number(clock))
        return count

    @property
    def picoseconds(self) -> int:
        now: int = self.call["now"](self.handle)
        return now

    @property
    def now(self) -> float:
        return self.picoseconds / PICOSECONDS

    def run(self, seconds: float, stop_at_frame: bool = False) -> None:
        """Let time pass; with `stop_at_frame` not beyond the end of a frame on MII pins that waits to be received."""
        self.run_until(self.picoseconds + round(seconds * PICOSECONDS), stop_at_frame)

    def run_cycles(self, clock: str, count: int) -> None:
        """Let the periods of a clock pass."""
        self.clock_number(clock)
        self.run_until(self.picoseconds + count * self._clocks[clock][1])

    def run_until(self, picoseconds: int, stop_at_frame: bool = False) -> None:
        """As `run`, to a time. Raises ValueError where no clock was started: nothing could happen."""
        if not self._clocks:
            raise ValueError("no clock was started")
        self.call["run"](self.handle, min(picoseconds, _FOREVER), stop_at_frame)
        self._stale = True

    def vcd(self, path: str | pathlib.Path, memories: bool = False) -> None:
        """Write a waveform from now on, of all signals; `memories` may be large. Costs most of the speed."""
        if not self.call["vcd"](self.handle, str(path).encode(), memories):
            raise OSError(f"cannot write {path}")

    def close_vcd(self) -> None:
        """The waveform ends here."""
        self.call["close_vcd"](self.handle)
