"""Parameter lists of discovery, word by word. RTPS 2.3, 9.4.2.11 (octets), 9.6.2.2 (meaning).

`Parameters` reads a list, keeps in the scratch area what is kept, and judges the rest; what follows from it is the business
of `discovery`.
"""

from __future__ import annotations

import enum
from collections.abc import Callable

from amaranth.hdl import Cat, Const, Module, Mux, Signal, Value
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.compare import below
from roslet.gateware.meta import ADDRESSES
from roslet.gateware.rtps import ports, tables
from roslet.gateware.rtps.ports import DISCOVERY, READ_LATENCY, ReadSignature, WriteSignature, exchanged
from roslet.gateware.rtps.tables import OwnMap, PeerMap
from roslet.gateware.words import MessageSignature
from roslet.wire.rtps import locator, qos
from roslet.wire.rtps import parameter_list as pl
from roslet.wire.rtps.participant_data import DEFAULT_LEASE

PL_CDR = 0x02
"""The second octet of an encapsulation header, whose lowest bit says little endian."""
_NEVER = 0x7FFFFFFF
"""Seconds of DURATION_INFINITE."""
LOOPBACK = 127
GROUP = int.from_bytes(locator.SPDP_MULTICAST_ADDRESS, "little")
"""The group of all participants, as a word has it."""
USER_GROUP_PORT = locator.user_multicast_port(0) - locator.metatraffic_multicast_port(0)
"""How far behind the port of announcements that of messages to the group is. RTPS 2.3, 9.6.1.1."""
MAX_LEASE = 0xFFFF
"""Seconds: leases are taken to be no longer, 18 hours."""


class _What(enum.IntEnum):
    """What is done with the value of a parameter."""

    SKIP = 0
    GUID = 1
    LEASE = 2
    LOCATOR = 3
    USER_LOCATOR = 4
    DOMAIN = 5
    TAG = 6
    TOPIC = 7
    TYPE = 8
    RELIABILITY = 9
    DURABILITY = 10
    DEADLINE = 11
    LIVELINESS = 12
    OWNERSHIP = 13
    ORDER = 14
    PRESENTATION = 15
    PARTITION = 16
    REPRESENTATION = 17
    GROUP = 18


_OF_PARTICIPANTS = {
    pl.PID_PARTICIPANT_GUID: _What.GUID,
    pl.PID_PARTICIPANT_LEASE_DURATION: _What.LEASE,
    pl.PID_METATRAFFIC_UNICAST_LOCATOR: _What.LOCATOR,
    pl.PID_DEFAULT_UNICAST_LOCATOR: _What.USER_LOCATOR,
    pl.PID_DEFAULT_MULTICAST_LOCATOR: _What.GROUP,
    pl.PID_DOMAIN_ID: _What.DOMAIN,
    pl.PID_DOMAIN_TAG: _What.TAG,
}
_OF_ENDPOINTS = {
    pl.PID_ENDPOINT_GUID: _What.GUID,
    pl.PID_UNICAST_LOCATOR: _What.USER_LOCATOR,
    pl.PID_MULTICAST_LOCATOR: _What.GROUP,
    pl.PID_TOPIC_NAME: _What.TOPIC,
    pl.PID_TYPE_NAME: _What.TYPE,
    pl.PID_RELIABILITY: _What.RELIABILITY,
    pl.PID_DURABILITY: _What.DURABILITY,
    pl.PID_DEADLINE: _What.DEADLINE,
    pl.PID_LIVELINESS: _What.LIVELINESS,
    pl.PID_OWNERSHIP: _What.OWNERSHIP,
    pl.PID_DESTINATION_ORDER: _What.ORDER,
    pl.PID_PRESENTATION: _What.PRESENTATION,
    pl.PID_PARTITION: _What.PARTITION,
    pl.PID_DATA_REPRESENTATION: _What.REPRESENTATION,
}

