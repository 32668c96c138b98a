"""Every template, composed in simulation and read by the software codec and by tshark: what it says, and its lengths."""

from __future__ import annotations

import pathlib
import subprocess
from typing import Any

import pytest

import pcap
import peers as programs
from gateware.words import Tables, WordBench, words
from roslet.gateware.rtps import tables
from roslet.gateware.rtps.composer import Composer
from roslet.gateware.rtps.parameters import GROUP
from roslet.gateware.rtps.rom import AFTERWARDS, ALIGNMENT, DO, Op, Rom
from roslet.gateware.rtps.tables import Local, OwnMap, PeerMap
from roslet.wire.rtps import endpoint_data, guid, inline_qos, message, participant_data
from roslet.wire.rtps.ack_nack import AckNack
from roslet.wire.rtps.data import FLAG_D, FLAG_K, Data
from roslet.wire.rtps.gap import Gap
from roslet.wire.rtps.heartbeat import Heartbeat
from roslet.wire.rtps.info_dst import InfoDestination

PREFIX, THEIRS = b"\1\x52" + bytes(range(10)), bytes(range(0x30, 0x3C))
IP = bytes((192, 168, 1, 100))
KEY = b"\0\0\x21\4"
HASH = "RIHS01_" + "5a" * 32
WRITERS = [
    Local("rt/a", "pkg::msg::dds_::A_", words=5, type_hash=HASH),
    Local("rt/bcd", "B", True, True, words=3, depth=4),
]
READERS = [Local("rt/longer_name", "C", reliable=True)]
FIRST, LAST, NUMBER, COUNT = (7 << 32) + 0xFFFFFFFE, (8 << 32) + 5, (8 << 32) + 3, 76
WANTED = (8 << 32) + 9
THEIR_IP, META_PORT, USER_PORT, INFO, PROXY_6, PROXY_7 = 0x0601A8C0, 7420, 7421, 0x30201, 66, 77
AGE, OLDEST = LAST - NUMBER, LAST - FIRST
SLOT, ENDPOINT, LOCAL = 1, 2, 1
TEXT = bytes(range(1, 13))

own = OwnMap(WRITERS, READERS)
peers = PeerMap(2, 3)
rom = Rom(own, 42, 20.0)


class Composed:
    """What came of a template: where to, its words as octets, in how many cycles from `start`, and after which `done` came;
    what comes `then`, whether they are a datagram, and what else was to be done, with which word."""

    def __init__(
        self, pushed: list[int], times: list[int], done: int, then: int, send: bool, did: list[Any]
    ) -> None:
        octets = b"".join(word.to_bytes(4, "little") for word in pushed)
        self.pushed, self.where, self.octets = pushed, octets[:8], octets[8:]
        self.times, self.done, self.then, self.send, self.did = times, done, AFTERWARDS[then], send, did


def compose(
    names: list[str], builtin: bool = False, kind: int = 0, size: int = 3, last: int = LAST
) -> dict[str, Composed]:
    init = own.init(PREFIX, IP, 7410, 7411, 7400)
    sample = own.samples[1]
    init[sample : sample + 4] = [size | 1 << 16, *words(TEXT)]
    for at in (own.writer_address(LOCAL, 0), own.writer_address(kind % 2, 0, builtin=True)):
        init[at : at + 4] = [last & 0xFFFFFFFF, last >> 32, OLDEST, COUNT]
    theirs = [0] * peers.depth
    at = peers._participants + 16 * SLOT
    theirs[at : at + 3] = words(THEIRS)
    theirs[at + tables.META_IP], theirs[at + tables.META_PORT] = THEIR_IP, META_PORT
    for place in (peers._endpoints + 8 * ENDPOINT, peers._builtins + 32 * SLOT + 8 * kind):
        wanted = [WANTED & 0xFFFFFFFF, WANTED >> 32]
        theirs[place : place + 8] = [*words(KEY), INFO, THEIR_IP, USER_PORT, *wanted, PROXY_6, PROXY_7]
    block: Any = Composer(rom, peers, own)
    bench = WordBench(Tables(peers, own, init, theirs=theirs, block=block), stalls=0)
    found: dict[str, Composed] = {}

    async def process(ctx: Any) -> None:
        subject = {"builtin": builtin, "kind": kind, "slot": SLOT, "endpoint": ENDPOINT, "local": LOCAL}
        subject |= {"age": AGE, "oldest": OLDEST, "sample": sample, "words": size, "padding": 0}
        ctx.set(block.subject, subject)
        ctx.set(block.borrow, 1)
        for name in names:
            ctx.set(block.at, rom.start[name])
            ctx.set(block.load, 1)
            await ctx.tick()
            ctx.set(block.load, 0)
            ctx.set(block.start, 1)
            pushed: list[int] = []
            times: list[int] = []
            did: list[Any] = []
            done = send = cycle = 0
            while not done:
                ports = block.push, block.word, block.do, block.done, block.send
                _, _, push, word, do, done, send = await ctx.tick().sample(*ports)
                ctx.set(block.start, 0)
                if push:
                    pushed.append(word)
                    times.append(cycle)
                did += [(name, word) for name in ACTIONS if getattr(do, name)]
                cycle += 1
                assert cycle < 500
            found[name] = Composed(pushed, times, cycle - 1, do.then, bool(send), did)
            _, _, push, done = await ctx.tick().sample(block.push, block.done)
            assert not push and not done

    bench.drive(process)
    bench.run()
    return found


