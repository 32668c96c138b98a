"""What a peer's reliable reader gets: what it asks for again, and heartbeats. RTPS 2.3, 8.4.9, 8.3.7.5."""

from __future__ import annotations

from amaranth.hdl import C, Module, Mux, Signal, Value

from roslet.gateware.rtps.sending import Sending


def repeat(m: Module, work: Sending, asked: Value, writers: Value, readers: Value, published: str) -> None:
    """The states from READER on, in which it is known what we have, and what it has and asks for. `asked`: it has said so
    now; `writers`, `readers`, those of ours that are enabled. State `published` comes after a message that is new.
    """
    subject, start_of = work.subject, work.rom.start
    age, oldest = subject.age, subject.oldest
    # Ages are compared a cycle before they are looked at; when one has changed they are not `settled` in the next.
    lost, beyond, settled = Signal(), Signal(), Signal()
    m.d.sync += [lost.eq(age > oldest), beyond.eq(age < work.ask_to), settled.eq(1)]
    with m.State("READER"):
        m.d.sync += settled.eq(0)
        with m.If(work.start < oldest):
            m.d.sync += oldest.eq(work.start)
        m.next = "JUDGE"
    with m.State("JUDGE"), m.If(settled):
        m.next = "IDLE"
        with m.If(asked):
            m.next = "REPEAT"
            with m.If(lost & ~beyond & ~subject.builtin):
                work.compose(m, start_of["gap"])
        with m.Elif(work.unacknowledged):
            m.next = "HEARTBEAT"
    with m.State("REPEAT"):
        m.d.sync += settled.eq(0)
        with m.If(lost):
            m.d.sync += age.eq(oldest)
        m.next = "AGAIN"
    with m.State("AGAIN"), m.If(settled):
        with m.If(beyond):  # nothing more is asked for
            m.next = "HEARTBEAT"
        with m.Elif(subject.builtin):
            m.d.sync += subject.local.eq(oldest - age)
            m.next = "DISCOVERY"
        with m.Else():
            work.compose(m, start_of["message"])
    with m.State("DISCOVERY"):
        told = []
        for bits, name, table in (
            (writers, "publication", work.own.writers),
            (readers, "subscription", work.own.readers),
        ):
            there = bits.bit_select(subject.local[: len(bits).bit_length()], 1)
            one = work.choose([C(start_of[f"{name}{n}"]) for n in range(len(table))] or [C(0)])
            told.append(Mux(there, one, start_of[f"{name}_gone"]))
        work.compose(m, Mux(subject.kind[0], told[1], told[0]))
    with m.State("NEXT"):
        m.next = published
        with m.If(~work.publishing):
            m.d.sync += [age.eq(age - 1), settled.eq(0)]
            m.next = "AGAIN"
    with m.State("HEARTBEAT"):
        work.compose(m, work.by_kind("heartbeat"))
