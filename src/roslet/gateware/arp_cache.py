"""Which hardware address an IPv4 address of the network has: asked for, remembered, forgotten. RFC 826."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal, Value
from amaranth.lib import data, memory, wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware import multicast
from roslet.gateware.compare import by_pairs
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


class ArpCache(wiring.Component):
    """2**`width` entries, `resolving` of which at most are being asked for at once.

    **Questions**, `lookup`. Of a multicast address, of 255.255.255.255, and of the subnet's broadcast address (there is none
    where the mask leaves fewer than two bits: RFC 3021) the answer is computed. Our own address, 0.0.0.0/8, and every
    address while `enable` is low, have `failed`. For an address outside the subnet the gateway's is looked for. What is in
    the cache is `found`. What is not gets an entry and is asked for, `retry_interval` apart, until it is learned or
    `retry_count` requests (one at least) were sent; `retry_interval` after the last of them it has `failed`, and for as long
    again, so that whoever asks now and then gets to know; after that a question begins anew. Otherwise nothing is known yet:
    a request is under way, or `resolving` others are.
    An answer takes 7 cycles where it is computed, up to 2**width + 6 otherwise, and while the cache is busy up to
    5 * 2**width + 18 besides.

    **Requests**: `ask` is high for one cycle when a request for `ask_ip` shall be sent; never while `ask_ready` is low. The
    first is sent up to 2**(width + 1) + 7 cycles after the answer to the question, or else when the entry is visited next.

    **What is learned**: while `learn` is high, which holds until `learned` is, `ip` has the hardware address `mac`. An entry
    of that address takes it, whether it was asked for or not, as in RFC 826. Without an entry the address is remembered only
    if `create` is high and an entry is free: nobody displaces, unasked, what is in use.

    **Room**: what is asked for takes a free entry, or else displaces, in turn, one that is not being asked for. An entry
    is forgotten `timeout` after its address was last learned.

    Time is counted in ticks of `tick` cycles (1024 with 16 entries), in which each entry is visited once: intervals are met
    within one tick and the cycles of an answer, and a request within another for each that is due in the same tick. `enable`
    stays high once it is. All is forgotten at reset.

    All that is done is a round: the entries are read one after another, an entry a cycle. What is looked for is compared
    with each, and what is learned written where it is found, which ends the first round; a second finds it a place; and by
    a round for each tick, and one for each new question, all are visited.
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
        self._tick_bits = width + max(_MIN_VISIT, width + 2)
        self.tick: int = 2**self._tick_bits
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
        count, tick = 2**self._width, self._tick_bits
        pair = data.StructLayout({"ip": 32, "mac": 48})
        status = data.StructLayout({"state": 2, "tries": TRIES, "age": INTERVAL - tick})
        block = {"ram_style": "block"}  # of LUTs it would be a twentieth of all that UDP takes
        # Behind the pairs of the entries, as many with the hardware address of everybody.
        init: list[dict[str, int]] = [{}] * count + [{"mac": multicast.number(multicast.BROADCAST)}] * count
        m.submodules.pairs = pairs = memory.Memory(shape=pair, depth=2 * count, init=init, attrs=block)
        m.submodules.statuses = statuses = memory.Memory(shape=status, depth=count, init=[], attrs=block)
        pair_read, pair_write = pairs.read_port(), pairs.write_port()
        status_read, status_write = statuses.read_port(), statuses.write_port()

        # A round: an entry is addressed, comes two cycles later since block RAM is slow, is shown in the next, when it is
        # known what it is equal to, and written in the one after.
        index, read, comes, at = (Signal(self._width, name=name) for name in ("index", "read", "comes", "at"))
        reading, coming, showing, last = Signal(), Signal(), Signal(), Signal()
        pair_comes, status_comes = Signal(pair), Signal(status)
        known, entry, new = Signal(pair), Signal(status), status_write.data
        m.d.comb += last.eq(showing & (at == count - 1))
        m.d.sync += [index.eq(index + 1), read.eq(index), comes.eq(read), at.eq(comes)]
        m.d.sync += [reading.eq(1), coming.eq(reading), showing.eq(coming)]
        m.d.sync += [pair_comes.eq(pair_read.data), status_comes.eq(status_read.data)]
        m.d.sync += [known.eq(pair_comes), entry.eq(status_comes)]
        put, update = Signal(), Signal()  # the entry that is shown is another from now on; its status is
        m.d.sync += [pair_write.addr.eq(at), pair_write.en.eq(put)]
        m.d.sync += [status_write.addr.eq(at), status_write.en.eq(put | update)]

        # What is looked for, and has been found
        key = Signal(32)
        finding, learning, learnt = Signal(), Signal(), Signal()  # `learnt`: what was done last
        same, match = Signal(32 // 2), Signal()
        m.d.sync += same.eq(by_pairs(pair_comes.ip, key))
        m.d.comb += match.eq(same.all() & (entry.state != FREE))
        answer = Signal(2)  # the state of the entry that was found, or FREE
        group_mac = multicast.hardware_address(lookup.ip)
        mac = Signal(48, init=multicast.number(multicast.PREFIX))
        free, pending = Signal(), Signal(range(self._resolving + 1))
        turn = Signal(self._width)  # where a place is looked for first: in turn they are displaced

        # What is known of the question, from a cycle after it has been put. Each bit has a register, and for each Yosys
        # finds the least LUTs.
        own, mask, gateway = (
            Value.cast(value) for value in (self.addresses.ip, self.addresses.mask, self.addresses.gateway)
        )
        ip, asked, group = lookup.ip, Signal(), multicast.is_multicast(lookup.ip)
        inside, ours, zero, ones, host_ones = (Signal() for _ in range(5))
        m.d.sync += [
            asked.eq(lookup.valid & ~lookup.done),
            inside.eq(((ip ^ own) & mask) == 0),
            ours.eq(ip == own),
            zero.eq(ip[:8] == 0),
            ones.eq(ip.all()),
            host_ones.eq((ip | mask).all()),
        ]
        # In the order of the wire bit 25 is the last but one of the mask.
        everybody = ones | (inside & host_ones & ~mask[25])
        nowhere = ~inside & (gateway[:8] == 0) & ~group & ~ones
        refused = ~self.enable | ours | zero | nowhere
        computed = group | everybody | refused

        # Time
        clock, due, fresh, aging = Signal(tick), Signal(), Signal(), Signal()
        old, late = Signal(), Signal()
        m.d.sync += clock.eq(clock + 1)
        m.d.sync += [
            old.eq(status_comes.age == self.timeout[tick:]),
            late.eq(status_comes.age == self.retry_interval[tick:]),
        ]
        asking = entry.state == PENDING
        unasked = asking & (entry.tries == 0)
        over = (aging & Mux(entry.state == KNOWN, old, late)) | unasked

        m.d.sync += [new.age.eq(entry.age + aging), new.tries.eq(entry.tries + over)]
        m.d.sync += new.state.eq(Mux(learning, KNOWN, PENDING))
        m.d.comb += [
            pair_write.data.ip.eq(key),
            pair_write.data.mac.eq(self.mac),
            self.ask_ip.eq(known.ip),
            lookup.mac.eq(mac),
            pair_read.addr.eq(Cat(index, finding & ~learning & everybody)),
            status_read.addr.eq(index),
        ]
        m.d.sync += self.learned.eq(0)

        with m.FSM(init="CLEAR") as fsm:
            with m.State("CLEAR"):
                m.d.comb += update.eq(1)
                m.d.sync += new.state.eq(FREE)
                with m.If(last):
                    m.next = "IDLE"
            with m.State("IDLE"):
                with m.If(due | fresh):
                    m.d.sync += [due.eq(0), fresh.eq(0), aging.eq(due)]
                    m.next = "VISIT"
                with m.Elif(self.learn & ~self.learned & ~(learnt & lookup.valid)):
                    m.d.sync += [learning.eq(1), learnt.eq(1), key.eq(self.ip)]
                    m.next = "FIND"
                with m.Elif(asked):
                    m.d.sync += [learning.eq(0), learnt.eq(0), key.eq(Mux(inside, ip, gateway))]
                    m.next = "FIND"
            with m.State("FIND"):
                m.d.comb += finding.eq(1)
                with m.If(showing):
                    m.d.comb += put.eq(match & learning)
                    m.d.sync += [free.eq(free | (entry.state == FREE)), pending.eq(pending + asking)]
                    with m.If(match):
                        m.d.sync += answer.eq(entry.state)
                    with m.If(group & ~everybody):
                        m.d.sync += mac[24:].eq(group_mac[24:])
                    with m.Elif(match | everybody):
                        m.d.sync += mac.eq(known.mac)
                with m.If(last | (showing & (match | (computed & ~learning)))):
                    m.next = "DECIDE"
            with m.State("DECIDE"):
                m.next = "IDLE"
                with m.If(learning):
                    m.d.sync += self.learned.eq(1)
                    with m.If(self.create & free & (answer == FREE)):
                        m.d.sync += self.learned.eq(0)
                        m.next = "PLACE"
                with m.Else():
                    m.d.comb += [
                        lookup.done.eq(1),
                        lookup.found.eq(Mux(computed, ~refused, answer == KNOWN)),
                        lookup.failed.eq(Mux(computed, refused, answer == FAILED)),
                    ]
                    with m.If(~computed & (answer == FREE) & (pending != self._resolving)):
                        m.next = "PLACE"
            with m.State("PLACE"):
                # There is one: where all are being asked for, `resolving` are, and nothing comes here.
                m.d.comb += put.eq(showing & ~asking & ((entry.state == FREE) | ~free))
                with m.If(put):
                    m.d.sync += [self.learned.eq(learning), fresh.eq(~learning)]
                    with m.If(~learning):
                        m.d.sync += turn.eq(comes)  # which is one further
                    m.next = "IDLE"
            with m.State("VISIT"):
                exhausted = ~unasked & (entry.tries >= self.retry_count)
                m.d.comb += update.eq(showing & (entry.state != FREE))
                m.d.sync += new.state.eq(entry.state)
                with m.If(over):
                    with m.If(~asking):
                        m.d.sync += new.state.eq(FREE)
                    with m.Elif(exhausted):
                        m.d.sync += new.state.eq(FAILED)
                    with m.Else():
                        m.d.comb += [update.eq(self.ask), self.ask.eq(showing & self.ask_ready)]
                with m.If(last):
                    m.next = "IDLE"

        with m.If(clock == 0):
            m.d.sync += due.eq(1)
        with m.If(~fsm.ongoing("VISIT") | over):
            m.d.sync += new.age.eq(0)
        with m.If(~fsm.ongoing("VISIT")):
            m.d.sync += new.tries.eq(0)
        with m.If(fsm.ongoing("DECIDE")):
            m.d.sync += index.eq(turn)
        with m.If(fsm.ongoing("IDLE")):
            m.d.sync += [index.eq(0), answer.eq(FREE), free.eq(0), pending.eq(0)]
            m.d.sync += mac.eq(mac.init)
        with m.If(fsm.ongoing("IDLE") | fsm.ongoing("DECIDE")):
            m.d.sync += [reading.eq(0), coming.eq(0), showing.eq(0)]
        return m
