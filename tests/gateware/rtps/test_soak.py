"""The receiving side as a whole: a session of the software engine, and then what seeded mutations make of it. Never
stuck."""

from __future__ import annotations

import random
from typing import Any

import pytest
from amaranth.hdl import Module
from amaranth.lib.wiring import connect

import pcap
from engine.rtps import hand
from gateware.frames import Bad
from gateware.rtps.discovering import IP, MASK, address
from gateware.words import Tables, WordBench
from peers import ROOT
from roslet.engine.rtps.participant import Participant
from roslet.gateware.rtps.discovery import Discovery
from roslet.gateware.rtps.queue import DatagramQueue
from roslet.gateware.rtps.submessages import Submessages
from roslet.gateware.rtps.tables import Local, OwnMap, PeerMap
from roslet.gateware.rtps.walker import Walker
from roslet.wire.rtps import locator, qos
from roslet.wire.rtps.qos import Qos

OURS, THEIRS = b"\1\x52" + bytes(range(1, 11)), b"\1\x52" + bytes(range(21, 31))
LONGEST = 1500
RELIABLE = Qos((qos.RELIABLE, 10**8), history=(qos.KEEP_LAST, 10))
W = b"\0\0\x77\3"


def session() -> list[bytes]:
    """What a participant of the engine sends to another, which has our prefix and our topics."""
    hosts = []
    for number, prefix in enumerate((THEIRS, OURS)):
        host = f"10.0.0.{number + 5}"
        own = locator.udp4(host, 7410), locator.udp4(host, 7411)
        hosts.append((Participant(prefix, 0, own[:1], own[1:], (("239.255.0.1", 7400),)), host))
    (them, _), (us, _) = hosts
    for participant, _ in hosts:
        participant.start(0.0)
    writer = them.create_writer("rt/in", "pkg::T_", RELIABLE, 0.0)
    them.create_reader("rt/out", "T1", RELIABLE, 0.0)
    us.create_reader("rt/in", "pkg::T_", RELIABLE, 0.0)
    other = us.create_writer("rt/out", "T1", RELIABLE, 0.0)
    sent: list[bytes] = []
    now = 0.0
    for step in range(300):
        now += 0.02
        if step > 50 and step % 40 == 0:
            writer.write(b"\0\1\0\0" + bytes([step & 255] * 8), now)
            other.write(b"\0\1\0\0" + bytes(4), now)
        for (one, host), (two, _) in (hosts, hosts[::-1]):
            one.handle_deadline(now)
            for parts, _ in one.datagrams_to_send(now):
                datagram = b"".join(bytes(part) for part in parts)
                if one is them:
                    sent.append(datagram)
                two.receive_datagram(datagram, (host, 7410), now)
    them.close(now)
    sent += [b"".join(bytes(part) for part in parts) for parts, _ in them.datagrams_to_send(now)]
    return sent


class Receiving(Tables):
    """Queue, walker, submessages and discovery as `participant` joins them."""

    def __init__(self) -> None:
        self.peer_map = peers = PeerMap(2, 3)
        own = OwnMap(
            [Local("rt/out", "T1", reliable=True, words=2)], [Local("rt/in", "pkg::T_", reliable=True)]
        )
        self.queue: Any = DatagramQueue(LONGEST)
        self.walker: Any = Walker(peers, own)
        self.submessages: Any = Submessages(peers, own)
        self.discovery: Any = Discovery(peers, own)
        init = own.init(OURS, bytes(4), 7410, 7411)
        blocks = {name: getattr(self, name) for name in ("queue", "walker", "submessages", "discovery")}
        super().__init__(peers, own, init, **blocks)
        self.drops = [
            f"{name}.{port}"
            for name, block in blocks.items()
            for port in block.signature.members
            if port.startswith("drop_")
        ]

    def elaborate(self, platform: object) -> Module:
        m = super().elaborate(platform)
        queue, walker, submessages, discovery = self.queue, self.walker, self.submessages, self.discovery
        connect(m, queue.o, walker.i)
        connect(m, walker.o, submessages.i)
        connect(m, submessages.discovery, discovery.i)
        m.d.comb += [
            walker.known.eq(queue.known),
            walker.good.eq(queue.good),
            walker.alive.eq(discovery.alive),
            walker.hold.eq(discovery.hold),
            discovery.idle.eq(walker.idle),
            discovery.heard.eq(walker.heard),
            discovery.heard_slot.eq(walker.heard_slot),
            submessages.over.eq(walker.idle),
            submessages.alive.eq(discovery.alive),
            submessages.matched.eq(discovery.matched),
        ]
        return m


