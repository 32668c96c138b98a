"""Who is there and what matches: RTPS 2.3, 8.5.3, 8.5.4; DDS 1.4, 2.2.3 (requested against offered)."""

from __future__ import annotations

import struct

import pytest

from engine.rtps import hand
from gateware.frames import STALLS
from gateware.rtps.discovering import GROUP_PORT, Node, address, prefix
from gateware.words import words
from roslet.gateware.rtps import ports
from roslet.gateware.rtps.tables import Local

W, R = b"\0\0\1\3", b"\0\0\2\4"
PARTICIPANT, PUBLICATION, SUBSCRIPTION = ports.PARTICIPANTS, ports.PUBLICATIONS, ports.SUBSCRIPTIONS


def reliability(kind: int, e: str = "<") -> bytes:
    return hand.parameter(0x1A, struct.pack(e + "IiI", kind, 0, 0), e)


def durability(kind: int, e: str = "<") -> bytes:
    return hand.parameter(0x1D, struct.pack(e + "I", kind), e)


def endpoint(
    entity: bytes = W,
    topic: str = "rt/in",
    type_name: str = "pkg::T_",
    n: int = 1,
    e: str = "<",
    *more: bytes,
) -> bytes:
    """Best effort, as it is the least that a writer offers and a reader asks for... of which `more` may say more."""
    return hand.payload(
        hand.parameter(0x5A, prefix(n) + entity, e),
        hand.parameter(0x05, hand.text(topic, e), e),
        hand.parameter(0x07, hand.text(type_name, e), e),
        *more,
        e=e,
    )


# -- participants


@pytest.mark.parametrize("stalls", STALLS)
@pytest.mark.parametrize("e", "<>")
def test_a_participant_is_kept_as_it_announces_itself_and_greeted(e: str, stalls: int) -> None:
    async def script(node: Node) -> None:
        came = await node.say(PARTICIPANT, hand.participant(prefix(1), "10.0.0.7", e), prefix(1))
        assert came == ([], [0, 1, 2, 3], [0], 0b01, 0)
        *guid, meta_ip, meta_port, user_ip, user_port, lease, _ = node.participant(0)
        assert guid == words(prefix(1))
        assert (meta_ip, meta_port, user_ip, user_port) == (
            address("10.0.0.7"),
            7410,
            address("10.0.0.7"),
            7411,
        )
        assert lease == 20
        await node.second()
        assert node.participant(0)[8] == 20
        # From its writers all is wanted, and its readers have been sent nothing yet and get everything.
        for kind in (2, 3):
            assert node.builtin(0, kind)[4:] == [1, 0, 0, 0]
        for kind in (0, 1):
            assert node.builtin(0, kind)[4:] == [0, 1, 0x7FFFFFFF, 0]
        # A second one; and then the first moves, which greets nobody.
        assert await node.arrive(2) == ([], [4, 5, 6, 7], [1], 0b11, 0)
        moved = hand.participant(prefix(1), "10.0.0.8", e)
        assert await node.say(PARTICIPANT, moved, prefix(1), 0) == ([], [], [], 0b11, 0)
        assert node.participant(0)[3:7] == [address("10.0.0.8"), 7410, address("10.0.0.8"), 7411]
        assert node.participant(1)[:3] == words(prefix(2))

    Node(stalls=stalls).run(script)


def test_a_full_table_makes_room_for_nobody_and_counts() -> None:
    async def script(node: Node) -> None:
        await node.arrive(1)
        await node.arrive(2)
        before = node.kept()
        assert await node.arrive(3) == (["full"], [], [], 0b11, 0)
        assert node.kept() == before
        assert (await node.arrive(2, slot=1)).drops == []

    Node().run(script)


def test_a_participant_that_departs_makes_room_and_comes_again_under_another_guid() -> None:
    async def script(node: Node) -> None:
        await node.arrive(1)
        await node.arrive(2)
        for n in range(3, 9):
            slot = n % 2
            gone = await node.say(PARTICIPANT, b"", prefix(n - 2), slot, gone=True, key=bytes(16))
            assert gone == ([], [], [], 0b10 >> slot, 0)
            assert (await node.arrive(n)).alive == 0b11
            assert node.participant(slot)[:3] == words(prefix(n))
        # Somebody unknown who departs was never there.
        assert await node.say(PARTICIPANT, b"", prefix(1), gone=True) == ([], [], [], 0b11, 0)

    Node().run(script)


