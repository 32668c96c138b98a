"""ArpCache: what it says of an address is what was learned of it, and what it asks for, somebody asked of it."""

from __future__ import annotations

from typing import Any

from amaranth.hdl import Assert, Assume, Cat, Const, Cover, Module, Mux, Signal, Value

from gateware.formal import Bug, Spec, assume_steady
from roslet.gateware import arp_cache

WIDTH = 1
INTERVAL = 7
TRIES = 2
VISIT = 4
TICK = 2 ** (WIDTH + VISIT)
LATE = TICK + 2 * (2**WIDTH + 6)
"""Cycles by which an interval may be missed: a tick, and what the cache may be busy with when a visit is due."""
MOST = 6 * (2**WIDTH + 4)
PROMPT = 2 ** (WIDTH + 1) + 7
"""Cycles of an answer, and from it to the first request, by the contract."""


def number(*octets: int) -> Value:
    """An address, its first octet in the lowest bits."""
    return Const(int.from_bytes(bytes(octets), "little"), 8 * len(octets))


NETWORK = number(10, 0, 0)
ELSEWHERE = number(10, 0, 1)
OWN, GATEWAY, MASK = number(10, 0, 0, 1), number(10, 0, 0, 2), number(255, 255, 255, 0)
LOW = 2
"""Bits of the last octet, in which addresses differ."""

CLOCK = "clock, due, fresh, aging = Signal(tick"


class _Cache(Spec):
    """Two entries, one of them being asked for, and a tick of 32 cycles. Questions and what is learned stand until they are
    taken."""

    module = arp_cache
    scale: tuple[tuple[str, str], ...] = (
        ("INTERVAL = 36", f"INTERVAL = {INTERVAL}"),
        ("TRIES = 6", f"TRIES = {TRIES}"),
        ("_MIN_VISIT = 6", f"_MIN_VISIT = {VISIT}"),
    )

    def block(self) -> Any:
        return self.gates.ArpCache(WIDTH, 1)

    def put(self, m: Module) -> Value:
        """Assume the rules of the inputs. High while the cache was enabled when the question was put."""
        dut, enabled = self.dut, Signal()
        m.d.sync += enabled.eq(dut.enable)
        m.d.comb += Assume(~enabled | dut.enable, "enabled")
        for steady in (dut.addresses.as_value(), dut.retry_count, dut.retry_interval, dut.timeout):
            assume_steady(m, steady)
        lookup = dut.lookup
        for valid, what, answer in (
            (lookup.valid, lookup.ip, lookup.done),
            (dut.learn, Cat(dut.ip, dut.mac, dut.create), dut.learned),
        ):
            waits, before = Signal(), Signal.like(what)
            m.d.sync += [waits.eq(valid & ~answer), before.eq(what)]
            m.d.comb += Assume(~waits | (valid & (what == before)), "held")
        begun, was_on, on = Signal(), Signal(), Signal()
        m.d.comb += on.eq(Mux(begun, was_on, dut.enable))
        m.d.sync += [begun.eq(lookup.valid & ~lookup.done), was_on.eq(on)]
        return on


class AnswersSpec(_Cache):
    """What needs no cache. `nobody`: what cannot be somebody's has failed. `everybody`, `group`: their hardware addresses
    are found."""

    quick, deep = 22, 30
    bugs = (
        Bug("nobody", "| ours | zero", "| zero"),
        Bug("everybody", "& ~group & ~ones", "& ~group"),
        Bug("group", "& ~group & ~ones", "& ~ones"),
    )

    def properties(self, m: Module) -> None:
        on = self.put(m)
        dut, lookup = self.dut, self.dut.lookup
        own, gateway, mask, ip = (
            Value.cast(value)
            for value in (dut.addresses.ip, dut.addresses.gateway, dut.addresses.mask, lookup.ip)
        )
        outside = (ip & mask) != (own & mask)
        has_hosts = ~mask[25]  # the last bit but one, in the order of the wire
        everybody = ip.all() | ((ip == (own | ~mask)) & has_hosts)
        group = ip[4:8] == 0xE
        nobody = (ip == own) | (ip[:8] == 0)
        nobody |= outside & (gateway[:8] == 0) & ~group & ~everybody
        group_mac = Cat(Const(0x5E0001, 24), ip[8:15], Const(0, 1), ip[16:])
        with m.If(lookup.done):
            with m.If(~dut.enable | (on & nobody)):
                m.d.comb += Assert(lookup.failed, "nobody")
            with m.Elif(on & everybody):
                m.d.comb += Assert(lookup.found & lookup.mac.all(), "everybody")
            with m.Elif(on & group):
                m.d.comb += Assert(lookup.found & (lookup.mac == group_mac), "group")
            with m.Else():
                m.d.comb += Cover(lookup.found, "somebody")


