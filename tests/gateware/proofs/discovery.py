"""Discovery's tables: nobody has two places or another's, nobody alive goes for somebody new, nobody stays who is gone.

Two participants, three endpoints, ids and prefixes of two bits, leases of up to 3 s. In the first cycle the tables become
any that keep the rules below, so what is said holds however they came about; the block's other registers begin as after a
reset, but for who was heard and which endpoint was looked at last.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import Any

from amaranth.hdl import Assert, Assume, C, Cat, Const, Cover, Module, Mux, Signal, Value
from amaranth.lib import wiring

from gateware.formal import Bug, Spec
from roslet.gateware.rtps import discovery, ports, tables
from roslet.gateware.rtps.parameters import Parameters
from roslet.gateware.rtps.scan import lowest
from roslet.gateware.rtps.tables import Local, OwnMap, PeerMap

PEERS = PeerMap(2, 3)
OWN = OwnMap(
    [Local("a", "T", reliable=True), Local("b", "T", transient_local=True)],
    [Local("c", "T", reliable=True), Local("d", "T", transient_local=True)],
)
IDS = 2
"""Bits in which prefixes differ, and entity ids."""
LEASE = 2
"""Bits of a lease, in seconds."""
LIST = 32
"""Cycles of a list, at most."""
SWEEP = 20
"""Cycles of a sweep, at most: of one that removes everybody."""


class CutParameters(wiring.Component):
    """`Parameters`, whose outputs are inputs of the proof: it says anything that its own proof, `ParametersSpec`, leaves."""

    def __init__(self, peers: PeerMap, own: OwnMap, judge_domain: bool) -> None:
        super().__init__(dict(Parameters(peers, own, judge_domain).signature.members.items()))
        self.takes = Signal()
        write = self.write
        given = self.done, self.read, self.same, self.near, self.listens, self.drop_malformed, self.takes
        addresses = self.peers.addr, self.own.addr, write.addr, write.data, write.en
        self.free = [Value.cast(value) for value in (*given, *addresses)]

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.d.comb += self.i.stream.ready.eq(Mux(self.done, self.proceed, self.takes))
        return m

    def contract(self, m: Module, within: Value, idle: Value) -> None:
        """Assume it, and when words are kept that came before. `within`: a list's first item was there before; `idle`, the
        walker is."""
        i = self.i.stream
        good = i.valid & i.payload.end & ~i.payload.bad
        held, read, same = Signal(), Signal.like(self.read.as_value()), Signal.like(self.same)
        wrote, kept = Signal(), Signal(2)
        m.d.sync += [wrote.eq(self.write.en), kept.eq(Cat(self.keep.en, kept))]
        m.d.sync += [held.eq(self.done & ~self.proceed), read.eq(self.read), same.eq(self.same)]
        addresses = Cat(self.peers.addr, self.own.addr, self.write.addr, self.write.data, self.write.en)
        m.d.comb += [
            Assume(~self.done | good, "done"),
            Assume(~held | (self.done & (self.read.as_value() == read) & (self.same == same)), "stays"),
            Assume(~(good & i.ready) | (self.done ^ self.drop_malformed), "told"),
            Assume(~self.drop_malformed | (good & i.ready), "told"),
            Assume(~self.write.en | (self.write.addr[4:] == PEERS._scratch >> 4), "kept"),
            Assume(~self.keep.en | ~(i.valid | within | idle), "kept before"),
            Assume(~kept.any() | ~i.valid, "kept before"),
            Assume(((i.valid | within) & ~self.done) | kept[0] | (addresses == 0), "quiet"),
            Assume(~self.done | ~wrote, "quiet"),
        ]


class PeerMemory:
    """The peers' memory, as `Participant` has it: written a cycle later, read in two, anything of a word that is written
    meanwhile. Of its words it has those by which somebody is known, and the leases; the others are any at any time."""

    def __init__(self, spec: Spec, m: Module, first: Value, address: Value, write: Any) -> None:
        every = range(PEERS.participants), range(PEERS.endpoints)
        slot_bits, place_bits = PEERS.slot_bits, PEERS.endpoint_bits
        self.prefix = [Signal(IDS, name=f"prefix{n}") for n in every[0]]
        self.lease = [Signal(LEASE, name=f"lease{n}") for n in every[0]]
        self.left = [Signal(tables.LEASE_BITS + 1, name=f"left{n}") for n in every[0]]
        self.key = [Signal(IDS, name=f"key{n}") for n in every[1]]
        self.info = [Signal(18, name=f"info{n}") for n in every[1]]
        rows: list[tuple[Value, Signal]] = []
        for n in every[0]:
            slot = Const(n, slot_bits)
            rows += [(PEERS.participant(slot, tables.PREFIX), self.prefix[n])]
            rows += [(PEERS.participant(slot, tables.LEASE), self.lease[n])]
            rows += [(PEERS.participant(slot, tables.LEFT), self.left[n])]
        for n in every[1]:
            place = Const(n, place_bits)
            rows += [(PEERS.endpoint(place, tables.KEY), self.key[n])]
            rows += [(PEERS.endpoint(place, tables.INFO), self.info[n])]
        self.sender, self.entity, self.announced = Signal(IDS), Signal(IDS), Signal(LEASE)
        """What the scratch area has."""
        put = Signal(len(write.en) + len(write.addr) + len(write.data))
        m.d.sync += put.eq(Cat(write.en, write.addr, write.data))
        written, at, value = put[0], put[1 : 1 + len(write.addr)], put[1 + len(write.addr) :]
        anything = spec.free(32, "anything")
        raw = Signal(32)
        m.d.sync += raw.eq(anything)
        scratch = {
            tables.PREFIX: self.sender,
            tables.LEASE: self.announced,
            tables.SCRATCH_ENTITY: self.entity,
        }
        for place, word in (*rows, *((PEERS.scratch(n), value) for n, value in scratch.items())):
            with m.If((address == place) & ~(written & (at == place))):
                m.d.sync += raw.eq(word)
        for n, (place, word) in enumerate(rows):
            with m.If(first):
                m.d.sync += word.eq(spec.free(len(word), f"word{n}"))
            with m.Elif(written & (at == place)):
                m.d.sync += word.eq(value)
        self.given = Signal(32)
        m.d.sync += self.given.eq(raw)


LOADS = "m.d.sync += [step.eq(step + 1), addressed.eq(step), before.eq(addressed)]"


FULL = "with m.If(slot == {}):\n                m.d.comb += self.drop_full"
SWEPT = "with m.If(slot == {}):\n                    m.d.sync += sweeping"
LAST_PLACE = "with m.If(endpoint == peers.endpoints - {}):"


class _Tables(Spec):
    """The block and its surroundings. `once`: a list, a sweep, or a list and then a sweep, begin at once, and nothing comes
    after them."""

    module = discovery
    once = True
    constants = MappingProxyType({"Parameters": CutParameters})
    scale: tuple[tuple[str, str], ...] = (
        (
            LOADS,
            LOADS
            + """
        with m.If(self.loads):
            m.d.sync += [self.alive.eq(self.any_alive), self.matched.eq(self.any_matched)]
            m.d.sync += [heard.eq(self.any_heard), self._endpoint.eq(self.any_endpoint)]""",
        ),
    )

    def block(self) -> Any:
        dut = self.gates.Discovery(PEERS, OWN)
        dut.loads = Signal(init=1)
        dut.any_alive, dut.any_matched = Signal(PEERS.participants), Signal(PEERS.endpoints)
        dut.any_heard, dut.any_endpoint = Signal(PEERS.participants), Signal(PEERS.endpoint_bits)
        return dut

    def properties(self, m: Module) -> None:
        dut = self.dut
        self.cut: CutParameters = dut._parameters
        self.ports += [*self.cut.free, dut.any_alive, dut.any_matched, dut.any_heard, dut.any_endpoint]
        self.ports = [port for port in self.ports if port is not dut.peers.data]
        self.first, self.second = dut.loads, Signal()
        m.d.sync += [self.first.eq(0), self.second.eq(self.first)]
        self.memory = PeerMemory(self, m, self.first, dut.peers.addr, dut.write)
        m.d.comb += dut.peers.data.eq(self.memory.given)
        info = self.memory.info
        self.slot_of = [word[tables.INFO_SLOT : tables.INFO_SLOT + 8] for word in info]
        self.writer_of = [word[tables.INFO_WRITER] for word in info]
        # What changes, in the cycle in which it has.
        before = Signal(PEERS.participants), Signal(PEERS.endpoints)
        m.d.sync += [before[0].eq(dut.alive), before[1].eq(dut.matched)]
        settles = self.first | self.second
        self.rose, self.fell = Signal(PEERS.participants), Signal(PEERS.participants)
        self.rose_place, self.fell_place = Signal(PEERS.endpoints), Signal(PEERS.endpoints)
        self.were, self.were_matched = before
        for there, was, rose, fell in (
            (dut.alive, before[0], self.rose, self.fell),
            (dut.matched, before[1], self.rose_place, self.fell_place),
        ):
            with m.If(~settles):
                m.d.comb += [rose.eq(there & ~was), fell.eq(was & ~there)]
        self.distinct = ~(dut.alive.all() & (self.memory.prefix[0] == self.memory.prefix[1]))
        self.given(m)
        self.judge(m)

    def judge(self, m: Module) -> None:
        """What is said of it."""
        raise NotImplementedError

    def given(self, m: Module) -> None:
        """Assume what `Walker`, `Submessages` and `Parameters` give."""
        dut, memory = self.dut, self.memory
        frames = self.assume(m, "i")
        self.cut.contract(m, frames.within, dut.idle)
        i, meta = dut.i.stream, dut.i.meta
        begins = i.valid & ~frames.within
        fresh = self.free(1, "fresh")  # its sender was looked up, and not only seen to be there still
        over = Signal(init=1)  # the datagram before is
        sender, known, slot = Signal(IDS), Signal(), Signal(8)
        entity, lease = Signal(IDS), Signal(LEASE)
        with m.If(dut.idle):
            m.d.sync += over.eq(1)
        with m.Elif(begins):
            m.d.sync += over.eq(0)
        with m.If(begins):
            m.d.sync += [sender.eq(memory.sender), known.eq(meta.known), slot.eq(meta.slot)]
        done = Signal()  # the list was already: nothing more of it is written
        m.d.sync += [done.eq(self.cut.done), entity.eq(memory.entity), lease.eq(memory.announced)]
        m.d.comb += [
            memory.sender.eq(Mux(begins, self.free(IDS, "its_prefix"), sender)),
            memory.entity.eq(Mux(done, entity, self.free(IDS, "its_entity"))),
            memory.announced.eq(Mux(done, lease, self.free(LEASE, "its_lease"))),
        ]
        self.is_sender = [dut.alive[n] & (prefix == memory.sender) for n, prefix in enumerate(memory.prefix)]
        held = Signal()
        m.d.sync += held.eq(dut.idle & dut.hold)
        m.d.comb += [
            Assume(~self.first | ~(i.valid | dut.tick | dut.heard), "nothing yet"),
            Assume(meta.kind <= ports.SUBSCRIPTIONS, "a kind"),
            Assume(~dut.idle | ~(i.valid | frames.within | dut.heard), "idle"),
            Assume(~held | dut.idle, "held"),
            Assume(~(dut.tick & dut.hold & dut.idle), "a second"),
            Assume(~begins | fresh | ~over, "looked up"),
            Assume(~begins | ~meta.known | (meta.slot < PEERS.participants), "a slot"),
            Assume(~begins | (meta.kind == ports.PARTICIPANTS) | meta.known, "of somebody"),
            Assume(~dut.heard | ((dut.heard_slot < PEERS.participants) & ~self.cut.done), "a slot"),
        ]
        if self.once:
            third, ended = Signal(), Signal()
            m.d.sync += [third.eq(self.second), ended.eq(ended | self.cut.proceed | (held & ~dut.hold))]
            m.d.comb += [
                Assume(
                    ~self.second | dut.tick | (i.valid & i.payload.end & ~self.cut.done & ~self.cut.takes),
                    "begins",
                ),
                Assume(~third | dut.hold & dut.idle | self.cut.done, "begins"),
                Assume(self.second | ~dut.tick, "once"),
                Assume(~ended | ~i.valid, "once"),
            ]
        with m.If(begins & fresh):
            m.d.comb += Assume(meta.known == Cat(self.is_sender).any(), "found")
            for n, is_sender in enumerate(self.is_sender):
                m.d.comb += Assume(~is_sender | (meta.slot == n), "found")
        with m.Elif(begins):
            m.d.comb += [
                Assume(memory.sender == sender, "the same"),
                Assume(meta.known == (known & dut.alive.bit_select(slot[:1], 1)), "there still"),
                Assume(meta.slot == slot, "the same"),
            ]

    def meant(self) -> None:
        """What the list that is done says."""
        cut, read, meta = self.cut, self.cut.read, self.dut.i.meta
        of_participant = cut.done & (meta.kind == ports.PARTICIPANTS)
        of_endpoint = cut.done & (meta.kind != ports.PARTICIPANTS)
        self.leaving = of_participant & meta.gone & meta.known
        self.announcing = of_participant & ~meta.gone & ~read.refused & read.guid & read.meta
        is_writer = meta.kind == ports.PUBLICATIONS
        # DDS 1.4, 2.2.3: what is requested is not more than what is offered.
        fits: list[Value] = []
        both: list[Value] = []  # are reliable
        for writer, reader in zip(OWN.writers, OWN.readers, strict=True):
            to_reader = (read.reliable | C(not reader.reliable)) & (
                read.durability >= C(reader.transient_local)
            )
            to_writer = (~read.reliable | C(writer.reliable)) & (read.durability <= C(writer.transient_local))
            fits.append(Mux(is_writer, to_reader, to_writer))
            both.append(read.reliable & Mux(is_writer, C(reader.reliable), C(writer.reliable)))
        self.local = lowest(cut.same)
        agrees = Mux(cut.same[0], fits[0], fits[1]) & cut.same.any() & ~read.refused
        self.reliable = Mux(cut.same[0], both[0], both[1])
        complete = read.guid & read.topic & read.type
        self.matching = of_endpoint & ~meta.gone & complete & agrees
        self.ending = of_endpoint & (meta.gone & (read.guid | meta.has_key) | ~meta.gone & complete & ~agrees)
        self.entity = self.memory.entity
        self.is_its = [
            of_endpoint
            & (self.memory.key[n] == self.entity)
            & (self.slot_of[n] == meta.slot)
            & (self.writer_of[n] == is_writer)
            for n in range(PEERS.endpoints)
        ]

    def leases(self, m: Module) -> None:
        """Who is silent: `lively`, something was heard since the last sweep; else `silent`, for how many sweeps."""
        dut, memory = self.dut, self.memory
        held = Signal()
        m.d.sync += held.eq(dut.hold & dut.idle)
        self.swept = swept = Signal()
        m.d.comb += swept.eq(held & ~dut.hold)
        self.expired: list[Value] = []
        done = Signal()  # in the cycle before: what was written last is there in the next
        m.d.sync += done.eq(self.cut.done)
        settled = ~self.cut.done & ~done & ~dut.hold
        for n in range(PEERS.participants):
            lively, silent, lease = Signal(), Signal(LEASE + 2), Signal(LEASE + 2)
            expired = ~lively & (silent > lease)
            self.expired.append(expired)
            counts = dut.alive[n] & ~lively & settled & ~swept
            m.d.comb += [
                Assume(~self.second | (lease == memory.lease[n]), "lease"),
                Assume(~self.second | lively | (silent + memory.left[n].as_signed() == lease), "lease"),
                Assert(~(dut.alive[n] & settled) | (memory.lease[n] == lease), "lease"),
                Assert(~counts | (silent + memory.left[n].as_signed() == lease), "lease"),
                Assert(~(swept & dut.alive[n] & expired), "expires"),
            ]
            with m.If(swept):
                m.d.sync += [lively.eq(0), silent.eq(Mux(lively, 0, silent + 1))]
            with m.If(self.cut.proceed & self.announcing & self.is_sender[n]):
                m.d.sync += [lively.eq(1), lease.eq(memory.announced)]
            with m.If(dut.heard & (dut.heard_slot == n)):
                m.d.sync += lively.eq(1)
            with m.If(self.first):
                m.d.sync += [lively.eq(dut.any_heard[n])]
                m.d.sync += [
                    silent.eq(self.free(LEASE + 2, f"silent{n}")),
                    lease.eq(self.free(LEASE + 2, f"lease{n}")),
                ]

    def rules(self, m: Module) -> None:
        """What the tables keep, and have in the beginning."""
        dut, memory, slot_of = self.dut, self.memory, self.slot_of
        self.single: Value = C(1, 1)
        for a in range(PEERS.endpoints):
            for b in range(a):
                same = (memory.key[a] == memory.key[b]) & (slot_of[a] == slot_of[b])
                same &= self.writer_of[a] == self.writer_of[b]
                self.single &= ~(dut.matched[a] & dut.matched[b] & same)
        self.of_somebody = Cat(
            ~dut.matched[n] | ((slot_of[n] < PEERS.participants) & dut.alive.bit_select(slot_of[n][:1], 1))
            for n in range(PEERS.endpoints)
        ).all()
        m.d.comb += Assume(~self.second | (self.distinct & self.single & self.of_somebody), "the rules")
        self.later = ~self.first & ~self.second

    def written(self) -> tuple[list[Value], list[Value], list[Value]]:
        """Whose words are: each participant's, its proxies', each endpoint's."""
        write = self.dut.write
        slots = [Const(n, PEERS.slot_bits) for n in range(PEERS.participants)]
        places = [Const(n, PEERS.endpoint_bits) for n in range(PEERS.endpoints)]
        return (
            [write.en & (write.addr[4:] == PEERS.participant(slot, 0)[4:]) for slot in slots],
            [write.en & (write.addr[5:] == PEERS.builtin(slot, 0, 0)[5:]) for slot in slots],
            [write.en & (write.addr[3:] == PEERS.endpoint(place, 0)[3:]) for place in places],
        )