def test_endpoints_go_with_their_participant_and_those_of_others_stay() -> None:
    async def script(node: Node) -> None:
        await node.arrive(1)
        await node.arrive(2)
        await node.tell(endpoint(), 0, 1)
        await node.tell(endpoint(n=2), 1, 2)
        assert (await node.tell(endpoint(R, "rt/out", "T1"), 0, 1)).matched == 0b111
        came = await node.say(PARTICIPANT, b"", prefix(1), 0, gone=True)
        assert (came.alive, came.matched) == (0b10, 0b010)
        assert (await node.tell(endpoint(n=2, entity=b"\0\0\7\3"), 1, 2)).matched == 0b011

    Node().run(script)


def test_who_is_silent_for_its_lease_is_gone_and_who_is_heard_stays() -> None:
    async def script(node: Node) -> None:
        lease = hand.parameter(0x02, struct.pack("<iI", 3, 0))
        await node.arrive(1, None, lease)
        await node.arrive(2, None, lease)
        await node.tell(endpoint(), 0, 1)
        lived = 0
        while node.ctx.get(node.block.alive) & 1:
            await node.second(heard=[1])
            lived += 1
            assert lived < 10
        assert 3 <= lived <= 3 + 2 + 1
        assert (node.ctx.get(node.block.alive), node.ctx.get(node.block.matched)) == (0b10, 0)
        for _ in range(12):
            await node.second(heard=[1])
        assert node.ctx.get(node.block.alive) == 0b10
        # It announces itself again: it is new.
        assert (await node.arrive(1)).greet == [0]

    Node().run(script)


def test_leases_of_all_lengths() -> None:
    async def script(node: Node) -> None:
        for seconds, kept in (
            (0, 0),
            (1, 1),
            (0xFFFE, 0xFFFE),
            (0xFFFF, 0xFFFF),
            (0x10000, 0x10000),
            (0x7FFFFFFF, 0x1FFFF),
        ):
            slot = 0 if node.ctx.get(node.block.alive) else None
            await node.arrive(1, slot, hand.parameter(0x02, struct.pack("<iI", seconds, 0xFFFFFFFF)))
            assert node.participant(0)[7] == kept
        # None said: 100 s (9.6.2.2.2).
        said = hand.payload(
            hand.parameter(0x50, prefix(1) + hand.PARTICIPANT),
            hand.parameter(0x32, hand.locator("10.0.0.1", 1)),
        )
        await node.say(PARTICIPANT, said, prefix(1), 0)
        assert node.participant(0)[7] == 100

    Node().run(script)


def test_leases_are_looked_at_only_while_the_walker_is_idle_which_is_held() -> None:
    async def script(node: Node) -> None:
        ctx, block = node.ctx, node.block
        await node.arrive(1)
        ctx.set(block.idle, 0)
        ctx.set(block.tick, 1)
        await ctx.tick()
        ctx.set(block.tick, 0)
        before = node.participant(0)
        for _ in range(40):
            await ctx.tick()
            assert ctx.get(block.hold)
        assert node.participant(0) == before
        ctx.set(block.idle, 1)
        await ctx.tick().repeat(40)
        assert not ctx.get(block.hold)

    Node().run(script)


@pytest.mark.parametrize(
    ("more", "reason"),
    [
        (hand.parameter(0x0F, struct.pack("<I", 5)), None),
        (hand.parameter(0x0F, struct.pack("<I", 6)), "refused"),
        (hand.parameter(0x0F, struct.pack("<I", 0x10005)), "refused"),
        (hand.parameter(0x4014, b"\1\0\0\0\0\0\0\0"), None),
        (hand.parameter(0x4014, hand.text("tag")), "refused"),
        (hand.parameter(0x4077, bytes(4)), "refused"),  # must be understood (9.6.2.2.1)
        (hand.parameter(0xC077, bytes(4)), None),  # a vendor's, who may mean anything
        (hand.parameter(0x8077, bytes(400)), None),
        (hand.parameter(0, bytes(12)), None),
        (hand.parameter(0x3F00, b""), None),
    ],
)
def test_who_is_of_another_domain_or_must_be_understood_is_refused(more: bytes, reason: str | None) -> None:
    async def script(node: Node) -> None:
        came = await node.arrive(1, None, more)
        assert (came.drops, came.alive) == ([reason] if reason else [], 0 if reason else 1)

    Node().run(script)


