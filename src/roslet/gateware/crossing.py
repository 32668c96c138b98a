"""A queue from one clock domain to another."""

from __future__ import annotations

from amaranth.hdl import Elaboratable, Module, ResetSignal, Signal, Value
from amaranth.lib.cdc import AsyncFFSynchronizer, FFSynchronizer
from amaranth.lib.memory import Memory

POINTER_STAGES = 2
RESET_STAGES = 4  # a reset is over only after the pointers that it has set to zero have crossed


def _gray(number: Value) -> Value:
    return number ^ number[1:]


class CrossingQueue(Elaboratable):
    """`depth` words of `width` bits, a power of two, from `w_domain` to `r_domain`.

    Ports, as those of Amaranth's FIFOs: a word `w_data` is taken with an edge of `w_domain` at which `w_en` and `w_rdy` are
    high; `r_data` is one where `r_rdy` is high, and gives way to the next with an edge of `r_domain` at which `r_en` is.
    `r_data` and `r_rdy` are registers, and hold one word more; so does the memory's own. Throughput one word in each cycle
    of the slower clock; a word is there at most 4 edges of `r_domain` after the one with which it was taken.

    Only the reset of `w_domain` empties it: it reaches `r_domain` by itself, at once, and ends there some cycles later.

    Amaranth's own has two long paths, from the comparison of pointers through an adder to the memory's address, and to the
    writer's Gray code; here the comparison only enables registers.
    """

    def __init__(self, width: int, depth: int, w_domain: str, r_domain: str) -> None:
        if depth < 4 or depth & (depth - 1):
            raise ValueError(
                f"the depth of a queue between clocks must be a power of two from 4 on, and not {depth}"
            )
        self.w_data, self.w_en, self.w_rdy = Signal(width), Signal(), Signal()
        self.r_data = Signal(width, reset_less=True)
        self.r_en, self.r_rdy = Signal(), Signal(reset_less=True)
        self._depth, self._w_domain, self._r_domain = depth, w_domain, r_domain

    def elaborate(self, platform: object) -> Module:
        m = Module()
        w_domain, r_domain = self._w_domain, self._r_domain
        m.submodules.words = words = Memory(shape=self.w_data.shape(), depth=self._depth, init=[])
        write, read = words.write_port(domain=w_domain), words.read_port(domain=r_domain)

        # One bit more than an address: an empty queue has equal pointers, a full one such as differ in that bit alone.
        pointer = range(2 * self._depth)
        w_at, w_gray, w_gray_there = Signal(pointer), Signal(pointer), Signal(pointer)
        r_at, r_gray = Signal(pointer, reset_less=True), Signal(pointer, reset_less=True)
        r_gray_there = Signal(pointer)
        m.submodules.w_crossing = FFSynchronizer(
            w_gray, w_gray_there, o_domain=r_domain, stages=POINTER_STAGES
        )
        m.submodules.r_crossing = FFSynchronizer(
            r_gray, r_gray_there, o_domain=w_domain, stages=POINTER_STAGES
        )

        full = w_gray == (
            r_gray_there ^ (0b11 << len(w_at) - 2)
        )  # half a turn of a Gray code changes its upper two bits
        w_next = (w_at + 1)[: len(w_at)]
        m.d.comb += [self.w_rdy.eq(~full), write.en.eq(self.w_en & ~full)]
        m.d.comb += [write.addr.eq(w_at), write.data.eq(self.w_data)]
        with m.If(write.en):
            m.d[w_domain] += [w_at.eq(w_next), w_gray.eq(_gray(w_next))]

        reset = Signal()
        m.submodules.reset = AsyncFFSynchronizer(
            ResetSignal(w_domain, allow_reset_less=True), reset, o_domain=r_domain, stages=RESET_STAGES
        )
        fetched = Signal(reset_less=True)  # the memory's register holds a word
        free = ~self.r_rdy | self.r_en
        r_next = (r_at + 1)[: len(r_at)]
        m.d.comb += [read.addr.eq(r_at), read.en.eq((r_gray != w_gray_there) & (~fetched | free))]
        with m.If(free):
            m.d[r_domain] += [self.r_data.eq(read.data), self.r_rdy.eq(fetched), fetched.eq(0)]
        with m.If(read.en):
            m.d[r_domain] += [r_at.eq(r_next), r_gray.eq(_gray(r_next)), fetched.eq(1)]
        with m.If(reset):
            m.d[r_domain] += [r_at.eq(0), r_gray.eq(0), fetched.eq(0), self.r_rdy.eq(0)]
        return m