class _Entries(_Cache):
    """`excluded`: `found` and `failed` exclude each other and come with `done`. `bound`: there is an answer within `MOST`
    cycles. And of one address, `watched`, any of the few that there are here:

    `learned`: what is found is what was learned last. `create`: and somebody had asked for it, or it came with `create`.
    `tried`: what has failed was asked for as often and as long ago as it should. `kept`: what is learned while it is being
    asked for, or first of all, is found until its time is over or another address is asked for. `ready`: no request while
    none can be sent. `wanted`: only for what somebody asked of the cache. `prompt`: the first question has one within
    `PROMPT` cycles. `apart`: requests keep their distance. `resolving`: nothing else is asked for meanwhile.
    """

    quick, deep = 44, 50
    # The first visit falls behind the first question: at reset nothing is there to be visited.
    scale = (*_Cache.scale, (CLOCK, f"{CLOCK}, init={TICK - 25}"))

    def tie(self, m: Module, port: Value, value: Value) -> None:
        """The port is no input any more."""
        target = Value.cast(port)
        self.ports = [other for other in self.ports if other is not target]
        m.d.comb += target.eq(value)

    def put(self, m: Module) -> Value:
        dut = self.dut
        outside = self.free(1, "outside")
        self.tie(m, dut.addresses, Cat(number(*bytes(6)), OWN, GATEWAY, MASK))
        self.tie(m, dut.ip, Cat(NETWORK, self.free(LOW, "told")))
        self.tie(m, dut.mac, self.free(1, "its_mac"))
        self.tie(m, dut.lookup.ip, Cat(Mux(outside, ELSEWHERE, NETWORK), self.free(LOW, "asked")))
        return super().put(m)

    def properties(self, m: Module) -> None:
        on = self.put(m)
        dut, lookup = self.dut, self.dut.lookup
        watched = Signal(32)
        m.d.comb += watched.eq(Cat(NETWORK, self.steady(m, LOW, "its_place")))
        inside = lookup.ip[:24] == NETWORK
        watched_key = Mux(inside, lookup.ip, GATEWAY) == watched

        told, mac = Signal(), Signal(48)
        heard = dut.learned & (dut.ip == watched)
        asked = dut.ask & (dut.ask_ip == watched)
        answered = lookup.done & watched_key & (lookup.ip != OWN) & on
        found = answered & lookup.found
        nothing = lookup.done & ~lookup.found & ~lookup.failed
        wanted, created = Signal(), Signal()
        first = Signal(init=1)  # nothing was ever learned or put into the cache
        there, age = Signal(), Signal(INTERVAL)
        pending, requests, since = Signal(), Signal(TRIES), Signal(INTERVAL)

        lasts = there & (age + LATE < dut.timeout)
        waits = pending & (since + LATE < dut.retry_interval)  # it is being asked for
        m.d.sync += [age.eq(age + ~age.all()), since.eq(since + ~since.all())]
        with m.If(nothing & watched_key):
            m.d.sync += wanted.eq(1)
        with m.If(nothing | dut.learned):
            m.d.sync += first.eq(0)
        with m.If(nothing & ~watched_key):
            m.d.sync += there.eq(0)
        with m.If(asked):
            m.d.sync += [pending.eq(1), requests.eq(requests + ~requests.all()), since.eq(0)]
        with m.If(heard):
            m.d.sync += [told.eq(1), mac.eq(dut.mac), created.eq(created | dut.create), age.eq(0)]
            m.d.sync += [there.eq(lasts | waits | (first & dut.create)), pending.eq(0), requests.eq(0)]

        begun, begun_for = Signal(), Signal(5)  # a request is to be sent
        with m.If(dut.ask | ~dut.ask_ready):
            m.d.sync += begun.eq(0)
        with m.Elif(nothing & first):
            m.d.sync += begun.eq(1)
        m.d.sync += begun_for.eq(Mux(begun, begun_for + 1, 0))
        failed = answered & lookup.failed
        waited = Signal(6)
        m.d.sync += waited.eq(Mux(lookup.valid & ~lookup.done, waited + 1, 0))
        claims = {
            "excluded": ~(lookup.found & lookup.failed) & (lookup.done | ~(lookup.found | lookup.failed)),
            "bound": waited < MOST,
            "learned": ~found | (told & (lookup.mac == mac)),
            "create": ~found | wanted | created,
            "tried": ~failed | ((requests >= dut.retry_count) & (requests > 0) & ~waits),
            "kept": ~(answered & lasts) | lookup.found,
            "ready": ~dut.ask | (dut.ask_ready & dut.enable),
            "wanted": ~asked | wanted,
            "prompt": begun_for < PROMPT,
            "apart": ~(asked & waits),
            "resolving": ~(dut.ask & ~asked & waits),
        }
        m.d.comb += [Assert(claims[bug.property], bug.property) for bug in self.bugs]
        m.d.comb += [
            Cover(found, "found"),
            Cover(failed, "failed"),
            Cover(asked & (requests == 1), "again"),
        ]


class EntriesSpec(_Entries):
    """Of those properties: what is found, and has failed."""

    bugs = (
        Bug("excluded", "answer == FAILED", "answer != FAILED"),
        Bug("learned", "put.eq(match & learning)", "update.eq(match & learning)"),
        Bug("create", "self.create & free", "free"),
        Bug("tried", "~unasked & (entry.tries", "(entry.tries"),
        Bug("kept", "status_comes.age == self.timeout[tick:]", "status_comes.age == 0"),
    )


class RequestsSpec(_Entries):
    """Of those properties: when there is an answer, and what is asked for."""

    bugs = (
        Bug("bound", "self.learn & ~self.learned & ~(learnt & lookup.valid)", "self.learn"),
        Bug("ready", "self.ask.eq(showing & self.ask_ready)", "self.ask.eq(showing)"),
        Bug("wanted", "Mux(learning, KNOWN, PENDING)", "PENDING"),
        Bug("prompt", "fresh.eq(~learning)", "fresh.eq(0)"),
        Bug("apart", "status_comes.age == self.retry_interval[tick:]", "1"),
        Bug("resolving", " & (pending != self._resolving)", ""),
    )


SPECS: tuple[type[Spec], ...] = (AnswersSpec, EntriesSpec, RequestsSpec)
