"""Fragments of IPv4 datagrams are put together in a memory outside. RFC 791, 3.2."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

from amaranth.hdl import C, Cat, Module, Mux, Signal, Value
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

from roslet.gateware.compare import above
from roslet.gateware.meta import IPV4_FRAGMENT, IPV4_RX
from roslet.gateware.stream import FrameSignature
from roslet.wire.net import ethernet, ipv4

MAX_PAYLOAD = ethernet.MTU - ipv4.SIZE
"""What a fragment brings at most."""

_UNIT = 3
"""Bits of an octet's place in a unit of 8, in which offsets count. RFC 791, 3.1."""

_KEY = ("source", "destination", "protocol", "identification")
"""What a datagram's fragments have in common. RFC 791, 3.2."""

_GIVING_UP = ("size", "overlap", "fragments")
_DROPS = (*_GIVING_UP, "slots", "duplicate", "given_up")


class PayloadMemorySignature(wiring.Signature):
    """A memory of octets with one port, seen from who uses it. With `ce`, `we` writes `wdata` at `addr`; with `ce` alone,
    `rdata` has the octet at `addr` a cycle later, and as long as neither changes."""

    def __init__(self, depth: int) -> None:
        super().__init__(
            {"addr": Out(range(depth)), "ce": Out(1), "we": Out(1), "wdata": Out(8), "rdata": In(8)}
        )


class _Timer(wiring.Component):
    """`over` a number of `cycles`, which stands steady for 8, after `start`, or up to 16 more.

    They are counted down by a subtractor of four bits: a ring of 8 digits turns by it, of which a turn takes 8.
    """

    def __init__(self) -> None:
        super().__init__({"cycles": In(32), "start": In(1), "over": Out(1)})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        ring = Signal(32)
        at = Signal(3)  # of the digit at hand
        first, last = at == 0, at == 7
        loading, borrow = Signal(), Signal()
        digit = ring[:4]
        borrows = Mux(first, ~digit[3], borrow & (digit == 0))
        counted = Mux(first, digit ^ 8, digit - borrow)[:4]
        m.d.sync += [
            at.eq(at + 1),
            ring.eq(Cat(ring[4:], Mux(loading, self.cycles.word_select(at, 4), counted))),
            borrow.eq(borrows),
        ]
        with m.If(last):
            m.d.sync += loading.eq(0)
        with m.If(self.start):
            m.d.sync += [at.eq(0), loading.eq(1), self.over.eq(0)]
        with m.Elif(last & borrows & ~loading):
            m.d.sync += self.over.eq(1)
        return m


