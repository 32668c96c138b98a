"""What submessages say: DATA, HEARTBEAT, ACKNACK, GAP. RTPS 2.3, 8.3.7 (meaning), 8.4 (behaviour), 9.4.5 (octets)."""

from __future__ import annotations

from collections.abc import Callable

from amaranth.hdl import C, Cat, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.compare import below
from roslet.gateware.rtps import ports, tables
from roslet.gateware.rtps.ports import (
    DISCOVERY,
    SUBMESSAGE,
    USER,
    DueSignature,
    ReadSignature,
    WriteSignature,
    exchanged,
)
from roslet.gateware.rtps.scan import find_endpoint
from roslet.gateware.rtps.tables import OwnMap, PeerMap
from roslet.gateware.words import MessageSignature
from roslet.wire.rtps import data as data_submessage
from roslet.wire.rtps import guid, submessage
from roslet.wire.rtps.heartbeat import FLAG_F
from roslet.wire.rtps.inline_qos import STATUS_DISPOSED, STATUS_UNREGISTERED
from roslet.wire.rtps.number_set import MAX_BITS
from roslet.wire.rtps.parameter_list import PID_KEY_HASH, PID_SENTINEL, PID_STATUS_INFO

TO_INLINE_QOS = 16
"""octetsToInlineQos of what we know: reader, writer, sequence number."""


def entity(octets: bytes) -> int:
    """An entity id as a word has it."""
    return int.from_bytes(octets, "little")


_SPDP_WRITER = entity(guid.ENTITYID_SPDP_BUILTIN_PARTICIPANT_WRITER)
_BUILTINS = {
    entity(guid.ENTITYID_SEDP_BUILTIN_PUBLICATIONS_READER): tables.PUBLICATIONS_READER,
    entity(guid.ENTITYID_SEDP_BUILTIN_SUBSCRIPTIONS_READER): tables.SUBSCRIPTIONS_READER,
    entity(guid.ENTITYID_SEDP_BUILTIN_PUBLICATIONS_WRITER): tables.PUBLICATIONS_WRITER,
    entity(guid.ENTITYID_SEDP_BUILTIN_SUBSCRIPTIONS_WRITER): tables.SUBSCRIPTIONS_WRITER,
}


