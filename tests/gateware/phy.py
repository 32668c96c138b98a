"""A PHY for the simulator: what its pins show, cycle by cycle, and the frames that they meant.

The octets of IEEE 802.3 are by hand, the check sequence is zlib's.
"""

from __future__ import annotations

import random
import zlib
from collections.abc import Iterable, Sequence
from typing import Any

PREAMBLE = bytes.fromhex("5555 5555 5555 55d5")
IDLE = (0, 0, 0)
Cycle = tuple[int, int, int]
"""Data, data valid, error."""


def fcs(frame: bytes) -> bytes:
    return zlib.crc32(frame).to_bytes(4, "little")


def sealed(frame: bytes) -> bytes:
    """Padded, and with its FCS."""
    padded = frame.ljust(60, b"\0")
    return padded + fcs(padded)


def some(rng: random.Random, size: int) -> bytes:
    return bytes(rng.randrange(256) for _ in range(size))


def symbols(octets: bytes, width: int) -> list[int]:
    if width == 8:
        return list(octets)
    return [half for octet in octets for half in (octet & 15, octet >> 4)]


def shown(octets: bytes, width: int, gap: int = 12, error: Iterable[int] = ()) -> list[Cycle]:
    """The cycles of a carrier that is `octets`, with the PHY's error in those listed, and `gap` octets of silence."""
    errors = set(error)
    cycles = [(data, 1, int(n in errors)) for n, data in enumerate(symbols(octets, width))]
    return cycles + [IDLE] * (gap * 8 // width)


async def play(ctx: Any, pins: tuple[Any, Any, Any], cycles: Iterable[Cycle], domain: str = "sync") -> None:
    data, valid, error = pins
    for cycle in cycles:
        for pin, value in zip((data, valid, error), cycle, strict=True):
            ctx.set(pin, value)
        await ctx.tick(domain)
    ctx.set(valid, 0)


class Watch:
    """What was sent: the octets of each carrier, the cycles of silence before it, and in which carriers the error pin was
    high. `add_testbench` it in the background."""

    def __init__(self, pins: Sequence[Any], width: int, domain: str = "sync") -> None:
        self.carriers: list[bytes] = []
        self.gaps: list[int] = []
        self.errors: list[int] = []
        self._pins, self._width, self._domain = pins, width, domain

    @property
    def frames(self) -> list[bytes]:
        """Of the carriers with preamble and right FCS, what is between."""
        return [c[8:-4] for c in self.carriers if c[:8] == PREAMBLE and fcs(c[8:-4]) == c[-4:]]

    async def run(self, ctx: Any) -> None:
        halves: list[int] = []
        gap = 0
        seen_error = False
        while True:
            data, enabled, *error = (await ctx.tick(self._domain).sample(*self._pins))[2:]
            if enabled:
                if not halves:
                    self.gaps.append(gap)
                    gap = 0
                halves.append(data)
                seen_error |= any(error)
                continue
            gap += 1
            if halves:
                if seen_error:
                    self.errors.append(len(self.carriers))
                self.carriers.append(self._joined(halves))
                halves, seen_error = [], False

    def _joined(self, halves: list[int]) -> bytes:
        if self._width == 8:
            return bytes(halves)
        assert len(halves) % 2 == 0, "half an octet was sent"
        return bytes(low | high << 4 for low, high in zip(halves[::2], halves[1::2], strict=True))
