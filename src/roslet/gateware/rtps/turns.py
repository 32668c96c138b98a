"""Whose turn it is to be served."""

from __future__ import annotations

from amaranth.hdl import C, Cat, Module, Mux, Signal
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.rtps import tables
from roslet.gateware.rtps.ports import DueSignature
from roslet.gateware.rtps.scan import lowest
from roslet.gateware.rtps.tables import PeerMap

JOB = data.StructLayout({"user": 1, "index": 8, "asked": 1, "greet": 1, "announce": 1})
"""To be served: everybody (`announce`), participant `index` (`greet`), or proxy `index`, one of the user's or a builtin one;
`asked`, something is due for it."""


class Turns(wiring.Component):
    """Remembers for whom something is due, and goes round among them.

    Ports: `due0`, `due1`, for whom something is due from now on; `greet` with `greet_slot`, a participant that is to be
    greeted; `announce`, everybody; `sweep`, each proxy once; `alive` and `matched`, the participants and user proxies that
    there are. `job` is what is next while `valid`, and steady until `taken` is high for a cycle.

    One proxy is looked at in a cycle, and stands at `job` two cycles later; what is due for one that is gone is forgotten.
    What becomes due for the job that is taken, in that cycle or later, is another job. Greetings and announcements wait
    while anything else is found.
    """

    def __init__(self, peers: PeerMap) -> None:
        self._peers = peers
        super().__init__(
            {
                **{f"due{n}": In(DueSignature(peers.proxy_bits)) for n in range(2)},
                "greet": In(1),
                "greet_slot": In(8),
                "announce": In(1),
                "sweep": In(1),
                "alive": In(peers.participants),
                "matched": In(peers.endpoints),
                "job": Out(JOB),
                "valid": Out(1),
                "taken": In(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        peers, job = self._peers, self.job
        vectors = Signal(peers.participants * tables.BUILTINS), Signal(peers.endpoints)
        greetings, announcing = Signal(peers.participants), Signal()
        index, user = Signal(peers.index_bits), Signal()
        sweep, sweeping = Signal(), Signal()  # from the next round on, in this one

        is_due, there, last = Signal(), Signal(), Signal()
        found, candidate = Signal(), Signal(JOB)  # a cycle after it was looked at
        m.d.comb += [
            is_due.eq(Mux(user, vectors[1].bit_select(index, 1), vectors[0].bit_select(index, 1))),
            there.eq(Mux(user, self.matched.bit_select(index, 1), self.alive.bit_select(index[2:], 1))),
            last.eq(index == Mux(user, len(vectors[1]) - 1, len(vectors[0]) - 1)),
        ]
        with m.If(~found & ~self.valid):
            m.d.sync += [found.eq((is_due | sweeping) & there), index.eq(index + 1)]
            m.d.sync += candidate.eq(Cat(user, Cat(index, C(0, 8 - len(index))), is_due, C(0, 2)))
            with m.If(last):
                m.d.sync += [index.eq(0), user.eq(~user)]
                with m.If(user):
                    m.d.sync += [sweeping.eq(sweep), sweep.eq(0)]
            for n, vector in enumerate(vectors):
                with m.If(user == n):
                    m.d.sync += vector.bit_select(index, 1).eq(0)
        with m.If(~self.valid):
            m.d.sync += [job.eq(candidate), self.valid.eq(found | greetings.any() | announcing)]
            with m.If(found):
                m.d.sync += found.eq(0)
            with m.Elif(greetings.any()):
                slot = lowest(greetings)
                m.d.sync += [job.greet.eq(1), job.index.eq(slot), greetings.bit_select(slot, 1).eq(0)]
            with m.Elif(announcing):
                m.d.sync += [job.announce.eq(1), announcing.eq(0)]
        with m.Elif(self.taken):
            m.d.sync += self.valid.eq(0)

        for source in (self.due0, self.due1):
            for n, vector in enumerate(vectors):
                with m.If(source.en & (source.proxy[-1] == n)):
                    m.d.sync += vector.bit_select(source.proxy[:-1], 1).eq(1)
        with m.If(self.greet):
            m.d.sync += greetings.bit_select(self.greet_slot, 1).eq(1)
        with m.If(self.announce):
            m.d.sync += announcing.eq(1)
        with m.If(self.sweep):
            m.d.sync += sweep.eq(1)
        return m
