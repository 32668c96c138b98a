"""What a peer's reliable reader gets: what it asks for again, and heartbeats. RTPS 2.3, 8.4.9, 8.3.7.5."""

from __future__ import annotations

from amaranth.hdl import C, Module, Mux, Signal, Value

from roslet.gateware.rtps import tables
from roslet.gateware.rtps.rom import Register
from roslet.gateware.rtps.sending import COMPOSE, Sending


def repeat(m: Module, work: Sending, asked: Value, writers: Value, readers: Value) -> None:
    """The states from READER on, in which what was asked for has come, the address first: what we have, and what it has
    and asks for. `asked`: it has said so now; `writers`, `readers`, those of ours that are enabled.

    From HEARTBEAT on with `work.publishing`: the message of the user's goes with the heartbeat, and NEXT READER follows.
    """
    ports, subject, own = work.ports, work.subject, work.own
    ask_to, start = Signal(work.age_shape), Signal(work.age_shape)
    unacknowledged, lost = Signal(), Signal()
    over = Signal()  # nothing more is asked for
    with m.State("READER"):
        m.d.comb += work.take_ip.eq(1)
        work.ask_own(m, tables.WRITER_LAST)
        m.next = "READER PORT"
    with m.State("READER PORT"):
        m.d.comb += work.take_port.eq(1)
        work.ask_own(m, tables.WRITER_LAST_HI)
        work.ask(m, tables.START)
        m.next = "LAST"
    with m.State("LAST"):
        m.d.comb += work.increment.eq(0)
        m.d.sync += work.last.eq(work.sum)
        work.ask_own(m, tables.WRITER_OLDEST)
        work.ask(m, tables.ACKED)
        m.next = "START"
    with m.State("START"):
        m.d.comb += work.increment.eq(0)
        m.d.sync += work.last_high.eq(work.sum)
        work.ask(m, tables.ASK_FROM)
        m.next = "ACKED"
    with m.State("ACKED"):
        m.d.sync += [start.eq(work.age_of_given()), work.oldest.eq(ports.own.data)]
        work.ask(m, tables.ASK_TO)
        m.next = "ASK FROM"
    with m.State("ASK FROM"):
        m.d.sync += unacknowledged.eq(~work.behind[31])
        with m.If(start < work.oldest):
            m.d.sync += work.oldest.eq(start)
        m.next = "ASK TO"
    with m.State("ASK TO"):
        m.d.sync += [work.age.eq(work.age_of_given()), work.borrowed.eq(work.behind[32])]
        m.next = "ASKED"
    with m.State("ASKED"):
        age = work.age_of_given()
        m.d.sync += ask_to.eq(Mux(age[-1], 0, age))
        m.next = "JUDGE"
    with m.State("JUDGE"):
        m.d.sync += lost.eq((work.age > work.oldest) & (work.age >= ask_to))
        m.next = "IDLE"
        with m.If(asked):
            m.next = "LOST"
        with m.Elif(unacknowledged):
            m.next = "HEARTBEAT"
    with m.State("LOST"):
        m.next = "REPEAT"
        with m.If(lost & ~subject.builtin):
            work.compose(m, work.rom.start["gap"], "REPEAT", COMPOSE)
    with m.State("REPEAT"):
        with m.If(work.age > work.oldest):
            m.d.sync += work.age.eq(work.oldest)
        m.d.sync += work.chosen.eq(Register.NUMBER)
        m.next = "AGED"
    with m.State("AGED"):
        m.d.sync += [over.eq(work.age < ask_to), subject.sample.eq(work.sample(work.number[:16]))]
        with m.If(subject.builtin):
            m.d.sync += subject.local.eq(work.oldest - work.age)
        m.next = "AGAIN"
    with m.State("AGAIN"):
        m.d.comb += work.of_sample.eq(1)
        m.next = "KEPT SAMPLE"
        with m.If(subject.builtin):
            m.next = "DISCOVERY"
        with m.If(over):
            m.next = "HEARTBEAT"
    with m.State("DISCOVERY"):
        told = []
        for bits, name, table in (
            (writers, "publication", own.writers),
            (readers, "subscription", own.readers),
        ):
            start_of = work.rom.start
            there = bits.bit_select(subject.local[: len(bits).bit_length()], 1)
            one = work.choose([C(start_of[f"{name}{n}"]) for n in range(len(table))] or [C(0)])
            told.append(Mux(there, one, start_of[f"{name}_gone"]))
        work.compose(m, Mux(subject.kind[0], told[1], told[0]), "NEXT")
    with m.State("KEPT SAMPLE"):
        m.next = "SAMPLE"
    with m.State("SAMPLE"):
        m.d.sync += [subject.words.eq(ports.own.data), subject.padding.eq(ports.own.data[16:18])]
        work.compose(m, work.rom.start["message"], "NEXT")
    with m.State("NEXT"):
        m.d.sync += [work.age.eq(work.age - 1), work.chosen.eq(Register.NUMBER)]
        m.next = "AGED"
    with m.State("HEARTBEAT"):
        work.ask_own(m, tables.WRITER_COUNT)
        m.next = "HEARTBEATS"
    with m.State("HEARTBEATS"):
        m.next = "COUNT"
    with m.State("COUNT"):
        work.store(m, tables.WRITER_COUNT)
        work.compose(m, work.by_kind("heartbeat"), "IDLE", COMPOSE)
        with m.If(work.publishing):
            start_of = work.rom.start
            template = Mux(work.to_group, start_of["group_message_heartbeat"], start_of["message_heartbeat"])
            work.compose(m, template, "NEXT READER")
