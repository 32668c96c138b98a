"""The walk over the submessages of a message. RTPS 2.3, 8.3.4 (rules), 9.4.4, 9.4.5.1 (octets)."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.compare import below
from roslet.gateware.rtps.ports import KEEP, READ_LATENCY, SUBMESSAGE, ReadSignature
from roslet.gateware.rtps.tables import OWN_PREFIX, PREFIX, SCRATCH_SOURCE, ZERO, OwnMap, PeerMap
from roslet.gateware.words import MessageSignature
from roslet.wire.rtps import header, submessage
from roslet.wire.rtps.guid import PROTOCOLVERSION_MAJOR

FORWARDED = (submessage.DATA, submessage.HEARTBEAT, submessage.ACKNACK, submessage.GAP)
FRAGMENTS = (submessage.DATA_FRAG, submessage.HEARTBEAT_FRAG, submessage.NACK_FRAG)

_PREFIX_WORDS = 3
_RTPS = int.from_bytes(header.PROTOCOL_RTPS, "little")
_INFO_SRC_BEFORE = 2
"""Words of INFO_SRC before the prefix: unused, version and vendor."""
_INFO_SRC_WORDS = _INFO_SRC_BEFORE + _PREFIX_WORDS
_COMPARED = READ_LATENCY + 1
"""Cycles from an address until what lies there has been compared."""


class Walker(wiring.Component):
    """Takes messages apart: gives the bodies of the submessages that are for us, one after another.

    Ports: `i`, messages; `known` and `good`, the verdict on the one that `i` gives (`DatagramQueue`); `o`, the words of a
    body, never more than its length says, and an end, with what its header says beside it; `alive`, which participants are
    known; `peers` and `own`, read ports; `keep`, the word at `i`, and at `o`, is of the sender's GUID prefix; `heard` is
    high for a cycle when something good came from participant `heard_slot`. `hold` keeps the next message waiting, and
    `idle` is high while none is taken.

    What is given are DATA, HEARTBEAT, ACKNACK and GAP, of messages to all or, by INFO_DST, to us. A good end is given only
    once it is known that the whole datagram is good: who has acted upon it need take nothing back. Where the datagram is
    bad, or ends within a submessage, so does the body.

    Throughput one word a cycle; a sender's prefix, and every INFO_SRC, takes 3 * (participants + 3) cycles, INFO_DST 15.

    Of good datagrams `drop_not_rtps`, `drop_version` (not 2.x), `drop_truncated` (ends within the header, or within a
    submessage by its length) drop what follows, as 8.3.4.1 has it; `drop_fragment` counts submessages that carry fragments.
    """

    def __init__(self, peers: PeerMap, own: OwnMap) -> None:
        self._peers, self._own = peers, own
        super().__init__(
            {
                "i": In(MessageSignature()),
                "known": In(1),
                "good": In(1),
                "o": Out(MessageSignature(SUBMESSAGE)),
                "alive": In(peers.participants),
                "peers": Out(ReadSignature(peers.address_bits)),
                "own": Out(ReadSignature(own.address_bits)),
                "keep": Out(KEEP),
                "heard": Out(1),
                "heard_slot": Out(8),
                "hold": In(1),
                "idle": Out(1),
                "drop_not_rtps": Out(1),
                "drop_version": Out(1),
                "drop_truncated": Out(1),
                "drop_fragment": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        i, o = self.i.stream, self.o.stream
        word = i.payload.data
        came, ended, taken = Signal(), Signal(), Signal()  # a word, not the end; the end; a word, now
        m.d.comb += [
            came.eq(i.valid & ~i.payload.end),
            ended.eq(i.valid & i.payload.end),
            taken.eq(came & i.ready),
        ]

        kind, flags = Signal(8), Signal(8)
        # Words of the submessage, less one: after the last its highest bit is set
        left, less = Signal(15, init=-1), Signal(15)
        length, begun = Signal(16), Signal()  # what `word` says if it is the header of one; it is that
        to_end = Signal()  # it goes to the end of the message
        tail = Signal(2)  # octets by which its length misses whole words
        for_us = Signal()
        slot, is_known = Signal(8), Signal()
        at = Signal(2)  # of the three words of a prefix
        step = Signal(range(self._peers.participants + _COMPARED + 1))  # of what is done with each
        whole, not_rtps, other_version = Signal(), Signal(), Signal()  # how the message ends
        m.d.comb += [
            self.o.meta.id.eq(kind),
            self.o.meta.flags.eq(flags),
            self.o.meta.known.eq(is_known),
            self.o.meta.slot.eq(slot),
            o.payload.data.eq(word),
            self.heard_slot.eq(slot),
            length.eq(Mux(word[8], word[16:32], Cat(word[24:32], word[16:24]))),
            less.eq(Mux(begun, length[2:], left) + (~begun | (length[:2] == 0)).replicate(len(left))),
        ]
        with m.If(taken):
            m.d.sync += left.eq(less)
        equals_own = Signal()
        m.d.sync += equals_own.eq(self.own.data == word)

        with m.FSM() as fsm:
            m.d.comb += self.idle.eq(fsm.ongoing("START"))
            with m.State("START"), m.If(i.valid & ~self.hold):
                m.next = "PROTOCOL"
            with m.State("PROTOCOL"):
                with m.If(ended):
                    m.next = "DROP"
                with m.Elif(i.valid):
                    m.d.comb += i.ready.eq(1)
                    m.next = "VERSION"
                    with m.If(word != _RTPS):
                        m.d.sync += not_rtps.eq(1)
                        m.next = "DROP"
            with m.State("VERSION"):
                with m.If(ended):
                    m.next = "DROP"
                with m.Elif(i.valid):
                    m.d.comb += i.ready.eq(1)
                    m.next = "PREFIX"
                    with m.If(word[:8] != PROTOCOLVERSION_MAJOR):
                        m.d.sync += other_version.eq(1)
                        m.next = "DROP"
            self._prefix(m, came, ended, at, step, slot, is_known)
            with m.State("SUBMESSAGE"):
                m.d.comb += begun.eq(1)
                m.d.sync += [
                    whole.eq(ended),
                    # It may have said before that it departs.
                    is_known.eq(is_known & self.alive.bit_select(slot, 1)),
                ]
                with m.If(ended):
                    m.next = "DROP"
                with m.Elif(i.valid):
                    m.d.comb += i.ready.eq(1)
                    m.d.sync += [
                        kind.eq(word[:8]),
                        flags.eq(word[8:16]),
                        tail.eq(-length[:2]),
                        to_end.eq(less[-1]),
                    ]
                    m.next = "SKIP"
                    with m.Switch(word[:8]):
                        with m.Case(submessage.INFO_DST):
                            m.next = "DESTINATION"
                        with m.Case(submessage.INFO_SRC):
                            m.next = "SOURCE"
                        with m.Case(submessage.PAD, submessage.INFO_TS):
                            m.d.sync += to_end.eq(0)
                        with m.Case(*FORWARDED), m.If(for_us):
                            m.next = "BODY"
                        with m.Case(*FRAGMENTS):
                            m.d.comb += self.drop_fragment.eq(for_us)
            with m.State("DESTINATION"):
                with m.If(left[-1] & ~to_end):  # it has less than a prefix
                    m.next = "SUBMESSAGE"
                with m.Else():
                    ours = self._compare_own(m, came, ended, at, step, equals_own, for_us)
            with m.State("SOURCE"):
                few = left[-1] | below(left[:-1], _INFO_SRC_WORDS - 1)  # words for it
                with m.If((at == 0) & few & ~to_end):
                    m.next = "SKIP"
                with m.Elif(came):
                    m.d.comb += i.ready.eq(1)
                    m.d.sync += at.eq(at + 1)
                    with m.If(at == _INFO_SRC_BEFORE - 1):
                        m.d.sync += at.eq(0)
                        m.next = "PREFIX"
                with m.If(ended):
                    m.next = "DROP"
            with m.State("BODY"):
                with m.If((left[-1] & ~to_end) | ended):
                    m.next = "BODY END"
                with m.Else():
                    m.d.comb += [o.valid.eq(i.valid), i.ready.eq(o.ready)]
            with m.State("BODY END"):
                padding = Mux(to_end, i.payload.padding, tail)
                missing = ~to_end & i.payload.end & (~left[-1] | (i.payload.padding > tail))
                settled = Signal()  # the item behind the body is there, which may be the end
                m.d.comb += [
                    settled.eq(self.known & i.valid),
                    o.payload.end.eq(1),
                    o.valid.eq(settled),
                    o.payload.bad.eq(~self.good | missing),
                    o.payload.padding.eq(Mux(o.payload.bad, 0, padding)),
                    self.heard.eq(settled & o.ready & ~o.payload.bad & is_known),
                ]
                with m.If(settled & o.ready):
                    m.next = "SUBMESSAGE"
                    with m.If(o.payload.bad):
                        m.next = "DROP"
            with m.State("SKIP"):
                with m.If(left[-1] & ~to_end):
                    m.next = "SUBMESSAGE"
                with m.Elif(ended):
                    m.d.sync += whole.eq(to_end)
                    m.next = "DROP"
                with m.Else():
                    m.d.comb += i.ready.eq(1)
            with m.State("DROP"):  # and the ordinary end, where nothing is left to be dropped
                m.d.comb += i.ready.eq(1)
                with m.If(ended):
                    m.next = "START"
                with m.If(ended & ~i.payload.bad):
                    m.d.comb += [
                        self.drop_not_rtps.eq(not_rtps),
                        self.drop_version.eq(other_version),
                        self.drop_truncated.eq(~(not_rtps | other_version | whole)),
                    ]
        with m.If(fsm.ongoing("START")):
            m.d.sync += [
                for_us.eq(1),
                left.eq(-1),
                to_end.eq(0),
                *(one.eq(0) for one in (whole, not_rtps, other_version)),
            ]
        with m.If(fsm.ongoing("START") | fsm.ongoing("SUBMESSAGE")):
            m.d.sync += [at.eq(0), step.eq(0), ours.eq(-1)]
        return m

    def _prefix(
        self, m: Module, came: Value, ended: Value, at: Value, step: Value, slot: Value, is_known: Value
    ) -> None:
        """Compare each word of a prefix, as it stands there, with that of each participant."""
        many = self._peers.participants
        i, word = self.i.stream, self.i.stream.payload.data
        match = Signal(many)  # so far; goes round with each word, the lowest bit is his whose word is there
        equal, same = Signal(), Signal()
        m.d.sync += equal.eq(self.peers.data == word)
        m.d.comb += same.eq(match[0] & equal)
        with m.State("PREFIX"):
            with m.If(ended):
                m.next = "DROP"
            with m.Elif(came):
                m.d.comb += self.peers.addr.eq(self._peers.participant(step, Cat(at, PREFIX)))
                m.d.sync += step.eq(step + 1)
                with m.If(step == 0):
                    m.d.comb += [
                        self.keep.en.eq(1),
                        self.keep.word.eq(SCRATCH_SOURCE + at),
                    ]
                    m.d.sync += is_known.eq(0)
                    with m.If(at == 0):
                        m.d.sync += match.eq(self.alive)
                with m.If(step >= _COMPARED):
                    m.d.sync += match.eq(Cat(match[1:], same))
                    with m.If(same):  # by the last word, it is who speaks
                        m.d.sync += [is_known.eq(1), slot.eq(step - _COMPARED)]
                with m.If(step == many + _COMPARED - 1):
                    m.d.comb += i.ready.eq(1)
                    m.d.sync += [step.eq(0), at.eq(at + 1)]
                    with m.If(at == _PREFIX_WORDS - 1):
                        m.next = "SKIP"

    def _compare_own(
        self, m: Module, came: Value, ended: Value, at: Value, step: Value, same: Value, for_us: Value
    ) -> Value:
        """INFO_DST: our prefix, or none (GUIDPREFIX_UNKNOWN), which is everybody. Each word is compared with ours, then with
        zero. Returns whether those until now were like that, two bits that must be set before."""
        ours = Signal(2, init=-1)
        m.d.comb += self.own.addr.eq(Mux(step[0], self._own.own(ZERO), self._own.own(OWN_PREFIX) + at))
        with m.If(came):
            m.d.sync += step.eq(step + 1)
            with m.If(step == _COMPARED):
                m.d.sync += ours[0].eq(ours[0] & same)
            with m.If(step == _COMPARED + 1):
                m.d.comb += self.i.stream.ready.eq(1)
                m.d.sync += [step.eq(0), ours[1].eq(ours[1] & same), at.eq(at + 1)]
                with m.If(at == _PREFIX_WORDS - 1):
                    m.d.sync += for_us.eq(ours[0] | (ours[1] & same))
                    m.next = "SKIP"
        with m.If(ended):
            m.next = "DROP"
        return ours