def test_a_participant_without_guid_or_locator_is_incomplete_and_one_of_another_guid_malformed() -> None:
    guid, here = (
        hand.parameter(0x50, prefix(1) + hand.PARTICIPANT),
        hand.parameter(0x32, hand.locator("10.0.0.1", 7410)),
    )

    async def script(node: Node) -> None:
        for said in (hand.payload(guid), hand.payload(here), hand.payload()):
            assert await node.say(PARTICIPANT, said, prefix(1)) == (["incomplete"], [], [], 0, 0)
        for n in range(12):
            wrong = bytearray(prefix(1))
            wrong[n] ^= 1
            said = hand.payload(hand.parameter(0x50, bytes(wrong) + hand.PARTICIPANT), here)
            assert await node.say(PARTICIPANT, said, prefix(1)) == (["malformed"], [], [], 0, 0)
        assert (await node.say(PARTICIPANT, hand.payload(guid, here), prefix(1))).alive == 1
        # Without a locator of its own, the user's messages go where discovery goes.
        assert node.participant(0)[3:7] == [address("10.0.0.1"), 7410] * 2

    Node().run(script)


# -- endpoints


@pytest.mark.parametrize("stalls", STALLS)
@pytest.mark.parametrize("e", "<>")
def test_endpoints_that_match_get_a_proxy(e: str, stalls: int) -> None:
    async def script(node: Node) -> None:
        await node.arrive(1)
        came = await node.tell(endpoint(W, "rt/in", "pkg::T_", 1, e, reliability(2, e)))
        assert came == ([], [8], [], 1, 0b001)
        assert node.endpoint(0) == [words(W)[0], 1 << 16, address("10.0.0.1"), 7411, 0, 0, 0, 0]
        here = hand.parameter(0x2F, hand.locator("10.0.0.9", 1234, e), e)
        came = await node.tell(endpoint(R, "rt/sure", "T2", 1, e, reliability(2, e), here))
        assert came == ([], [9], [], 1, 0b011)
        key, info, ip, port, acked, ask_from, ask_to, start = node.endpoint(1)
        assert (key, info, ip, port) == (words(R)[0], 1 << 8 | 1 << 17, address("10.0.0.9"), 1234)
        assert (acked, ask_from, ask_to, start) == (
            1,
            1,
            0,
            1,
        )  # nothing was written yet, and nothing is asked for
        # Transient-local both: what was written before is for it, all that is kept.
        came = await node.tell(
            endpoint(b"\0\0\3\4", "rt/latched", "T3", 1, e, reliability(2, e), durability(1, e))
        )
        assert came.matched == 0b111 and node.endpoint(2)[1] == 2 << 8 | 1 << 17
        assert (0 - node.endpoint(2)[7]) & 0xFFFFFFFF == 1 << 15  # MAX_HISTORY before the last
        # Said again, it moves only.
        node.ctx.set(node.bench.dut.peers_memory.data[node.peers._endpoints + 8 + 4], 77)
        came = await node.tell(endpoint(R, "rt/sure", "T2", 1, e, reliability(2, e)))
        assert came == ([], [], [], 1, 0b111)
        assert node.endpoint(1)[2:5] == [address("10.0.0.1"), 7411, 77]

    Node(stalls=stalls).run(script)


LISTENS = hand.locator("239.255.0.1", GROUP_PORT + 1)


