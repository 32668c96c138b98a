"""Parameter lists put to discovery, one after another, and what came of each."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Sequence
from typing import Any, NamedTuple

from engine.rtps import hand
from gateware.frames import Bad
from gateware.words import Tables, WordBench, words
from roslet.gateware.rtps import ports
from roslet.gateware.rtps.discovery import Discovery
from roslet.gateware.rtps.tables import Local, OwnMap, PeerMap

DROPS = ("full", "incomplete", "refused", "qos", "malformed")
IP, MASK = "10.0.0.100", "255.255.255.0"
DOMAIN = 5
GROUP_PORT = 8650  # 7400 + 250 * DOMAIN. RTPS 2.3, 9.6.1.1
WRITERS = [
    Local("rt/out", "T1"),
    Local("rt/sure", "T2", reliable=True),
    Local("rt/latched", "T3", True, True),
]
READERS = [
    Local("rt/in", "pkg::T_"),
    Local("rt/strict", "T5", reliable=True),
    Local("rt/kept", "T6", True, True),
]


def prefix(n: int) -> bytes:
    return b"\1\x0f" + bytes([n]) * 10


def address(text: str) -> int:
    return int.from_bytes(bytes(int(part) for part in text.split(".")), "little")


class Came(NamedTuple):
    """What came of a list: reasons, proxies that are due, slots to be greeted, and the two tables then."""

    drops: list[str]
    due: list[int]
    greet: list[int]
    alive: int
    matched: int


class Node:
    """Discovery with its memories. A script is `async def script(node)`, run by `run`."""

    def __init__(
        self,
        participants: int = 2,
        endpoints: int = 3,
        stalls: int = 0,
        writers: Sequence[Local] = WRITERS,
        readers: Sequence[Local] = READERS,
    ) -> None:
        self.peers, self.own = PeerMap(participants, endpoints), OwnMap(writers, readers)
        init = self.own.init(bytes(range(12)), bytes(4), 0, 0)
        self.block: Any = Discovery(self.peers, self.own)
        self.bench = WordBench(Tables(self.peers, self.own, init, block=self.block), stalls, seed=stalls)
        self._drops: list[str] = []
        self._due: list[int] = []
        self._greet: list[int] = []
        self.bench.watch(self._watch)
        self.ctx: Any = None

    async def _watch(self, ctx: Any) -> None:
        block = self.block
        while True:
            _, _, due, proxy, greet, slot, *high = await ctx.tick().sample(
                block.due.en,
                block.due.proxy,
                block.greet,
                block.greet_slot,
                *(getattr(block, f"drop_{name}") for name in DROPS),
            )
            if due:
                self._due.append(proxy)
            if greet:
                self._greet.append(slot)
            self._drops += [name for name, one in zip(DROPS, high, strict=True) if one]

    def run(self, script: Callable[[Node], Awaitable[None]], cycles: int = 200_000) -> None:
        async def process(ctx: Any) -> None:
            self.ctx = ctx
            ctx.set(self.block.idle, 1)
            ctx.set(self.block.domain, DOMAIN)
            ctx.set(self.block.group_port, GROUP_PORT)
            addresses = {"mac": 0, "ip": address(IP), "gateway": 0, "mask": address(MASK)}
            ctx.set(self.block.addresses, addresses)
            await ctx.tick()
            await script(self)

        self.bench.drive(process)
        self.bench.run(cycles=cycles)

    # -- what is kept

    def word(self, at: int) -> int:
        value: int = self.ctx.get(self.bench.dut.peers_memory.data[at])
        return value

    def participant(self, slot: int) -> list[int]:
        """Its prefix, addresses and ports, and nothing but these in their words, its lease, and what is left of it."""
        at = self.peers._participants + 16 * slot
        words = [self.word(at + n) for n in range(9)]
        return [*words[:3], *words[4:7], words[7] & 0xFFFF, words[3], words[8]]

    def builtin(self, slot: int, kind: int) -> list[int]:
        at = self.peers._builtins + 32 * slot + 8 * kind
        return [self.word(at + n) for n in range(8)]

    def endpoint(self, number: int) -> list[int]:
        words = [self.word(self.peers._endpoints + 8 * number + n) for n in range(8)]
        return [*words[:3], words[3] & 0xFFFF, *words[4:]]

    def in_group(self, number: int) -> bool:
        """Whether what is for an endpoint may go to the group."""
        return bool(self.word(self.peers._endpoints + 8 * number + 3) >> 16 & 1)

    def kept(self) -> list[int]:
        """All but the scratch area."""
        memory: list[int] = self.bench.dut.peek(self.ctx)
        return memory[: self.peers._scratch] + memory[self.peers._scratch + 16 :]

    # -- what is said

    async def say(
        self,
        kind: int,
        octets: bytes,
        sender: bytes = prefix(1),
        slot: int | None = None,
        gone: bool = False,
        key: bytes = b"",
    ) -> Came:
        """A list from somebody, known as participant `slot` or not, about something that is `gone`, with its `key`."""
        ctx, i, random = self.ctx, self.block.i, self.bench.random
        marks = len(self._drops), len(self._due), len(self._greet)
        scratch = self.bench.dut.peers_memory.data
        for at, octets_ in ((9, sender), (12, key)):
            for n, word in enumerate(words(octets_)):
                ctx.set(scratch[self.peers._scratch + at + n], word)
        meta = {
            "kind": kind,
            "known": slot is not None,
            "slot": slot or 0,
            "gone": gone,
            "has_key": bool(key),
        }
        ctx.set(i.meta, meta)
        bad = isinstance(octets, Bad)
        pad = 0 if bad else -len(octets) % 4
        items = [{"data": word, "end": 0, "bad": 0, "padding": 0} for word in words(octets)]
        items.append({"data": random.getrandbits(32), "end": 1, "bad": bad, "padding": pad})
        for item in items:
            while random.randrange(100) < self.bench.stalls:
                await ctx.tick()
            ctx.set(i.stream.payload, item)
            ctx.set(i.stream.valid, 1)
            ready = 0
            while not ready:
                _, _, ready = await ctx.tick().sample(i.stream.ready)
            ctx.set(i.stream.valid, 0)
        await ctx.tick()
        return Came(
            self._drops[marks[0] :],
            self._due[marks[1] :],
            self._greet[marks[2] :],
            ctx.get(self.block.alive),
            ctx.get(self.block.matched),
        )

    async def arrive(self, n: int, slot: int | None = None, *more: bytes) -> Came:
        """Participant `n` announces itself."""
        said = hand.participant(prefix(n), f"10.0.0.{n}", "<", *more)
        return await self.say(ports.PARTICIPANTS, said, prefix(n), slot)

    async def tell(self, octets: bytes, slot: int = 0, n: int = 1, **more: Any) -> Came:
        """Participant `n`, which has this slot, says this of an endpoint."""
        writer = (
            octets[8 + 15] in (2, 3) if more.get("kind") is None else more.pop("kind") == ports.PUBLICATIONS
        )
        kind = ports.PUBLICATIONS if writer else ports.SUBSCRIPTIONS
        return await self.say(kind, octets, prefix(n), slot, **more)

    async def second(self, heard: Sequence[int] = ()) -> None:
        """A second passes, in which these slots were heard."""
        ctx, block = self.ctx, self.block
        for slot in heard:
            ctx.set(block.heard, 1)
            ctx.set(block.heard_slot, slot)
            await ctx.tick()
        ctx.set(block.heard, 0)
        ctx.set(block.tick, 1)
        await ctx.tick()
        ctx.set(block.tick, 0)
        await ctx.tick().repeat(3)
        for _ in range(400):
            if not ctx.get(block.hold):
                break
            await ctx.tick()
        else:
            raise AssertionError("the sweep does not end")