class _Slot(wiring.Component):
    """What is known of one datagram: its key, which ranges of it are there, its age.

    Ranges count in units of 8 octets; the last fragment's has no end, so that whatever lies behind it overlaps. They are
    compared with the fragment at hand one at a time: at each `rotate` the next stands ready, after as many as there can be
    the first again. None overlap, so all is there when those before the last add up to where the last begins.

    `same`: a cycle ago the key was this fragment's; `known`: and the datagram is still waited for. `evictable`: a new one
    may have the slot: this one was given up, or is a repetition, maybe of late duplicates only, of the one before.
    `complete`: a cycle ago all was there.
    """

    def __init__(self, max_fragments: int, unit_bits: int) -> None:
        self._count = max_fragments
        self._range = data.StructLayout({"valid": 1, "start": unit_bits, "stop": unit_bits, "last": 1})
        super().__init__(
            {
                "fragment": In(IPV4_FRAGMENT),
                "stop": In(unit_bits),
                "rotate": In(1),
                "accept": In(1),
                "give_up": In(1),
                "free": In(1),
                "expiration": In(32),
                "same": Out(1),
                "known": Out(1),
                "busy": Out(1),
                "evictable": Out(1),
                "given_up": Out(1),
                "overlaps": Out(1),
                "repeats": Out(1),
                "full": Out(1),
                "complete": Out(1),
                "expired": Out(1),
                "total": Out(unit_bits + _UNIT),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        fragment = self.fragment
        key = Cat(fragment[name] for name in _KEY)
        its_key = Signal(len(key))
        suspect = Signal()
        ranges = [Signal(self._range, name=f"range{n}") for n in range(self._count)]
        new = Signal(self._range)
        units = Signal.like(self.stop)  # of all that is there; what the last has less than one is none
        has_last = Signal()
        m.submodules.timer = timer = _Timer()
        m.d.comb += [
            new.valid.eq(1),
            new.start.eq(fragment.offset),
            new.stop.eq(self.stop),
            new.last.eq(~fragment.more),
            self.known.eq(self.busy & self.same),
            self.evictable.eq(self.given_up | suspect),
            timer.cycles.eq(self.expiration),
            self.expired.eq(self.busy & timer.over),
        ]
        m.d.sync += self.same.eq(its_key == key)

        at_hand = ranges[0]
        tail, its_tail = fragment.length[:_UNIT], self.total[:_UNIT]
        m.d.comb += [
            self.overlaps.eq(
                at_hand.valid
                & ((new.start < at_hand.stop) | at_hand.last)
                & ((at_hand.start < new.stop) | new.last)
            ),
            self.repeats.eq((Value.cast(at_hand) == Value.cast(new)) & (fragment.more | (tail == its_tail))),
            self.full.eq(at_hand.valid),
        ]
        m.d.sync += self.complete.eq(has_last & (units == self.total[_UNIT:]))
        with m.If(self.rotate | self.accept):
            m.d.sync += [one.eq(next_one) for one, next_one in pairwise(ranges)]
            m.d.sync += ranges[-1].eq(Mux(self.accept, Value.cast(new), Value.cast(at_hand)))
        with m.If((self.accept | self.give_up) & ~self.known):
            m.d.comb += timer.start.eq(1)
            m.d.sync += [its_key.eq(key), self.busy.eq(1), suspect.eq(self.same)]
        with m.If(self.give_up):
            m.d.sync += self.given_up.eq(1)
        with m.If(self.accept):
            m.d.sync += units.eq(units + fragment.length[_UNIT:])
        with m.If(self.accept & ~fragment.more):
            m.d.sync += [has_last.eq(1), self.total.eq(Cat(tail, self.stop))]
        with m.If(self.free):
            m.d.sync += [
                signal.eq(0)
                for signal in (self.busy, self.given_up, has_last, units, *(one.valid for one in ranges))
            ]
        return m


class Reassembly(wiring.Component):
    """Puts datagrams together of their fragments, which may come in any order.

    Ports: `i`, fragments; `o`, whole datagrams, `meta` being the last arrived fragment's, but for `length`;
    `ip_payloadsmem`, the memory, of `depth` octets: `max_pendings` slots of `max_fragments * max_payload`; `expiration`, in
    cycles, as it is when a datagram's first fragment comes.

    A fragment waits for `max_fragments` + 2 cycles before its first octet is taken, and for two at its end; it is written
    an octet a cycle. When the last that was missing has come, its end waits until the whole datagram has been read and has
    gone out, an octet a cycle; so `i` stalls for as many cycles as that has octets, and five.

    Fragments belong together that have source, destination, protocol and identification in common. What has a range that
    is there already is a duplicate, and dropped (`drop_duplicate`). A datagram is given up, and all that still comes of it
    is dropped (`drop_given_up`), when a fragment overlaps another, or lies behind the last (`drop_overlap`); when its room
    is too small, or a fragment is empty, or is not the last and no multiple of 8 octets long (`drop_size`); when it has more
    fragments than `max_fragments` (`drop_fragments`). A fragment that ends badly does not count.

    A datagram that is not whole `expiration` cycles after its first fragment has come, or up to 16 more, is forgotten
    (`drop_expired`), as soon as no fragment is passing. While all slots are in use, other datagrams are dropped
    (`drop_slots`): who came first keeps the slot, since to give it to who comes last would let a flood of first fragments
    undo everyone's datagrams, where now it delays them by `expiration` at most. But a slot whose datagram was given up,
    or has the key of the datagram before it (late duplicates would hold it in vain), is given to who asks for it.
    """

    def __init__(self, max_pendings: int = 1, max_fragments: int = 2, max_payload: int = MAX_PAYLOAD) -> None:
        if max_pendings < 1:
            raise ValueError(f"a datagram needs a slot: max_pendings is 1 at least, not {max_pendings}")
        if max_fragments < 2:
            raise ValueError(f"what has fragments has two: max_fragments is 2 at least, not {max_fragments}")
        if max_payload < 1 << _UNIT or max_payload % (1 << _UNIT):
            raise ValueError(f"max_payload must be a multiple of 8 octets (RFC 791, 3.2), not {max_payload}")
        self._pendings = max_pendings
        self._fragments = max_fragments
        self._room = max_fragments * max_payload
        if self._room > 0xFFFF:
            raise ValueError(f"a datagram has 65535 octets at most, not {self._room}")
        self.depth = max_pendings * self._room
        super().__init__(
            {
                "i": In(FrameSignature(IPV4_FRAGMENT)),
                "o": Out(FrameSignature(IPV4_RX)),
                "ip_payloadsmem": Out(PayloadMemorySignature(self.depth)),
                "expiration": In(32),
                **{f"drop_{reason}": Out(1) for reason in (*_DROPS, "expired")},
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        i, o, mem = self.i.stream, self.o.stream, self.ip_payloadsmem
        fragment = self.i.meta
        unit_bits = bits_for(self._room >> _UNIT)
        slots = [_Slot(self._fragments, unit_bits) for _ in range(self._pendings)]
        chosen = Signal(range(self._pendings)) if self._pendings > 1 else Signal(1)

        def any_slot(fact: Callable[[_Slot], Value]) -> Value:
            return Cat(fact(slot) for slot in slots).any()

        def of_chosen(fact: Callable[[_Slot], Value]) -> Value:
            return Cat(*(fact(slot) & (chosen == n) for n, slot in enumerate(slots))).any()

        accept, give_up, rotate, take_over, done = (
            Signal(name=name) for name in ("accept", "give_up", "rotate", "take_over", "done")
        )
        stop = Signal(17 - _UNIT)  # the sum of an offset and a length
        for n, slot in enumerate(slots):
            m.submodules[f"slot{n}"] = slot
            mine = chosen == n
            m.d.comb += [
                slot.fragment.eq(fragment),
                slot.stop.eq(stop),
                slot.expiration.eq(self.expiration),
                slot.rotate.eq(rotate),
                slot.accept.eq(accept & mine),
                slot.give_up.eq(give_up & mine),
            ]

        # -- what is wrong with a fragment

        tail = fragment.length[:_UNIT]
        wrong_size = Signal()
        room = self._room >> _UNIT
        m.d.comb += wrong_size.eq(
            above(stop, room)
            | ((stop == room) & tail.any())
            | ~fragment.length.any()
            | (fragment.more & tail.any())
        )
        overlap, repeat = Signal(), Signal()

        # -- which slot a fragment belongs to: its datagram's; a new one's, that which had its key before, then any

        choice = Signal.like(chosen)
        has_choice = Signal(init=1)
        kinds: list[Callable[[_Slot], Value]] = [
            lambda slot: slot.known,
            lambda slot: ~slot.busy & slot.same,
            lambda slot: ~slot.busy,
            lambda slot: slot.evictable,
        ]
        preferences = [(n, kind(slot)) for kind in kinds for n, slot in enumerate(slots)]
        m.d.comb += [has_choice.eq(Cat(condition for _, condition in preferences).any())]
        for n, condition in reversed(preferences):
            with m.If(condition):
                m.d.comb += choice.eq(n)
        has_slot = Signal()

        # -- the memory

        at = Signal(range(self._room + 1))
        following = Signal.like(at)  # one more
        to_following = [at.eq(following), following.eq(following + 1)]
        total = Signal.like(at)
        base = Signal(range(self.depth))
        with m.Switch(chosen):
            for n, slot in enumerate(slots):
                with m.Case(n):
                    m.d.comb += [base.eq(n * self._room), total.eq(slot.total)]
        advance, fetched, has_octet = Signal(), Signal(), Signal()
        octet = Signal(8)  # since block RAM is slow to show what it has
        m.d.comb += [
            mem.addr.eq(base + Mux(advance, following, at)),
            mem.wdata.eq(i.payload.data),
            o.payload.data.eq(octet),
            *(self.o.meta[name].eq(fragment[name]) for name, _ in IPV4_RX if name != "length"),
            self.o.meta.length.eq(total),
        ]

        reason = Signal(range(len(_DROPS)))
        rotated = Signal(range(self._fragments))
        ended = i.valid & i.payload.end
        good = ended & ~i.payload.bad
        expiring = Signal(self._pendings)
        for n, slot in enumerate(slots):
            m.d.comb += slot.free.eq(expiring[n] | ((take_over | done) & (chosen == n)))

        def drop(why: str) -> None:
            m.d.sync += reason.eq(_DROPS.index(why))
            m.next = "DROP"

        with m.FSM():
            with m.State("IDLE"):
                for n, slot in reversed(list(enumerate(slots))):  # one at a time, to be counted
                    with m.If(slot.expired):
                        m.d.comb += [expiring.eq(1 << n), self.drop_expired.eq(~slot.given_up)]
                m.d.sync += [
                    stop.eq(fragment.offset + fragment.length[_UNIT:]),
                    overlap.eq(0),
                    repeat.eq(0),
                    rotated.eq(0),
                ]
                with m.If(i.valid):
                    m.next = "CHECK"
            with m.State("CHECK"):
                m.d.comb += rotate.eq(1)
                m.d.sync += [
                    overlap.eq(overlap | any_slot(lambda slot: slot.known & slot.overlaps)),
                    repeat.eq(repeat | any_slot(lambda slot: slot.known & slot.repeats)),
                    rotated.eq(rotated + 1),
                    chosen.eq(choice),
                    has_slot.eq(has_choice),
                ]
                with m.If(rotated == self._fragments - 1):
                    m.next = "DECIDE"
            with m.State("DECIDE"):
                known = of_chosen(lambda slot: slot.known)
                m.d.sync += [at.eq(fragment.offset << _UNIT), following.eq(Cat(C(1, _UNIT), fragment.offset))]
                with m.If(known & of_chosen(lambda slot: slot.given_up)):
                    drop("given_up")
                with m.Elif(wrong_size):
                    drop("size")
                with m.Elif(~has_slot):
                    drop("slots")
                with m.Elif(repeat):
                    drop("duplicate")
                with m.Elif(overlap):
                    drop("overlap")
                with m.Elif(known & of_chosen(lambda slot: slot.full)):
                    drop("fragments")
                with m.Else():
                    m.d.comb += take_over.eq(~known)
                    m.next = "STORE"
            with m.State("STORE"):
                m.d.comb += i.ready.eq(~good)
                with m.If(good):
                    m.d.comb += accept.eq(1)
                    m.next = "STORED"
                with m.Elif(ended):
                    m.next = "IDLE"
                with m.Elif(i.valid):
                    m.d.comb += [mem.ce.eq(1), mem.we.eq(1)]
                    m.d.sync += to_following
            with m.State("STORED"):
                m.next = "JUDGE"
            with m.State("JUDGE"):
                m.d.sync += [at.eq(0), following.eq(1), fetched.eq(0), has_octet.eq(0)]
                with m.If(of_chosen(lambda slot: slot.complete)):
                    m.next = "REPLAY"
                with m.Else():
                    m.d.comb += i.ready.eq(1)
                    m.next = "IDLE"
            with m.State("REPLAY"):
                m.d.comb += [
                    mem.ce.eq(1),
                    o.valid.eq(has_octet),
                    advance.eq(fetched & (o.ready | ~has_octet)),
                ]
                m.d.sync += fetched.eq(1)
                with m.If(advance):
                    m.d.sync += [*to_following, octet.eq(mem.rdata), has_octet.eq(1)]
                    with m.If(following == total):
                        m.d.comb += mem.ce.eq(0)
                        m.next = "LAST"
            with m.State("LAST"):
                m.d.comb += o.valid.eq(1)
                with m.If(o.ready):
                    m.next = "END"
            with m.State("END"):
                m.d.comb += [o.valid.eq(1), o.payload.end.eq(1), i.ready.eq(o.ready), done.eq(o.ready)]
                with m.If(o.ready):
                    m.next = "IDLE"
            with m.State("DROP"):
                m.d.comb += i.ready.eq(1)
                with m.If(ended):
                    m.next = "IDLE"
                with m.If(good), m.Switch(reason):
                    for n, name in enumerate(_DROPS):
                        with m.Case(n):
                            m.d.comb += getattr(self, f"drop_{name}").eq(1)
                            if name in _GIVING_UP:
                                m.d.comb += give_up.eq(has_slot)
        return m


class NoReassembly(wiring.Component):
    """In place of `Reassembly`, where nothing is put together.

    Ports: `i`, fragments, each of which is dropped, and counted by `drop_none` if its end is good.
    """

    def __init__(self) -> None:
        super().__init__({"i": In(FrameSignature(IPV4_FRAGMENT)), "drop_none": Out(1)})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        i = self.i.stream
        m.d.comb += [i.ready.eq(1), self.drop_none.eq(i.valid & i.payload.end & ~i.payload.bad)]
        return m