@pytest.mark.parametrize(
    ("participant", "endpoint_", "in_group"),
    [
        ([], [], False),
        ([(0x48, LISTENS)], [], True),
        ([], [(0x30, LISTENS)], True),
        ([(0x48, hand.locator("239.255.0.1", GROUP_PORT))], [], False),  # that is discovery's port
        ([(0x48, hand.locator("239.255.0.2", GROUP_PORT + 1))], [], False),
        ([(0x48, hand.locator("239.255.0.2", GROUP_PORT + 1)), (0x48, LISTENS)], [], True),
        # With a locator of its own, what holds by default does not.
        ([(0x48, LISTENS)], [(0x2F, hand.locator("10.0.0.9", 1234))], False),
        ([], [(0x2F, hand.locator("10.0.0.9", 1234)), (0x30, LISTENS)], True),
        # Behind the gateway our group is not heard.
        ([(0x31, hand.locator("172.16.0.9", 7411)), (0x48, LISTENS)], [], False),
        ([(0x31, hand.locator("172.16.0.9", 7411))], [(0x30, LISTENS)], False),
        ([], [(0x30, LISTENS), (0x2F, hand.locator("172.16.0.9", 1234))], False),
    ],
)
@pytest.mark.parametrize("e", "<>")
def test_who_listens_to_the_group_within_our_subnet_may_get_messages_there(
    e: str, participant: list[tuple[int, bytes]], endpoint_: list[tuple[int, bytes]], in_group: bool
) -> None:
    def swapped(octets: bytes) -> bytes:  # kind and port are numbers
        return octets if e == "<" else octets[:4][::-1] + octets[4:8][::-1] + octets[8:]

    def said(parameters: list[tuple[int, bytes]]) -> list[bytes]:
        return [hand.parameter(pid, swapped(octets), e) for pid, octets in parameters]

    async def script(node: Node) -> None:
        guid = hand.parameter(0x50, prefix(1) + hand.PARTICIPANT, e)
        meta = hand.parameter(0x32, hand.locator("10.0.0.1", 7410, e), e)
        await node.say(PARTICIPANT, hand.payload(guid, meta, *said(participant), e=e), prefix(1))
        came = await node.tell(endpoint(R, "rt/sure", "T2", 1, e, reliability(2, e), *said(endpoint_)))
        assert came.matched == 1
        assert node.in_group(0) == in_group

    Node().run(script)


def test_of_a_transient_local_writer_all_is_wanted_from_the_first_on() -> None:
    async def script(node: Node) -> None:
        await node.arrive(1)
        await node.tell(endpoint(W, "rt/kept", "T6", 1, "<", reliability(2), durability(1)))
        assert node.endpoint(0)[1] == 2 << 8 | 1 << 16 | 1 << 17
        assert node.endpoint(0)[4:7] == [1, 0, 0]

    Node().run(script)


def test_an_endpoint_goes_when_it_is_disposed_of_by_key_or_by_list() -> None:
    async def script(node: Node) -> None:
        await node.arrive(1)
        for by_key in (True, False):
            assert (await node.tell(endpoint())).matched == 1
            other = hand.payload(hand.parameter(0x5A, prefix(1) + b"\0\0\x55\3"))
            assert (await node.tell(other, gone=True)).matched == 1
            if by_key:
                wrong = await node.tell(b"", gone=True, key=prefix(1) + b"\0\0\x55\3", kind=PUBLICATION)
                assert wrong.matched == 1
                wrong = await node.tell(b"", gone=True, key=prefix(1) + W, kind=SUBSCRIPTION)
                assert wrong.matched == 1
                came = await node.tell(b"", gone=True, key=prefix(1) + W, kind=PUBLICATION)
            else:
                came = await node.tell(hand.payload(hand.parameter(0x5A, prefix(1) + W)), gone=True)
            assert came == ([], [], [], 1, 0)
        assert (await node.tell(b"", gone=True, kind=PUBLICATION)).drops == ["incomplete"]

    Node().run(script)


def test_an_endpoint_that_agrees_no_more_goes() -> None:
    async def script(node: Node) -> None:
        await node.arrive(1)
        assert (await node.tell(endpoint())).matched == 1
        assert await node.tell(endpoint(topic="rt/other")) == ([], [], [], 1, 0)
        assert (await node.tell(endpoint())).matched == 1
        assert await node.tell(
            endpoint(W, "rt/in", "pkg::T_", 1, "<", hand.parameter(0x1F, b"\1\0\0\0"))
        ) == (["qos"], [], [], 1, 0)

    Node().run(script)