class Node:
    def __init__(self, seed: int) -> None:
        self.dut = Receiving()
        self.bench = WordBench(self.dut, 0, seed)
        self.user: list[bytes] = []
        self.bench.count(*self.dut.drops)
        self.bench.watch(self._take)
        self.ctx: Any = None

    async def _take(self, ctx: Any) -> None:
        stream = self.dut.submessages.user.stream
        ctx.set(stream.ready, 1)
        octets = bytearray()
        while True:
            _, _, valid, item = await ctx.tick().sample(stream.valid, stream.payload)
            if valid and item.end:
                if not item.bad:
                    self.user.append(bytes(octets[: len(octets) - item.padding]))
                octets.clear()
            elif valid:
                octets += item.data.to_bytes(4, "little")

    def run(self, script: Any, cycles: int) -> None:
        async def process(ctx: Any) -> None:
            self.ctx = ctx
            ctx.set(self.dut.submessages.room, 1)
            addresses = {"mac": 0, "ip": address(IP), "gateway": 0, "mask": address(MASK)}
            ctx.set(self.dut.discovery.addresses, addresses)
            await ctx.tick()
            await script(self)

        self.bench.drive(process)
        self.bench.run(cycles=cycles)

    async def send(self, datagram: bytes) -> None:
        """A datagram, until it has been dealt with; an octet a cycle."""
        ctx, stream = self.ctx, self.dut.queue.i.stream
        bad = isinstance(datagram, Bad)
        for item in [
            *({"data": octet, "end": 0, "bad": 0} for octet in datagram),
            {"data": 0, "end": 1, "bad": bad},
        ]:
            ctx.set(stream.payload, item)
            ctx.set(stream.valid, 1)
            ready = 0
            while not ready:
                _, _, ready = await ctx.tick().sample(stream.ready)
        ctx.set(stream.valid, 0)
        await ctx.tick().repeat(2)
        for _ in range(20 * LONGEST):
            if not ctx.get(self.dut.queue.known) and ctx.get(self.dut.walker.idle):
                break
            await ctx.tick()
        else:
            raise AssertionError(f"stuck after {datagram.hex()}")
        await ctx.tick().repeat(4)

    @property
    def tables(self) -> tuple[int, int]:
        return self.ctx.get(self.dut.discovery.alive), self.ctx.get(self.dut.discovery.matched)

    async def second(self) -> None:
        tick = self.dut.discovery.tick
        self.ctx.set(tick, 1)
        await self.ctx.tick()
        self.ctx.set(tick, 0)

    async def prove_alive(self) -> None:
        """A participant comes, with a writer whose message arrives, once; and goes."""
        text = bytes(self.bench.random.randrange(256) for _ in range(8))
        e = self.bench.random.choice("<>")
        said = hand.endpoint(THEIRS + W, "rt/in", "pkg::T_", e)
        message = hand.message(hand.data(W, 7, b"\0\1\0\0" + text, e=e), prefix=THEIRS)
        for prefix in {THEIRS, *(self.known())}:
            await self.send(hand.departure(prefix))
        assert self.tables == (0, 0)
        await self.send(hand.spdp(THEIRS, "10.0.0.5", e))
        assert self.tables == (1, 0)
        await self.send(hand.message(hand.data(hand.PUBLICATIONS_WRITER, 1, said, e=e), prefix=THEIRS))
        assert self.tables == (1, 1)
        before = len(self.user)
        await self.send(message)
        await self.send(Bad(message))
        await self.send(message)
        assert self.user[before:] == [text]

    def known(self) -> list[bytes]:
        """Prefixes of who is there, whoever that is."""
        memory, base = self.dut.peek(self.ctx), self.dut.peer_map._participants
        return [
            b"".join(memory[base + 16 * n + k].to_bytes(4, "little") for k in range(3))
            for n in range(2)
            if self.tables[0] >> n & 1
        ]


