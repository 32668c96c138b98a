"""Whose turn it is to be served."""

from __future__ import annotations

from amaranth.hdl import C, Cat, Module, Mux, Signal, Value
from amaranth.lib import data, memory, wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.rtps.ports import DueSignature
from roslet.gateware.rtps.tables import BUILTINS, PeerMap, aligned

JOB = data.StructLayout({"user": 1, "index": 8, "asked": 1, "greet": 1, "announce": 1})
"""To be served: everybody (`announce`), participant `index` (`greet`), or proxy `index`, one of the user's or a builtin one;
`asked`, something is due for it."""


class Turns(wiring.Component):
    """Remembers for whom something is due, and goes round among them.

    Ports: `due0`, `due1`, for whom something is due from now on; `greet` with `greet_slot`, a participant that is to be
    greeted; `announce`, everybody; `sweep`, each proxy once; `alive` and `matched`, the participants and user proxies that
    there are. `job` is what is next while `valid`, and steady until `taken` is high for a cycle.

    One proxy, or whether a participant is to be greeted, is looked at in three cycles, and stands at `job` in the next; what
    is due for one that is gone is forgotten. What becomes due for the job that is taken, in that cycle or later, is another
    job. An announcement waits while somebody is found.

    It must not become due by `due1` in two cycles in a row, nor by `due0` or `greet` within three cycles: there is one
    memory for all, whose bits are set and read by turns. In the first round after a reset all is forgotten.
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
        # A bit for each proxy, and for each participant that is to be greeted
        sizes = BUILTINS << peers.slot_bits, 1 << peers.endpoint_bits, 1 << peers.slot_bits
        (builtins, users, greetings), places = aligned(sizes)
        m.submodules.bits = bits = memory.Memory(
            shape=1, depth=1 << (places - 1).bit_length(), init=[], attrs={"ram_style": "block"}
        )
        write, read = bits.write_port(), bits.read_port()

        def place(base: int, index: Value, size: int) -> Value:
            low = (size - 1).bit_length()
            return Cat(index[:low], C(base >> low, len(read.addr) - low))

        def of_proxy(proxy: Value) -> Value:
            return Mux(proxy[-1], place(users, proxy[:-1], sizes[1]), place(builtins, proxy[:-1], sizes[0]))

        # -- who says so: one waits while the other is written
        sources = [(Signal(), Signal.like(read.addr)) for _ in range(2)]
        (first, first_at), (second, second_at) = sources
        with m.If(~second):
            m.d.sync += first.eq(0)
        with m.If(self.due0.en | self.greet):
            m.d.sync += first.eq(1)
            m.d.sync += first_at.eq(
                Mux(self.greet, place(greetings, self.greet_slot, sizes[2]), of_proxy(self.due0.proxy))
            )
        m.d.sync += second.eq(self.due1.en)
        m.d.sync += second_at.eq(of_proxy(self.due1.proxy))

        # -- who is looked at
        at = Signal.like(read.addr)
        user, builtin = (
            at[(size - 1).bit_length() :] == base // size
            for base, size in ((users, sizes[1]), (builtins, sizes[0]))
        )
        greet = ~(user | builtin)
        due, there = Signal(), Signal()
        sweep, sweeping = Signal(), Signal()  # from the next round on, in this one
        fresh = Signal(init=1)
        announcing, found = Signal(), Signal()
        written, forget, step = Signal(), Signal(), Signal()
        index = Signal(peers.index_bits)
        alive = self.alive.bit_select(at[2 : 2 + peers.slot_bits], 1)
        m.d.comb += [
            index.eq(at[: 2 + peers.slot_bits]),
            found.eq(((there & (due | sweeping)) | (greet & due)) & ~fresh),
            written.eq(first | second),
            write.addr.eq(Mux(second, second_at, Mux(first, first_at, at))),
            write.data.eq(written),
            write.en.eq(written | forget),
            read.addr.eq(at),
        ]
        for kind, bits_ in ((user, peers.endpoint_bits), (greet, peers.slot_bits)):
            with m.If(kind):
                m.d.comb += index.eq(at[:bits_])
        with m.FSM():
            with m.State("READ"), m.If(~written):
                m.next = "TAKE"
            with m.State("TAKE"):
                m.d.sync += due.eq(read.data)
                m.d.sync += there.eq(
                    Mux(user, self.matched.bit_select(at[: peers.endpoint_bits], 1), alive & builtin)
                )
                m.next = "DECIDE"
                with m.If(written):  # maybe of this one
                    m.next = "READ"
            with m.State("DECIDE"):
                m.next = "READ"
                m.d.sync += [
                    job.user.eq(user),
                    job.index.eq(index),
                    job.asked.eq(due),
                    job.greet.eq(greet & found),
                    job.announce.eq(~found),
                ]
                with m.If(~written):
                    m.d.comb += forget.eq(due | fresh)
                    with m.If(found | announcing):
                        m.d.sync += announcing.eq(found & announcing)
                        m.next = "OFFER"
                    with m.Else():
                        m.d.comb += step.eq(1)
            with m.State("OFFER"):
                m.d.comb += self.valid.eq(1)
                with m.If(self.taken):
                    m.d.comb += step.eq(1)
                    m.next = "READ"
        with m.If(step):
            m.d.sync += at.eq(at + 1)
            with m.If(at.all()):
                m.d.sync += [sweeping.eq(sweep), sweep.eq(0), fresh.eq(0)]
        with m.If(self.announce):
            m.d.sync += announcing.eq(1)
        with m.If(self.sweep):
            m.d.sync += sweep.eq(1)
        return m
