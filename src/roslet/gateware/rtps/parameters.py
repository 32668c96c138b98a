"""Parameter lists of discovery, word by word. RTPS 2.3, 9.4.2.11 (octets), 9.6.2.2 (meaning).

`Parameters` reads a list, keeps in the scratch area what is kept, and judges the rest; what follows from it is the business
of `discovery`.
"""

from __future__ import annotations

from collections.abc import Mapping

from amaranth.hdl import Cat, Module, Mux, Signal, Value
from amaranth.lib import data, memory, wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.meta import ADDRESSES
from roslet.gateware.rtps import ports, tables
from roslet.gateware.rtps.ports import DISCOVERY, KEEP, READ_LATENCY, ReadSignature, WriteSignature
from roslet.gateware.rtps.tables import OwnMap, PeerMap
from roslet.gateware.words import MessageSignature
from roslet.wire.rtps import locator, qos
from roslet.wire.rtps import parameter_list as pl
from roslet.wire.rtps.participant_data import DEFAULT_LEASE

PL_CDR = 0x02
"""The second octet of an encapsulation header, whose lowest bit says little endian."""
LOOPBACK = 127
GROUP = int.from_bytes(locator.SPDP_MULTICAST_ADDRESS, "little")
"""The group of all participants, as a word has it."""

_ROW = data.StructLayout(
    dict.fromkeys(
        (
            *("known", "must", "end", "guid", "lease", "locator", "user", "group", "text", "type"),
            *("reliability", "durability", "readers", "domain", "few", "zero", "never"),
            *("then_never", "then_false", "representation"),
        ),
        1,
    )
)
"""What is done with the value of a parameter: its first words are kept, or judged.

`known`: anything; `must` be understood, by its id; `end` of the list. `locator`, of the `user`'s messages or of discovery,
or of a `group`; `text`, of the `type` or topic. What refuses, `readers` only or everybody: another `domain`; a first word
that is not 0 or 1 (`few`), not `zero`, not that of DURATION_INFINITE (`never`); a second one that is not that
(`then_never`), or begins with a boolean that is true (`then_false`); another `representation`."""

_OF_PARTICIPANTS = {
    pl.PID_SENTINEL: "end",
    pl.PID_PARTICIPANT_GUID: "guid",
    pl.PID_PARTICIPANT_LEASE_DURATION: "lease",
    pl.PID_METATRAFFIC_UNICAST_LOCATOR: "locator",
    pl.PID_DEFAULT_UNICAST_LOCATOR: "locator user",
    pl.PID_DEFAULT_MULTICAST_LOCATOR: "group",
    pl.PID_DOMAIN_ID: "domain",
    pl.PID_DOMAIN_TAG: "must few",  # a text with no more than its NUL
}
# By the default of each policy: AUTOMATIC, SHARED, BY_RECEPTION_TIMESTAMP, INSTANCE, no partition.
_OF_ENDPOINTS = {
    pl.PID_SENTINEL: "end",
    pl.PID_ENDPOINT_GUID: "guid",
    pl.PID_UNICAST_LOCATOR: "locator user",
    pl.PID_MULTICAST_LOCATOR: "group",
    pl.PID_TOPIC_NAME: "text",
    pl.PID_TYPE_NAME: "text type",
    pl.PID_RELIABILITY: "reliability",
    pl.PID_DURABILITY: "durability",
    pl.PID_DEADLINE: "readers never",
    pl.PID_LIVELINESS: "readers zero then_never",
    pl.PID_OWNERSHIP: "zero",
    pl.PID_DESTINATION_ORDER: "readers zero",
    pl.PID_PRESENTATION: "readers zero then_false",
    pl.PID_PARTITION: "zero",
    pl.PID_DATA_REPRESENTATION: "representation",
}
_ID_BITS = 7
"""Of an id, those by which the table is read: no two in it have the same."""


def _rows(*lists: Mapping[int, str]) -> list[dict[str, int]]:
    """The table: a row for each of these lists and low bits of an id."""
    rows: list[dict[str, int]] = []
    for table in lists:
        found = {pid % (1 << _ID_BITS): f"known {words}" for pid, words in table.items()}
        rows += [dict.fromkeys(found.get(n, "").split(), 1) for n in range(1 << _ID_BITS)]
    return rows