ACTIONS = ("store", "last", "oldest", "info", "port", "start", "acked", "ask_from", "ask_to", "place", "size")
assert set(ACTIONS) < set(DO.members)
NAMES = list(rom.size)


@pytest.fixture(scope="module")
def composed() -> dict[str, Composed]:
    return compose(NAMES)


def read(octets: bytes) -> list[Any]:
    header, found = message.parse(octets)
    assert header.guid_prefix == PREFIX
    assert octets[:8] == b"RTPS\2\3\1\x52"
    return found


def directed(octets: bytes) -> list[Any]:
    to, *found = read(octets)
    assert to == InfoDestination(THEIRS)
    return found


def test_there_is_a_template_for_all_that_a_node_says() -> None:
    assert set(NAMES) == {
        "participant", "greeting", "publication0", "publication1", "subscription0", "publication_gone", "subscription_gone",
        "publication_heartbeat", "subscription_heartbeat", "publication_acknack", "subscription_acknack",
        "message", "message_heartbeat", "group_message", "group_message_heartbeat", "heartbeat", "acknack", "gap",
    }  # fmt: skip


def template(name: str) -> list[tuple[int, int]]:
    """Its words as operations and arguments, with its end."""
    items = [(word >> 32, word & 0xFFFFFFFF) for word in rom.words[ALIGNMENT * rom.start[name] :]]
    return items[: 1 + next(n for n, item in enumerate(items) if has(item, "end"))]


def has(item: tuple[int, int], flag: str) -> bool:
    return item[0] > Op.OWN and bool(item[1] >> DO[flag].offset & 1)


@pytest.mark.parametrize("name", NAMES)
def test_declared_lengths_are_emitted_lengths_and_a_word_comes_each_cycle(
    composed: dict[str, Composed], name: str
) -> None:
    """The walk of the codec ends where the octets do: no length says less or more, and none of zero hides it."""
    one = composed[name]
    at = 20
    while at < len(one.octets):
        length = int.from_bytes(one.octets[at + 2 : at + 4], "little")
        assert length > 0 and length % 4 == 0
        at += 4 + length
    assert at == len(one.octets)
    has_message = Op.MESSAGE in [op for op, _ in template(name)]
    count = len(one.octets) // 4
    # `size` counts the place of the message as a word.
    assert count == rom.size[name] + (3 - 1 if has_message else 0)
    items = template(name)
    first = next(n for n, item in enumerate(items) if not has(item, "quiet"))
    assert one.times[0] == 7 + first
    quiet = sum(has(item, "quiet") for item in items[first:-1])
    assert one.times[-1] - one.times[0] == len(one.pushed) - 1 + quiet + (
        has_message and items[-2][0] != Op.MESSAGE
    )
    assert one.done - one.times[-1] == (items[-1][0] == Op.END) + (items[-2][0] == Op.MESSAGE)
    assert one.send
    told = name.endswith("_gone") or name.startswith(("publication0", "publication1", "subscription0"))
    assert one.then == ("NEXT" if "message" in name or told else "REPEAT" if name == "gap" else "IDLE")
    assert message.parse(one.octets)


def test_the_announcement_says_who_and_where_we_are(composed: dict[str, Composed]) -> None:
    (data,) = read(composed["participant"].octets)
    assert composed["greeting"].octets == composed["participant"].octets
    assert (data.writer_id, data.sequence, data.flags) == (
        guid.ENTITYID_SPDP_BUILTIN_PARTICIPANT_WRITER,
        1,
        FLAG_D,
    )
    said = participant_data.parse(data.payload)
    assert said.guid == PREFIX + guid.ENTITYID_PARTICIPANT
    assert (said.domain_id, said.lease, said.builtin_endpoints) == (42, 20 * 10**9, 0x3F)
    assert [str(one) for one in said.metatraffic_unicast] == ["192.168.1.100:7410"]
    assert [str(one) for one in said.default_unicast] == ["192.168.1.100:7411"]
    assert said.user_data == b"enclave=/;"