READ = data.StructLayout(
    {
        "guid": 1,
        "meta": 1,
        "user": 1,
        "topic": 1,
        "type": 1,
        "lease": 16,
        "entity": 32,
        "refused": 1,
        "reliable": 1,
        "durability": 2,
    }
)
"""What a list has said. `guid`, `meta`, `user`, `topic`, `type`: it was there (the locators, one that can be used); `lease`
in seconds; `entity` id; `refused`, a policy that none of our endpoints agrees to, or another domain, or something that must
be understood; `reliable` and `durability`, kinds, as offered or requested."""


class Parameters(wiring.Component):
    """Reads one list at a time.

    Ports: `i`, lists with their encapsulation header; `peers` and `own`, read ports; `write`; `addresses`, `group_port`
    (where all are announced to), `domain`, ours:
    that is not looked at where `judge_domain` is false.
    `read` is what the list has said, and `same` a bit for each of our endpoints of the other kind: it has this topic and
    this type. `near`: where it takes the user's messages is in our subnet; `listens`: it takes them by the group of all
    participants as well, at the port for these. All are steady while `done` is high: the list's good end is at `i`, and
    stays there until `proceed` is high for a cycle. After a bad end the next list is read.

    In the scratch area there are then the words of a participant, of which `read` says whether they were there, or of an
    endpoint its locator. Of several locators the first in our own subnet is taken, else the first.

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
        little = Signal()
        number = Signal(32)  # the word as one, in the cycle after
        m.d.sync += number.eq(Mux(little, word, exchanged(word)))
        is_participant = meta.kind == ports.PARTICIPANTS

        what = Signal(_What)
        # Words of a value: still to come, less one, so that after the last the highest bit is set; and before
        left, at = Signal(15), Signal(10)
        step = Signal(range(self.locals + READ_LATENCY + 1))  # within a word
        text_left = Signal(16)
        masked = Signal(32)
        # Of a locator whose words are passing
        self._usable, self._port = Signal(), Signal(16)
        self._user_group_port = Signal(16)
        self._near = [Signal(), Signal()]  # what was taken, of each kind, is in our subnet
        m.d.comb += [
            self._user_group_port.eq(self.group_port + USER_GROUP_PORT),
            self.near.eq(Mux(read.user, self._near[1], self._near[0])),
        ]

        with m.FSM():
            with m.State("IDLE"):
                default = meta.kind == ports.PUBLICATIONS  # writers are reliable if they say nothing
                m.d.sync += [read.eq(0), read.reliable.eq(default), self.same.eq(-1)]
                m.d.sync += [near.eq(0) for near in self._near]
                m.d.sync += self.listens.eq(0)
                m.d.sync += read.lease.eq(DEFAULT_LEASE // 1_000_000_000)
                with m.If(ended):
                    m.next = "DONE"  # what is gone may have no list
                with m.Elif(i.valid):
                    m.next = "ENCAPSULATION"
            with m.State("ENCAPSULATION"):
                m.d.comb += i.ready.eq(1)
                m.d.sync += little.eq(word[8])
                m.next = "PARAMETER"
                with m.If((word[:8] != 0) | (word[9:16] != PL_CDR >> 1)):
                    m.next = "MALFORMED"
            with m.State("PARAMETER"):
                pid = Mux(little, word[:16], Cat(word[8:16], word[:8]))
                length = Mux(little, word[16:32], Cat(word[24:32], word[16:24]))
                # What must be understood, and is not.
                unknown = (pid & pl.FLAG_MUST_UNDERSTAND).any() & ~(pid & pl.FLAG_VENDOR).any()
                m.d.sync += [what.eq(_What.SKIP), left.eq(length[2:] - 1), at.eq(0), step.eq(0)]
                for here, table in ((is_participant, _OF_PARTICIPANTS), (~is_participant, _OF_ENDPOINTS)):
                    with m.If(here & came), m.Switch(pid):
                        for value, action in table.items():
                            with m.Case(value):
                                m.d.sync += what.eq(action)
                        with m.Default(), m.If(unknown):
                            m.d.sync += read.refused.eq(1)
                with m.If(came):
                    m.d.comb += i.ready.eq(1)
                    m.next = "VALUE"
                    with m.If(length[:2] != 0):
                        m.next = "MALFORMED"
                    with m.If(pid == pl.PID_SENTINEL):
                        m.next = "REST"
                with m.Elif(i.valid):
                    m.next = "MALFORMED"
            with m.State("VALUE"):
                with m.If(left[-1]):
                    m.next = "PARAMETER"
                with m.Elif(ended):
                    m.next = "MALFORMED"
                with m.Elif(came):
                    last = Signal()  # cycle of this word
                    m.d.comb += [last.eq(step == 1), i.ready.eq(last)]
                    m.d.sync += step.eq(step + 1)
                    with m.If(last):
                        m.d.sync += [left.eq(left - 1), at.eq(at + ~at.all()), step.eq(0)]
                    self._value(m, what, at, step, word, number, little, left, last, text_left, masked)
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
        return m

    def _value(
        self,
        m: Module,
        what: Value,
        at: Value,
        step: Value,
        word: Value,
        number: Value,
        little: Value,
        left: Value,
        last: Value,
        text_left: Value,
        masked: Value,
    ) -> None:
        """One word of a value, which stands there until `last`."""
        meta, read = self.i.meta, self.read
        reader = meta.kind == ports.SUBSCRIPTIONS  # it requests; what it requests beyond our offer is refused
        own_ip, mask = Value.cast(self.addresses.ip), Value.cast(self.addresses.mask)

        def keep(target: Value, value: Value) -> None:
            m.d.comb += [self.write.en.eq(1), self.write.addr.eq(target), self.write.data.eq(value)]

        def refuse(condition: Value) -> None:
            with m.If(condition & (step != 0)):
                m.d.sync += read.refused.eq(1)

        first, second = at == 0, at == 1
        with m.Switch(what):
            with m.Case(_What.GUID):
                m.d.comb += self.peers.addr.eq(self._peers.scratch((tables.SCRATCH_SOURCE + at)[:4]))
                m.d.comb += last.eq(step == READ_LATENCY)
                with m.If(at == 3):
                    m.d.sync += [read.entity.eq(word), read.guid.eq(1)]
                with m.Elif(at[2:] == 0):
                    keep(self._peers.scratch(at), word)
                    with m.If(last & (self.peers.data != word)):
                        m.next = "MALFORMED"
            with m.Case(_What.LEASE), m.If(first):
                m.d.sync += read.lease.eq(Mux(number[16:].any(), MAX_LEASE, number[:16]))
            for kind, flag, ip in (
                (_What.LOCATOR, read.meta, tables.META_IP),
                (_What.USER_LOCATOR, read.user, tables.USER_IP),
            ):
                with m.Case(kind):
                    self._locator(
                        m, at, step, word, number, last, flag, ip, ((word ^ own_ip) & mask) == 0, keep
                    )
            with m.Case(_What.GROUP):
                self._group(m, at, step, word, number, last)
            with m.Case(_What.DOMAIN):
                if self._judge_domain:
                    refuse(first & (number != self.domain))
            with m.Case(_What.TAG):
                refuse(first & (number[1:] != 0))  # a text with more than its NUL
            for kind, flag, is_type in ((_What.TOPIC, read.topic, 0), (_What.TYPE, read.type, 1)):
                with m.Case(kind):
                    self._text(m, at, step, word, number, left, last, text_left, masked, flag, is_type)
            with m.Case(_What.RELIABILITY), m.If(first):
                m.d.sync += read.reliable.eq(number == qos.RELIABLE)
            with m.Case(_What.DURABILITY), m.If(first):
                m.d.sync += read.durability.eq(number[:2])
            with m.Case(_What.DEADLINE):
                refuse(first & reader & (number != _NEVER))
            with m.Case(_What.LIVELINESS):
                refuse(reader & ((first & (number != qos.AUTOMATIC)) | (second & (number != _NEVER))))
            with m.Case(_What.OWNERSHIP):
                refuse(first & (number != qos.SHARED))
            with m.Case(_What.ORDER):
                refuse(first & reader & (number != qos.BY_RECEPTION_TIMESTAMP))
            with m.Case(_What.PRESENTATION):
                refuse(reader & ((first & (number != qos.INSTANCE)) | (second & (word[:16] != 0))))
            with m.Case(_What.PARTITION):
                refuse(first & (number != 0))
            with m.Case(_What.REPRESENTATION):
                # A writer uses the first of its list, a reader takes any of it; the first two are looked at.
                ids = Mux(little, word, Cat(word[8:16], word[:8], word[24:32], word[16:24]))
                one = Signal()  # there is no second
                with m.If(first):
                    m.d.sync += one.eq(number == 1)
                also = reader & ~one & (ids[16:] == qos.XCDR1)
                refuse(second & (ids[:16] != qos.XCDR1) & ~also)

    def _locator(
        self,
        m: Module,
        at: Value,
        step: Value,
        word: Value,
        number: Value,
        last: Value,
        flag: Value,
        ip: int,
        is_near: Value,
        keep: Callable[[Value, Value], None],
    ) -> None:
        """Kind, port, twelve zeros, address. `is_near`: `word` is an address of our own subnet."""
        usable, port = self._usable, self._port
        near = self._near[ip == tables.USER_IP]
        with m.If(at == 0):
            m.d.sync += usable.eq(number == locator.LOCATOR_KIND_UDPv4)
        with m.Elif((at == 1) & (step != 0)):
            m.d.sync += [port.eq(number), usable.eq(usable & (number[:16] != 0) & (number[16:] == 0))]
        with m.Elif(at == 5):
            wanted = usable & (word[:8] != 0) & (word[:8] != LOOPBACK) & (~flag | (is_near & ~near))
            m.d.comb += last.eq(step == 1)
            with m.If(wanted):
                keep(self._peers.scratch(Mux(step == 0, ip, ip + 1)), Mux(step == 0, word, port))
                with m.If(last):
                    m.d.sync += [flag.eq(1), near.eq(is_near)]

    def _group(self, m: Module, at: Value, step: Value, word: Value, number: Value, last: Value) -> None:
        """A locator of a group: whether it is the one that we know, at the port for the user's messages."""
        usable = self._usable
        with m.If(at == 0):
            m.d.sync += usable.eq(number == locator.LOCATOR_KIND_UDPv4)
        with m.Elif((at == 1) & (step != 0)):
            m.d.sync += usable.eq(usable & (number == self._user_group_port))
        with m.Elif((at == 5) & last & usable & (word == GROUP)):
            m.d.sync += self.listens.eq(1)

    def _text(
        self,
        m: Module,
        at: Value,
        step: Value,
        word: Value,
        number: Value,
        left: Value,
        last: Value,
        text_left: Value,
        masked: Value,
        flag: Value,
        is_type: int,
    ) -> None:
        """A text: compared, a word at a time, with that of each of our endpoints of the other kind."""
        first = at == 0
        m.d.sync += masked.eq(Mux(first, number, word))  # which is looked at later: the word stays
        for n in range(4):
            with m.If(~first & below(text_left, n + 1)):
                m.d.sync += masked.word_select(n, 8).eq(0)
        reader = self.i.meta.kind == ports.PUBLICATIONS
        m.d.comb += [
            self.own.addr.eq(self._own.text(reader, Const(is_type, 1), step, at)),
            last.eq(step == self.locals + READ_LATENCY - 1),
        ]
        # Whose word the memory gives next, and now
        addressed, shown = Signal(range(self.locals)), Signal(range(self.locals))
        m.d.sync += [addressed.eq(step), shown.eq(addressed)]
        with m.If((step >= READ_LATENCY) & (first | (text_left != 0))):
            for n in range(self.locals):
                with m.If((shown == n) & (self.own.data != masked)):
                    m.d.sync += self.same[n].eq(0)
        with m.If(last):
            m.d.sync += text_left.eq(Mux(text_left[2:] != 0, Cat(text_left[:2], text_left[2:] - 1), 0))
            with m.If(first):
                m.d.sync += [text_left.eq(number), flag.eq(number[16:] == 0)]
                with m.If((number == 0) | (number[16:] != 0) | (((number[:16] + 3) >> 2) > left[:-1])):
                    m.next = "MALFORMED"