READ = data.StructLayout(
    {
        "guid": 1,
        "meta": 1,
        "user": 1,
        "topic": 1,
        "type": 1,
        "refused": 1,
        "reliable": 1,
        "durability": 2,
    }
)
"""What a list has said. `guid`, `meta`, `user`, `topic`, `type`: it was there (the locators, one that can be used);
`refused`, a policy that none of our endpoints agrees to, or another domain, or something that must be understood;
`reliable` and `durability`, kinds, as offered or requested."""


LAST = 5
"""The step in which a word that is looked at is taken: in four its octets pass, in two it is judged and kept."""


class _Passing:
    """What is passing: a parameter's header, or its value."""

    def __init__(self, locals_: int) -> None:
        self.act, self.known = Signal(_ROW), Signal()
        self.must = Signal()  # it must be understood
        self.little = Signal()
        self.last_of_text = 4 * locals_ + READ_LATENCY - 1
        self.step = Signal(range(self.last_of_text + 1))  # within a word
        self.last = Signal(init=1)  # the word is taken
        self.octet, self.place = Signal(8), Signal(2)  # one of its octets, and which
        self.passes = Signal()  # these do, for the first time
        self.shifts = Signal()  # and its number is kept
        # Of a word as a number: its lower half; that, or the other one, is not zero; it is DURATION_INFINITE's seconds.
        self.number, self.any, self.high, self.never = Signal(16), Signal(), Signal(), Signal()
        self.at = Signal(14)  # words of the value before this one
        self.first, self.second = Signal(), Signal()
        # Of a text: this word has what is left of its octets, less than four; it has none.
        self.partial, self.over = Signal(), Signal()
        self.unlike = Signal()  # an octet of it was not like that of the endpoint which was looked at
        self.usable = Signal()  # the locator; of a list, it has one item
        self.near = Signal(2)  # what was taken, of discovery and of the user's, is in our subnet
        # What is kept, and where
        self.keeps_word, self.keeps_number, self.keeps_high = Signal(), Signal(), Signal()
        self.target = Signal(4)

    def octets(self, m: Module, word: Value) -> None:
        """The octets of a word pass, that with the highest bits of a number first."""
        octet, begins = self.octet, Signal()
        m.d.comb += [
            self.place.eq(self.step[:2] ^ self.little.replicate(2)),
            octet.eq(word.word_select(self.place, 8)),
            self.passes.eq(~self.step[2:].any()),
            begins.eq(self.step[:2] == 0),
            self.any.eq(self.number.any()),
        ]
        with m.If(self.passes):
            m.d.sync += self.never.eq((octet[:7] == 0x7F) & (octet[7] ^ begins) & (self.never | begins))
            with m.If(~self.step[1]):
                m.d.sync += self.high.eq(octet.any() | (self.high & ~begins))
            with m.If(self.shifts):
                m.d.sync += self.number.eq(Cat(octet, self.number[:8]))


