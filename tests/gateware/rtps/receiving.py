"""Submessages put to the block that does what they say, one after another, and what came of each."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from typing import Any, NamedTuple

from gateware.frames import Bad
from gateware.words import Tables, WordBench, words
from roslet.gateware.rtps.submessages import Submessages
from roslet.gateware.rtps.tables import Local, OwnMap, PeerMap

PARTICIPANTS, ENDPOINTS = 2, 3
DROPS = ("unmatched", "old", "early", "busy", "invalid")
NEXT_LO, NEXT_HI, LAST, START = 4, 5, 6, 7
ACKED, ASK_FROM, ASK_TO = 4, 5, 6


class Came(NamedTuple):
    """What came of a submessage: messages of the user's as (octets, reader, representation), `Bad` ones too; lists of
    discovery as (octets, meta); reasons; proxies for which something is due; whether what is kept has changed, the scratch
    area apart."""

    user: list[tuple[bytes, int, int]]
    discovery: list[tuple[bytes, Any]]
    drops: list[str]
    due: list[int]
    changed: bool


class Receiver:
    """The block with its memory. A script is `async def script(say)`, run by `run`."""

    def __init__(self, stalls: int = 0, readers: int = 2) -> None:
        self.peers = PeerMap(PARTICIPANTS, ENDPOINTS)
        own = OwnMap([], [Local(f"t{n}", "T") for n in range(readers)])
        init = own.init(bytes(12), bytes(4), 0, 0)
        self.block: Any = Submessages(self.peers, own)
        self.bench = WordBench(Tables(self.peers, own, init, block=self.block), stalls, seed=stalls)
        self._user = self.bench.receive_words("block.user")
        self._discovery = self.bench.receive_words("block.discovery")
        self._drops: list[str] = []
        self._due: list[int] = []
        self.bench.watch(self._watch)
        self.ctx: Any = None

    async def _watch(self, ctx: Any) -> None:
        block = self.block
        while True:
            _, _, due, proxy, *high = await ctx.tick().sample(
                block.due.en, block.due.proxy, *(getattr(block, f"drop_{name}") for name in DROPS)
            )
            if due:
                self._due.append(proxy)
            self._drops += [name for name, one in zip(DROPS, high, strict=True) if one]

    def run(self, script: Callable[[Receiver], Awaitable[None]], cycles: int = 60_000) -> None:
        async def process(ctx: Any) -> None:
            self.ctx = ctx
            ctx.set(self.block.alive, (1 << PARTICIPANTS) - 1)
            ctx.set(self.block.matched, (1 << ENDPOINTS) - 1)
            ctx.set(self.block.room, -1)
            ctx.set(self.block.over, 1)
            await script(self)

        self.bench.drive(process)
        self.bench.run(cycles=cycles)

    # -- what is kept

    def word(self, at: int) -> int:
        value: int = self.ctx.get(self.bench.dut.peers_memory.data[at])
        return value

    def put(self, at: int, value: int) -> None:
        self.ctx.set(self.bench.dut.peers_memory.data[at], value)

    def builtin(self, slot: int, kind: int, word: int) -> int:
        """Where it lies: the layout that `tables` describes."""
        return self.peers._builtins + 32 * slot + 8 * kind + word

    def endpoint(self, number: int, word: int) -> int:
        return self.peers._endpoints + 8 * number + word

    def writer(
        self, number: int, key: bytes, wanted: int = 0, slot: int = 0, local: int = 0, reliable: bool = True
    ) -> None:
        """Endpoint `number` is a writer of a peer, of which `wanted` is wanted next."""
        self._proxy(number, key, slot, local, True, reliable)
        self.put(self.endpoint(number, NEXT_LO), wanted & 0xFFFFFFFF)
        self.put(self.endpoint(number, NEXT_HI), wanted >> 32)
        self.put(self.endpoint(number, LAST), 0)

    def reader(self, number: int, key: bytes, slot: int = 0, local: int = 0) -> None:
        """Endpoint `number` is a reader of a peer."""
        self._proxy(number, key, slot, local, False, True)
        for word in (ACKED, ASK_FROM, ASK_TO, START):
            self.put(self.endpoint(number, word), 0)

    def _proxy(self, number: int, key: bytes, slot: int, local: int, writer: bool, reliable: bool) -> None:
        self.put(self.endpoint(number, 0), words(key)[0])
        self.put(self.endpoint(number, 1), slot | local << 8 | writer << 16 | reliable << 17)

    def wanted(self, number: int) -> int:
        return self.word(self.endpoint(number, NEXT_LO)) | self.word(self.endpoint(number, NEXT_HI)) << 32

    def kept(self) -> list[int]:
        """All but the scratch area."""
        memory: list[int] = self.bench.dut.peek(self.ctx)
        return memory[: self.peers._scratch] + memory[self.peers._scratch + 16 :]

    # -- what is said

    async def say(
        self, submessage: bytes, slot: int | None = 0, bad: bool = False, cut: int | None = None, pad: int = 0
    ) -> Came:
        """A submessage from participant `slot`, or from somebody unknown; its body ends badly, or after `cut` octets, or
        `pad` octets before its last word is full. `over` is low while it comes."""
        ctx, i, random = self.ctx, self.block.i, self.bench.random
        before = self.kept()
        marks = len(self._user), len(self._discovery), len(self._drops), len(self._due)
        body = submessage[4:] if cut is None else submessage[4 : 4 + cut]
        ctx.set(self.block.over, 0)
        meta = {"id": submessage[0], "flags": submessage[1], "known": slot is not None, "slot": slot or 0}
        ctx.set(i.meta, meta)
        pad = 0 if bad else pad + -len(body) % 4
        items = [{"data": word, "end": 0, "bad": 0, "padding": 0} for word in words(body)]
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
        ctx.set(i.meta, {"id": random.randrange(256), "flags": 255, "known": 1, "slot": 0})
        await ctx.tick().repeat(2)
        quiet = len(self._due)
        ctx.set(self.block.over, 1)
        await ctx.tick().repeat(3)
        assert len(self._due) - quiet <= 1
        return Came(
            [(octets, meta.reader, meta.representation) for octets, meta in self._user[marks[0] :]],
            self._discovery[marks[1] :],
            self._drops[marks[2] :],
            self._due[marks[3] :],
            self.kept() != before,
        )


def whole(came: Came) -> list[tuple[bytes, int, int]]:
    """The user's messages that are good."""
    return [one for one in came.user if not isinstance(one[0], Bad)]
