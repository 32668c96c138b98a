"""What becomes of a user's message: it is kept, and sent to each reader that matches. RTPS 2.3, 8.4.2.2."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from amaranth.hdl import Array, C, Module, Signal, Value

from roslet.gateware.rtps import tables
from roslet.gateware.rtps.parameters import USER_GROUP_PORT
from roslet.gateware.rtps.sending import Sending


def publish(
    m: Module,
    work: Sending,
    streams: Sequence[Any],
    drop_long: Sequence[Value],
    matched: Value,
    group_port: Value,
    over: Signal,
) -> None:
    """The states from PUBLISH on: the message that is valid at the one of `streams` that is our writer's. `over` is set
    when it has been dealt with. IDLE follows.
    """
    ports, subject, own, start_of = work.ports, work.subject, work.own, work.rom.start
    local, endpoint, words = subject.local, subject.endpoint, subject.words
    theirs, ours = ports.peers.data, ports.own.data
    item, valid = Signal.like(streams[0].payload), Signal()
    its = local[: (len(streams) - 1).bit_length()]
    m.d.comb += [
        item.eq(Array(Value.cast(one.payload) for one in streams)[its]),
        valid.eq(Array(one.valid for one in streams)[its]),
    ]
    most = work.choose([C(one.words, len(words)) for one in own.writers])
    reliable = work.choose([C(one.reliable, 1) for one in own.writers])
    long, full = Signal(), Signal()
    carried, all_kept = Signal(), Signal()
    kept, start = Signal(work.age_shape), Signal(work.age_shape)
    last_endpoint = endpoint == work.peers.endpoints - 1
    # Of this message's readers one, several are in the group; of each writer's last one there were several.
    in_group, one_there, several_there = Signal(), Signal(), Signal()
    grouped = Signal()  # it has gone to the group
    several = Signal(len(streams))
    with m.State("PUBLISH"):
        work.ask_own(m, tables.WRITER_LAST)
        m.d.sync += [grouped.eq(0), one_there.eq(0), several_there.eq(0)]
        m.d.sync += [words.eq(0), long.eq(0), work.age.eq(0), full.eq(most == 0)]
        m.next = "NUMBERED"
    with m.State("NUMBERED"):
        work.ask_own(m, tables.WRITER_OLDEST)
        m.next = "NUMBER"
    with m.State("NUMBER"):
        m.d.sync += subject.sample.eq(work.sample(work.sum[:16]))
        m.next = "KEPT"
    with m.State("KEPT"):
        oldest = work.choose([C(one.depth - 1, len(kept)) for one in own.writers])
        m.d.sync += all_kept.eq(ours[: len(kept)] == oldest)
        m.next = "KEEP"
    with m.State("KEEP"):
        for n, one in enumerate(streams):
            m.d.comb += one.ready.eq(local == n)
        with m.If(valid & ~item.end):
            with m.If(full):
                m.d.sync += long.eq(1)
            with m.Else():
                m.d.sync += [words.eq(words + 1), full.eq((words + 1)[: len(words)] == most)]
                m.d.comb += ports.write.en.eq(1)
        m.d.comb += [ports.write.addr.eq(subject.sample | (words + 1)), ports.write.data.eq(item.data)]
        with m.If(valid & item.end):
            m.d.sync += subject.padding.eq(item.padding)
            m.next = "SIZE"
            with m.If(item.bad | long):
                for n, dropped in enumerate(drop_long):
                    m.d.comb += dropped.eq((local == n) & ~item.bad)
                m.d.sync += over.eq(1)
                m.next = "IDLE"
    with m.State("SIZE"):
        m.d.comb += [
            ports.write.en.eq(1),
            ports.write.addr.eq(subject.sample),
            ports.write.data.eq(words | subject.padding << 16),
        ]
        work.ask_own(m, tables.WRITER_LAST)
        m.next = "STORE"
    with m.State("STORE"):
        work.ask_own(m, tables.WRITER_LAST_HI)
        m.next = "STORE LAST"
    with m.State("STORE LAST"):
        m.d.sync += [work.last.eq(work.sum), carried.eq(work.sum[32])]
        work.store(m, tables.WRITER_LAST)
        work.ask_own(m, tables.WRITER_OLDEST)
        m.next = "STORE HIGH"
    with m.State("STORE HIGH"):
        m.d.comb += work.increment.eq(carried)
        m.d.sync += work.last_high.eq(work.sum)
        work.store(m, tables.WRITER_LAST_HI)
        m.next = "STORE KEPT"
    with m.State("STORE KEPT"):
        m.d.comb += work.increment.eq(~all_kept)
        m.d.sync += kept.eq(work.sum)
        work.store(m, tables.WRITER_OLDEST)
        m.next = "EACH READER"

    with m.State("EACH READER"):  # an endpoint a cycle, of those that there are not
        work.ask(m, tables.INFO)
        with m.If(matched.bit_select(endpoint, 1)):
            m.next = "THE READER"
        with m.Else():
            m.d.sync += endpoint.eq(endpoint + 1)
            with m.If(last_endpoint):
                m.next = "PUBLISHED"
    with m.State("THE READER"):
        work.ask(m, tables.IP)
        m.next = "READER OF"
    with m.State("READER OF"):
        work.ask(m, tables.PORT)
        m.d.sync += [
            subject.slot.eq(theirs[tables.INFO_SLOT : tables.INFO_SLOT + 8]),
            work.reliable.eq(theirs[tables.INFO_RELIABLE]),
            work.oldest.eq(kept),
        ]
        its_writer = theirs[tables.INFO_LOCAL : tables.INFO_LOCAL + len(local)]
        m.next = "NEXT READER"
        with m.If(~theirs[tables.INFO_WRITER] & (its_writer == local)):
            m.next = "READER IP"
    with m.State("READER IP"):
        m.d.comb += work.take_ip.eq(1)
        work.ask(m, tables.START)
        m.next = "READER'S PORT"
    with m.State("READER'S PORT"):
        m.d.comb += work.take_port.eq(1)
        m.d.sync += in_group.eq(theirs[tables.PORT_GROUP])
        m.next = "READER START"
    with m.State("READER START"):
        m.next = "READER AGE"
    with m.State("READER AGE"):
        m.d.sync += start.eq(work.age_of_given())
        m.next = "READER OLDEST"
    with m.State("READER OLDEST"):
        with m.If(work.reliable):
            m.next = "HEARTBEAT"
        with m.Else():
            work.compose(m, start_of["message"], "NEXT READER")
        with m.If(start < work.oldest):
            m.d.sync += work.oldest.eq(start)
        with m.Elif(in_group):  # what is kept is the same for all of these
            m.d.sync += [one_there.eq(1), several_there.eq(one_there)]
            with m.If(grouped):
                m.next = "NEXT READER"
            with m.Elif(several.bit_select(its, 1)):
                m.d.comb += [work.to_all.eq(1), work.group_port.eq(group_port + USER_GROUP_PORT)]
                m.d.sync += [work.to_group.eq(1), grouped.eq(1)]
                with m.If(reliable):
                    m.next = "HEARTBEAT"
                with m.Else():
                    work.compose(m, start_of["group_message"], "NEXT READER")
    with m.State("NEXT READER"):
        m.d.sync += [endpoint.eq(endpoint + 1), work.to_group.eq(0)]
        m.next = "EACH READER"
        with m.If(last_endpoint):
            m.next = "PUBLISHED"
    with m.State("PUBLISHED"):
        m.d.sync += [several.bit_select(its, 1).eq(several_there), over.eq(1)]
        m.next = "IDLE"