def test_more_endpoints_than_the_table_holds_are_counted_and_the_others_stay() -> None:
    async def script(node: Node) -> None:
        await node.arrive(1)
        for n in range(3):
            assert (await node.tell(endpoint(bytes([0, 0, n, 3])))).matched == (2 << n) - 1
        before = node.kept()
        assert await node.tell(endpoint(b"\0\0\x09\3")) == (["full"], [], [], 1, 0b111)
        assert node.kept() == before
        assert (await node.tell(endpoint(bytes([0, 0, 1, 3])))).drops == []
        await node.tell(hand.payload(hand.parameter(0x5A, prefix(1) + bytes([0, 0, 1, 3]))), gone=True)
        assert await node.tell(endpoint(b"\0\0\x09\3")) == ([], [9], [], 1, 0b111)

    Node().run(script)


def test_equal_ids_of_two_participants_are_two_endpoints() -> None:
    async def script(node: Node) -> None:
        await node.arrive(1)
        await node.arrive(2)
        await node.tell(endpoint(), 0, 1)
        assert (await node.tell(endpoint(n=2), 1, 2)).matched == 0b011
        await node.tell(hand.payload(hand.parameter(0x5A, prefix(2) + W)), 1, 2, gone=True)
        assert node.ctx.get(node.block.matched) == 0b001

    Node().run(script)


def test_an_endpoint_without_guid_topic_or_type_is_incomplete() -> None:
    parts = [
        hand.parameter(0x5A, prefix(1) + W),
        hand.parameter(0x05, hand.text("rt/in")),
        hand.parameter(0x07, hand.text("pkg::T_")),
    ]

    async def script(node: Node) -> None:
        await node.arrive(1)
        for n in range(3):
            came = await node.tell(hand.payload(*parts[:n], *parts[n + 1 :]), kind=PUBLICATION)
            assert came == (["incomplete"], [], [], 1, 0)
        assert (await node.tell(hand.payload(*reversed(parts)), kind=PUBLICATION)).matched == 1

    Node().run(script)


FOREVER = struct.pack("<iI", 0x7FFFFFFF, 0xFFFFFFFF)
SECOND = struct.pack("<iI", 1, 0)


def policy(pid: int, *values: int) -> bytes:
    return hand.parameter(pid, struct.pack("<" + "I" * len(values), *values))


def shorts(*values: int) -> bytes:
    return hand.parameter(0x73, struct.pack("<I" + "H" * len(values), len(values), *values))