@pytest.mark.parametrize("name", ["publication0", "publication1", "subscription0"])
def test_endpoints_are_described_as_they_are(composed: dict[str, Composed], name: str) -> None:
    (data,) = directed(composed[name].octets)
    writer, n = name.startswith("publication"), int(name[-1])
    local = (WRITERS if writer else READERS)[n]
    kind = "PUBLICATIONS" if writer else "SUBSCRIPTIONS"
    assert data.reader_id == getattr(guid, f"ENTITYID_SEDP_BUILTIN_{kind}_READER")
    assert data.writer_id == getattr(guid, f"ENTITYID_SEDP_BUILTIN_{kind}_WRITER")
    assert data.sequence == NUMBER
    said = endpoint_data.parse(data.payload)
    assert said.guid == PREFIX + bytes((0, 0, n + 1, 3 if writer else 4))
    assert (said.topic, said.type_name) == (local.topic, local.type_name)
    assert (said.qos.reliable, said.qos.durability) == (local.reliable, int(local.transient_local))
    assert said.qos.history == (0, local.depth)
    assert said.qos.user_data == (f"typehash={HASH};".encode() if local.type_hash else b"")


@pytest.mark.parametrize("kind", ["publication", "subscription"])
def test_an_endpoint_that_is_gone_is_disposed_of(composed: dict[str, Composed], kind: str) -> None:
    (data,) = directed(composed[f"{kind}_gone"].octets)
    whose = PREFIX + bytes((0, 0, LOCAL + 1, 3 if kind == "publication" else 4))
    assert data.flags == FLAG_K
    status = inline_qos.parse(bytes(data.inline_qos), True)
    assert (status.key_hash, status.status) == (whose, 3)
    assert endpoint_data.parse_key(data.payload) == whose


@pytest.mark.parametrize("size", [0, 1, 3])
def test_a_message_is_sent_with_its_length(size: int) -> None:
    both = compose(["message", "message_heartbeat"], size=size)
    (data,) = directed(both["message"].octets)
    text = b"\0\1\0\0" + TEXT[: 4 * size]
    assert data == Data(KEY, b"\0\0\2\3", NUMBER, text, b"", FLAG_D)
    data, beat = directed(both["message_heartbeat"].octets)
    assert data.payload == text
    assert beat == Heartbeat(KEY, b"\0\0\2\3", FIRST, LAST, COUNT)


def test_a_message_for_a_group_names_nobody() -> None:
    both = compose(["group_message", "group_message_heartbeat"], size=3)
    text, anybody = b"\0\1\0\0" + TEXT[:12], bytes(4)
    (data,) = read(both["group_message"].octets)
    assert data == Data(anybody, b"\0\0\2\3", NUMBER, text, b"", FLAG_D)
    again, beat = read(both["group_message_heartbeat"].octets)
    assert again == data
    assert beat == Heartbeat(anybody, b"\0\0\2\3", FIRST, LAST, COUNT)


def test_heartbeats_acknacks_and_gaps_have_their_numbers(composed: dict[str, Composed]) -> None:
    assert directed(composed["heartbeat"].octets) == [Heartbeat(KEY, b"\0\0\2\3", FIRST, LAST, COUNT)]
    (ack,) = directed(composed["acknack"].octets)
    assert (ack.reader_id, ack.writer_id, ack.count, ack.final) == (b"\0\0\2\4", KEY, COUNT, True)
    assert ack.state.numbers() == [WANTED, WANTED + 1, WANTED + 2]
    (gap,) = directed(composed["gap"].octets)
    assert isinstance(gap, Gap) and isinstance(ack, AckNack)
    asked_from = WANTED >> 32  # the word of a reader's proxy that a writer's has for its higher one
    assert tables.ASK_FROM == tables.NEXT_HI
    start = (LAST >> 32) - 1 << 32 | asked_from  # as we say that it is borrowed from
    assert (gap.reader_id, gap.writer_id, gap.start) == (KEY, b"\0\0\2\3", start)
    assert (gap.gaps.base, gap.gaps.bits) == (FIRST, 0)


