"""What is sent, when, and to whom. RTPS 2.3, 8.4 (behaviour of writers and readers), 8.5.3.2 (announcements)."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.rtps.composer import WINDOW, subject_layout
from roslet.gateware.rtps.ports import WriteSignature
from roslet.gateware.rtps.publishing import publish
from roslet.gateware.rtps.repeating import repeat
from roslet.gateware.rtps.rom import ALIGNMENT, DO, Rom
from roslet.gateware.rtps.scan import lowest
from roslet.gateware.rtps.sending import Sending
from roslet.gateware.rtps.tables import OwnMap, PeerMap
from roslet.gateware.rtps.turns import JOB
from roslet.gateware.words import MessageSignature


class Sender(wiring.Component):
    """Serves who is next.

    Ports: `publish0` .. for each writer of the user, the first `users` of the tables' writers: its messages. `job`, `valid`,
    `taken`, of `Turns`; `matched`, the user proxies that there are; `write`, whose data mean nothing while `en` is
    low; `template`, `load`, `go`, `done`, `word`, `do`, `borrow`, `subject`, of the composer; `room`, of the outbox;
    `writers`, `readers`, a bit for each of ours that is enabled; `again`, high for a cycle when every proxy must be served
    once.

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

    def __init__(self, rom: Rom, peers: PeerMap, own: OwnMap, users: int, window: int = WINDOW) -> None:
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
                "write": Out(WriteSignature(own.address_bits)),
                "template": Out(range(-(-len(rom.words) // ALIGNMENT))),
                "load": Out(1),
                "go": Out(1),
                "done": In(1),
                "word": In(32),
                "do": In(DO),
                "borrow": Out(1),
                "subject": Out(subject_layout(peers, own, window)),
                "room": In(1),
                "again": Out(1),
                **{
                    name: In(max(1, len(table)), init=(1 << max(1, len(table))) - 1)
                    for name, table in (("writers", own.writers), ("readers", own.readers))
                },
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        work = Sending(m, self, self._rom, self._peers, self._own, self._window)
        self._yield, self._asked = Signal(), Signal()
        with m.FSM():
            self._idle(m, work)
            self._who(m, work)
            published = "NEXT READER" if self._users else "IDLE"
            repeat(m, work, self._asked, self.writers, self.readers, published)
            if self._users:
                streams = [getattr(self, f"publish{n}").stream for n in range(self._users)]
                long = [getattr(self, f"drop_long{n}") for n in range(self._users)]
                publish(m, work, streams, long, self.matched, self._yield)
            work.composition(m, bool(self._users))
        return m

    def _idle(self, m: Module, work: Sending) -> None:
        """Whose turn it is."""
        job, subject = self.job, self.subject
        pending = Cat(getattr(self, f"publish{n}").stream.valid for n in range(self._users))
        enabled = Cat(self.writers, self.readers)
        told = Signal(len(enabled), init=-1)  # as peers have been told
        with m.State("IDLE"):
            m.d.sync += [
                self._yield.eq(0),
                work.publishing.eq(0),
                self._asked.eq(job.asked),
                subject.builtin.eq(~job.user),
                subject.kind.eq(job.index),
                subject.slot.eq(Mux(job.greet, job.index, job.index[2:])),
                subject.endpoint.eq(job.index),
                work.is_writer.eq(job.index[1]),
                work.reliable.eq(1),
            ]
            with m.If(enabled != told):
                m.d.sync += [told.eq(enabled), subject.builtin.eq(1), subject.kind.eq(0)]
                m.next = "CHANGED"
            with m.Elif(self.valid & ~(pending.any() & ~self._yield)):
                m.d.comb += self.taken.eq(1)
                m.next = "WHO"
                with m.If(job.user):
                    work.run(m, work.rom.start["who"])
                with m.If(job.announce):
                    work.compose(m, self._rom.start["participant"])
                with m.If(job.greet):
                    work.compose(m, self._rom.start["greeting"])
            if self._users:
                with m.Elif(pending.any()):
                    m.d.sync += [work.publishing.eq(1), subject.builtin.eq(0), subject.endpoint.eq(0)]
                    if self._users > 1:
                        later = Cat(pending[n] & (subject.local < n) for n in range(self._users))
                        m.d.sync += subject.local.eq(Mux(later.any(), lowest(later), lowest(pending)))
                    else:
                        m.d.sync += subject.local.eq(0)
                    m.next = "PUBLISH"

        # All endpoints are told of again, by new numbers: of writers, then of readers.
        with m.State("CHANGED"):
            m.d.sync += subject.age.eq(Mux(subject.kind[0], -len(self._own.readers), -len(self._own.writers)))
            work.run(m, work.rom.start["changed"])
        with m.State("TOLD"):
            m.d.sync += subject.kind.eq(1)
            m.next = "CHANGED"
            with m.If(subject.kind[0]):
                m.d.comb += self.again.eq(1)
                m.next = "IDLE"

    def _who(self, m: Module, work: Sending) -> None:
        """A proxy: what it is, and of a peer's writer what it says its last is, and what we want."""
        with m.State("WHO"):
            m.next = "IDLE"
            with m.If(work.is_writer & self._asked):
                work.run(m, work.rom.start["wanted"])
            with m.If(~work.is_writer & work.reliable):
                work.run(m, work.rom.start["asked"])
        with m.State("WRITER"):
            m.next = "IDLE"
            with m.If(work.heard):
                work.compose(m, work.by_kind("acknack"))
