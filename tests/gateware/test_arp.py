"""ARP as RFC 826 has it, octets by hand and by scapy: scapy asks, answers and lies, and reads what is sent."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import pytest
from scapy.layers.l2 import ARP, Ether

from gateware.frames import STALLS, Bad, Bench
from gateware.network import (
    BROADCAST,
    GATEWAY,
    IP,
    MAC,
    PEER,
    PEER_MAC,
    address,
    configure,
    number,
    octets,
    watch_pauses,
)
from roslet.gateware.arp import Arp
from roslet.gateware.arp_rx import ArpRx

RETRY, LIFE = 600, 1500
TICK = 128
"""Of the contract of `ArpCache`, with 2 entries: intervals are met within it."""

WITHIN = 6 * (16 + 4)
"""Cycles of an answer, by the contract of `ArpCache` with 16 entries."""

SMALL = {"cache_width": 1, "resolving": 1}
GAP = 4 + 12 + 8 + 14
"""Octets on the line between messages: FCS, gap, preamble and header (IEEE 802.3, 3.1.1 and 4.4.2), at a cycle each."""

Answer = tuple[bool, bool, bytes]
PENDING: Answer = (False, False, b"")
FAILED: Answer = (False, True, b"")


def message(operation: int, sender: bytes, ip: bytes, target: bytes, target_ip: bytes) -> bytes:
    return struct.pack("!HHBBH6s4s6s4s", 1, 0x0800, 6, 4, operation, sender, ip, target, target_ip)


def request(sender: bytes = PEER_MAC, ip: bytes = PEER, target: bytes = IP) -> bytes:
    return message(1, sender, ip, bytes(6), target)


def reply(sender: bytes = PEER_MAC, ip: bytes = PEER) -> bytes:
    return message(2, sender, ip, MAC, IP)


class Node:
    """An Arp block on a bench: what it sends is taken all the time, what it is told and asked comes in order."""

    def __init__(self, stalls: int = 30, parameters: Any = None, **inputs: Any) -> None:
        self.bench = Bench(Arp(**(parameters or {})), stalls)
        settings = {"enable": 1, "retry_count": 3, "retry_interval": 10**6, "timeout": 10**6}
        configure(self.bench, **{**settings, **inputs})
        self.sent = self.bench.receive("o")
        self.bench.count("drop_arp", "drop_busy")
        self.dut: Any = self.bench.dut

    async def tell(self, ctx: Any, *frames: bytes, gap: int = GAP) -> None:
        port = self.dut.i.stream
        for frame in frames:
            await ctx.tick().repeat(gap)
            items = [{"data": octet, "end": 0, "bad": 0} for octet in frame]
            for item in [*items, {"data": 0, "end": 1, "bad": isinstance(frame, Bad)}]:
                ctx.set(port.payload, item)
                ctx.set(port.valid, 1)
                await ctx.tick().until(port.ready)
                ctx.set(port.valid, 0)

    async def ask(self, ctx: Any, ip: bytes) -> Answer:
        lookup = self.dut.lookup
        ctx.set(lookup.ip, number(ip))
        ctx.set(lookup.valid, 1)
        for _ in range(WITHIN):
            _, _, done, found, failed, mac = await ctx.tick().sample(
                lookup.done, lookup.found, lookup.failed, lookup.mac
            )
            if done:
                ctx.set(lookup.valid, 0)
                assert not (found and failed)
                return bool(found), bool(failed), octets(mac, 6) if found else b""
        raise AssertionError(f"no answer within {WITHIN} cycles")

    async def rest(self, ctx: Any, cycles: int = 200) -> None:
        await ctx.tick().repeat(cycles)

    def run(self, process: Any, cycles: int = 100_000) -> None:
        self.bench.drive(process)
        self.bench.run(cycles=cycles)

    @property
    def frames(self) -> list[tuple[bytes, bytes]]:
        """What was sent, but for the announcement: destination and message."""
        got = [(frame[:6], frame[6:]) for frame, _ in self.sent]
        assert all(meta.type == 0x0806 for _, meta in self.sent)
        assert not got or got[0] == (BROADCAST, request(MAC, IP, IP))
        return got[1:]

    @property
    def asked(self) -> list[bytes]:
        """The addresses that were asked for."""
        return [frame[24:] for destination, frame in self.frames if frame[7] == 1]


def found(mac: bytes) -> Answer:
    return True, False, mac


def test_its_own_address_is_announced_once_when_it_is_enabled_and_not_before() -> None:
    node = Node(enable=0)
    quiet: list[int] = []

    async def process(ctx: Any) -> None:
        await node.rest(ctx)
        await node.tell(ctx, request())
        assert await node.ask(ctx, PEER) == FAILED
        await node.rest(ctx)
        quiet.append(len(node.sent))
        ctx.set(node.dut.enable, 1)
        await node.rest(ctx, 500)

    node.run(process)
    assert quiet == [0]
    assert len(node.sent) == 1
    assert node.frames == []
    assert node.sent[0][0] == bytes.fromhex(
        "ffffffffffff 0001 0800 06 04 0001 020000000002 c0a80164 000000000000 c0a80164"
    )


@pytest.mark.parametrize("stalls", STALLS)
def test_a_request_for_our_address_is_answered_to_whoever_asked(stalls: int) -> None:
    node = Node(stalls)
    pauses = watch_pauses(node.bench)  # which a MAC that does not store frames could not bear
    asked = ARP(hwsrc="02:00:00:00:0a:0b", psrc="192.168.1.10", pdst="192.168.1.100", op="who-has")

    async def process(ctx: Any) -> None:
        await node.rest(ctx)
        await node.tell(ctx, bytes(asked), request(target=GATEWAY), bytes(asked) + bytes(18))
        await node.rest(ctx, 1000)

    node.run(process)
    assert [destination for destination, _ in node.frames] == [PEER_MAC] * 2
    for _, frame in node.frames:
        answer = ARP(frame)
        assert answer.answers(asked)
        assert (answer.op, answer.hwsrc, answer.psrc) == (2, "02:00:00:00:00:02", "192.168.1.100")
        assert (answer.hwdst, answer.pdst) == ("02:00:00:00:0a:0b", "192.168.1.10")
        assert frame == message(2, MAC, IP, PEER_MAC, PEER)
    assert node.bench.counts == {"drop_arp": 0, "drop_busy": 0}
    assert pauses == []


@pytest.mark.parametrize("stalls", STALLS)
def test_an_unknown_address_is_asked_for_and_found_when_its_owner_answers(stalls: int) -> None:
    node = Node(stalls)
    answers: list[Answer] = []

    async def process(ctx: Any) -> None:
        await node.rest(ctx)
        answers.append(await node.ask(ctx, PEER))
        await node.rest(ctx, 500)
        answers.append(await node.ask(ctx, PEER))
        asked = ARP(node.frames[0][1])
        answer = ARP(op="is-at", hwsrc=PEER_MAC, psrc=asked.pdst, hwdst=asked.hwsrc, pdst=asked.psrc)
        await node.tell(ctx, bytes(Ether(dst=MAC) / answer)[14:] + bytes(18))
        await node.rest(ctx, 60)
        answers.append(await node.ask(ctx, PEER))

    node.run(process)
    assert answers == [PENDING, PENDING, found(PEER_MAC)]
    assert node.frames == [(BROADCAST, request(MAC, IP, PEER))]


@pytest.mark.parametrize("count", [0, 1, 3])
def test_an_address_fails_an_interval_after_the_last_request_and_is_asked_for_anew_another_later(
    count: int,
) -> None:
    node = Node(0, SMALL, retry_count=count, retry_interval=RETRY)
    cycle = [0]
    events: list[tuple[str, int]] = []

    async def watch(ctx: Any) -> None:
        while len(events) < max(count, 1) + 2:
            (_, _, asked) = await ctx.tick().sample(node.dut._cache.ask)
            cycle[0] += 1
            if asked:
                events.append(("ask", cycle[0]))

    async def process(ctx: Any) -> None:
        await node.rest(ctx, 100)
        last = None
        while len(events) < max(count, 1) + 2:
            answer = await node.ask(ctx, PEER)
            if answer != last and answer == FAILED:
                events.append(("failed", cycle[0]))
            last = answer

    node.bench.drive(watch)
    node.run(process)
    assert [name for name, _ in events] == ["ask"] * max(count, 1) + ["failed", "ask"]
    for (_, before), (_, after) in pairwise(events):
        assert RETRY - TICK < after - before < RETRY + TICK + 30


def test_an_address_is_forgotten_timeout_after_it_was_last_learned() -> None:
    node = Node(0, SMALL, timeout=LIFE)
    lives: list[int] = []

    async def process(ctx: Any) -> None:
        await node.rest(ctx)
        for refresh in (0, 900):
            await node.tell(ctx, request())
            if refresh:
                await node.rest(ctx, refresh)
                await node.tell(ctx, request(target=GATEWAY))
            await node.rest(ctx, 40)
            for n in range(200):
                if not (await node.ask(ctx, PEER))[0]:
                    lives.append(n * 50)
                    break
                await node.rest(ctx, 43)

    node.run(process)
    assert len(lives) == 2
    for life in lives:
        assert LIFE - 1.8 * TICK < life < LIFE + 1.8 * TICK


def test_who_asks_for_us_is_known_at_once() -> None:
    node = Node()
    answers: list[Answer] = []

    async def process(ctx: Any) -> None:
        await node.rest(ctx)
        await node.tell(ctx, request())
        await node.rest(ctx, 60)
        answers.append(await node.ask(ctx, PEER))

    node.run(process)
    assert answers == [found(PEER_MAC)]
    assert node.asked == []


OTHER_MAC = bytes.fromhex("0200 00de ad01")


@pytest.mark.parametrize(
    ("lies", "answer"),
    [
        ([reply()], PENDING),  # nobody asked
        ([request(ip=bytes(4))], PENDING),  # a probe
        ([request(target=GATEWAY)], PENDING),  # for somebody else
        ([request(ip=PEER, target=PEER)], PENDING),  # an announcement
        ([request(), reply(OTHER_MAC)], found(OTHER_MAC)),  # what is cached follows its owner: RFC 826
        ([request(), request(OTHER_MAC, PEER, PEER)], found(OTHER_MAC)),
        ([request(), request(OTHER_MAC, PEER, GATEWAY)], found(OTHER_MAC)),
        ([request(), Bad(request(OTHER_MAC))], found(PEER_MAC)),
        ([request(), request(OTHER_MAC)[:27]], found(PEER_MAC)),
    ],
)
def test_what_is_learned_from_messages_that_nobody_asked_for(lies: Sequence[bytes], answer: Answer) -> None:
    node = Node(stalls=0)
    answers: list[Answer] = []

    async def process(ctx: Any) -> None:
        await node.rest(ctx)
        for lie in lies:
            await node.tell(ctx, lie)
            await node.rest(ctx, 100)
        answers.append(await node.ask(ctx, PEER))

    node.run(process)
    assert answers == [answer]


def test_a_probe_is_answered() -> None:
    node = Node()

    async def process(ctx: Any) -> None:
        await node.rest(ctx)
        await node.tell(ctx, request(ip=bytes(4)))
        await node.rest(ctx, 500)

    node.run(process)
    assert node.frames == [(PEER_MAC, message(2, MAC, IP, PEER_MAC, bytes(4)))]


@pytest.mark.parametrize("stalls", STALLS)
def test_malformed_messages_are_dropped_whole_and_counted(stalls: int) -> None:
    good = request()
    wrong = [good[:n] + bytes([good[n] ^ 0x20]) + good[n + 1 :] for n in range(8)]
    wrong += [message(operation, PEER_MAC, PEER, bytes(6), IP) for operation in (0, 3, 4, 0x0101)]
    wrong += [request(sender=BROADCAST), request(sender=bytes.fromhex("0100 5e00 0001"))]
    wrong += [request(ip=IP), message(2, PEER_MAC, IP, MAC, IP)]
    wrong += [frame + bytes(18) for frame in wrong]
    wrong += [good[:size] for size in range(28)]
    spoilt = [Bad(frame) for frame in [*wrong, good, good + bytes(18)]]
    bench = Bench(ArpRx(), stalls)
    configure(bench)
    bench.send("i", [*wrong, *spoilt, good, good + bytes(18)])
    bench.count("seen", "drop_arp", "drop_busy")
    bench.run()
    assert bench.counts == {"seen": 2, "drop_arp": len(wrong), "drop_busy": 0}


def test_a_message_is_not_overwritten_while_it_is_held() -> None:
    bench = Bench(ArpRx(), stalls=0)
    configure(bench, hold=1)
    bench.send("i", [request(), Bad(request()), request() + bytes(18), request()[:8]])
    bench.count("seen", "overwritten", "drop_arp", "drop_busy")
    bench.run()
    assert bench.counts == {"seen": 0, "overwritten": 0, "drop_arp": 1, "drop_busy": 2}


@pytest.mark.parametrize(
    ("ip", "answer"),
    [
        ("224.0.0.1", found(bytes.fromhex("0100 5e00 0001"))),
        ("239.255.0.1", found(bytes.fromhex("0100 5e7f 0001"))),
        ("255.255.255.255", found(BROADCAST)),
        ("192.168.1.255", found(BROADCAST)),
        ("192.168.1.100", FAILED),
        ("0.0.0.0", FAILED),
        ("192.168.2.255", PENDING),
        ("192.168.1.254", PENDING),
        ("8.8.8.8", PENDING),
    ],
)
def test_groups_and_broadcast_are_answered_without_asking(ip: str, answer: Answer) -> None:
    node = Node()
    answers: list[Answer] = []

    async def process(ctx: Any) -> None:
        await node.rest(ctx)
        answers.append(await node.ask(ctx, address(ip)))
        await node.rest(ctx, 500)

    node.run(process)
    assert answers == [answer]
    asked = GATEWAY if not ip.startswith("192.168.1.") else address(ip)
    assert node.asked == ([asked] if answer == PENDING else [])


def test_what_lies_outside_the_subnet_goes_to_the_gateway_which_is_asked_for_once() -> None:
    node = Node(stalls=0)
    answers: list[Answer] = []

    async def process(ctx: Any) -> None:
        await node.rest(ctx)
        for ip in ("10.0.0.1", "8.8.8.8", "192.168.1.1"):
            answers.append(await node.ask(ctx, address(ip)))
        await node.tell(ctx, reply(OTHER_MAC, GATEWAY))
        await node.rest(ctx, 60)
        for ip in ("10.0.0.1", "8.8.8.8", "192.168.1.1"):
            answers.append(await node.ask(ctx, address(ip)))

    node.run(process)
    assert answers == [PENDING] * 3 + [found(OTHER_MAC)] * 3
    assert node.asked == [GATEWAY]


def test_without_a_gateway_what_lies_outside_the_subnet_fails_but_for_groups_and_broadcast() -> None:
    node = Node()
    configure(node.bench, gateway=bytes(4))
    answers: list[Answer] = []

    async def process(ctx: Any) -> None:
        await node.rest(ctx)
        answers.append(await node.ask(ctx, address("8.8.8.8")))
        answers.append(await node.ask(ctx, address("239.1.2.3")))
        answers.append(await node.ask(ctx, address("255.255.255.255")))

    node.run(process)
    assert answers == [FAILED, found(bytes.fromhex("0100 5e01 0203")), found(BROADCAST)]


def test_a_link_of_two_has_no_broadcast_address() -> None:
    node = Node()
    configure(node.bench, mask=bytes((255, 255, 255, 254)))
    answers: list[Answer] = []

    async def process(ctx: Any) -> None:
        await node.rest(ctx)
        answers.append(await node.ask(ctx, address("192.168.1.101")))

    node.run(process)
    assert answers == [PENDING]


def neighbour(n: int) -> tuple[bytes, bytes]:
    return bytes((2, 0, 0, 0, 1, n)), bytes((192, 168, 1, n))


def test_several_addresses_resolve_at_once_and_further_ones_wait_for_them() -> None:
    node = Node(stalls=0)
    answers: list[Answer] = []

    async def process(ctx: Any) -> None:
        await node.rest(ctx)
        for n in range(1, 7):
            answers.append(await node.ask(ctx, neighbour(n)[1]))
            await node.rest(ctx, 100)
        assert node.asked == [neighbour(n)[1] for n in range(1, 5)]
        await node.tell(ctx, reply(*neighbour(3)))
        await node.rest(ctx, 60)
        for n in (3, 6, 5):
            answers.append(await node.ask(ctx, neighbour(n)[1]))
        await node.rest(ctx, 100)
        assert node.asked[4:] == [neighbour(6)[1]]

    node.run(process)
    assert answers == [PENDING] * 6 + [found(neighbour(3)[0]), PENDING, PENDING]


def test_what_is_asked_for_displaces_in_turn_and_what_is_told_does_not() -> None:
    node = Node(stalls=0, parameters={"cache_width": 2, "resolving": 2})
    answers: dict[int, Answer] = {}

    async def process(ctx: Any) -> None:
        await node.rest(ctx)
        for n in range(1, 8):  # four of whom find room
            await node.tell(ctx, request(*neighbour(n)))
            await node.rest(ctx, 100)
        for n in range(1, 5):
            answers[n] = await node.ask(ctx, neighbour(n)[1])
        for n in range(5, 8):
            await node.ask(ctx, neighbour(n)[1])  # asked for: displaces one
            await node.rest(ctx, 100)
            await node.tell(ctx, reply(*neighbour(n)))
            await node.rest(ctx, 60)
        for n in range(4, 8):
            answers[n] = await node.ask(ctx, neighbour(n)[1])

    node.run(process)
    assert answers == {n: found(neighbour(n)[0]) for n in range(1, 8)}
    assert node.asked == [neighbour(n)[1] for n in range(5, 8)]


def test_what_is_being_resolved_is_not_displaced() -> None:
    node = Node(stalls=0, parameters={"cache_width": 1})  # both entries may be resolving
    answers: list[Answer] = []

    async def process(ctx: Any) -> None:
        await node.rest(ctx)
        for n in (1, 2, 3):
            await node.ask(ctx, neighbour(n)[1])
        for n in (3, 2, 1):
            await node.tell(ctx, reply(*neighbour(n)))
            await node.rest(ctx, 60)
        for n in (1, 2):
            answers.append(await node.ask(ctx, neighbour(n)[1]))

    node.run(process)
    assert answers == [found(neighbour(n)[0]) for n in (1, 2)]


def test_a_flood_of_requests_is_answered_as_fast_as_it_can_be_and_nothing_is_stuck() -> None:
    node = Node(stalls=0)
    answers: list[Answer] = []

    async def flood(ctx: Any) -> None:
        await node.rest(ctx)
        for n in range(60):  # closer than any line can bring them
            await node.tell(ctx, request(*neighbour(n + 1)))
        await node.rest(ctx, 300)

    async def process(ctx: Any) -> None:
        await node.rest(ctx, 600)
        for _ in range(20):
            answers.append(await node.ask(ctx, address("192.168.1.200")))
            await node.rest(ctx, 30)

    node.bench.drive(flood)
    node.run(process)
    replies = [frame for _, frame in node.frames if frame[7] == 2]
    assert len(replies) + node.bench.counts["drop_busy"] == 60
    assert len(replies) > 25
    assert all(frame[18:24] == neighbour(frame[27])[0] for frame in replies)
    assert node.asked[0] == address("192.168.1.200")  # between the replies
    assert answers == [PENDING] * 20


@pytest.mark.parametrize(("stuck", "lost"), [(False, 0), (True, 2)])
def test_one_reply_waits_while_one_is_sent_and_the_newest_is_kept(stuck: bool, lost: int) -> None:
    node = Node(stalls=0)

    async def process(ctx: Any) -> None:
        await node.rest(ctx, 100)
        await node.tell(ctx, request(*neighbour(1)))
        if stuck:
            node.bench.stalls = 97
        await node.rest(ctx, 30)
        for n in (2, 3, 4):
            await node.tell(ctx, request(*neighbour(n)) + bytes(18))
            await node.rest(ctx, 20 if stuck else 100)
        node.bench.stalls = 0
        await node.rest(ctx, 200)

    node.run(process)
    assert node.bench.counts["drop_busy"] == lost
    last = node.frames[-1]
    assert last == (neighbour(4)[0], message(2, MAC, IP, *neighbour(4)))


def test_whenever_the_next_message_comes_a_reply_is_to_one_that_was_whole() -> None:
    node = Node(stalls=0)
    askers = [(bytes([16 * n, *PEER_MAC[1:5], n]), address(f"192.168.1.{n}")) for n in (1, 2, 3)]
    gaps = range(1, 80)  # one is answered while the next ones come

    async def process(ctx: Any) -> None:
        await node.rest(ctx)
        for gap in gaps:
            await node.tell(ctx, *(request(*asker) for asker in askers), gap=gap)
            await node.rest(ctx, 300)

    node.run(process)
    replies = [(mac, message(2, MAC, IP, mac, ip)) for mac, ip in askers]
    assert all(frame in replies for frame in node.frames)
    assert len(node.frames) + node.bench.counts["drop_busy"] == 3 * len(gaps)
    assert all(node.frames.count(frame) > 50 for frame in replies) and node.bench.counts["drop_busy"] > 0


def test_a_message_is_taken_an_octet_a_cycle_whatever_becomes_of_it() -> None:
    bench = Bench(Arp(), stalls=0)
    configure(bench, enable=1)
    bench.send("i", [request() + bytes(18)] * 10, [{"source": 0, "group": 0}] * 10)
    bench.run(cycles=10 * 47 + 5)


@pytest.mark.parametrize(
    ("parameters", "sentence"),
    [
        ({"cache_width": 0}, "a cache has .* entries, not 2..0"),
        ({"cache_width": 9}, "a cache has .* entries, not 2..9"),
        ({"resolving": 0}, "of 16 entries 1 to 16 can be resolving, not 0"),
        ({"resolving": 17}, "of 16 entries 1 to 16 can be resolving, not 17"),
    ],
)
def test_impossible_sizes_are_refused(parameters: dict[str, int], sentence: str) -> None:
    with pytest.raises(ValueError, match=sentence):
        Arp(**parameters)


def test_an_answer_takes_no_more_cycles_than_the_contract_says() -> None:
    node = Node(stalls=0)
    taken: list[int] = []

    async def flood(ctx: Any) -> None:
        await node.rest(ctx)
        for n in range(40):
            await node.tell(ctx, request(*neighbour(n % 16 + 1)))

    async def process(ctx: Any) -> None:
        await node.rest(ctx)
        for _ in range(60):
            for ip in (address("224.0.0.9"), neighbour(16)[1]):
                ctx.set(node.dut.lookup.ip, number(ip))
                ctx.set(node.dut.lookup.valid, 1)
                taken.append(1)
                while not ctx.get(node.dut.lookup.done):
                    await ctx.tick()
                    taken[-1] += 1
                await ctx.tick()
                ctx.set(node.dut.lookup.valid, 0)
                await ctx.tick()

    node.bench.drive(flood)
    node.run(process)
    assert min(taken[::2]) == 7
    assert max(taken) <= WITHIN