def test_a_datagram_begins_with_where_it_goes(composed: dict[str, Composed]) -> None:
    def place(ip: int, port: int) -> bytes:
        return ip.to_bytes(4, "little") + port.to_bytes(4, "little")

    group = {"participant": 7400, "group_message": 7401, "group_message_heartbeat": 7401}
    for name in NAMES:
        port = META_PORT if name.startswith(("greeting", "publication", "subscription")) else USER_PORT
        to = place(GROUP, group[name]) if name in group else place(THEIR_IP, port)
        assert composed[name].where == to, name


def test_heartbeats_and_acknacks_are_counted(composed: dict[str, Composed]) -> None:
    for name in NAMES:
        counted = "heartbeat" in name or "acknack" in name
        assert [word for what, word in composed[name].did if what == "store"] == [COUNT + 1] * counted, name


def test_a_message_is_looked_for_where_its_number_says(composed: dict[str, Composed]) -> None:
    for name in NAMES:
        looked = [one for one in composed[name].did if one[0] in ("place", "size")]
        of_message = "message" in name
        assert looked == [("place", NUMBER & 0xFFFFFFFF), ("size", 3 | 1 << 16)] * of_message, name


LOW = LAST & 0xFFFFFFFF
KEPT = [("store", LOW + 1), ("last", LOW + 1), ("store", LAST >> 32)]
LOOKS = {
    "changed": ([("store", LOW - AGE)], "TOLD"),
    "who": ([("info", INFO)], "WHO"),
    "wanted": ([("last", PROXY_6), ("ask_from", WANTED & 0xFFFFFFFF)], "WRITER"),
    "asked": (
        [
            ("last", LOW),
            ("oldest", OLDEST),
            ("start", PROXY_7),
            ("acked", WANTED & 0xFFFFFFFF),
            ("ask_from", WANTED >> 32),
            ("ask_to", PROXY_6),
        ],
        "READER",
    ),
    "next": ([("place", LOW + 1), ("oldest", OLDEST)], "KEEP"),
    "kept": (KEPT, "EACH READER"),
    "kept_more": ([("store", OLDEST + 1), *KEPT], "EACH READER"),
    "to_reader": ([("start", PROXY_7), ("info", INFO), ("oldest", OLDEST), ("port", USER_PORT)], "TO READER"),
}


def test_what_writes_nothing_looks_at_and_stores_what_is_said() -> None:
    assert set(LOOKS) == set(rom.start) - set(rom.size)
    for name, one in compose(list(LOOKS)).items():
        assert (one.did, one.then, one.pushed, one.send) == (*LOOKS[name], [], False), name


def test_what_the_lower_word_of_a_number_carries_goes_to_the_higher_one() -> None:
    one = compose(["kept"], last=(8 << 32) - 1)["kept"]
    assert one.did == [("store", 0), ("last", 0), ("store", 8)]


@pytest.mark.parametrize(("kind", "name"), [(2, "publication"), (3, "subscription")])
def test_discovery_is_acknowledged_by_its_own_readers_and_told_by_its_own_writers(
    kind: int, name: str
) -> None:
    which = f"ENTITYID_SEDP_BUILTIN_{name.upper()}S"
    reader, writer = getattr(guid, f"{which}_READER"), getattr(guid, f"{which}_WRITER")
    both = compose([f"{name}_acknack", f"{name}_heartbeat"], builtin=True, kind=kind)
    (ack,) = directed(both[f"{name}_acknack"].octets)
    assert (ack.reader_id, ack.writer_id) == (reader, writer)
    assert ack.state.base == WANTED
    (beat,) = directed(both[f"{name}_heartbeat"].octets)
    assert (beat.reader_id, beat.writer_id, beat.first, beat.last) == (reader, writer, FIRST, LAST)


def test_tshark_finds_nothing_malformed(composed: dict[str, Composed], tmp_path: pathlib.Path) -> None:
    path = tmp_path / "composed.pcap"
    pcap.write(path, [composed[name].octets for name in NAMES])
    fields = ["frame.protocols", "_ws.malformed", "_ws.expert.message"]
    command = [str(programs.require("tshark")), "-r", str(path), "-T", "fields"]
    command += [part for field in fields for part in ("-e", field)]
    said = subprocess.run(command, capture_output=True, text=True, check=True, timeout=60).stdout
    lines = said.rstrip("\n").split("\n")
    assert len(lines) == len(NAMES)
    for line in lines:
        protocols, malformed, expert = line.split("\t")
        assert "rtps" in protocols and not malformed and not expert, line


def test_words_that_are_not_whole_are_refused() -> None:
    from roslet.gateware.rtps.rom import _words

    with pytest.raises(ValueError, match="5 octets are no words"):
        _words(bytes(5))
