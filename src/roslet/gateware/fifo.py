"""Queues of frames, in one clock domain and between two. What they give comes from registers.

A queue keeps items, not frames: what goes in comes out as soon as it can, so a frame's beginning leaves before its end has
come. An item takes 9 bits of memory, the width of common block RAMs: at an end the lowest bit of `data` is not kept, as
`bad` has its place. The others pass, and can say why an end is bad.
"""

from __future__ import annotations

from amaranth.hdl import C, Cat, Module, Mux, ShapeLike, Signal, Value
from amaranth.lib import data, memory, stream, wiring
from amaranth.lib.cdc import PulseSynchronizer
from amaranth.lib.fifo import SyncFIFOBuffered
from amaranth.lib.wiring import In, Out

from roslet.gateware.crossing import CrossingQueue
from roslet.gateware.stream import FrameSignature
from roslet.gateware.words import MessageSignature

_WIDTH = 9


def _pack(item: data.View) -> Value:
    return Cat(Mux(item.end, item.bad, item.data[0]), item.data[1:], item.end)


def _input(m: Module, i: stream.Interface, queue: SyncFIFOBuffered | CrossingQueue) -> None:
    m.d.comb += [queue.w_data.eq(_pack(i.payload)), queue.w_en.eq(i.valid), i.ready.eq(queue.w_rdy)]


def _output(m: Module, queue: SyncFIFOBuffered | CrossingQueue, o: stream.Interface) -> None:
    end = queue.r_data[8]
    m.d.comb += [
        o.payload.data.eq(queue.r_data[:8]),
        o.payload.end.eq(end),
        o.payload.bad.eq(end & queue.r_data[0]),
    ]
    m.d.comb += [o.valid.eq(queue.r_rdy), queue.r_en.eq(o.ready)]


class FrameRegister(wiring.Component):
    """Two places in registers between `i` and `o`, both with `meta`: no path leads through, neither of items nor of `ready`.

    `meta` passes as it is, and is not kept: where there is one, an end is taken at `i` in the cycle after it was taken at
    `o`. Throughput one octet a cycle; latency one cycle.
    """

    def __init__(self, meta: ShapeLike | None = None) -> None:
        super().__init__({"i": In(FrameSignature(meta)), "o": Out(FrameSignature(meta))})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        i, o = self.i.stream, self.o.stream
        spare = Signal.like(i.payload)
        spared = Signal()  # `spare` has an item, as `o` was not ready for the one before
        comes = Signal()
        if self.o.signature.layout is None:
            m.d.comb += [i.ready.eq(~spared), comes.eq(i.valid & ~spared)]
        else:
            copied, gone = Signal(), Signal()  # of the end that is valid at `i`
            m.d.comb += [
                self.o.meta.eq(self.i.meta),
                i.ready.eq(gone | (~spared & ~i.payload.end)),
                comes.eq(i.valid & ~spared & ~copied),
            ]
            m.d.sync += gone.eq(o.valid & o.ready & o.payload.end)
            with m.If(gone):
                m.d.sync += copied.eq(0)
            with m.Elif(comes):
                m.d.sync += copied.eq(i.payload.end)
        with m.If(~o.valid | o.ready):
            m.d.sync += [
                o.payload.eq(Mux(spared, spare, i.payload)),
                o.valid.eq(spared | comes),
                spared.eq(0),
            ]
        with m.Elif(comes):
            m.d.sync += [spare.eq(i.payload), spared.eq(1)]
        return m


class FrameStage(wiring.Component):
    """One place in registers between `i` and `o`, both with `meta`: no path of items leads through, but that of `ready`
    does: for where `o.ready` comes early. It has a sixth of the logic of a `FrameRegister`.

    `meta` passes as it is, and is not kept; or, with `late`, through a register, where it is chosen from much and does not
    change before its end is taken. Where there is one, an end is taken at `i` in the cycle in which it is taken at `o`.
    Throughput one octet a cycle; latency one cycle.
    """

    def __init__(self, meta: ShapeLike | None = None, late: bool = False) -> None:
        self._late = late
        super().__init__({"i": In(FrameSignature(meta)), "o": Out(FrameSignature(meta))})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        i, o = self.i.stream, self.o.stream
        free = ~o.valid | o.ready
        if self.o.signature.layout is None:
            copied: Value = C(0)
            m.d.comb += i.ready.eq(free)
        else:
            copied = o.valid & o.payload.end  # of the end that is valid at `i`
            m.d.comb += i.ready.eq(free & (copied | ~i.payload.end))
            m.d["sync" if self._late else "comb"] += self.o.meta.eq(self.i.meta)
        with m.If(free):
            m.d.sync += [o.payload.eq(i.payload), o.valid.eq(i.valid & ~copied)]
        return m


