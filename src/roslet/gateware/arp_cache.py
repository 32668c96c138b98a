"""Which hardware address an IPv4 address of the network has: asked for, remembered, forgotten. RFC 826."""

from __future__ import annotations

from amaranth.hdl import Const, Module, Mux, Signal, Value
from amaranth.lib import data, memory, wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware import multicast
from roslet.gateware.meta import ADDRESSES, LookupSignature

FREE, PENDING, KNOWN, FAILED = range(4)
"""States of an entry."""

INTERVAL = 36
"""Bits of the intervals, which count cycles."""

TRIES = 6

MAX_WIDTH = 8
"""2**8 entries are read one after another for each question: 2.6 us at 100 MHz."""

RESOLVING = 4
"""How many addresses are asked for at once, unless told otherwise or there are fewer entries."""

_MIN_VISIT = 6
_SCAN_LAG = 3
"""An entry is visible two cycles after it is addressed, since block RAM is slow, and whether it is the one that is looked
for known a cycle later."""


class ArpCache(wiring.Component):
    """2**`width` entries, `resolving` of which at most are being asked for at once.

    **Questions**, `lookup`. Of a multicast address, of 255.255.255.255, and of the subnet's broadcast address (there is none
    where the mask leaves fewer than two bits: RFC 3021) the answer is computed. Our own address, 0.0.0.0/8, and every
    address while `enable` is low, have `failed`. For an address outside the subnet the gateway's is looked for. What is in
    the cache is `found`. What is not gets an entry and is asked for, `retry_interval` apart, until it is learned or
    `retry_count` requests (one at least) were sent; `retry_interval` after the last of them it has `failed`, and for as long
    again, so that whoever asks now and then gets to know; after that a question begins anew. Otherwise nothing is known yet:
    a request is under way, or `resolving` others are.
    An answer takes 4 cycles where it is computed, up to 2**width + 7 otherwise, and while the cache is busy as much again
    and 7 more.

    **Requests**: `ask` is high for one cycle when a request for `ask_ip` shall be sent; never while `ask_ready` is low. The
    first is sent 3 cycles after the answer to the question, or else when the entry is visited next.

    **What is learned**: while `learn` is high, which holds until `learned` is, `ip` has the hardware address `mac`. An entry
    of that address takes it, whether it was asked for or not, as in RFC 826. Without an entry the address is remembered only
    if `create` is high and an entry is free: nobody displaces, unasked, what is in use.

    **Room**: what is asked for takes a free entry, or else displaces, in turn, one that is not being asked for. An entry
    is forgotten `timeout` after its address was last learned.

    Time is counted in ticks of `tick` cycles (1024 with 16 entries), in which each entry is visited once: intervals are met
    within one tick and the cycles of an answer. `enable` stays high once it is. All is forgotten at reset.
    """

    def __init__(self, width: int = 4, resolving: int | None = None) -> None:
        if resolving is None:
            resolving = min(RESOLVING, 2**width)
        if not 1 <= width <= MAX_WIDTH:
            raise ValueError(f"a cache has 2**1 to 2**{MAX_WIDTH} entries, not 2**{width}")
        if not 1 <= resolving <= 2**width:
            raise ValueError(f"of {2**width} entries 1 to {2**width} can be resolving, not {resolving}")
        self._width = width
        self._resolving = resolving
        # A visit waits until what the cache is busy with is over, which must be before the next is due.
        self._visit = max(_MIN_VISIT, width + 2)
        self.tick: int = 2 ** (width + self._visit)
        super().__init__(
            {
                "enable": In(1),
                "addresses": In(ADDRESSES),
                "retry_count": In(TRIES),
                "retry_interval": In(INTERVAL),
                "timeout": In(INTERVAL),
                "lookup": In(LookupSignature()),
                "learn": In(1),
                "ip": In(32),
                "mac": In(48),
                "create": In(1),
                "learned": Out(1),
                "ask": Out(1),
                "ask_ip": Out(32),
                "ask_ready": In(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        lookup = self.lookup
        count = 2**self._width
        tick = self._width + self._visit
        pair = data.StructLayout({"ip": 32, "mac": 48})
        status = data.StructLayout({"state": 2, "tries": TRIES, "left": INTERVAL - tick})
        block = {"ram_style": "block"}  # of LUTs it would be a twentieth of all that UDP takes
        m.submodules.pairs = pairs = memory.Memory(shape=pair, depth=count, init=[], attrs=block)
        m.submodules.statuses = statuses = memory.Memory(shape=status, depth=count, init=[], attrs=block)
        pair_read, pair_write = pairs.read_port(), pairs.write_port()
        status_read, status_write = statuses.read_port(), statuses.write_port()
        index = Signal(self._width)  # of the entry that is written, or read, to be visible two cycles later
        for port in (pair_read, pair_write, status_read, status_write):
            m.d.comb += port.addr.eq(index)
        known, entry, new = Signal(pair), Signal(status), status_write.data
        m.d.sync += [known.eq(pair_read.data), entry.eq(status_read.data)]

        # What is being done
        key = Signal(32)
        learning, learnt, computed = Signal(), Signal(), Signal()  # `learnt`: what was done last
        group, everybody, refused = Signal(), Signal(), Signal()

        # What a scan has found
        step = Signal(range(count + _SCAN_LAG))
        read, reading, shown, showing = Signal(self._width), Signal(), Signal(self._width), Signal()
        hit, hit_at = Signal(), Signal(self._width)
        free, usable, candidate = Signal(), Signal(), Signal(self._width)
        pending = Signal(range(self._resolving + 1))
        full = pending == self._resolving
        turn = Signal(self._width)  # a scan begins here: the first that is displaced

        # Time
        clock, due, visited = Signal(self._visit), Signal(), Signal(self._width)
        m.d.sync += clock.eq(clock + 1)
        with m.If(clock == 0):
            m.d.sync += due.eq(1)
        less = Signal(INTERVAL - tick + 1)
        m.d.comb += less.eq(Value.cast(entry.left) - 1)
        asking = entry.state == PENDING
        unasked = asking & (entry.tries == 0)
        over = less[-1] | unasked

        m.d.comb += [
            pair_write.data.ip.eq(key),
            pair_write.data.mac.eq(self.mac),
            new.left.eq(Mux(learning, self.timeout[tick:], Mux(over, self.retry_interval[tick:], less[:-1]))),
            self.ask_ip.eq(known.ip),
            lookup.mac.eq(
                Mux(
                    everybody,
                    Const(multicast.number(multicast.BROADCAST), 48),
                    Mux(group, multicast.hardware_address(lookup.ip), known.mac),
                )
            ),
        ]
        m.d.sync += [read.eq(index), shown.eq(read), showing.eq(reading)]

        with m.FSM(init="CLEAR"):
            with m.State("CLEAR"):
                m.d.comb += [new.state.eq(FREE), status_write.en.eq(1)]
                m.d.sync += index.eq(index + 1)
                with m.If(index == count - 1):
                    m.next = "IDLE"
            with m.State("IDLE"):
                m.d.sync += [index.eq(turn), step.eq(0), reading.eq(0), showing.eq(0), pending.eq(0)]
                m.d.sync += [hit.eq(0), free.eq(0), usable.eq(0), computed.eq(0)]
                with m.If(due):
                    m.d.sync += [due.eq(0), index.eq(visited), visited.eq(visited + 1), learning.eq(0)]
                    m.next = "READ"
                with m.Elif(self.learn & ~(learnt & lookup.valid)):
                    m.d.sync += [learning.eq(1), learnt.eq(1), key.eq(self.ip)]
                    m.next = "SCAN"
                with m.Elif(lookup.valid):
                    own = Value.cast(self.addresses.ip)
                    mask = Value.cast(self.addresses.mask)
                    gateway = Value.cast(self.addresses.gateway)
                    ip = lookup.ip
                    inside = ((ip ^ own) & mask) == 0
                    # In the order of the wire bit 25 is the last but one of the mask.
                    subnet = inside & ~mask[25] & (ip | mask).all()
                    nowhere = (ip[:8] == 0) | (~inside & (gateway[:8] == 0))
                    is_group = multicast.is_multicast(ip)
                    m.d.sync += [
                        learning.eq(0),
                        learnt.eq(0),
                        key.eq(Mux(inside, ip, gateway)),
                        group.eq(is_group),
                        everybody.eq(subnet | ip.all()),
                        refused.eq(~self.enable | (ip == own) | (nowhere & ~is_group & ~ip.all())),
                    ]
                    m.next = "SCAN"
            with m.State("SCAN"):
                m.d.sync += [step.eq(step + 1), index.eq(index + 1), reading.eq(step < count)]
                with m.If(showing):
                    m.d.sync += [hit.eq((known.ip == key) & (entry.state != FREE)), hit_at.eq(shown)]
                    with m.If(asking):
                        m.d.sync += pending.eq(Mux(full, pending, pending + 1))
                    with m.Elif(~free & ((entry.state == FREE) | ~usable)):
                        m.d.sync += [candidate.eq(shown), usable.eq(1), free.eq(entry.state == FREE)]
                with m.If(~learning & (group | everybody | refused)):
                    m.d.sync += computed.eq(1)
                    m.next = "ANSWER"
                with m.Elif(hit):
                    m.d.sync += index.eq(hit_at)
                    m.next = "HIT"
                with m.Elif(step == count + _SCAN_LAG - 1):
                    m.d.sync += index.eq(candidate)
                    m.next = "MISS"
            with m.State("HIT"):
                m.d.comb += new.state.eq(KNOWN)
                with m.If(learning):
                    m.d.comb += [self.learned.eq(1), pair_write.en.eq(1), status_write.en.eq(1)]
                    m.next = "IDLE"
                with m.Else():
                    m.next = "HIT READ"
            with m.State("HIT READ"):
                m.next = "ANSWER"
            with m.State("ANSWER"):
                m.d.comb += [
                    lookup.done.eq(1),
                    lookup.found.eq(Mux(computed, ~refused, entry.state == KNOWN)),
                    lookup.failed.eq(Mux(computed, refused, entry.state == FAILED)),
                ]
                m.next = "IDLE"
            with m.State("MISS"):
                m.next = "IDLE"
                m.d.comb += [new.state.eq(Mux(learning, KNOWN, PENDING)), pair_write.en.eq(status_write.en)]
                with m.If(learning):
                    m.d.comb += [self.learned.eq(1), status_write.en.eq(free & self.create)]
                with m.Else():
                    m.d.comb += lookup.done.eq(1)
                    with m.If(usable & ~full):
                        m.d.comb += status_write.en.eq(1)
                        m.d.sync += turn.eq(candidate + 1)
                        m.next = "READ"
            with m.State("READ"):
                m.next = "READ ENTRY"
            with m.State("READ ENTRY"):
                m.next = "VISIT"
            with m.State("VISIT"):
                m.d.comb += [
                    new.state.eq(entry.state),
                    new.tries.eq(entry.tries),
                    status_write.en.eq(self.enable & (entry.state != FREE)),
                ]
                with m.If(over):
                    with m.If(~asking):
                        m.d.comb += new.state.eq(FREE)
                    with m.Elif(~unasked & (entry.tries >= self.retry_count)):
                        m.d.comb += new.state.eq(FAILED)
                    with m.Else():
                        m.d.comb += [
                            new.tries.eq(entry.tries + 1),
                            status_write.en.eq(self.ask_ready & self.enable),
                            self.ask.eq(self.ask_ready & self.enable),
                        ]
                m.next = "IDLE"
        return m
