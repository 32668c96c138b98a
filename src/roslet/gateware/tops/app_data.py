"""The user's messages, as the manual has them: data that stand at ports, and a memory of octets. The manual, 4.2 and 4.3."""

from __future__ import annotations

from amaranth.hdl import C, Cat, Module, Signal, Value
from amaranth.lib import memory, wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.rtps.ports import USER
from roslet.gateware.words import MessageSignature


def _right(m: Module, req: Value, rel: Value, grant: Signal, wanted: Value, moving: Signal) -> Value:
    """Who may touch the data: the user while `grant` is high, the node while `moving` is, never both. High when the node's
    turn begins, which `wanted` asks for.

    The user has it in the cycle after `req`, if nobody else has. Where both want it, it goes to the node; and when the node
    has had it, to the user: so nobody waits for ever, however the other asks.
    """
    before = Signal()  # the node had it in the last cycle
    begins = Signal()
    m.d.sync += before.eq(moving)
    m.d.comb += begins.eq(wanted & ~grant & ~moving & ~(before & req))
    with m.If(grant):
        m.d.sync += grant.eq(~rel)
    with m.Elif(req & ~moving & ~begins):
        m.d.sync += grant.eq(1)
    return begins


class AppDataTx(wiring.Component):
    """Publishes what stands at `ros2_pub_app_data`, of `size` octets at most. The manual, 4.2.

    Ports: `req`, `rel`, `grant`, the right to change the data; `length`, in octets; `index`, which word of the data is
    wanted, which is `word` in the next cycle; `periodic`, high for a cycle when a message is due by the clock; `enable`;
    `o`, messages.

    A message is due when `periodic` says so, and, unless `on_change` is false, when the user gives back the right to change
    the data. It goes as soon as the user does not have that right, which is not given while a message is taken: it has
    the data of one moment. Messages that become due before one goes are one.

    The first word is valid 3 cycles after `rel`, a word each two cycles. Not sent: `drop_long`, a length above `size`. While
    `enable` is low nothing is due.
    """

    def __init__(self, size: int, on_change: bool = True) -> None:
        if not 1 <= size <= 255:
            raise ValueError(f"a message has 1 to 255 octets at most, not {size}")
        self._size, self._on_change = size, on_change
        words = (size + 3) // 4
        super().__init__(
            {
                "req": In(1),
                "rel": In(1),
                "grant": Out(1),
                "length": In(8),
                "index": Out(range(max(2, words))),
                "word": In(32),
                "periodic": In(1),
                "enable": In(1),
                "o": Out(MessageSignature()),
                "drop_long": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        o = self.o.stream
        due, moving = Signal(), Signal()
        begins = _right(m, self.req, self.rel, self.grant, due, moving)
        left = Signal(range((self._size + 3) // 4 + 1))
        m.d.comb += [o.payload.data.eq(self.word)]
        with m.If(begins):
            m.d.sync += due.eq(0)
        changed = self.grant & self.rel & C(self._on_change, 1)
        with m.If(self.periodic | changed):
            m.d.sync += due.eq(1)
        with m.If(~self.enable):
            m.d.sync += due.eq(0)
        with m.FSM() as fsm:
            m.d.comb += moving.eq(~fsm.ongoing("IDLE"))
            with m.State("IDLE"):
                m.d.sync += [self.index.eq(0), left.eq((self.length + 3)[2:])]
                with m.If(begins):
                    m.next = "LOOK"
                    with m.If(self.length > self._size):
                        m.d.comb += self.drop_long.eq(1)
                        m.next = "LONG"
            with m.State("LONG"):
                m.next = "IDLE"
            with m.State("LOOK"):
                m.next = "SEND"
            with m.State("SEND"):  # `word` is that of `index`, which stays until it is taken
                m.d.comb += [o.valid.eq(1), o.payload.end.eq(left == 0)]
                with m.If(left == 0):
                    m.d.comb += o.payload.padding.eq(C(0, 2) - self.length[:2])
                with m.If(o.ready):
                    m.d.sync += [self.index.eq(self.index + 1), left.eq(left - 1)]
                    m.next = "LOOK"
                    with m.If(left == 0):
                        m.next = "IDLE"
        return m


class AppDataRx(wiring.Component):
    """Writes messages of up to `size` octets into the user's memory. The manual, 3.6 and 4.3.

    Ports: `i`, messages; `room`, for whoever gives them (`Submessages`): a whole one can be taken; `enable`, none is while
    it is low; `addr`, `ce`, `we`, `wdata`, of the memory; `length` and `representation`, of the message in it; `req`,
    `rel`, `grant`, the right to read it; `recv`, there is a message that the user has not had the right to read: it falls
    when that right is given, or the next message is written.

    A message is kept here until it is known to be good, and until the user does not have the right to read the one before;
    that right is not given while it is written, an octet a cycle. So the memory never has parts of two messages while the
    user reads, and what was bad never touches it. `recv` rises 4 cycles, and one for each octet, after the end of the
    message, where the memory is free. What comes while one is kept is for whoever gives messages to drop: `room` is low.

    Good, and dropped whole: `drop_long`, more than `size` octets.
    """

    def __init__(self, size: int) -> None:
        if not 1 <= size <= 255:
            raise ValueError(f"a message has 1 to 255 octets at most, not {size}")
        self._size = size
        super().__init__(
            {
                "i": In(MessageSignature(USER)),
                "room": Out(1),
                "enable": In(1),
                "addr": Out(range(size)),
                "ce": Out(1),
                "we": Out(1),
                "wdata": Out(8),
                "length": Out(8),
                "representation": Out(16),
                "req": In(1),
                "rel": In(1),
                "grant": Out(1),
                "recv": Out(1),
                "drop_long": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        i = self.i.stream
        words = (self._size + 3) // 4
        m.submodules.kept = kept = memory.Memory(shape=32, depth=max(2, words), init=[])
        write, read = kept.write_port(), kept.read_port(domain="comb")
        full, moving = Signal(), Signal()
        judging = Signal()  # one has come whose end is good
        count, long = Signal(range(words + 1)), Signal()
        octets, too_long = Signal(9), Signal()  # of the one that is judged, or kept
        at = octets[:8]
        representation = Signal(16)
        begins = _right(m, self.req, self.rel, self.grant, full, moving)
        with m.If(self.req & ~moving & ~begins & ~self.grant):
            m.d.sync += self.recv.eq(0)

        # -- in
        came = i.valid & i.ready & ~i.payload.end
        m.d.comb += [
            self.room.eq(self.enable & i.ready),
            i.ready.eq(~full & ~judging),
            write.addr.eq(count),
            write.data.eq(i.payload.data),
            write.en.eq(came & (count != words)),
        ]
        with m.If(came):
            m.d.sync += [count.eq(count + (count != words)), long.eq(long | (count == words))]
        with m.If(i.valid & i.ready & i.payload.end):
            m.d.sync += [
                octets.eq(Cat(C(0, 2), count) - i.payload.padding),
                too_long.eq(long),
                representation.eq(self.i.meta.representation),
                judging.eq(~i.payload.bad),
                count.eq(0),
                long.eq(0),
            ]
        with m.If(judging):
            m.d.sync += judging.eq(0)
            with m.If(too_long | (octets > self._size)):
                m.d.comb += self.drop_long.eq(1)
            with m.Else():
                m.d.sync += full.eq(1)

        # -- out
        place = Signal(8)
        m.d.comb += [
            read.addr.eq(place[2:]),
            self.addr.eq(place),
            self.wdata.eq(read.data.word_select(place[:2], 8)),
        ]
        with m.FSM() as fsm:
            m.d.comb += moving.eq(~fsm.ongoing("IDLE"))
            with m.State("IDLE"):
                m.d.sync += place.eq(0)
                with m.If(begins):
                    m.d.sync += self.recv.eq(0)
                    m.next = "MOVE"
            with m.State("MOVE"):
                m.d.comb += [self.ce.eq(place != at), self.we.eq(place != at)]
                m.d.sync += place.eq(place + 1)
                with m.If(place == at):
                    m.d.sync += [
                        full.eq(0),
                        self.recv.eq(1),
                        self.length.eq(at),
                        self.representation.eq(representation),
                    ]
                    m.next = "IDLE"
        return m