class Submessages(wiring.Component):
    """Does what submessages say, and gives away what DATA carry.

    Ports: `i`, bodies of submessages (`Walker`); `user`, messages for our readers; `discovery`, parameter lists of
    participants and endpoints; `room`, a bit for each of our readers: whoever takes its messages can take a whole one now,
    and waits with it for no longer than it takes to store; `over`, no datagram is passing; `alive`, `matched`, the
    participants and user proxies that there are; `peers`, a read port, and `write`; `due`, something must be
    sent for a proxy.

    A message's words go out before it is known that its datagram is good, and its end says so. What is kept is changed
    only at a good end:

    - DATA of a peer's writer that matches: it is taken if its number is the one wanted next, or, from a writer that does not
      repeat, a later one. The first of all is taken whatever its number. The next one is wanted then.
      What a heartbeat told of and is still missing then, or is missing before a number that came too early, is asked for
      when the datagram is over: `due`.
    - HEARTBEAT: what is before its first is wanted no more; from a volatile writer that has not been heard, nothing that it
      covers is. `due` unless it is final and nothing is missing: an ACKNACK.
    - GAP that begins at or before what is wanted: what is behind the run that begins there is wanted next.
    - ACKNACK: what is acknowledged and asked for, from the first to the last of its set. `due`: that is sent.

    Good, and dropped: `drop_unmatched`, from a writer that matches none of our readers, or for another reader; `drop_old`, a
    number that we had or that was skipped; `drop_early`, a later number than the one wanted, from a writer that repeats it;
    `drop_busy`, no room (a reliable writer repeats it); `drop_invalid`, what RTPS calls so: a number below 1, a set of more
    than 256, octetsToInlineQos below 16, both data and key, no encapsulation header.
    """

    def __init__(self, peers: PeerMap, own: OwnMap) -> None:
        self._peers = peers
        self._readers = max(1, len(own.readers))
        super().__init__(
            {
                "i": In(MessageSignature(SUBMESSAGE)),
                "user": Out(MessageSignature(USER)),
                "discovery": Out(MessageSignature(DISCOVERY)),
                "room": In(self._readers),
                "over": In(1),
                "alive": In(peers.participants),
                "matched": In(peers.endpoints),
                "peers": Out(ReadSignature(peers.address_bits)),
                "write": Out(WriteSignature(peers.address_bits)),
                "due": Out(DueSignature(peers.proxy_bits)),
                **{f"drop_{name}": Out(1) for name in ("unmatched", "old", "early", "busy", "invalid")},
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        i, meta = self.i.stream, self.i.meta
        word = i.payload.data
        number = Mux(meta.flags[0], word, exchanged(word))
        came, ended, good = Signal(), Signal(), Signal()
        is_data = meta.id == submessage.DATA
        m.d.comb += [
            came.eq(i.valid & ~i.payload.end),
            ended.eq(i.valid & i.payload.end),
            good.eq(ended & ~i.payload.bad),
        ]

        # What is known of this submessage
        sn, wanted = Signal(64), Signal(32)
        wanted_high = Signal(32)
        ahead = Signal(65)
        after, after_high = Signal(32), Signal(32)  # the number behind `sn`
        m.d.comb += [Cat(after, after_high).eq(sn + 1), ahead.eq(sn - Cat(wanted, wanted_high))]
        # A cycle after either has changed: the number is the one that is wanted, or before it; it is one; what is wanted is
        # known.
        same, behind, legal, known = Signal(), Signal(), Signal(), Signal()
        m.d.sync += [
            same.eq(ahead == 0),
            behind.eq(ahead[64]),
            legal.eq(~sn[63] & (sn != 0)),
            known.eq((wanted != 0) | (wanted_high != 0)),
        ]
        for_any = Signal()  # reader id unknown
        reader_number = Signal(8)  # from 0 on; in its entity id it is in the third octet, from 1 on
        builtin, builtin_kind, spdp = Signal(), Signal(2), Signal()
        found = Signal()  # a proxy; `endpoint` is the user's
        endpoint = Signal(range(self._peers.endpoints))
        info = Signal(32)
        skip = Signal(15)
        place, one = Signal(6), Signal()  # of a set, the bit that is looked at
        gone, has_key = Signal(), Signal()
        reason = Signal(2)  # why DATA is not taken
        unmatched, old, early, busy = range(4)
        last_lo = Signal(32)
        options = Signal(2)
        reliable = info[tables.INFO_RELIABLE] | builtin
        index = Mux(builtin, Cat(builtin_kind, meta.slot), endpoint)[: self._peers.index_bits]
        proxy = Cat(index, C(0, self._peers.index_bits - len(index)), ~builtin)
        # Is to be asked for when this datagram is over
        more, more_proxy = Signal(), Signal.like(self.due.proxy)
        m.d.comb += self.due.proxy.eq(proxy)
        with m.If(more & self.over):
            m.d.comb += [self.due.en.eq(1), self.due.proxy.eq(more_proxy)]
            m.d.sync += more.eq(0)

        def at(what: int | Value) -> Value:
            return Mux(
                builtin,
                self._peers.builtin(meta.slot, builtin_kind, what),
                self._peers.endpoint(endpoint, what),
            )

        def take(state: str) -> None:
            """Take a word and go on; a body that ends here is dropped."""
            with m.If(came):
                m.d.comb += i.ready.eq(1)
                m.next = state
            with m.If(ended):
                m.next = "INVALID"

        def put(what: int, value: Value) -> list[object]:
            return [self.write.en.eq(1), self.write.addr.eq(at(what)), self.write.data.eq(value)]

        m.d.comb += [
            self.user.meta.reader.eq(info[tables.INFO_LOCAL : tables.INFO_LOCAL + 8]),
            self.user.stream.payload.data.eq(word),
            self.discovery.stream.payload.eq(i.payload),
            self.discovery.meta.kind.eq(Mux(spdp, ports.PARTICIPANTS, builtin_kind - 1)),
            self.discovery.meta.known.eq(meta.known),
            self.discovery.meta.slot.eq(meta.slot),
            self.discovery.meta.gone.eq(gone),
            self.discovery.meta.has_key.eq(has_key),
        ]

        with m.FSM():
            with m.State("IDLE"):
                m.d.sync += [builtin.eq(0), spdp.eq(0), found.eq(0), gone.eq(0), has_key.eq(0), skip.eq(0)]
                with m.If(ended):
                    m.next = "INVALID"
                with m.Elif(i.valid):
                    m.next = "READER"
                    with m.If(is_data):
                        m.next = "DATA"
            with m.State("DATA"):
                to_qos = Mux(meta.flags[0], word[16:32], Cat(word[24:32], word[16:24]))
                take("READER")
                m.d.sync += skip.eq(to_qos[2:])
                both = meta.flags & (data_submessage.FLAG_D | data_submessage.FLAG_K)
                with m.If(
                    came
                    & (
                        below(to_qos, TO_INLINE_QOS)
                        | (to_qos[:2] != 0)
                        | (both == data_submessage.FLAG_D | data_submessage.FLAG_K)
                    )
                ):
                    m.next = "INVALID"
            with m.State("READER"):
                m.d.sync += [
                    for_any.eq(word == 0),
                    reader_number.eq(word[16:24] - 1),
                ]
                take("WRITER")
                with m.If(came & (meta.id == submessage.ACKNACK)):
                    m.d.comb += i.ready.eq(0)
                    m.next = "FIND"
            with m.State("WRITER"):
                with m.If(came):
                    m.next = "FIND"
                with m.If(ended):
                    m.next = "INVALID"
            writer = meta.id != submessage.ACKNACK  # it is from one
            with m.State("FIND"):  # `word` is the id of the peer's endpoint
                m.next = "SCAN"
                with m.If(~meta.known):
                    m.next = "FOUND"
                with m.If(word == _SPDP_WRITER):
                    m.d.sync += spdp.eq(1)
                    m.next = "FOUND"
                for value, kind in _BUILTINS.items():
                    with m.If((word == value) & (writer == kind // tables.PUBLICATIONS_WRITER)):
                        m.d.sync += [builtin.eq(1), builtin_kind.eq(kind), found.eq(meta.known)]
                        m.next = "FOUND"
            find_endpoint(
                m,
                self._peers,
                self.peers.addr,
                self.peers.data,
                self.matched,
                word,
                meta.slot,
                writer,
                endpoint,
                info,
                found,
                "FOUND",
            )
            with m.State("FOUND"):  # the word that was looked for is there still
                m.d.comb += [i.ready.eq(1), self.peers.addr.eq(at(tables.NEXT_LO))]
                m.next = "LOAD"
                with m.If(meta.id == submessage.ACKNACK):
                    m.next = "LOCAL WRITER"
            with m.State("LOCAL WRITER"):  # one reader of a peer matches one writer of ours
                take("SN HIGH")
            with m.State("LOAD"):
                m.d.comb += self.peers.addr.eq(at(tables.NEXT_HI))
                m.next = "LOAD LOW"
            with m.State("LOAD LOW"):
                m.d.comb += self.peers.addr.eq(at(tables.LAST))
                m.d.sync += wanted.eq(self.peers.data)
                m.next = "LOAD HIGH"
            with m.State("LOAD HIGH"):
                m.d.sync += wanted_high.eq(self.peers.data)
                m.next = "LOAD LAST"
            with m.State("LOAD LAST"):
                m.d.sync += last_lo.eq(self.peers.data)
                m.next = "SN HIGH"
            with m.State("SN HIGH"):
                m.d.sync += sn[32:].eq(number)
                take("SN LOW")
            with m.State("SN LOW"):
                m.d.sync += sn[:32].eq(number)
                with m.Switch(meta.id):
                    with m.Case(submessage.DATA):
                        take("EXTRA")
                    with m.Case(submessage.ACKNACK):
                        take("ACKNACK BITS")
                    with m.Default():
                        take("FIRST")
            # -- DATA
            with m.State("EXTRA"):
                with m.If(skip != TO_INLINE_QOS // 4):
                    with m.If(came):
                        m.d.sync += skip.eq(skip - 1)
                    take("EXTRA")
                with m.Elif(meta.flags & data_submessage.FLAG_Q):
                    m.next = "QOS"
                with m.Else():
                    m.next = "JUDGE"
            self._inline_qos(m, number, take, gone, has_key, skip)
            with m.State("JUDGE"):
                local = info[tables.INFO_LOCAL : tables.INFO_LOCAL + 8]
                room = self.room.bit_select(local[: max(1, (self._readers - 1).bit_length())], 1)
                for_us = for_any | (reader_number == local)
                m.next = "DROP"
                with m.If(~legal):
                    m.next = "INVALID"
                with m.Elif(spdp):
                    m.next = "DISCOVERY"
                with m.Elif(~found | (~builtin & ~for_us)):
                    m.d.sync += reason.eq(unmatched)
                with m.Elif(behind & known):
                    m.d.sync += reason.eq(old)
                with m.Elif(reliable & ~same & known):
                    m.d.sync += reason.eq(early)
                with m.Elif(builtin):
                    m.next = "DISCOVERY"
                with m.Elif(~(meta.flags & data_submessage.FLAG_D).any()):
                    # It was disposed, or has no content: there is nothing to tell.
                    m.next = "ADVANCE"
                with m.Elif(~room):
                    m.d.sync += reason.eq(busy)
                with m.Else():
                    m.next = "ENCAPSULATION"
            with m.State("ENCAPSULATION"):
                m.d.sync += [
                    self.user.meta.representation.eq(Cat(word[8:16], word[:8])),
                    options.eq(word[24:26]),
                ]
                take("USER")
            with m.State("USER"):
                user = self.user.stream
                m.d.comb += [
                    user.valid.eq(i.valid),
                    user.payload.end.eq(i.payload.end),
                    user.payload.bad.eq(i.payload.bad),
                    user.payload.padding.eq(
                        Mux(i.payload.padding != 0, i.payload.padding, Mux(good, options, 0))
                    ),
                ]
                with m.If(~i.payload.end):
                    m.d.comb += i.ready.eq(user.ready)
                with m.Elif(i.valid & user.ready):  # the end stays until it has been dealt with
                    m.next = "ADVANCE"
            with m.State("ADVANCE"):
                m.d.comb += i.ready.eq(came)
                m.d.sync += [wanted.eq(after), wanted_high.eq(after_high)]
                with m.If(good):
                    m.next = "WRITE LOW"
                with m.Elif(ended):
                    m.next = "INVALID"
            with m.State("WRITE LOW"):
                m.d.comb += put(tables.NEXT_LO, wanted)
                m.next = "WRITE HIGH"
            with m.State("WRITE HIGH"):
                m.d.comb += put(tables.NEXT_HI, wanted_high)
                m.d.comb += i.ready.eq(1)
                # Of what a heartbeat told of, there is more.
                with m.If(is_data & reliable & ~(last_lo - wanted)[31]):
                    m.d.sync += [more.eq(1), more_proxy.eq(proxy)]
                m.next = "IDLE"
            with m.State("DISCOVERY"):
                m.d.comb += self.discovery.stream.valid.eq(i.valid)
                with m.If(~i.payload.end):
                    m.d.comb += i.ready.eq(self.discovery.stream.ready)
                with m.Elif(i.valid & self.discovery.stream.ready):
                    m.next = "ADVANCE"
                    with m.If(spdp):
                        m.next = "TAKEN"
            with m.State("TAKEN"):
                m.d.comb += i.ready.eq(1)
                m.next = "IDLE"
            with m.State("DROP"):
                m.d.comb += i.ready.eq(1)
                with m.If(ended):
                    m.next = "IDLE"
                with m.If(good):
                    m.d.comb += [
                        self.drop_unmatched.eq(reason == unmatched),
                        self.drop_old.eq(reason == old),
                        self.drop_early.eq(reason == early),
                        self.drop_busy.eq(reason == busy),
                    ]
                    with m.If(found & (reason == early)):
                        m.d.sync += [more.eq(1), more_proxy.eq(proxy)]
            with m.State("INVALID"):
                m.d.comb += i.ready.eq(1)
                with m.If(ended):
                    m.d.comb += self.drop_invalid.eq(~i.payload.bad)
                    m.next = "IDLE"
            # -- HEARTBEAT and GAP: two numbers
            with m.State("FIRST"):
                m.next = "LAST HIGH"
            with m.State("LAST HIGH"):
                # What is kept aside is the lower first; a GAP's list has its base here.
                with m.If(~legal):
                    m.next = "INVALID"
                with m.Else():
                    # A GAP must begin here or before, and then moves what is wanted to where it ends; a HEARTBEAT at once.
                    with m.If((meta.id == submessage.HEARTBEAT) & known & ~behind):
                        m.d.sync += [wanted.eq(sn), wanted_high.eq(sn[32:])]
                    m.d.sync += skip[0].eq(same | behind)
                    with m.If(came):
                        m.d.sync += sn[32:].eq(number)
                    take("LAST LOW")
            with m.State("LAST LOW"):
                m.d.sync += [sn[:32].eq(number), place.eq(0)]
                take("COUNT")
                with m.If(came & (meta.id == submessage.GAP)):
                    m.next = "GAP BASE"
            with m.State("COUNT"):
                m.d.sync += last_lo.eq(sn[:32])
                with m.If(~known):
                    m.d.sync += [wanted.eq(after), wanted_high.eq(after_high)]
                take("COUNTED")
                with m.If(sn[63]):
                    m.next = "INVALID"
            with m.State("COUNTED"):
                m.next = "HEARD"
            with m.State("HEARD"):
                missing = ~behind
                with m.If(came | (ended & ~found)):
                    m.d.comb += i.ready.eq(1)
                with m.If(ended & ~found):
                    m.d.comb += self.drop_unmatched.eq(good)
                    m.next = "IDLE"
                with m.Elif(good):
                    m.d.comb += put(tables.LAST, last_lo)
                    m.d.comb += self.due.en.eq((~(meta.flags & FLAG_F).any() | missing) & reliable)
                    m.next = "WRITE LOW"
                with m.Elif(ended):
                    m.next = "INVALID"
            # -- sets of numbers, from `sn` on
            with m.State("GAP BASE"):
                m.next = "GAP BITS"
            with m.State("GAP BITS"):
                with m.If(skip[0] & known & ~behind):
                    m.d.sync += [wanted.eq(sn), wanted_high.eq(sn[32:])]
                self._bits(m, number, came, ended, skip, "GAP NEXT")
                with m.If(sn[63]):
                    m.next = "INVALID"
            with m.State("GAP SET"):
                # The run of ones at the beginning of the first word, a bit in two cycles; what is behind is asked for again.
                with m.If(came & (skip != 0) & ~place[5] & one & same):
                    m.d.sync += [
                        Cat(sn, wanted, wanted_high).eq(Cat(after, after_high, after, after_high)),
                        place.eq(place + 1),
                        skip.eq(skip - 1),
                    ]
                    m.next = "GAP NEXT"
                with m.Else():
                    m.d.comb += i.ready.eq(came)
                    with m.If(came):
                        m.d.sync += skip.eq(0)
                    with m.If(ended & ~found):
                        m.d.comb += [i.ready.eq(1), self.drop_unmatched.eq(good)]
                        m.next = "IDLE"
                    with m.Elif(good):
                        m.next = "WRITE LOW"
                    with m.Elif(ended):
                        m.next = "INVALID"
            with m.State("GAP NEXT"):
                m.d.sync += one.eq(number.bit_select(~place[:5], 1))
                with m.If(i.valid):
                    m.next = "GAP SET"
            with m.State("ACKNACK BITS"):
                self._bits(m, number, came, ended, skip, "ACKNACK SET")
            with m.State("ACKNACK SET"):
                m.d.comb += i.ready.eq(came)
                with m.If(ended):
                    m.next = "INVALID"
                with m.If(good & found):
                    m.d.comb += put(tables.ACKED, sn[:32])
                    m.next = "ASK FROM"
                with m.Elif(good):
                    m.d.comb += [i.ready.eq(1), self.drop_unmatched.eq(1)]
                    m.next = "IDLE"
            with m.State("ASK FROM"):
                m.d.comb += put(tables.ASK_FROM, sn[:32])
                m.d.sync += wanted.eq(sn[:32] + (skip[:9] - 1))
                m.next = "ASK TO"
            with m.State("ASK TO"):
                m.d.comb += put(tables.ASK_TO, wanted)
                m.d.comb += [self.due.en.eq((skip != 0) | ~(meta.flags & FLAG_F).any()), i.ready.eq(1)]
                m.next = "IDLE"
        return m

    def _inline_qos(
        self, m: Module, number: Value, take: Callable[[str], None], gone: Value, has_key: Value, skip: Value
    ) -> None:
        """STATUS_INFO and KEY_HASH; whatever else is there is skipped."""
        i, flags = self.i.stream, self.i.meta.flags
        word = i.payload.data
        came = i.valid & ~i.payload.end
        pid = Mux(flags[0], word[:16], Cat(word[8:16], word[:8]))
        length = Mux(flags[0], word[16:32], Cat(word[24:32], word[16:24]))
        is_status, is_key = Signal(), Signal()
        at = Signal(2)
        with m.State("QOS"):
            m.d.sync += [
                is_status.eq(pid == PID_STATUS_INFO),
                is_key.eq((pid == PID_KEY_HASH) & (length == 16)),
                skip.eq((length + 3)[2:]),
                at.eq(0),
            ]
            take("QOS VALUE")
            with m.If(came & (pid == PID_SENTINEL)):
                m.next = "JUDGE"
        with m.State("QOS VALUE"):
            with m.If(skip == 0):
                m.next = "QOS"
            with m.Else():
                take("QOS VALUE")
                with m.If(came):
                    m.d.sync += [
                        skip.eq(skip - 1),
                        at.eq(at + 1),
                        is_status.eq(0),
                        has_key.eq(has_key | is_key),
                    ]
                    with m.If(is_status):  # four octets, whose last has the flags, in whatever byte order
                        m.d.sync += gone.eq((word[24:32] & (STATUS_DISPOSED | STATUS_UNREGISTERED)).any())
                    with m.If(is_key):
                        m.d.comb += [
                            self.write.en.eq(1),
                            self.write.addr.eq(self._peers.scratch((tables.SCRATCH_KEY + at)[:4])),
                            self.write.data.eq(word),
                        ]

    def _bits(self, m: Module, number: Value, came: Value, ended: Value, skip: Value, state: str) -> None:
        """How many bits a set has, into `skip`."""
        i = self.i.stream
        with m.If(came):
            m.d.comb += i.ready.eq(1)
            m.d.sync += skip.eq(number[:9])
            m.next = state
            with m.If(~below(number, MAX_BITS + 1)):
                m.next = "INVALID"
        with m.If(ended):
            m.next = "INVALID"