class ParticipantsSpec(_Tables):
    """What participants say, one list, and a sweep of leases, from any tables on. Lists, and who is said to be known, are as
    `Parameters`, `Submessages` and `Walker` give them by their own proofs; a sweep is over within a second.

    `earned`: a slot is given for an announcement only, to one only, and is the first that was free. `words`: nothing is
    written over what is somebody's but by them, and of endpoints nothing. `greeted`: who is new is said. `entered`: who
    announces itself has a slot then, unless all have somebody, or another came in this datagram. `full`: that is said only
    where it is so. `evicted`: a slot is lost by a farewell or a lease that has expired, and by nothing else; `left`,
    `expires`: and by these it is. `lease`: that is the one announced last. `lost`: an endpoint is
    unmatched only where its participant goes, and none is matched. `of_somebody`: the participant of each is there, but
    while a list or a sweep is under way.

    Of the four proxies of a participant one is made here.
    """

    quick, deep = 27, 39
    scale = (
        *_Tables.scale,
        ("with m.If(step == 15 + READ_LATENCY):", "with m.If(step == 3 + READ_LATENCY):"),
    )
    bugs = (
        Bug(
            "of_somebody",
            "step == peers.endpoints + READ_LATENCY - 1",
            "step == peers.endpoints + READ_LATENCY - 2",
        ),
        Bug(
            "evicted",
            "some = ~self.peers.data[tables.LEASE_BITS]",
            "some = self.peers.data[: tables.LEASE_BITS].any()",
        ),
        Bug("expires", "some = ~self.peers.data[tables.LEASE_BITS]", "some = C(1, 1)"),
        Bug("lease", "step == tables.USER_PORT + READ_LATENCY", "step == tables.PREFIX + 2 + READ_LATENCY"),
        Bug(
            "left",
            'm.If(meta.known):\n                m.next = "REMOVE"',
            "m.If(meta.known):\n                pass",
        ),
        Bug("earned", "with m.Elif(read.refused):", "with m.Elif(0):"),
        Bug("entered", "with m.Elif(~arrived):", "with m.Elif(~self.alive.any()):"),
        Bug("greeted", "self.greet.eq(1)", "self.greet.eq(read.user)"),
        Bug("words", "with m.Elif(self.alive.bit_select(slot[: peers.slot_bits], 1)):", "with m.Elif(0):"),
        Bug("lost", "tables.INFO_SLOT + len(slot)] == slot", "tables.INFO_SLOT + len(slot)] != slot"),
        Bug("full", FULL.format("peers.participants"), FULL.format("peers.participants - 1")),
    )

    def judge(self, m: Module) -> None:
        dut, cut, meta = self.dut, self.cut, self.dut.i.meta
        m.d.comb += Assume(~dut.i.stream.valid | (meta.kind == ports.PARTICIPANTS), "of participants")
        self.meant()
        self.leases(m)
        self.rules(m)
        arrived, full = Signal(), Signal()
        greeted, greeted_slot = Signal(), Signal(8)
        risen = Signal(PEERS.participants)
        with m.If(dut.idle):
            m.d.sync += arrived.eq(0)
        with m.If(dut.greet):
            m.d.sync += arrived.eq(1)
        m.d.sync += [full.eq(cut.done & (full | dut.drop_full)), greeted.eq(dut.greet)]
        m.d.sync += [greeted_slot.eq(dut.greet_slot), risen.eq(Mux(cut.done, risen | self.rose, 0))]
        new = risen | self.rose  # by this list
        settled = self.later & ~cut.done & ~dut.hold
        m.d.comb += [
            Assert(
                ~(cut.proceed & self.announcing) | Cat(self.is_sender).any() | full | (arrived & ~meta.known),
                "entered",
            ),
            Assert(~dut.drop_full | (cut.done & ~meta.known & dut.alive.all()), "full"),
            Assert(self.rose.any() == greeted, "greeted"),
            Assert(~settled | self.of_somebody, "of_somebody"),
            Assert(~self.rose_place.any(), "lost"),
            Cover(self.rose.any(), "arrived"),
            Cover(self.leaving & self.fell_place.any(), "departed"),
            Cover(self.fell.any() & dut.hold, "expired"),
            Cover(full & self.announcing, "no slot"),
        ]
        its_words, its_proxies, of_endpoints = self.written()
        m.d.comb += Assert(~Cat(of_endpoints).any(), "words")
        for n in range(PEERS.participants):
            here = meta.slot == n
            its = cut.done & Mux(meta.known, here, ~dut.alive[n] | new[n])
            counts = dut.hold & (dut.write.addr[:4] == tables.LEFT)
            m.d.comb += [
                Assert(~self.fell[n] | (self.leaving & here) | (dut.hold & self.expired[n]), "evicted"),
                Assert(~(cut.proceed & self.leaving & here) | ~dut.alive[n], "left"),
                Assert(~self.rose[n] | (self.announcing & ~meta.known & self.were[:n].all()), "earned"),
                Assert(~self.rose[n] | (greeted_slot == n), "greeted"),
                Assert(~its_words[n] | its | counts, "words"),
                Assert(~its_proxies[n] | (self.announcing & new[n]), "words"),
            ]
        for n in range(PEERS.endpoints):
            of_gone: Value = C(0, 1)
            for slot in range(PEERS.participants):
                gone = (self.leaving & (meta.slot == slot)) | (dut.hold & self.expired[slot])
                of_gone |= gone & (self.slot_of[n] == slot)
            m.d.comb += Assert(~self.fell_place[n] | of_gone, "lost")


