"""Drives blocks frame by frame in Amaranth's simulator: stalls on both sides, and the rules of streams watched throughout.

A frame is `bytes`, or a `Bad` one whose end says that it must be forgotten. A simulation ends by itself: `Bench.run` has a
limit.
"""

from __future__ import annotations

import random
from collections.abc import Awaitable, Callable, Iterable, Mapping, Sequence
from typing import Any

from amaranth.hdl import ClockDomain, Elaboratable, Module
from amaranth.sim import Simulator

CYCLES = 20_000
"""What a simulation may take, where a test does not say otherwise."""


STALLS = (0, 30, 80)
"""Stalls that every block is tried with."""


class Bad(bytes):
    """A frame that ends badly."""


async def taken(ctx: Any, stream: Any) -> None:
    """Wait until the item at `stream` has been taken. Amaranth's `until` does not stand being left behind by a simulation
    that ends."""
    ready = False
    while not ready:
        (_, _, ready) = await ctx.tick().sample(stream.ready)


class Bench:
    """A block, what is sent to it and what it gave. Ports are found by name: `bench.send("i", frames)`.

    `stalls` is how often, of a hundred cycles, a sender has nothing or a receiver is not ready. `STALLS` are worth trying.
    `clocks` are the periods of domains besides `sync`, of any phase.
    """

    def __init__(
        self,
        dut: Elaboratable,
        stalls: int = 30,
        seed: int = 0,
        period: float = 1e-8,
        clocks: Mapping[str, float] | None = None,
    ) -> None:
        self.dut: Any = dut
        self.stalls = stalls
        self.random = random.Random(seed)
        self.counts: dict[str, int] = {}
        top = Module()
        top.domains.sync = ClockDomain()  # a block without registers has none of its own
        top.submodules.dut = dut
        self._simulator = Simulator(top)
        self._simulator.add_clock(period)
        for domain, other in (clocks or {}).items():
            self._simulator.add_clock(other, phase=other * self.random.random(), domain=domain)
        self._waiting = 0
        self._faults: list[str] = []
        self._received: dict[str, list[tuple[bytes, Any]]] = {}

    def _port(self, name: str) -> Any:
        found = self.dut
        for part in name.split("."):
            found = getattr(found, part)
        return found

    # -- what is driven

    def send(self, name: str, frames: Iterable[bytes], metas: Sequence[Any] | None = None) -> None:
        """Send frames to the FrameSignature port `name`, one after another, with `metas[n]` beside the nth."""
        sent = list(frames)
        port = self._port(name)
        self._waiting += 1

        async def process(ctx: Any) -> None:
            for number, frame in enumerate(sent):
                if metas is not None:
                    ctx.set(port.meta, metas[number])
                items = [{"data": octet, "end": 0, "bad": 0} for octet in frame]
                items.append({"data": self.random.randrange(256), "end": 1, "bad": isinstance(frame, Bad)})
                for item in items:
                    while self.random.randrange(100) < self.stalls:
                        await ctx.tick()
                    ctx.set(port.stream.payload, item)
                    ctx.set(port.stream.valid, 1)
                    await taken(ctx, port.stream)
                    ctx.set(port.stream.valid, 0)
            self._waiting -= 1

        self._simulator.add_testbench(process, background=True)

    def receive(self, name: str) -> list[tuple[bytes, Any]]:
        """Take frames from the FrameSignature port `name`, ready now and then: (frame, meta, None where it has none) are
        appended to the list that is returned. The rules of streams are watched."""
        port = self._port(name)
        got: list[tuple[bytes, Any]] = []
        self._received[name] = got
        has_meta = port.signature.layout is not None

        async def process(ctx: Any) -> None:
            octets = bytearray()
            held: Any = None
            meta: Any = None
            ready = 0
            while True:
                ready = int(self.random.randrange(100) >= self.stalls)
                ctx.set(port.stream.ready, ready)
                clocked = await ctx.tick().sample(
                    port.stream.valid, port.stream.payload, *([port.meta] if has_meta else [])
                )
                valid, item = clocked[2], clocked[3]
                now = (item.data, item.end, item.bad) if valid else None
                beside = repr(clocked[4]) if has_meta else None
                if held is not None and now != held:
                    self._faults.append(f"{name}: {held} was withdrawn for {now}")
                if not valid:
                    held = None
                    continue
                if item.bad and not item.end:
                    self._faults.append(f"{name}: bad without end")
                if meta is not None and beside != meta:
                    self._faults.append(f"{name}: meta changed within a frame, from {meta} to {beside}")
                meta = beside
                held = None if ready else now
                if not ready:
                    continue
                if item.end:
                    frame = Bad(octets) if item.bad else bytes(octets)
                    got.append((frame, clocked[4] if has_meta else None))
                    octets.clear()
                    meta = None
                else:
                    octets.append(item.data)

        self._simulator.add_testbench(process, background=True)
        return got

    def count(self, *names: str) -> None:
        """Count the cycles in which outputs are high: `bench.counts[name]`."""
        self.counts.update(dict.fromkeys(names, 0))
        signals = [self._port(name) for name in names]

        async def process(ctx: Any) -> None:
            while True:
                (_, _, *high) = await ctx.tick().sample(*signals)
                if any(high):
                    for name, one in zip(names, high, strict=True):
                        self.counts[name] += int(bool(one))

        self._simulator.add_testbench(process, background=True)

    def drive(self, process: Callable[[Any], Awaitable[None]]) -> None:
        """A testbench of the test's own, which must end."""
        self._waiting += 1

        async def wrapped(ctx: Any) -> None:
            await process(ctx)
            self._waiting -= 1

        self._simulator.add_testbench(wrapped, background=True)

    def watch(self, process: Callable[[Any], Awaitable[None]]) -> None:
        """A testbench of the test's own, which goes on until the simulation ends."""
        self._simulator.add_testbench(process, background=True)

    def run(self, until: Callable[[], bool] | None = None, cycles: int = CYCLES, rest: int = 50) -> None:
        """Simulate until all is sent, and `until()` is so, and `rest` cycles more. Fails where that takes more than
        `cycles`, or where a rule of streams was broken."""
        done = False

        async def watch(ctx: Any) -> None:
            nonlocal done
            for _ in range(cycles):
                await ctx.tick()
                if self._waiting == 0 and (until is None or until()):
                    done = True
                    break
            await ctx.tick().repeat(rest)

        self._simulator.add_testbench(
            watch
        )  # the only one that is not in the background: the simulation ends with it
        self._simulator.run()
        assert not self._faults, self._faults[:5]
        assert done, f"not over after {cycles} cycles; received {self._received}"