def mutated(random_: random.Random, sent: list[bytes]) -> bytes:
    datagram = bytearray(random_.choice(sent))
    for _ in range(random_.randrange(1, 4)):
        at = random_.randrange(20 if random_.randrange(8) else 0, len(datagram)) if len(datagram) > 20 else 0
        kind = random_.randrange(8)
        if not datagram:
            break
        if kind < 3:
            datagram[at] = random_.choice(
                [0, 1, 0x80, 0xFF, datagram[at] ^ 1 << random_.randrange(8), random_.randrange(256)]
            )
        elif kind == 3:
            del datagram[at:]
        elif kind == 4:
            datagram[at:at] = random_.randbytes(random_.choice([1, 4, 8]))
        elif kind == 5:
            datagram += random_.choice(sent)[20:]
        elif kind == 6:
            datagram[at & ~3 : (at & ~3) + 4] = random_.choice(
                [bytes(4), b"\xff" * 4, b"\1\0\0\0", b"\0\0\0\1", b"\x15\5\0\0"]
            )
        else:
            del datagram[at & ~3 : (at & ~3) + 4]
    found = bytes(datagram[: random_.choice([LONGEST, LONGEST + 40])])
    return Bad(found) if random_.randrange(10) == 0 else found


def test_a_session_of_the_engine_is_understood_from_arrival_to_departure() -> None:
    sent = session()

    async def script(node: Node) -> None:
        seen: list[tuple[int, int]] = []
        for datagram in sent:
            await node.send(datagram)
            if not seen or seen[-1] != node.tables:
                seen.append(node.tables)
        assert seen[0] == (0, 0) or seen[0] == (1, 0)
        assert max(seen) == (1, 0b11) and seen[-1] == (0, 0)
        assert len(node.user) >= 4 and all(len(octets) == 8 for octets in node.user)
        assert len(set(node.user)) == len(node.user)

    one = Node(0)
    one.run(script, 400_000)
    quiet = {name: count for name, count in one.bench.counts.items() if count}
    assert set(quiet) <= {"submessages.drop_unmatched", "submessages.drop_old", "submessages.drop_early"}, (
        quiet
    )


def test_who_announces_itself_twice_in_a_datagram_is_there_once() -> None:
    once = hand.spdp(THEIRS)

    async def script(node: Node) -> None:
        await node.send(once + once[20:])
        assert node.tables == (1, 0)
        await node.send(once + once[20:])
        assert node.tables == (1, 0)
        await node.send(hand.spdp(OURS[:11] + b"\xee"))
        assert node.tables == (3, 0)
        await node.prove_alive()

    Node(0).run(script, 20_000)


def test_who_has_departed_is_not_known_for_the_rest_of_the_datagram() -> None:
    leaves = hand.departure(THEIRS)
    said = hand.data(hand.PUBLICATIONS_WRITER, 1, hand.endpoint(THEIRS + W, "rt/in", "pkg::T_"))

    async def script(node: Node) -> None:
        await node.send(hand.spdp(THEIRS))
        await node.send(leaves + said)
        assert node.tables == (0, 0)
        # And who departs and comes back is new: what it says is heard from the first on.
        await node.send(hand.spdp(THEIRS))
        await node.send(hand.message(said, prefix=THEIRS))
        assert node.tables == (1, 1)
        await node.send(leaves + hand.spdp(THEIRS)[20:])
        assert node.tables == (1, 0)
        await node.send(hand.message(said, prefix=THEIRS))
        assert node.tables == (1, 1)
        await node.prove_alive()

    Node(0).run(script, 20_000)


@pytest.mark.parametrize("seed", range(2))
def test_after_hostile_datagrams_every_good_one_is_still_handled(seed: int) -> None:
    random_ = random.Random(seed)
    sent = [datagram for datagram in session() if len(datagram) < 700]

    async def script(node: Node) -> None:
        for _ in range(7):
            for _ in range(7):
                await node.send(mutated(random_, sent))
                if random_.randrange(4) == 0:
                    await node.second()
            await node.prove_alive()

    one = Node(seed)
    one.run(script, 1_000_000)
    counted = {name for name, count in one.bench.counts.items() if count}
    assert len(counted) >= 3, counted


def test_recorded_sessions_of_other_makers_are_walked_without_a_fault() -> None:
    """Fast DDS, of two distributions, and Cyclone DDS, as they spoke to each other: nothing is malformed, nobody is
    stuck."""

    async def script(node: Node) -> None:
        for name in ("fastdds_cyclone_topic", "jazzy_topic"):
            recorded = [payload for _, _, payload in pcap.read(ROOT / f"tests/captures/rtps/{name}.pcap")]
            for datagram in [one for one in recorded if len(one) <= LONGEST][:15]:
                await node.send(datagram)
        await node.prove_alive()

    one = Node(3)
    one.run(script, 1_000_000)
    for name in (
        "walker.drop_truncated",
        "walker.drop_not_rtps",
        "walker.drop_version",
        "discovery.drop_malformed",
        "submessages.drop_invalid",
    ):
        assert one.bench.counts[name] == 0, name
