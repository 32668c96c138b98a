"""What is sent, when, and to whom. RTPS 2.3, 8.4 (behaviour of writers and readers), 8.5.3.2 (announcements)."""

from __future__ import annotations

from collections.abc import Sequence

from amaranth.hdl import Array, C, Cat, Module, Mux, Signal, Value, signed
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.octets import pick
from roslet.gateware.rtps import tables
from roslet.gateware.rtps.composer import SUBJECT
from roslet.gateware.rtps.parameters import GROUP, USER_GROUP_PORT
from roslet.gateware.rtps.ports import READ_LATENCY, ReadSignature, WriteSignature
from roslet.gateware.rtps.rom import REGISTER_BITS, Register, Rom
from roslet.gateware.rtps.scan import lowest
from roslet.gateware.rtps.tables import OwnMap, PeerMap
from roslet.gateware.rtps.turns import JOB
from roslet.gateware.words import MessageSignature

CDR_LE = 0x0100
"""The encapsulation header of our messages, as a word has it."""
AGE = signed(16)
"""How far a number is behind a writer's last: 0, it is the last; -1, the next; the oldest ones are all MAX_AGE."""
MAX_AGE = tables.MAX_HISTORY - 1


class Sender(wiring.Component):
    """Serves who is next.

    Ports: `publish0` .. for each writer of the user, the first `users` of the tables' writers: its messages. `job`, `valid`,
    `taken`, of `Turns`; `matched`, the user proxies that there are; `group_port`, where all are to be announced to,
    and messages for the group at the next; `peers` and `own`, read ports, and `write`; `template`, `start`, `done`, `which`,
    `register`, `subject`, of the composer;
    `room`, `busy`, `finish`, `ip`, `port`, of the outbox; `writers`, `readers`, a bit for each of ours that is enabled;
    `again`, high for a cycle when every proxy must be served once.

    - When one of ours is enabled or disabled, all are told of again, under new numbers: of those that are not enabled, that
      they are gone.
    - A message is kept, replacing the oldest that its writer keeps, and sent at once to each reader that matches, with a
      HEARTBEAT to those that are reliable. Those that are in the group too, and need nothing older than the others, get it
      there together, if there were several of them at the writer's message before. Between two messages somebody else is
      served.
    - A peer's writer gets an ACKNACK when it is due: what is missing up to its last, `window` of it at most, as peers put
      what they repeat into one datagram.
    - A peer's reader gets, when it has asked, what it has asked for, of what is kept; a GAP for what is not; and a
      HEARTBEAT. Otherwise it gets a HEARTBEAT if it has not acknowledged everything.
    - Our announcement goes to everybody, or to the participant that is to be greeted.

    Dropped: `drop_long{n}`, a message of more words than its writer's.
    """

    def __init__(self, rom: Rom, peers: PeerMap, own: OwnMap, users: int, window: int = 3) -> None:
        if not 1 <= window <= 32:
            raise ValueError(f"an ACKNACK asks for 1 to 32 messages, not {window}")
        self._rom, self._peers, self._own, self._users, self._window = rom, peers, own, users, window
        super().__init__(
            {
                **{f"publish{n}": In(MessageSignature()) for n in range(users)},
                **{f"drop_long{n}": Out(1) for n in range(users)},
                "job": In(JOB),
                "valid": In(1),
                "taken": Out(1),
                "matched": In(peers.endpoints),
                "group_port": In(16),
                "peers": Out(ReadSignature(peers.address_bits)),
                "own": Out(ReadSignature(own.address_bits)),
                "write": Out(WriteSignature(own.address_bits)),
                "template": Out(range(len(rom.words))),
                "start": Out(1),
                "done": In(1),
                "which": In(REGISTER_BITS),
                "register": Out(32),
                "subject": Out(SUBJECT),
                "room": In(1),
                "busy": In(1),
                "finish": Out(1),
                "ip": Out(32),
                "port": Out(16),
                "again": Out(1),
                **{
                    name: In(max(1, len(table)), init=(1 << max(1, len(table))) - 1)
                    for name, table in (("writers", own.writers), ("readers", own.readers))
                },
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        self._afterwards: list[str] = []
        self._after = Signal(4)
        # The writer whose number is `last`; and of its messages the one that is spoken of, and the oldest for who is served
        self._last, self._last_high = Signal(32), Signal(32)
        self._age, self._oldest = Signal(AGE), Signal(AGE)
        self._kept = Signal(16)
        self._padding = Signal(2)
        self._publishing, self._yield, self._asked = Signal(), Signal(), Signal()
        self._is_writer, self._reliable = Signal(), Signal()  # the peer's endpoint
        self._to_group = Signal()  # a message goes to the group now
        self._local = Signal(8)
        self._count = Signal(32)
        m.d.comb += self.subject.entity.eq(self._local + 1)
        self._increased = Signal(32)
        m.d.comb += self._increased.eq(self.own.data + 1)
        self._registers(m)
        # Asked for of peers: this word of the proxy that is served, or of its participant. In IDLE it is the job's, whose
        # turn comes next; in EACH READER that of an endpoint.
        self._word, self._of_participant = Signal(4), Signal()
        self._stepping, self._step = Signal(), Signal(range(self._peers.endpoints))
        idle, composing = Signal(), Signal()
        self._ask(m, idle, composing)
        with m.FSM() as fsm:
            m.d.comb += [idle.eq(fsm.ongoing("IDLE")), composing.eq(fsm.ongoing("COMPOSING"))]
            self._idle(m)
            self._announcements(m)
            self._who(m)
            self._writer(m)
            self._reader(m)
            if self._users:
                self._publish(m)
            with m.State("COMPOSE"), m.If(self.room & ~self.busy):
                m.d.comb += self.start.eq(1)
                m.next = "COMPOSING"
            with m.State("COMPOSING"):
                m.d.comb += self.finish.eq(self.done)
                with m.If(self.done), m.Switch(self._after):
                    for n, state in enumerate(self._afterwards):
                        with m.Case(n):
                            m.next = state
        return m

    # -- what states share

    def _ask(self, m: Module, idle: Value, composing: Value) -> None:
        """Of peers what is asked for; while the composer asks, nothing."""
        peers, subject, job = self._peers, self.subject, self.job
        slot = Mux(idle, job.index, subject.slot)
        endpoint = Mux(idle, job.index, Mux(self._stepping, self._step, subject.endpoint))
        with m.If(~composing):
            with m.If(self._of_participant):
                m.d.comb += self.peers.addr.eq(peers.participant(slot, self._word))
            with m.Elif(subject.builtin & ~idle):
                m.d.comb += self.peers.addr.eq(peers.builtin(slot, subject.kind, self._word))
            with m.Else():
                m.d.comb += self.peers.addr.eq(peers.endpoint(endpoint, self._word))

    def _registers(self, m: Module) -> None:
        """What templates refer to."""
        which, last = self.which, Cat(self._last, self._last_high)
        age = Signal(AGE)
        number = Signal(64)
        m.d.comb += [
            age.eq(Mux((which == Register.FIRST) | (which == Register.FIRST_HIGH), self._oldest, self._age)),
            number.eq(last - age),
        ]
        # Of the numbers from the one that is wanted on, the first in the highest bit
        missing = Cat(self._age >= n for n in reversed(range(self._window)))
        with m.Switch(which):
            for register, value in (
                (Register.FIRST, number[:32]),
                (Register.FIRST_HIGH, number[32:]),
                (Register.NUMBER, number[:32]),
                (Register.NUMBER_HIGH, number[32:]),
                (Register.LAST, self._last),
                (Register.LAST_HIGH, self._last_high),
                (Register.COUNT, self._count),
                (Register.BITMAP, Cat(C(0, 32 - self._window), missing)),
                (Register.ENCAPSULATION, Cat(C(CDR_LE, 24), self._padding)),
            ):
                with m.Case(register):
                    m.d.comb += self.register.eq(value)

    def _age_of(self, number: Value) -> Value:
        """How far a number is behind the last."""
        difference = self._difference(number)
        return Mux(difference[31], -1, Mux(difference[15:31].any(), MAX_AGE, difference[:15])).as_signed()

    def _difference(self, number: Value) -> Value:
        """The same, whose highest bit says that the number is yet to come."""
        return (self._last - number)[:32]

    def _compose(self, m: Module, template: Value | int, then: str) -> None:
        """Compose it for `ip` and `port`, when there is room, and go on."""
        if then not in self._afterwards:
            self._afterwards.append(then)
        m.d.sync += [self.template.eq(template), self._after.eq(self._afterwards.index(then))]
        m.next = "COMPOSE"

    def _write(self, m: Module, address: Value | int, value: Value) -> None:
        m.d.comb += [self.write.en.eq(1), self.write.addr.eq(address), self.write.data.eq(value)]

    def _by_kind(self, name: str) -> Value:
        """The template for our discovery writer, or reader, that is served, or for the user's."""
        start, subject = self._rom.start, self.subject
        of_builtin = Mux(subject.kind[0], start[f"subscription_{name}"], start[f"publication_{name}"])
        return Mux(subject.builtin, of_builtin, start[name])

    def _writer_word(self, word: int) -> Value:
        return self._own.writer(self._local, word)

    def _choose(self, values: Sequence[Value]) -> Value:
        """That of our endpoint."""
        return pick(list(values) or [C(0)], self._local[: max(0, (len(values) - 1).bit_length())])

    def _sample(self, number: Value) -> Value:
        """Where our writer keeps the message with this number."""
        return self._choose([self._own.sample(n, number) for n in range(len(self._own.writers))])

    # -- whose turn it is

    def _idle(self, m: Module) -> None:
        job, subject = self.job, self.subject
        pending = Cat(getattr(self, f"publish{n}").stream.valid for n in range(self._users))
        enabled = Cat(self.writers, self.readers)
        told = Signal(len(enabled), init=-1)  # as peers have been told
        with m.State("IDLE"):
            m.d.sync += [
                self._yield.eq(0),
                self._publishing.eq(0),
                self._asked.eq(job.asked),
                subject.builtin.eq(~job.user),
                subject.kind.eq(job.index),
                subject.slot.eq(Mux(job.greet, job.index, job.index[2:])),
                subject.endpoint.eq(job.index),
            ]
            with m.If(enabled != told):
                m.d.sync += [told.eq(enabled), subject.kind.eq(0)]
                m.next = "CHANGED"
            with m.Elif(self.valid & ~(pending.any() & ~self._yield)):
                m.d.comb += self.taken.eq(1)
                m.next = "LOOK"
                with m.If(job.announce):
                    m.next = "ANNOUNCE"
                with m.If(job.greet):
                    m.next = "GREET"
            if self._users:
                with m.Elif(pending.any()):
                    m.d.sync += [self._publishing.eq(1), subject.builtin.eq(0)]
                    if self._users > 1:
                        later = Cat(pending[n] & (self._local < n) for n in range(self._users))
                        m.d.sync += self._local.eq(Mux(later.any(), lowest(later), lowest(pending)))
                    else:
                        m.d.sync += self._local.eq(0)
                    m.next = "PUBLISH"
            m.d.comb += [
                self._of_participant.eq(job.greet),
                self._word.eq(Mux(job.greet, tables.META_IP, tables.INFO)),
            ]

        # All endpoints are told of again, by new numbers: of writers, then of readers.
        with m.State("CHANGED"):
            m.d.comb += self.own.addr.eq(self._first_word())
            m.next = "FIRST"
        with m.State("FIRST"):
            m.next = "NEW FIRST"
        with m.State("NEW FIRST"):
            many = Mux(subject.kind[0], len(self._own.readers), len(self._own.writers))
            self._write(m, self._first_word(), self.own.data + many)
            m.d.sync += subject.kind.eq(1)
            m.next = "CHANGED"
            with m.If(subject.kind[0]):
                m.d.comb += self.again.eq(1)
                m.next = "IDLE"

    def _first_word(self) -> Value:
        """Where the first number is that our discovery writer has."""
        own = self._own
        return Mux(self.subject.kind[0], own.own(tables.SUBSCRIPTIONS), own.own(tables.PUBLICATIONS))

    def _announcements(self, m: Module) -> None:
        with m.State("ANNOUNCE"):
            m.d.sync += [self.ip.eq(GROUP), self.port.eq(self.group_port)]
            m.next = "ANNOUNCEMENT"
        with m.State("GREET"):
            m.d.comb += [self._of_participant.eq(1), self._word.eq(tables.META_PORT)]
            m.next = "GREET IP"
        with m.State("GREET IP"):
            m.d.sync += self.ip.eq(self.peers.data)
            m.next = "GREET PORT"
        with m.State("GREET PORT"):
            m.d.sync += self.port.eq(self.peers.data)
            m.next = "ANNOUNCEMENT"
        with m.State("ANNOUNCEMENT"):  # it never changes, nor does its number
            m.d.sync += [self._last.eq(1), self._last_high.eq(0), self._age.eq(0)]
            self._compose(m, self._rom.start["participant"], "IDLE")

    # -- a proxy

    def _who(self, m: Module) -> None:
        subject = self.subject
        with m.State("LOOK"):
            m.next = "WHO"
        with m.State("WHO"):
            info = self.peers.data
            m.d.comb += [
                self._of_participant.eq(subject.builtin),
                self._word.eq(Mux(subject.builtin, tables.META_IP, tables.IP)),
            ]
            m.d.sync += [self._is_writer.eq(subject.kind[1]), self._reliable.eq(1)]
            with m.If(~subject.builtin):
                m.d.sync += [
                    self._is_writer.eq(info[tables.INFO_WRITER]),
                    self._reliable.eq(info[tables.INFO_RELIABLE]),
                    self._local.eq(info[tables.INFO_LOCAL : tables.INFO_LOCAL + 8]),
                    subject.slot.eq(info[tables.INFO_SLOT : tables.INFO_SLOT + 8]),
                ]
            m.next = "WHERE"
        with m.State("WHERE"):
            m.d.comb += [
                self._of_participant.eq(subject.builtin),
                self._word.eq(Mux(subject.builtin, tables.META_PORT, tables.PORT)),
            ]
            m.next = "IDLE"
            with m.If(self._is_writer & self._asked):
                m.next = "WRITER"
            with m.If(~self._is_writer & self._reliable):
                m.next = "READER"

    def _writer(self, m: Module) -> None:
        """A peer's writer: what it says its last is, and what we want."""
        own = self._own
        with m.State("WRITER"):
            m.d.sync += self.ip.eq(self.peers.data)
            m.d.comb += self._word.eq(tables.LAST)
            m.next = "WRITER PORT"
        with m.State("WRITER PORT"):
            m.d.sync += self.port.eq(self.peers.data)
            m.d.comb += self._word.eq(tables.NEXT_LO)
            m.next = "WANTED"
        with m.State("WANTED"):
            m.d.sync += self._last.eq(self.peers.data)
            m.d.comb += self.own.addr.eq(own.own(tables.ACKNACK_COUNT))
            m.next = "MISSING"
        with m.State("MISSING"):
            m.d.sync += self._age.eq(self._age_of(self.peers.data))
            m.next = "ACKNACK"
            with m.If(self.peers.data == 0):
                m.next = "IDLE"  # nothing has been heard of it
        with m.State("ACKNACK"):
            m.d.sync += self._count.eq(self._increased)
            self._write(m, own.own(tables.ACKNACK_COUNT), self._increased)
            self._compose(m, self._by_kind("acknack"), "IDLE")

    def _reader(self, m: Module) -> None:
        """A peer's reader: what we have, and what it has and asks for."""
        own, subject = self._own, self.subject
        ask_to = Signal(AGE)
        start, unacknowledged, lost = Signal(AGE), Signal(), Signal()
        over = Signal()  # nothing more is asked for
        kinds = len(own.writers) - 1, len(own.readers) - 1  # ages of the oldest that discovery has to say
        with m.State("READER"):
            m.d.sync += self.ip.eq(self.peers.data)
            m.d.comb += self.own.addr.eq(
                Mux(subject.builtin, self._first_word(), self._writer_word(tables.WRITER_LAST))
            )
            m.next = "READER PORT"
        with m.State("READER PORT"):
            m.d.sync += self.port.eq(self.peers.data)
            m.d.comb += self.own.addr.eq(self._writer_word(tables.WRITER_LAST_HI))
            m.d.comb += self._word.eq(tables.START)
            m.next = "LAST"
        with m.State("LAST"):
            most = Mux(subject.kind[0], C(kinds[1], AGE), C(kinds[0], AGE))
            m.d.sync += [
                self._oldest.eq(most),
                self._last.eq(self.own.data + Mux(subject.builtin, most, 0)),
            ]
            m.d.comb += self.own.addr.eq(self._writer_word(tables.WRITER_COUNT))
            m.d.comb += self._word.eq(tables.ACKED)
            m.next = "START"
        with m.State("START"):
            age = self._age_of(self.peers.data)
            m.d.sync += [start.eq(Mux(subject.builtin, MAX_AGE, age)), self._last_high.eq(self.own.data)]
            with m.If(subject.builtin):
                m.d.sync += self._last_high.eq(0)
            m.d.comb += self._word.eq(tables.ASK_FROM)
            m.next = "ACKED"
        with m.State("ACKED"):
            m.d.sync += [
                unacknowledged.eq(~self._difference(self.peers.data)[31]),
                self._kept.eq(self.own.data),
            ]
            with m.If(~subject.builtin):
                m.d.sync += self._oldest.eq((self.own.data - 1)[:16].as_signed())
            m.d.comb += self._word.eq(tables.ASK_TO)
            m.next = "ASK FROM"
        with m.State("ASK FROM"):
            m.d.sync += self._age.eq(self._age_of(self.peers.data))
            with m.If(start < self._oldest):
                m.d.sync += self._oldest.eq(start)
            m.next = "ASK TO"
        with m.State("ASK TO"):
            age = self._age_of(self.peers.data)
            m.d.sync += ask_to.eq(Mux(age[-1], 0, age))
            m.next = "JUDGE"
        with m.State("JUDGE"):
            m.next = "IDLE"
            m.d.sync += lost.eq((self._age > self._oldest) & (self._age < start) & (self._age >= ask_to))
            with m.If(self._asked):
                m.next = "LOST"
            with m.Elif(unacknowledged):
                m.next = "HEARTBEAT"
        with m.State("LOST"):
            m.next = "RESEND"
            with m.If(lost & ~subject.builtin):
                self._compose(m, self._rom.start["gap"], "RESEND")
        with m.State("RESEND"):
            with m.If(self._age > self._oldest):
                m.d.sync += self._age.eq(self._oldest)
            m.next = "AGED"
        with m.State("AGED"):
            m.d.sync += [
                over.eq(self._age < ask_to),
                subject.sample.eq(self._sample((self._last - self._age)[:16])),
            ]
            with m.If(subject.builtin):
                m.d.sync += self._local.eq(self._oldest - self._age)
            m.next = "AGAIN"
        with m.State("AGAIN"):
            m.d.comb += self.own.addr.eq(subject.sample)
            m.next = "KEPT SAMPLE"
            with m.If(subject.builtin):
                m.next = "DISCOVERY"
            with m.If(over):
                m.next = "HEARTBEAT"
        with m.State("DISCOVERY"):
            starts = [
                self._choose([C(self._rom.start[f"{name}{n}"]) for n in range(len(table))])
                for name, table in (("publication", own.writers), ("subscription", own.readers))
            ]
            told = [
                Mux(
                    bits.bit_select(self._local[: len(bits).bit_length()], 1),
                    start,
                    self._rom.start[f"{name}_gone"],
                )
                for bits, start, name in (
                    (self.writers, starts[0], "publication"),
                    (self.readers, starts[1], "subscription"),
                )
            ]
            self._compose(m, Mux(subject.kind[0], told[1], told[0]), "NEXT")
        with m.State("KEPT SAMPLE"):
            m.next = "SAMPLE"
        with m.State("SAMPLE"):
            m.d.sync += [subject.words.eq(self.own.data[:16]), self._padding.eq(self.own.data[16:18])]
            self._compose(m, self._rom.start["message"], "NEXT")
        with m.State("NEXT"):
            m.d.sync += self._age.eq(self._age - 1)
            m.next = "AGED"
        with m.State("HEARTBEAT"):
            m.d.comb += self.own.addr.eq(own.own(tables.HEARTBEAT_COUNT))
            m.next = "HEARTBEATS"
        with m.State("HEARTBEATS"):
            m.next = "COUNT"
        with m.State("COUNT"):
            m.d.sync += self._count.eq(self._increased)
            self._write(m, own.own(tables.HEARTBEAT_COUNT), self._increased)
            self._compose(m, self._by_kind("heartbeat"), "IDLE")
            if self._users:
                with m.If(self._publishing):
                    start = self._rom.start
                    template = Mux(
                        self._to_group, start["group_message_heartbeat"], start["message_heartbeat"]
                    )
                    self._compose(m, template, "NEXT READER")

    # -- a message of the user's

    def _publish(self, m: Module) -> None:
        own, peers, subject = self._own, self._peers, self.subject
        endpoint = subject.endpoint
        streams = [getattr(self, f"publish{n}").stream for n in range(self._users)]
        item = Signal.like(streams[0].payload)
        valid = Signal()
        m.d.comb += [
            item.eq(Array(Value.cast(one.payload) for one in streams)[self._local]),
            valid.eq(Array(one.valid for one in streams)[self._local]),
        ]
        words, long, full = subject.words, Signal(), Signal()
        most = self._choose([C(one.words, 16) for one in own.writers])
        latency = READ_LATENCY + 1  # until it is known whether it is one
        step = Signal(range(peers.endpoints + latency + 1))
        addressed, given_of, shown = (Signal(range(peers.endpoints)) for _ in range(3))
        reads = Signal(range(latency + 1))  # under way
        ours = Signal()
        start = Signal(AGE)
        # Of this message's readers one, several are in the group; of each writer's last one there were several.
        in_group, one_there, several_there = Signal(), Signal(), Signal()
        grouped = Signal()  # it has gone to the group
        several = Signal(self._users)
        its = self._local[: (self._users - 1).bit_length()]
        with m.State("PUBLISH"):
            m.d.comb += self.own.addr.eq(self._writer_word(tables.WRITER_LAST))
            m.d.sync += [grouped.eq(0), one_there.eq(0), several_there.eq(0)]
            m.d.sync += [words.eq(0), long.eq(0), self._age.eq(0), endpoint.eq(0)]
            m.next = "NUMBERED"
        with m.State("NUMBERED"):
            m.d.comb += self.own.addr.eq(self._writer_word(tables.WRITER_LAST_HI))
            m.next = "NUMBER"
        with m.State("NUMBER"):
            m.d.sync += self._last.eq(self._increased)
            m.d.comb += self.own.addr.eq(self._writer_word(tables.WRITER_COUNT))
            m.next = "NUMBER HIGH"
        with m.State("NUMBER HIGH"):
            m.d.sync += self._last_high.eq(Mux(self._last == 0, self._increased, self.own.data))
            m.d.sync += subject.sample.eq(self._sample(self._last))
            m.next = "KEPT"
        with m.State("KEPT"):
            all_kept = self.own.data[:16] == self._choose([C(one.depth, 16) for one in own.writers])
            m.d.sync += [self._kept.eq(Mux(all_kept, self.own.data, self._increased)), full.eq(most == 0)]
            m.next = "KEEP"
        with m.State("KEEP"):
            for n, one in enumerate(streams):
                with m.If(self._local == n):
                    m.d.comb += one.ready.eq(1)
            with m.If(valid & ~item.end):
                with m.If(full):
                    m.d.sync += long.eq(1)
                with m.Else():
                    m.d.sync += [words.eq(words + 1), full.eq((words + 1)[:16] == most)]
                    self._write(m, subject.sample | (words + 1), item.data)
            with m.If(valid & item.end):
                m.d.sync += self._padding.eq(item.padding)
                m.next = "SIZE"
                with m.If(item.bad | long):
                    for n in range(self._users):
                        m.d.comb += getattr(self, f"drop_long{n}").eq((self._local == n) & ~item.bad)
                    m.d.sync += self._yield.eq(1)
                    m.next = "IDLE"
        with m.State("SIZE"):
            self._write(m, subject.sample, Cat(words, self._padding))
            m.next = "STORE"
        with m.State("STORE"):
            self._write(m, self._writer_word(tables.WRITER_LAST), self._last)
            m.next = "STORE HIGH"
        with m.State("STORE HIGH"):
            self._write(m, self._writer_word(tables.WRITER_LAST_HI), self._last_high)
            m.next = "STORE KEPT"
        with m.State("STORE KEPT"):
            self._write(m, self._writer_word(tables.WRITER_COUNT), self._kept)
            m.d.sync += [step.eq(0), reads.eq(0)]
            m.next = "EACH READER"
        with m.State("EACH READER"):  # an endpoint a cycle
            info = self.peers.data
            is_reader = self.matched.bit_select(given_of, 1) & ~info[tables.INFO_WRITER]
            m.d.comb += [self._stepping.eq(1), self._step.eq(step), self._word.eq(tables.INFO)]
            m.d.sync += [
                step.eq(step + 1),
                addressed.eq(step),
                given_of.eq(addressed),
                shown.eq(given_of),
                endpoint.eq(shown),
                ours.eq(is_reader & (info[tables.INFO_LOCAL : tables.INFO_LOCAL + 8] == self._local)),
                self._oldest.eq((self._kept - 1)[:16].as_signed()),
            ]
            with m.If((reads == latency) & ours):
                m.next = "THE READER"
            with m.Else():
                m.d.sync += [
                    subject.slot.eq(info[tables.INFO_SLOT : tables.INFO_SLOT + 8]),
                    self._reliable.eq(info[tables.INFO_RELIABLE]),
                ]
            with m.If(reads != latency):
                m.d.sync += reads.eq(reads + 1)
            with m.Elif(~ours & (shown == peers.endpoints - 1)):
                m.next = "PUBLISHED"
        with m.State("THE READER"):
            m.d.comb += self._word.eq(tables.IP)
            m.next = "READER IP"
        with m.State("READER IP"):
            m.d.comb += self._word.eq(tables.PORT)
            m.next = "READER WHERE"
        with m.State("READER WHERE"):
            m.d.sync += self.ip.eq(self.peers.data)
            m.d.comb += self._word.eq(tables.START)
            m.next = "READER'S PORT"
        with m.State("READER'S PORT"):
            m.d.sync += [self.port.eq(self.peers.data), in_group.eq(self.peers.data[tables.PORT_GROUP])]
            m.next = "READER START"
        with m.State("READER START"):
            m.d.sync += start.eq(self._age_of(self.peers.data))
            m.next = "READER OLDEST"
        with m.State("READER OLDEST"):
            with m.If(self._reliable):
                m.next = "HEARTBEAT"
            with m.Else():
                self._compose(m, self._rom.start["message"], "NEXT READER")
            with m.If(start < self._oldest):
                m.d.sync += self._oldest.eq(start)
            with m.Elif(in_group):  # what is kept is the same for all of these
                m.d.sync += [one_there.eq(1), several_there.eq(one_there)]
                with m.If(grouped):
                    m.next = "NEXT READER"
                with m.Elif(several.bit_select(its, 1)):
                    m.d.sync += [
                        self._to_group.eq(1),
                        grouped.eq(1),
                        self.ip.eq(GROUP),
                        self.port.eq(self.group_port + USER_GROUP_PORT),
                    ]
                    with m.If(self._choose([C(one.reliable, 1) for one in own.writers])):
                        m.next = "HEARTBEAT"
                    with m.Else():
                        self._compose(m, self._rom.start["group_message"], "NEXT READER")
        with m.State("NEXT READER"):
            m.d.sync += [step.eq(endpoint + 1), reads.eq(0), self._to_group.eq(0)]
            m.next = "EACH READER"
            with m.If(endpoint == peers.endpoints - 1):
                m.next = "PUBLISHED"
        with m.State("PUBLISHED"):
            m.d.sync += [several.bit_select(its, 1).eq(several_there), self._yield.eq(1)]
            m.next = "IDLE"
