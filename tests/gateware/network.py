"""A node's addresses, for tests, and how gateware holds them."""

from __future__ import annotations

from typing import Any

from gateware.frames import Bench

MAC, IP = bytes.fromhex("0200 0000 0002"), bytes((192, 168, 1, 100))
GATEWAY, MASK = bytes((192, 168, 1, 1)), bytes((255, 255, 255, 0))
BROADCAST = bytes.fromhex("ffff ffff ffff")
PEER_MAC, PEER = bytes.fromhex("0200 0000 0a0b"), bytes((192, 168, 1, 10))


def number(octets: bytes) -> int:
    """As gateware holds octets: the first in the lowest bits."""
    return int.from_bytes(octets, "little")


def octets(value: int, size: int) -> bytes:
    return value.to_bytes(size, "little")


def address(text: str) -> bytes:
    return bytes(map(int, text.split(".")))


def configure(bench: Bench, mask: bytes = MASK, gateway: bytes = GATEWAY, **inputs: Any) -> None:
    """Give a block its addresses, and other inputs their values, from the first cycle on."""
    addresses = {"mac": number(MAC), "ip": number(IP), "gateway": number(gateway), "mask": number(mask)}

    async def process(ctx: Any) -> None:
        if hasattr(bench.dut, "addresses"):
            ctx.set(bench.dut.addresses, addresses)
        for name, value in inputs.items():
            ctx.set(getattr(bench.dut, name), value)

    bench.drive(process)


def watch_pauses(bench: Bench, name: str = "o") -> list[int]:
    """Note, in the list that is returned, each cycle within a frame in which a port has nothing to give."""
    stream = getattr(bench.dut, name).stream
    pauses: list[int] = []

    async def process(ctx: Any) -> None:
        within, cycle = False, 0
        while True:
            _, _, valid, ready, end = await ctx.tick().sample(stream.valid, stream.ready, stream.payload.end)
            cycle += 1
            if within and not valid:
                pauses.append(cycle)
            if valid and ready:
                within = not end

    bench.watch(process)
    return pauses