class Parameters(wiring.Component):
    """Reads one list at a time.

    Ports: `i`, lists with their encapsulation header; `peers` and `own`, read ports; `write`; `keep`, the word at `i` is
    kept though it is of no list and not valid, at least three cycles before the next list; `addresses`, `group_port` (where
    all are announced to), `domain`, ours: that is not looked at where `judge_domain` is false.
    `read` is what the list has said, and `same` a bit for each of our endpoints of the other kind: it has this topic and
    this type. `near`: where it takes the user's messages is in our subnet; `listens`: it takes them by the group of all
    participants as well, at the port for these. All are steady while `done` is high: the list's good end is at `i`, and
    stays there until `proceed` is high for a cycle. After a bad end the next list is read.

    In the scratch area there are then the words of a participant, of which `read` says whether they were there, but for its
    lease, which is there in any case, or of an endpoint its locator; and the entity id of a GUID that was there, at
    SCRATCH_ENTITY. Of several locators the first in our own subnet is taken, else the first.

    A parameter's header takes seven cycles, a word of a value six, or of a text that may be ours four for each of our
    endpoints and two, a word that is not looked at one.

    Good lists that are not what they should be are dropped: `drop_malformed`: no PL_CDR, no end, a value longer than the
    list, or a GUID that is not the sender's.
    """

    def __init__(self, peers: PeerMap, own: OwnMap, judge_domain: bool = True) -> None:
        self._peers, self._own, self._judge_domain = peers, own, judge_domain
        self.locals = 1 << own.local_bits
        super().__init__(
            {
                "i": In(MessageSignature(DISCOVERY)),
                "peers": Out(ReadSignature(peers.address_bits)),
                "own": Out(ReadSignature(own.address_bits)),
                "write": Out(WriteSignature(peers.address_bits)),
                "keep": In(KEEP),
                "addresses": In(ADDRESSES),
                "group_port": In(16),
                "domain": In(8),
                "done": Out(1),
                "proceed": In(1),
                "read": Out(READ),
                "same": Out(self.locals),
                "near": Out(1),
                "listens": Out(1),
                "drop_malformed": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        i, meta, read = self.i.stream, self.i.meta, self.read
        word = i.payload.data
        came, ended = Signal(), Signal()
        m.d.comb += [came.eq(i.valid & ~i.payload.end), ended.eq(i.valid & i.payload.end)]
        m.submodules.table = table = memory.Memory(
            shape=_ROW, depth=2 << _ID_BITS, init=_rows(_OF_ENDPOINTS, _OF_PARTICIPANTS)
        )
        row = table.read_port()
        v = _Passing(self.locals)
        v.octets(m, word)
        length = Signal(16)  # of the value; in words, and two bits, what is left of it
        none = Signal()  # no word is
        m.d.sync += v.step.eq(v.step + came)
        with m.If(v.last):
            m.d.sync += v.step.eq(0)
        # Whose word the memory gives next, and now, and gave before
        addressed, shown, judged = (Signal(range(self.locals)) for _ in range(3))
        m.d.sync += [addressed.eq(v.step[2:]), shown.eq(addressed), judged.eq(shown), v.unlike.eq(0)]
        with m.If(v.unlike):
            m.d.sync += self.same.bit_select(judged, 1).eq(0)
        m.d.comb += [
            row.addr.eq(Cat(v.number[:_ID_BITS], meta.kind == ports.PARTICIPANTS)),
            self.near.eq(Mux(read.user, v.near[1], v.near[0])),
        ]

        with m.FSM() as fsm:
            with m.State("IDLE"):
                with m.If(ended):
                    m.next = "DONE"  # what is gone may have no list
                with m.Elif(i.valid):
                    m.next = "ENCAPSULATION"
            with m.State("ENCAPSULATION"):
                m.d.comb += i.ready.eq(1)
                m.d.comb += v.keeps_number.eq(1)  # a lease, as nothing else has come
                m.d.sync += v.little.eq(word[8])
                m.next = "PARAMETER"
                with m.If((word[:8] != 0) | (word[9:16] != PL_CDR >> 1)):
                    m.next = "MALFORMED"
            with m.State("PARAMETER"):
                # Of an id and a length, as a number, the upper half passes first.
                of_id = v.step[1] == v.little
                m.d.comb += [v.shifts.eq(of_id), v.last.eq(v.step == LAST), i.ready.eq(came & v.last)]
                with m.If(v.passes & ~of_id):
                    passed = Cat(v.octet, length[:8])
                    m.d.sync += [length.eq(passed), none.eq(passed[2:] == 0)]
                known = v.number[_ID_BITS:] == row.data.must << 14 - _ID_BITS
                m.d.sync += [v.act.eq(row.data), v.known.eq(known & row.data.known)]
                m.d.sync += v.must.eq(v.number[14] & ~v.number[15])
                with m.If(i.ready):
                    m.next = "VALUE"
                with m.If(ended):
                    m.next = "MALFORMED"
            with m.State("VALUE"):
                with m.If(v.must & ~v.known):
                    m.d.sync += read.refused.eq(1)
                with m.If(v.known & v.act.end):
                    m.next = "REST"
                with m.Elif(length[:2] != 0):
                    m.next = "MALFORMED"
                with m.Elif(none):
                    m.next = "PARAMETER"
                    with m.If(~v.over & ~(v.partial & (v.number[:2] == 0))):
                        m.next = "MALFORMED"
                with m.Elif(ended):
                    m.next = "MALFORMED"
                with m.Elif(came & ~v.known):
                    m.d.comb += i.ready.eq(1)
                with m.Elif(came):
                    longer = v.act.text & self.same.any()
                    m.d.comb += [
                        v.last.eq((v.step == v.last_of_text) | ((v.step == LAST) & ~longer)),
                        i.ready.eq(v.last),
                    ]
                    self._judge(m, v)
                    self._guid(m, v)
                    self._locator(m, v)
                    self._text(m, v)
            with m.State("REST"):
                m.d.comb += i.ready.eq(came)
                with m.If(ended):
                    m.next = "DONE"
            with m.State("DONE"):
                m.d.comb += [self.done.eq(~i.payload.bad), i.ready.eq(self.proceed | i.payload.bad)]
                with m.If(i.ready):
                    m.next = "IDLE"
            with m.State("MALFORMED"):
                m.d.comb += [i.ready.eq(1), self.drop_malformed.eq(ended & ~i.payload.bad)]
                with m.If(ended):
                    m.next = "IDLE"
        # Below all states: so these are resets of registers, not inputs of multiplexers.
        with m.If(i.valid & i.ready):
            m.d.sync += [v.at.eq(v.at + 1), v.first.eq(0), v.second.eq(v.first)]
        with m.If(fsm.ongoing("VALUE") & i.valid & i.ready):
            m.d.sync += [length[2:].eq(length[2:] - 1), none.eq(length[2:] == 1)]
        with m.If(fsm.ongoing("PARAMETER")):
            m.d.sync += [v.at.eq(0), v.first.eq(1), v.second.eq(0), v.over.eq(1)]
        with m.If(fsm.ongoing("IDLE")):
            default = meta.kind == ports.PUBLICATIONS  # writers are reliable if they say nothing
            m.d.sync += [read.eq(0), read.reliable.eq(default), self.same.eq(-1)]
            m.d.sync += [
                v.near.eq(0),
                self.listens.eq(0),
                v.act.eq(0),
                v.number.eq(DEFAULT_LEASE // 1_000_000_000),
            ]
        # Which of the two is kept is known late in a cycle, so it is chosen in the next.
        kept_word, kept_number = Signal(32), Signal(tables.LEASE_BITS)
        is_word, is_number = Signal(), Signal()
        m.d.sync += [
            self.write.addr.eq(self._peers.scratch(v.target)),
            kept_word.eq(word),
            kept_number.eq(Cat(v.number, v.keeps_high)),
            is_word.eq(v.keeps_word),
            is_number.eq(v.keeps_number),
        ]
        with m.If(~(v.keeps_word | v.keeps_number)):
            m.d.sync += self.write.addr.eq(0)
        m.d.comb += v.target.eq(tables.LEASE)
        with m.If(v.act.guid):
            m.d.comb += v.target.eq(v.at[:2] | (v.at[:2] == 3).replicate(2) << 2)
        with m.If(v.act.locator):
            m.d.comb += v.target.eq(Cat(v.last, v.act.user, 1))
        with m.If(self.keep.en):
            m.d.comb += [v.keeps_word.eq(1), v.target.eq(self.keep.word)]
        m.d.comb += [
            self.write.en.eq(is_word | is_number),
            self.write.data.eq(Mux(is_word, kept_word, 0) | Mux(is_number, kept_number, 0)),
        ]
        return m

    def _judge(self, m: Module, v: _Passing) -> None:
        """Numbers: what is read of them, and what is not as it should be."""
        act, read, number = v.act, self.read, v.number
        first, second = v.first & v.last, v.second & v.last
        m.d.comb += v.shifts.eq(v.first | (v.second & ~act.text))
        # It requests; what it requests beyond our offer is refused.
        reader = self.i.meta.kind == ports.SUBSCRIPTIONS
        beyond = v.high | number[2:].any()
        is_few = ~beyond & ~number[1]
        # The halves of a word as they came
        front, back = Mux(v.little, v.any, v.high), Mux(v.little, v.high, v.any)
        at_first = (act.zero & (v.any | v.high)) | (act.never & ~v.never) | (act.few & ~is_few)
        if self._judge_domain:
            at_first |= act.domain & (v.high | (number != self.domain))
        # A writer uses the first of its list, a reader takes any of it; the first two are looked at. XCDR1 is 0.
        other = front & ~(reader & ~v.usable & ~back)
        at_second = (act.then_never & ~v.never) | (act.then_false & front) | (act.representation & other)
        with m.If(((first & at_first) | (second & at_second)) & (reader | ~act.readers)):
            m.d.sync += read.refused.eq(1)
        with m.If(first):
            m.d.sync += v.usable.eq(is_few & number[0])  # 1: UDPv4; one item
            with m.If(act.reliability):
                m.d.sync += read.reliable.eq(~beyond & (number[:2] == qos.RELIABLE))
            with m.If(act.durability):
                m.d.sync += read.durability.eq(number[:2])
        with m.If(act.lease & v.first & ~v.passes):
            m.d.comb += [v.keeps_number.eq(1), v.keeps_high.eq(v.high)]

    def _guid(self, m: Module, v: _Passing) -> None:
        """Its prefix must be its sender's."""
        with m.If(v.act.guid & (v.at[2:] == 0)):
            m.d.comb += self.peers.addr.eq(self._peers.scratch((tables.SCRATCH_SOURCE + v.at[:2])[:4]))
            is_entity = v.at[:2] == 3
            m.d.comb += v.keeps_word.eq(1)
            with m.If(is_entity):
                m.d.sync += self.read.guid.eq(1)
            with m.Elif(v.last & (self.peers.data != self.i.stream.payload.data)):
                m.next = "MALFORMED"

    def _locator(self, m: Module, v: _Passing) -> None:
        """Kind, port, twelve zeros, address: of somebody, or of the group that we know."""
        act, read = v.act, self.read
        word = self.i.stream.payload.data
        own_ip, mask = Value.cast(self.addresses.ip), Value.cast(self.addresses.mask)
        # Of a word whose octets have passed
        is_near, is_host, is_group = Signal(), Signal(), Signal()
        m.d.sync += [
            is_near.eq(((word ^ own_ip) & mask) == 0),
            is_host.eq((word[:8] != 0) & (word[:8] != LOOPBACK)),
            is_group.eq(word == GROUP),
        ]
        user_group_port = Signal(16)
        m.d.comb += user_group_port.eq(self.group_port + tables.USER_GROUP_PORT)
        with m.If(v.second & v.last):
            m.d.sync += v.usable.eq(v.usable & ~v.high & Mux(act.group, v.number == user_group_port, v.any))
        flag, near = Mux(act.user, read.user, read.meta), v.near.bit_select(act.user, 1)
        wanted = is_host & (~flag | (is_near & ~near))
        with m.If((v.at == 5) & v.usable & ~v.passes):
            with m.If(act.group & is_group):
                m.d.sync += self.listens.eq(1)
            with m.If(act.locator & wanted):
                m.d.comb += [v.keeps_word.eq(~v.last), v.keeps_number.eq(v.last)]
                with m.If(v.last):
                    m.d.sync += near.eq(is_near)
                    with m.If(act.user):
                        m.d.sync += read.user.eq(1)
                    with m.Else():
                        m.d.sync += read.meta.eq(1)

    def _text(self, m: Module, v: _Passing) -> None:
        """A text: compared, an octet at a time, with that of each of our endpoints of the other kind."""
        reader = self.i.meta.kind == ports.PUBLICATIONS
        # Its length is compared as a number.
        own = self.own.data.word_select(v.step[:2] ^ (v.little | v.first).replicate(2), 8)
        counts = v.first | (~v.over & (~v.partial | (v.place < v.number[:2])))
        m.d.sync += v.unlike.eq(v.act.text & (v.step >= READ_LATENCY) & counts & (own != v.octet))
        with m.If(v.act.text):
            m.d.comb += self.own.addr.eq(self._own.text(reader, v.act.type, v.step[2:], v.at))
            with m.If(v.last):
                m.d.sync += [v.partial.eq(v.at == v.number[2:]), v.over.eq(~v.first & (v.over | v.partial))]
                with m.If(v.first):
                    with m.If(v.act.type):
                        m.d.sync += self.read.type.eq(1)
                    with m.Else():
                        m.d.sync += self.read.topic.eq(1)
                    with m.If(v.high | ~v.any):
                        m.next = "MALFORMED"
