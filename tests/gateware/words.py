"""Drives blocks message by message: what `frames` does for octets, for streams of words (`roslet.gateware.words`); and the
two memories that the RTPS blocks read and write, beside them.

A message is `bytes`, or a `frames.Bad` one; octets that fill its last word up are sent at random, and not received.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from amaranth.hdl import Cat, Elaboratable, Module, Mux, Signal
from amaranth.lib import memory
from amaranth.lib.wiring import Out

from gateware.frames import Bad, Bench
from roslet.gateware.rtps.tables import OwnMap, PeerMap


def words(octets: bytes) -> list[int]:
    """Little endian, the last filled up with zeros."""
    return [int.from_bytes(octets[at : at + 4], "little") for at in range(0, len(octets), 4)]


class WordBench(Bench):
    """A `Bench` whose ports may be MessageSignatures."""

    def send_words(
        self,
        name: str,
        messages: Iterable[bytes],
        metas: Sequence[Any] | None = None,
        verdict: tuple[str, str] | None = None,
    ) -> None:
        """Send messages to the port `name`, with `metas[n]` beside the nth. `verdict` names the inputs that say that the
        end is known, some time before it comes, and whether it is good (`DatagramQueue`)."""
        sent = list(messages)
        port = self._port(name)
        known, good = (self._port(one) for one in verdict) if verdict else (None, None)
        self._waiting += 1

        async def process(ctx: Any) -> None:
            for number, message in enumerate(sent):
                if metas is not None:
                    ctx.set(port.meta, metas[number])
                bad = isinstance(message, Bad)
                pad = -len(message) % 4
                full = message + (bytes(pad) if known is not None else self.random.randbytes(pad))
                items = [{"data": word, "end": 0, "bad": 0, "padding": 0} for word in words(full)]
                items.append(
                    {
                        "data": self.random.getrandbits(32),
                        "end": 1,
                        "bad": bad,
                        "padding": 0 if bad else pad,
                    }
                )
                until_known = self.random.randrange(2 * len(items))

                def tell(bad: bool = bad) -> None:
                    if known is not None:
                        ctx.set(good, not bad)
                        ctx.set(known, 1)

                for item in items:
                    waiting = True
                    while waiting:
                        if until_known == 0 or item["end"]:
                            tell()
                        until_known = max(0, until_known - 1)
                        if not ctx.get(port.stream.valid) and self.random.randrange(100) >= self.stalls:
                            ctx.set(port.stream.payload, item)
                            ctx.set(port.stream.valid, 1)
                        _, _, valid, ready = await ctx.tick().sample(port.stream.valid, port.stream.ready)
                        waiting = not (valid and ready)
                    ctx.set(port.stream.valid, 0)
                if known is not None:
                    ctx.set(known, 0)
                    ctx.set(good, self.random.randrange(2))
            self._waiting -= 1

        self._simulator.add_testbench(process, background=True)

    def receive_words(self, name: str) -> list[tuple[bytes, Any]]:
        """Take messages from the port `name`, ready now and then: as `receive`. The rules of streams are watched."""
        port = self._port(name)
        got: list[tuple[bytes, Any]] = []
        self._received[name] = got
        has_meta = port.signature.layout is not None

        async def process(ctx: Any) -> None:
            octets = bytearray()
            held: Any = None
            meta: Any = None
            while True:
                ready = int(self.random.randrange(100) >= self.stalls)
                ctx.set(port.stream.ready, ready)
                clocked = await ctx.tick().sample(
                    port.stream.valid, port.stream.payload, *([port.meta] if has_meta else [])
                )
                valid, item = clocked[2], clocked[3]
                now = (item.end or item.data, item.end, item.bad, item.padding) if valid else None
                beside = repr(clocked[4]) if has_meta else None
                if held is not None and now != held:
                    self._faults.append(f"{name}: {held} was withdrawn for {now}")
                if not valid:
                    held = None
                    continue
                if not item.end and (item.bad or item.padding):
                    self._faults.append(f"{name}: bad or padding without end")
                if meta is not None and beside != meta:
                    self._faults.append(f"{name}: meta changed within a message, from {meta} to {beside}")
                meta = beside
                held = None if ready else now
                if not ready:
                    continue
                if item.end:
                    whole = bytes(octets[: max(0, len(octets) - item.padding)])
                    got.append((Bad(whole) if item.bad else whole, clocked[4] if has_meta else None))
                    octets.clear()
                    meta = None
                else:
                    octets += item.data.to_bytes(4, "little")

        self._simulator.add_testbench(process, background=True)
        return got


class Tables(Elaboratable):
    """Blocks with the two memories that they share by turns, as `participant` has them; `blocks` by their names, which are
    attributes."""

    def __init__(
        self,
        peers: PeerMap,
        own: OwnMap,
        init: Sequence[int],
        /,
        *,
        theirs: Sequence[int] = (),
        **blocks: Any,
    ) -> None:
        self._blocks, self._peers = blocks, peers
        self.__dict__.update(blocks)
        self.peers_memory = memory.Memory(shape=32, depth=peers.depth, init=list(theirs))
        self.own_memory = memory.Memory(shape=32, depth=own.depth, init=list(init))

    def elaborate(self, platform: object) -> Module:
        m = Module()
        for name, block in self._blocks.items():
            m.submodules[name] = block
        for name, mem in (("peers", self.peers_memory), ("own", self.own_memory)):
            m.submodules[f"{name}_memory"] = mem
            users = [getattr(one, name) for one in self._blocks.values() if name in one.signature.members]
            read = mem.read_port()
            m.d.comb += read.addr.eq(_either(user.addr for user in users))
            given = Signal(32, name=f"{name}_given")
            m.d.sync += given.eq(read.data)
            m.d.comb += [user.data.eq(given) for user in users]
            for block in self._blocks.values():
                if f"hide_{name}" in block.signature.members:
                    with m.If(getattr(block, f"hide_{name}")):
                        m.d.sync += given.eq(0)
                if f"fill_{name}" in block.signature.members:
                    with m.If(getattr(block, f"fill_{name}")):
                        m.d.sync += given.eq(-1)
        write = self.peers_memory.write_port()
        ports = [block.write for block in self._blocks.values() if "write" in block.signature.members]
        m.d.comb += [
            write.en.eq(Cat(port.en for port in ports).any()),
            write.addr.eq(_either(port.addr for port in ports)),
            write.data.eq(_either(Mux(port.en, port.data, 0) for port in ports)),
        ]
        for block in self._blocks.values():
            members = block.signature.members
            if "keep" in members and members["keep"].flow == Out:
                with m.If(block.keep.en):
                    m.d.comb += [
                        write.en.eq(1),
                        write.addr.eq(self._peers.scratch(block.keep.word)),
                        write.data.eq(block.i.stream.payload.data),
                    ]
        return m

    def peek(self, ctx: Any) -> list[int]:
        """What is known of peers now."""
        return [ctx.get(self.peers_memory.data[at]) for at in range(self.peers_memory.depth)]


def _either(values: Iterator[Any]) -> Any:
    """All of them but one are zero."""
    found: Any = 0
    for value in values:
        found = value | found
    return found