OURS = {
    "in": ("rt/in", "pkg::T_", PUBLICATION),
    "strict": ("rt/strict", "T5", PUBLICATION),
    "kept": ("rt/kept", "T6", PUBLICATION),
    "out": ("rt/out", "T1", SUBSCRIPTION),
    "sure": ("rt/sure", "T2", SUBSCRIPTION),
    "latched": ("rt/latched", "T3", SUBSCRIPTION),
}
RELIABLE, BEST = reliability(2), reliability(1)
QOS: list[tuple[str, bytes, bool]] = [
    # our best-effort, volatile reader takes what any writer offers
    *(("in", one, True) for one in (b"", BEST, RELIABLE, *(durability(n) for n in range(4)))),
    # our reliable one only from a reliable writer, which a writer is that says nothing
    ("strict", RELIABLE, True),
    ("strict", b"", True),
    ("strict", BEST, False),
    # our transient-local one only from one that is so or more
    *(("kept", RELIABLE + durability(n), n >= 1) for n in range(4)),
    ("kept", b"", False),
    ("kept", BEST + durability(1), False),
    # our best-effort writer serves who asks for no more, as a reader does that says nothing
    ("out", b"", True),
    ("out", BEST, True),
    ("out", RELIABLE, False),
    *(("out", durability(n), n == 0) for n in range(4)),
    ("sure", b"", True),
    ("sure", RELIABLE, True),
    *(("sure", RELIABLE + durability(n), n == 0) for n in range(4)),
    *(("latched", RELIABLE + durability(n), n <= 1) for n in range(4)),
    # DEADLINE, LIVELINESS: what is offered may be better, what is asked for not
    ("in", hand.parameter(0x23, SECOND), True),
    ("out", hand.parameter(0x23, SECOND), False),
    ("out", hand.parameter(0x23, FOREVER), True),
    ("in", hand.parameter(0x1B, struct.pack("<I", 2) + SECOND), True),
    ("out", hand.parameter(0x1B, struct.pack("<I", 0) + FOREVER), True),
    ("out", hand.parameter(0x1B, struct.pack("<I", 1) + FOREVER), False),
    ("out", hand.parameter(0x1B, struct.pack("<I", 0) + SECOND), False),
    # OWNERSHIP must be equal
    ("in", policy(0x1F, 0), True),
    ("in", policy(0x1F, 1), False),
    ("out", policy(0x1F, 0), True),
    ("out", policy(0x1F, 1), False),
    # DESTINATION_ORDER, PRESENTATION
    ("in", policy(0x25, 1), True),
    ("out", policy(0x25, 0), True),
    ("out", policy(0x25, 1), False),
    ("in", policy(0x21, 2, 0x0101), True),
    ("out", policy(0x21, 0, 0), True),
    ("out", policy(0x21, 1, 0), False),
    ("out", policy(0x21, 0, 1), False),
    ("out", policy(0x21, 0, 0x100), False),
    # PARTITION: ours is the one without a name
    ("in", policy(0x29, 0), True),
    ("in", hand.parameter(0x29, struct.pack("<I", 1) + hand.text("p")), False),
    ("out", hand.parameter(0x29, struct.pack("<I", 1) + hand.text("p")), False),
    # DATA_REPRESENTATION: ours is XCDR1. A writer uses its first; a reader takes any of its list
    ("in", shorts(), True),
    ("in", shorts(0), True),
    ("in", shorts(2), False),
    ("in", shorts(0, 2), True),
    ("in", shorts(2, 0), False),
    ("out", shorts(), True),
    ("out", shorts(0), True),
    ("out", shorts(2), False),
    ("out", shorts(2, 0), True),
    ("out", shorts(0, 2), True),
    # what makes no difference
    (
        "in",
        policy(0x40, 1, 0)
        + policy(0x41, 1, 2, 3)
        + hand.parameter(0x2C, b"\4\0\0\0user")
        + policy(0x27, 5, 0),
        True,
    ),
    ("out", policy(0x40, 1, 0) + hand.parameter(0x04, SECOND) + hand.parameter(0x2B, SECOND), True),
    ("in", hand.parameter(0x4099, bytes(4)), False),  # must be understood
    ("in", hand.parameter(0xC099, bytes(4)), True),
]


def test_offered_and_requested_policies_match_as_dds_says() -> None:
    async def script(node: Node) -> None:
        await node.arrive(1)
        for number, (name, more, matches) in enumerate(QOS):
            topic, type_name, kind = OURS[name]
            entity = W if kind == PUBLICATION else R
            came = await node.tell(endpoint(entity, topic, type_name, 1, "<", more))
            assert came.drops == ([] if matches else ["qos"]), (number, name, more.hex())
            assert came.matched == int(matches)
            gone = hand.payload(hand.parameter(0x5A, prefix(1) + entity))
            assert (await node.tell(gone, gone=True)).matched == 0

    Node().run(script)


def test_a_node_without_writers_or_readers_knows_participants_and_matches_nothing() -> None:
    async def script(node: Node) -> None:
        assert (await node.arrive(1)).alive == 1
        assert await node.tell(endpoint()) == ([], [], [], 1, 0)
        assert await node.tell(endpoint(R, "", "")) != ([], [], [], 1, 1)

    Node(writers=[], readers=[]).run(script)


@pytest.mark.parametrize(("participants", "endpoints"), [(1, 1), (3, 5)])
def test_tables_of_other_sizes(participants: int, endpoints: int) -> None:
    async def script(node: Node) -> None:
        for n in range(participants):
            assert (await node.arrive(n + 1)).alive == (2 << n) - 1
        assert (await node.arrive(9)).drops == ["full"]
        for n in range(endpoints):
            who = n % participants
            came = await node.tell(endpoint(bytes([0, 0, n, 3]), n=who + 1), who, who + 1)
            assert came.matched == (2 << n) - 1
            assert node.endpoint(n)[2] == address(f"10.0.0.{who + 1}")
        for slot in range(participants):
            came = await node.say(PARTICIPANT, b"", prefix(slot + 1), slot, gone=True)
            left = sum(1 << n for n in range(endpoints) if n % participants > slot)
            assert came.matched == left

    Node(participants, endpoints, writers=[], readers=[Local("rt/in", "pkg::T_")]).run(script)