class MessageRegister(wiring.Component):
    """One place in registers between `i` and `o`, messages with `meta`: no path leads through, and of what is before it
    `o.ready` moves two bits only.

    `meta` passes as it is, and is not kept: an end is taken at `i` in the cycle after it was taken at `o`. While nothing is
    valid at `o`, its payload is what was at `i` a cycle before, valid or not: `Participant` keeps words by that. Throughput
    one word in two cycles; latency one cycle.
    """

    def __init__(self, meta: ShapeLike) -> None:
        super().__init__({"i": In(MessageSignature(meta)), "o": Out(MessageSignature(meta))})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        i, o = self.i.stream, self.o.stream
        gone = Signal()  # the end that is valid at `i` has been taken at `o`
        m.d.comb += [
            self.o.meta.eq(self.i.meta),
            i.ready.eq(gone | (~o.valid & ~i.payload.end)),
        ]
        m.d.sync += gone.eq(o.payload.end & o.valid & o.ready)
        with m.If(o.valid):
            m.d.sync += o.valid.eq(~o.ready)
        with m.Else():
            m.d.sync += [o.payload.eq(i.payload), o.valid.eq(i.valid & ~gone)]
        return m


class FrameFifo(wiring.Component):
    """A queue of `depth` items, and three in registers, within `sync`: `i` to `o`.

    Full, it makes `i` wait: nothing is dropped. Throughput one item a cycle; latency 3 cycles, 1 with a depth of 2: the two
    are then all it has.
    """

    def __init__(self, depth: int) -> None:
        if depth < 2:
            raise ValueError(f"a queue of frames has at least two places, not {depth}")
        self._depth = depth
        super().__init__({"i": In(FrameSignature()), "o": Out(FrameSignature())})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.register = register = FrameRegister()
        wiring.connect(m, register.o, wiring.flipped(self.o))
        if self._depth == 2:
            wiring.connect(m, wiring.flipped(self.i), register.i)
            return m
        m.submodules.queue = queue = SyncFIFOBuffered(width=_WIDTH, depth=self._depth + 1)
        _input(m, self.i.stream, queue)
        _output(m, queue, register.i.stream)
        return m


class AsyncFrameFifo(wiring.Component):
    """A queue of `depth` items, a power of two, from the clock domain `i_domain` to `o_domain`: `i` to `o`.

    Full, it makes `i` wait: nothing is dropped. Throughput one item in a cycle of the slower clock. An item is valid at `o`
    at most 4 cycles of `o_domain` after the edge of `i_domain` with which it was taken. The reset of `i_domain` empties it.
    """

    def __init__(self, depth: int, i_domain: str, o_domain: str) -> None:
        self._queue = CrossingQueue(_WIDTH, depth, i_domain, o_domain)
        super().__init__({"i": In(FrameSignature()), "o": Out(FrameSignature())})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.queue = queue = self._queue
        _input(m, self.i.stream, queue)
        _output(m, queue, self.o.stream)
        return m