class EndpointsSpec(_Tables):
    """What one list says of an endpoint, from any tables on; given as above.

    `matched`: one that agrees has a place then, unless none is free. `right`: that is the first free one, and has its id,
    its participant and what is ours; `due`: and something is sent to it. `full`: that none is free is said only where it is
    so. `unmatched`: one that agrees no more, or is disposed, has no place. `lost`: by these a place is lost, and by nothing
    else, nor is a participant's. `single`: none has two. `words`: nothing is written but to its own place, or a free one.
    """

    quick, deep = 30, 44
    bugs = (
        Bug(
            "single",
            'with m.Elif(found):\n                m.next = "PROXY"',
            'with m.Elif(found & (endpoint == 0)):\n                m.next = "PROXY"\n'
            '            with m.Elif(found):\n                m.d.sync += found.eq(0)\n                m.next = "PLACE"',
        ),
        Bug("right", "is_writer, reliable)", "is_writer, read.reliable)"),
        Bug("due", "len(endpoint)), C(1, 1))", "len(endpoint)), C(0, 1))"),
        Bug(
            "matched",
            "self._joins.eq(1)",
            "self._joins.eq(transient)",
        ),
        Bug("unmatched", "read.type & ~same.any()", "read.type & same.any()"),
        Bug("full", LAST_PLACE.format(1), LAST_PLACE.format(2)),
        Bug(
            "lost",
            "with m.Elif(~read.guid | ~read.topic | ~read.type):",
            "with m.Elif(~read.guid | ~read.topic | ~read.type):\n                m.d.sync += self.matched.eq(0)",
        ),
        Bug("words", "with m.If(self.matched.bit_select(endpoint, 1)):", "with m.If(0):"),
    )

    def judge(self, m: Module) -> None:
        dut, cut, meta, memory = self.dut, self.cut, self.dut.i.meta, self.memory
        m.d.comb += [
            Assume(~dut.i.stream.valid | (meta.kind != ports.PARTICIPANTS), "of endpoints"),
            Assume(~dut.tick, "no sweep"),
        ]
        self.meant()
        self.rules(m)
        its = Cat(its & there for its, there in zip(self.is_its, dut.matched, strict=True))
        full = Signal()
        due, proxy = Signal(), Signal.like(dut.due.proxy)
        m.d.sync += [due.eq(dut.due.en), proxy.eq(dut.due.proxy)]
        m.d.sync += full.eq(cut.done & (full | dut.drop_full))
        of_participants, of_proxies, its_words = self.written()
        m.d.comb += [
            Assert(~(cut.proceed & self.matching) | its.any() | full, "matched"),
            Assert(~(cut.proceed & self.ending) | ~its.any(), "unmatched"),
            Assert(~dut.drop_full | (self.matching & dut.matched.all() & ~its.any()), "full"),
            Assert(~self.later | self.single, "single"),
            Assert(~(self.rose | self.fell).any(), "lost"),
            Assert(~Cat(of_participants, of_proxies).any(), "words"),
            Cover(self.rose_place.any(), "matched"),
            Cover(self.fell_place.any() & ~meta.gone, "agrees no more"),
            Cover(full & self.matching, "no place"),
        ]
        for n in range(PEERS.endpoints):
            info = memory.info[n]
            right = self.matching & self.is_its[n] & self.were_matched[:n].all()
            right &= info[tables.INFO_LOCAL : tables.INFO_LOCAL + 8] == self.local
            right &= info[tables.INFO_RELIABLE] == self.reliable
            to_it = due & (proxy == Cat(Const(n, PEERS.index_bits), C(1, 1)))
            m.d.comb += [
                Assert(~self.fell_place[n] | (self.ending & self.is_its[n]), "lost"),
                Assert(~self.rose_place[n] | right, "right"),
                Assert(~self.rose_place[n] | to_it, "due"),
                Assert(~its_words[n] | (self.matching & (~dut.matched[n] | self.is_its[n])), "words"),
            ]


