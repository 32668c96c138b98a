"""What the states of the sender share: whom they serve, the ages of messages, and the ways to composer and memory."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from amaranth.hdl import C, Module, Mux, Signal, Value

from roslet.gateware.octets import pick
from roslet.gateware.rtps import tables
from roslet.gateware.rtps.composer import age_shape, writer_word
from roslet.gateware.rtps.rom import AFTERWARDS, DO, PUBLISHING, Rom
from roslet.gateware.rtps.tables import OwnMap, PeerMap


class Sending:
    """Of the sender `sender`, whose ports it drives.

    Numbers are known by their age, how far they are behind `last`, the writer's last: 0, it is the last; -1, the next; what
    is older than anything kept has the greatest age there is. `subject.age` and `oldest`: of the message that is spoken of,
    and of the oldest for who is served.
    """

    def __init__(self, m: Module, sender: Any, rom: Rom, peers: PeerMap, own: OwnMap, window: int) -> None:
        self.rom, self.peers, self.own = rom, peers, own
        self.ports, self.subject = sender, sender.subject
        self.age_shape = age_shape(own, window)
        self.publishing = Signal()  # a message of the user's
        # What is known of a proxy: it is a writer, or one for our writer, and reliable; it is in the group; something has
        # been heard of it. Of a reader: where it begins, what it asks for, and whether it lacks something.
        self.is_writer, self.is_ours, self.reliable = Signal(), Signal(), Signal()
        self.in_group, self.heard, self.unacknowledged = Signal(), Signal(), Signal()
        self.start, self.ask_to = Signal(self.age_shape), Signal(self.age_shape)
        self.last = Signal(32)
        # Of the message it is known where it belongs; all that is looked at before it
        self.placed, self.counted = Signal(), Signal()
        self._take(m)

    def _take(self, m: Module) -> None:
        """What the templates look at."""
        ports, subject, do, word = self.ports, self.subject, self.ports.do, self.ports.word
        # By how much what was looked at a cycle before is behind the last: the highest bit is borrowed from the words above,
        # the next says that it is yet to come.
        behind, later = Signal(33), Signal(DO)
        m.d.sync += [behind.eq(self.last - word), later.eq(do)]
        with m.If(do.store):
            m.d.comb += [ports.write.en.eq(1), ports.write.addr.eq(writer_word(self.own, subject, do.word))]
        m.d.comb += ports.write.data.eq(word)
        with m.If(do.last):
            m.d.sync += self.last.eq(word)
        with m.If(do.oldest):
            m.d.sync += subject.oldest.eq(word)
        local = word[tables.INFO_LOCAL : tables.INFO_LOCAL + 8]
        with m.If(do.info):
            m.d.sync += [
                self.is_writer.eq(word[tables.INFO_WRITER]),
                self.reliable.eq(word[tables.INFO_RELIABLE]),
                self.is_ours.eq(local == subject.local),
                subject.slot.eq(word[tables.INFO_SLOT : tables.INFO_SLOT + 8]),
            ]
            with m.If(~self.publishing):
                m.d.sync += subject.local.eq(local)
        with m.If(do.port):
            m.d.sync += self.in_group.eq(word[tables.PORT_GROUP])
        with m.If(ports.done):
            m.d.sync += self.counted.eq(1)
        with m.If(do.place):
            m.d.sync += self.placed.eq(1)
            m.d.sync += subject.sample.eq(self.sample(word))
        with m.If(do.size):
            m.d.sync += [subject.words.eq(word), subject.padding.eq(word[16:18])]
        with m.If(do.ask_from):
            m.d.sync += self.heard.eq(word != 0)
        age = self._age(behind)
        with m.If(later.start):
            m.d.sync += self.start.eq(age)
        with m.If(later.acked):
            m.d.sync += self.unacknowledged.eq(~behind[31])
        with m.If(later.ask_from):
            m.d.sync += [subject.age.eq(age), ports.borrow.eq(behind[32])]
        with m.If(later.ask_to):
            m.d.sync += self.ask_to.eq(Mux(age[-1], 0, age))

    def _age(self, behind: Value) -> Value:
        bits = self.age_shape.width - 1
        older = Mux(behind[bits:31].any(), (1 << bits) - 1, behind[:bits])
        return Mux(behind[31], C(-1, bits + 1), older).as_signed()

    def sample(self, number: Value) -> Value:
        """Where our writer keeps the message with this number."""
        return self.choose([self.own.sample(n, number) for n in range(len(self.own.writers))] or [C(0)])

    # -- what states do

    def choose(self, values: Sequence[Value]) -> Value:
        """That of our endpoint."""
        return pick(list(values), self.subject.local[: max(0, (len(values) - 1).bit_length())])

    def by_kind(self, name: str) -> Value:
        """The template for our discovery writer, or reader, that is served, or for the user's."""
        start, subject = self.rom.start, self.subject
        of_builtin = Mux(subject.kind[0], start[f"subscription_{name}"], start[f"publication_{name}"])
        return Mux(subject.builtin, of_builtin, start[name])

    def compose(self, m: Module, template: Value | int) -> None:
        """Compose it when there is room, and go on where its end says."""
        self._begin(m, template, self.ports.room)

    def run(self, m: Module, template: Value | int) -> None:
        """Do at once what that template says, which is not of a datagram, and go on where its end says."""
        self._begin(m, template, C(1, 1))

    def _begin(self, m: Module, template: Value | int, now: Value) -> None:
        m.d.comb += [self.ports.template.eq(template), self.ports.load.eq(1), self.ports.go.eq(now)]
        m.next = "COMPOSING"
        with m.If(~now):
            m.next = "COMPOSE"

    def composition(self, m: Module, publishes: bool) -> None:
        """The states in which that happens: the last of an FSM, which has those of `publish` if it `publishes`."""
        ports = self.ports
        with m.State("COMPOSE"), m.If(ports.room):
            m.d.comb += ports.go.eq(1)
            m.next = "COMPOSING"
        with m.State("COMPOSING"), m.If(ports.done), m.Switch(ports.do.then):
            for n, state in enumerate(AFTERWARDS if publishes else AFTERWARDS[:PUBLISHING]):
                with m.Case(n):
                    m.next = state
