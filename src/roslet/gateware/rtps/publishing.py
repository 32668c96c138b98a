"""What becomes of a user's message: it is kept, and sent to each reader that matches. RTPS 2.3, 8.4.2.2."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from amaranth.hdl import Array, C, Module, Mux, Signal, Value

from roslet.gateware.rtps.sending import Sending


def publish(
    m: Module,
    work: Sending,
    streams: Sequence[Any],
    drop_long: Sequence[Value],
    matched: Value,
    over: Signal,
) -> None:
    """The states from PUBLISH on: the message that is valid at the one of `streams` that is our writer's. `over` is set
    when it has been dealt with. IDLE follows.
    """
    ports, subject, own, start_of = work.ports, work.subject, work.own, work.rom.start
    local, endpoint, words = subject.local, subject.endpoint, subject.words
    item, offered, valid = Signal.like(streams[0].payload), Signal(), Signal()
    its = local[: (len(streams) - 1).bit_length()]
    chosen = [
        item.eq(Array(Value.cast(one.payload) for one in streams)[its]),
        offered.eq(Array(one.valid for one in streams)[its]),
    ]
    if len(streams) == 1:
        m.d.comb += chosen
    most = work.choose([C(one.words, len(words)) for one in own.writers])
    before = work.choose([C(one.depth - 1, len(subject.oldest)) for one in own.writers])  # kept at most
    reliable = work.choose([C(one.reliable, 1) for one in own.writers])
    long, full = Signal(), Signal()
    last_endpoint = endpoint == work.peers.endpoints - 1
    # Of this message's readers one, several are in the group; of each writer's last one there were several.
    one_there, several_there = Signal(), Signal()
    grouped = Signal()  # it has gone to the group
    several = Signal(len(streams))
    # Where it will be kept is known before it begins, or is always the same; how many are kept, before it ends.
    always = all(one.depth == 1 for one in own.writers)
    with m.State("PUBLISH"):
        m.d.sync += [grouped.eq(0), one_there.eq(0), several_there.eq(0)]
        m.d.sync += [words.eq(0), long.eq(0), subject.age.eq(0), full.eq(most == 0)]
        m.d.sync += [work.placed.eq(always), work.counted.eq(0), subject.sample.eq(work.sample(C(0, 16)))]
        work.run(m, start_of["next"])
        m.next = "KEEP"
    with m.State("KEEP"):
        ready = work.placed & (work.counted | ~item.end)
        m.d.comb += valid.eq(offered & ready)
        fetch = ready
        if len(streams) > 1:  # a word waits in a register: it is chosen late, and `ready` leads far
            fetch = ~offered | (work.placed & ~item.end)
            with m.If(fetch):
                m.d.sync += chosen
            with m.Elif(valid):
                m.d.sync += offered.eq(0)
        for n, one in enumerate(streams):
            m.d.comb += one.ready.eq((local == n) & fetch)
        m.d.comb += [ports.write.addr.eq(subject.sample | (words + 1)), ports.write.data.eq(item.data)]
        with m.If(valid & ~item.end):
            with m.If(full):
                m.d.sync += long.eq(1)
            with m.Else():
                m.d.sync += [words.eq(words + 1), full.eq((words + 1)[: len(words)] == most)]
                m.d.comb += ports.write.en.eq(1)
        with m.If(item.end):
            m.d.comb += [
                ports.write.addr.eq(subject.sample),
                ports.write.data[:16].eq(words),
                ports.write.data[16:18].eq(item.padding),
            ]
        with m.If(valid & item.end):
            with m.If(item.bad | long):
                for n, dropped in enumerate(drop_long):
                    m.d.comb += dropped.eq((local == n) & ~item.bad)
                m.d.sync += over.eq(1)
                m.next = "IDLE"
            with m.Else():
                m.d.comb += ports.write.en.eq(1)
                template = Mux(subject.oldest == before, start_of["kept"], start_of["kept_more"])
                work.run(m, template)

    with m.State("EACH READER"):  # an endpoint a cycle, of those that there are not
        with m.If(matched.bit_select(endpoint, 1)):
            work.run(m, work.rom.start["to_reader"])
        with m.Else():
            m.d.sync += endpoint.eq(endpoint + 1)
            with m.If(last_endpoint):
                m.next = "PUBLISHED"
    with m.State("TO READER"):
        m.next = "NEXT READER"
        with m.If(~work.is_writer & work.is_ours):
            template = Mux(work.reliable, start_of["message_heartbeat"], start_of["message"])
            work.compose(m, template)
            with m.If(work.start < subject.oldest):
                m.d.sync += subject.oldest.eq(work.start)
            with m.Elif(work.in_group):  # what is kept is the same for all of these
                m.d.sync += [one_there.eq(1), several_there.eq(one_there)]
                with m.If(grouped):
                    m.next = "NEXT READER"
                with m.Elif(several.bit_select(its, 1)):
                    m.d.sync += grouped.eq(1)
                    template = Mux(reliable, start_of["group_message_heartbeat"], start_of["group_message"])
                    work.compose(m, template)
    with m.State("NEXT READER"):
        m.d.sync += endpoint.eq(endpoint + 1)
        m.next = "EACH READER"
        with m.If(last_endpoint):
            m.next = "PUBLISHED"
    with m.State("PUBLISHED"):
        m.d.sync += [several.bit_select(its, 1).eq(several_there), over.eq(1)]
        m.next = "IDLE"
