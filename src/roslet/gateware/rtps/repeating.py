"""What a peer's reliable reader gets: what it asks for again, and heartbeats. RTPS 2.3, 8.4.9, 8.3.7.5."""

from __future__ import annotations

from amaranth.hdl import C, Module, Mux, Value

from roslet.gateware.rtps.sending import Sending


def repeat(m: Module, work: Sending, asked: Value, writers: Value, readers: Value, published: str) -> None:
    """The states from READER on, in which it is known what we have, and what it has and asks for. `asked`: it has said so
    now; `writers`, `readers`, those of ours that are enabled. State `published` comes after a message that is new.
    """
    subject, start_of = work.subject, work.rom.start
    age, oldest = subject.age, subject.oldest
    with m.State("READER"):
        with m.If(work.start < oldest):
            m.d.sync += oldest.eq(work.start)
        m.next = "JUDGE"
    with m.State("JUDGE"):
        m.next = "IDLE"
        with m.If(asked):
            m.next = "REPEAT"
            with m.If((age > oldest) & (age >= work.ask_to) & ~subject.builtin):
                work.compose(m, start_of["gap"])
        with m.Elif(work.unacknowledged):
            m.next = "HEARTBEAT"
    with m.State("REPEAT"):
        with m.If(age > oldest):
            m.d.sync += age.eq(oldest)
        m.next = "AGAIN"
    with m.State("AGAIN"):
        with m.If(age < work.ask_to):  # nothing more is asked for
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
            m.d.sync += age.eq(age - 1)
            m.next = "AGAIN"
    with m.State("HEARTBEAT"):
        work.compose(m, work.by_kind("heartbeat"))
