"""What the states of the sender share: whom they serve, the numbers of messages, and the ways to memories and composer."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from amaranth.hdl import Cat, Module, Mux, Signal, Value, signed

from roslet.gateware.octets import pick
from roslet.gateware.rtps.parameters import GROUP
from roslet.gateware.rtps.rom import Register, Rom
from roslet.gateware.rtps.tables import OwnMap, PeerMap

NUMBERS, COMPOSE = "NUMBERS", "COMPOSE"
"""The state before a template with numbers is composed, and that before one whose NUMBER_HIGH is known."""


class Sending:
    """Of the sender `sender`, whose ports it drives.

    Numbers are known by their age, how far they are behind `last`, the writer's last: 0, it is the last; -1, the next; all
    that are older than anything kept are `max_age` old. `age` and `oldest`: of the message that is spoken of, and of the
    oldest for who is served.
    """

    def __init__(self, m: Module, sender: Any, rom: Rom, peers: PeerMap, own: OwnMap, window: int) -> None:
        self.rom, self.peers, self.own = rom, peers, own
        self.ports, self.subject = sender, sender.subject
        told = len(own.writers), len(own.readers)
        bits = max(window, *told, *(writer.depth for writer in own.writers)).bit_length()
        self.age_shape, self.max_age = signed(bits + 1), (1 << bits) - 1
        self.last, self.last_high = Signal(32), Signal(32)
        self.age, self.oldest = Signal(self.age_shape), Signal(self.age_shape)
        self.reliable = Signal()  # the peer's endpoint
        self.publishing, self.to_group = Signal(), Signal()  # a message of the user's; to the group now
        self._afterwards: list[str] = []
        self._after = Signal(4)

        # What the memories are looked at for, unless the composer looks: a word of the proxy that is served, or of
        # its participant; one of our writer, or of its message.
        self.chosen, self._composing = Signal(2), Signal()
        self.word, self.of_participant = Signal(4), Signal()
        self.own_word, self.of_sample = Signal(2), Signal()
        with m.If(~self._composing):
            with m.If(self.of_participant):
                m.d.comb += sender.peers.addr.eq(peers.participant(self.subject.slot, self.word))
            with m.Elif(self.subject.builtin):
                builtin = peers.builtin(self.subject.slot, self.subject.kind, self.word)
                m.d.comb += sender.peers.addr.eq(builtin)
            with m.Else():
                m.d.comb += sender.peers.addr.eq(peers.endpoint(self.subject.endpoint, self.word))
            with m.If(self.of_sample):
                m.d.comb += sender.own.addr.eq(self.subject.sample)
            with m.Else():
                m.d.comb += sender.own.addr.eq(self._writer_word(self.own_word))

        # What our own memory gives, and more
        self.increment, self.sum = Signal(8, init=1), Signal(33)
        m.d.comb += [self.sum.eq(sender.own.data + self.increment), sender.write.data.eq(self.sum)]
        # Where it goes: to whom what peers gave belongs, or to the group of all
        self.take_ip, self.take_port, self.to_all, self.group_port = Signal(), Signal(), Signal(), Signal(16)
        with m.If(self.take_ip):
            m.d.sync += sender.ip.eq(sender.peers.data)
        with m.If(self.take_port):
            m.d.sync += sender.port.eq(sender.peers.data)
        with m.If(self.to_all):
            m.d.sync += [sender.ip.eq(GROUP), sender.port.eq(self.group_port)]
        # By how much what they gave a cycle before is behind the last: the highest bit is borrowed from the words above, the
        # next says that it is yet to come.
        self.behind = Signal(33)
        m.d.sync += self.behind.eq(self.last - sender.peers.data)
        self._numbers(m)
        m.d.comb += self.subject.missing.eq(
            Cat(self.age >= n for n in reversed(range(window))) << 32 - window
        )

    def _numbers(self, m: Module) -> None:
        """`number`, which the composer asks for, or, while that is idle, `chosen` says: its lower word, or the higher one,
        which needs to know what was borrowed from it, or carried, for the lower."""
        which = Signal(2)
        high, is_number = which[0], which[1]
        self.borrowed, first_borrowed = Signal(signed(2)), Signal(signed(2))
        self._first_borrowed = first_borrowed
        age = Mux(is_number, self.age, self.oldest)
        less = Mux(is_number, self.borrowed, first_borrowed)
        difference = Signal(signed(34))
        m.d.comb += [
            which.eq(Mux(self._composing, self.ports.which, self.chosen)),
            difference.eq(Mux(high, self.last_high, self.last) - Mux(high, less, age)),
            self.ports.register.eq(difference),
        ]
        self.number = difference[:32]
        self._borrow = (-difference[32:34].as_signed())[:2].as_signed()

    def age_of_given(self) -> Value:
        """The age of the number whose lower word peers gave a cycle before."""
        bits, behind = len(self.age) - 1, self.behind
        older = Mux(behind[bits:31].any(), self.max_age, behind[:bits])
        return Mux(behind[31], -1, older).as_signed()

    # -- what states do

    def ask(self, m: Module, word: int | Value, of_participant: Value | int = 0) -> None:
        """For a word of the proxy that is served, or of its participant."""
        m.d.comb += [self.word.eq(word), self.of_participant.eq(of_participant)]

    def ask_own(self, m: Module, word: int) -> None:
        """For a word of our writer."""
        m.d.comb += self.own_word.eq(word)

    def store(self, m: Module, word: int) -> None:
        """`sum`, as a word of our writer."""
        m.d.comb += [self.ports.write.en.eq(1), self.ports.write.addr.eq(self._writer_word(word))]

    def _writer_word(self, word: int | Value) -> Value:
        subject = self.subject
        return self.own.writer(Mux(subject.builtin, subject.kind[0], subject.local), word, subject.builtin)

    def choose(self, values: Sequence[Value]) -> Value:
        """That of our endpoint."""
        return pick(list(values), self.subject.local[: max(0, (len(values) - 1).bit_length())])

    def sample(self, number: Value) -> Value:
        """Where our writer keeps the message with this number."""
        return self.choose([self.own.sample(n, number) for n in range(len(self.own.writers))])

    def by_kind(self, name: str) -> Value:
        """The template for our discovery writer, or reader, that is served, or for the user's."""
        start, subject = self.rom.start, self.subject
        of_builtin = Mux(subject.kind[0], start[f"subscription_{name}"], start[f"publication_{name}"])
        return Mux(subject.builtin, of_builtin, start[name])

    def compose(self, m: Module, template: Value | int, then: str, first: str = NUMBERS) -> None:
        """Compose it for `ip` and `port`, when there is room, and go on; in state `first` first."""
        if then not in self._afterwards:
            self._afterwards.append(then)
        m.d.sync += [
            self.ports.template.eq(template),
            self._after.eq(self._afterwards.index(then)),
            self.chosen.eq(Register.NUMBER if first == NUMBERS else Register.FIRST),
        ]
        m.next = first

    def composition(self, m: Module) -> None:
        """The states in which that happens: the last of an FSM."""
        ports = self.ports
        with m.State(NUMBERS):
            m.d.sync += [self.borrowed.eq(self._borrow), self.chosen.eq(Register.FIRST)]
            m.next = COMPOSE
        with m.State(COMPOSE):
            m.d.sync += self._first_borrowed.eq(self._borrow)
            with m.If(ports.room & ~ports.busy):
                m.d.comb += ports.start.eq(1)
                m.d.sync += self._composing.eq(1)
                m.next = "COMPOSING"
        with m.State("COMPOSING"):
            m.d.comb += ports.finish.eq(ports.done)
            with m.If(ports.done):
                m.d.sync += self._composing.eq(0)
                with m.Switch(self._after):
                    for n, state in enumerate(self._afterwards):
                        with m.Case(n):
                            m.next = state