class ManyListsSpec(_Tables):
    """`distinct`: a participant has one place, whatever it says, and how often, in one datagram or in several."""

    once = False
    quick, deep = 40, 54
    scale = (
        *_Tables.scale,
        ("with m.If(step == 15 + READ_LATENCY):", "with m.If(step == 3 + READ_LATENCY):"),
    )
    bugs = (Bug("distinct", "with m.Elif(~arrived):", "with m.Else():"),)

    def judge(self, m: Module) -> None:
        dut, meta = self.dut, self.dut.i.meta
        departed = Signal()
        m.d.sync += departed.eq(departed | self.fell.any())
        m.d.comb += [
            Assume(meta.kind == ports.PARTICIPANTS, "participants"),
            Assume(~dut.tick, "no lease expires"),
            Assume(~self.second | self.distinct, "distinct"),
            Assert(self.first | self.second | self.distinct, "distinct"),
            Cover(self.rose.any() & departed, "again"),
        ]


class BoundsSpec(_Tables):
    """Whatever the memory has, and however many lists come. `proceeds`: a list that is done is dealt with within `LIST`
    cycles, and `swept`: the walker is held no longer than `SWEEP` cycles."""

    quick, deep = 40, 80
    bugs = (
        Bug("proceeds", "with m.If(step == 15 + READ_LATENCY):", "with m.If(step[:4] == 16):"),
        Bug("swept", SWEPT.format("peers.participants"), SWEPT.format("255")),
    )

    def properties(self, m: Module) -> None:
        dut, cut = self.dut, self.dut._parameters
        self.ports += [*cut.free, dut.any_alive, dut.any_matched, dut.any_heard, dut.any_endpoint]
        m.d.sync += dut.loads.eq(0)
        frames = self.assume(m, "i")
        cut.contract(m, frames.within, dut.idle)
        held = Signal()
        list_, sweep = Signal(range(LIST + 2)), Signal(range(SWEEP + 2))
        m.d.sync += [
            held.eq(dut.idle & dut.hold),
            list_.eq(Mux(cut.done & ~cut.proceed, list_ + 1, 0)),
            sweep.eq(Mux(dut.hold & dut.idle, sweep + 1, 0)),
        ]
        m.d.comb += [
            Assume(~dut.loads | ~(dut.i.stream.valid | dut.tick | dut.heard), "nothing yet"),
            Assume(~dut.idle | ~(dut.i.stream.valid | frames.within | dut.heard), "idle"),
            Assume(~held | dut.idle, "held"),
            Assume(~(dut.tick & held), "a second"),
            Assert(list_ <= LIST, "proceeds"),
            Assert(sweep <= SWEEP, "swept"),
            Cover(list_ == LIST, "longest"),
            Cover(sweep == SWEEP, "all"),
        ]


SPECS: tuple[type[Spec], ...] = (ParticipantsSpec, EndpointsSpec, ManyListsSpec, BoundsSpec)