class LossyFrameFifo(wiring.Component):
    """`AsyncFrameFifo` for a source that cannot wait: `i.stream.ready` is always high.

    What comes while the queue is full is lost, and with it the rest of its frame. Where the queue has some of that frame,
    its bad end follows as soon as there is room, and whatever comes before that is lost as well; the next frame is whole
    again. `drop_overflow` is high for one cycle of `o_domain` for each frame of which something was lost: a cycle of
    `o_domain` must be shorter than two frames' ends are apart.
    """

    def __init__(self, depth: int, i_domain: str, o_domain: str) -> None:
        self._queue = CrossingQueue(_WIDTH, depth, i_domain, o_domain)
        self._domains = i_domain, o_domain
        super().__init__({"i": In(FrameSignature()), "o": Out(FrameSignature()), "drop_overflow": Out(1)})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        i = self.i.stream
        i_domain, o_domain = self._domains
        m.submodules.queue = queue = self._queue
        m.submodules.lost = lost = PulseSynchronizer(i_domain, o_domain)
        m.d.comb += [i.ready.eq(1), self.drop_overflow.eq(lost.o)]
        _output(m, queue, self.o.stream)

        begun = Signal()  # the queue has some of the frame that is passing
        owed = Signal()  # the queue has some of a frame whose bad end did not fit
        m.d.comb += queue.w_data.eq(_pack(i.payload))
        with m.If(owed):
            m.d.comb += [queue.w_data.eq(0b1_0000_0001), queue.w_en.eq(1)]
            with m.If(queue.w_rdy):
                m.d[i_domain] += owed.eq(0)
        with m.FSM(domain=i_domain):
            with m.State("PASS"), m.If(i.valid):
                with m.If(queue.w_rdy & ~owed):
                    m.d.comb += queue.w_en.eq(1)
                    m.d[i_domain] += begun.eq(~i.payload.end)
                with m.Else():
                    m.d.comb += lost.i.eq(1)
                    m.d[i_domain] += begun.eq(0)
                    with m.If(begun):
                        m.d[i_domain] += owed.eq(1)
                    with m.If(~i.payload.end):
                        m.next = "DROP"
            with m.State("DROP"), m.If(i.valid & i.payload.end):
                m.next = "PASS"
        return m


class WholeFrameFifo(wiring.Component):
    """A queue of `depth` items, a power of two, within `sync`, that gives only whole frames whose ends are good: `i` to `o`.

    For what cannot be taken back once it has begun. Throughput one item a cycle at `i`, one in two cycles at `o`; a frame
    begins 3 cycles after its end was taken. Full, it makes `i` wait while it has a whole frame. A frame that ends badly, or
    has no octets, leaves nothing. One of `depth` octets or more can never be whole: it is dropped, and `drop_too_long` is
    high for one cycle where its end is good.
    """

    def __init__(self, depth: int) -> None:
        if depth < 2 or depth & (depth - 1):
            raise ValueError(f"a queue of whole frames has places for a power of two of items, not {depth}")
        self._depth = depth
        super().__init__({"i": In(FrameSignature()), "o": Out(FrameSignature()), "drop_too_long": Out(1)})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        i, o = self.i.stream, self.o.stream
        m.submodules.items = items = memory.Memory(shape=_WIDTH, depth=self._depth, init=[])
        write, read = items.write_port(), items.read_port()

        # One bit more than an address: the places between two of these are known by their difference.
        pointer = range(2 * self._depth)
        written, whole, taken = Signal(pointer), Signal(pointer), Signal(pointer)
        full, none = Signal(), Signal()
        m.d.comb += [
            full.eq((written ^ taken) == self._depth),
            none.eq(whole == taken),
            write.addr.eq(written),
            write.data.eq(_pack(i.payload)),
        ]
        with m.FSM():
            with m.State("PASS"):
                m.d.comb += [i.ready.eq(~full), write.en.eq(i.valid & ~full)]
                with m.If(write.en):
                    m.d.sync += written.eq(written + 1)
                    with m.If(i.payload.end):
                        with m.If(i.payload.bad | (written == whole)):
                            m.d.sync += written.eq(whole)
                        with m.Else():
                            m.d.sync += whole.eq(written + 1)
                with m.Elif(full & none & i.valid):
                    m.d.sync += written.eq(whole)
                    m.next = "DROP"
            with m.State("DROP"):
                m.d.comb += i.ready.eq(1)
                with m.If(i.valid & i.payload.end):
                    m.d.comb += self.drop_too_long.eq(~i.payload.bad)
                    m.next = "PASS"

        # An item is at `o` until it has been taken; only then the next is read.
        fetched = Signal()
        end = read.data[8]
        m.d.comb += [
            read.addr.eq(taken),
            read.en.eq(~none & ~fetched),
            o.valid.eq(fetched),
            o.payload.data.eq(read.data[:8]),
            o.payload.end.eq(end),
        ]
        m.d.sync += fetched.eq(~none & (~fetched | ~o.ready))
        with m.If(fetched & o.ready):
            m.d.sync += taken.eq(taken + 1)
        return m
