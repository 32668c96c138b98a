"""What submessages say: DATA, HEARTBEAT, ACKNACK, GAP. RTPS 2.3, 8.3.7 (meaning), 8.4 (behaviour), 9.4.5 (octets)."""

from __future__ import annotations

from amaranth.hdl import C, Cat, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out

from roslet.gateware.compare import below
from roslet.gateware.rtps import ports, tables
from roslet.gateware.rtps.inline_qos import skip_inline_qos
from roslet.gateware.rtps.ports import (
    DISCOVERY,
    KEEP,
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
from roslet.wire.rtps.number_set import MAX_BITS

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
    participants and user proxies that there are; `peers`, a read port, of which `fill_peers` says a cycle later that ones
    shall be given for what lies there, and `write`, whose data mean nothing while `en` is low; `keep`, the word at `i`, and
    at `discovery`, is of the key of something that is no more; `due`, something must be sent for a proxy.

    A message's words go out before it is known that its datagram is good, and its end says so. What is kept is changed
    only at a good end:

    - DATA of a peer's writer that matches: it is taken if its number is the one wanted next, or, from a writer that does not
      repeat, a later one. The first of all is taken whatever its number. The next one is wanted then.
      What a heartbeat told of and is still missing then, or is missing before a number that came too early, is asked for
      when the datagram is over: `due`.
    - HEARTBEAT: what is before its first is wanted no more; from a volatile writer that has not been heard, nothing that it
      covers is. `due` unless it is final and nothing is missing: an ACKNACK.
    - GAP that begins at or before what is wanted: what is behind the run that begins there is wanted next.
    - ACKNACK: what is acknowledged and asked for, from the first to the last of its set; of an empty one, from the next one
      to the first. `due`: that is sent.

    Good, and dropped: `drop_unmatched`, from a writer that matches none of our readers, or for another reader; `drop_old`, a
    number that we had or that was skipped; `drop_early`, a later number than the one wanted, from a writer that repeats it;
    `drop_busy`, no room (a reliable writer repeats it); `drop_invalid`, what RTPS calls so: a number below 1, a set of more
    than 256, octetsToInlineQos below 16, both data and key, no encapsulation header.

    Words are taken at once, but for some eight cycles before DATA's content, and one for each bit of a GAP's first word. A
    good end takes up to 18 cycles: what HEARTBEAT, GAP and ACKNACK say is looked at then.
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
                "fill_peers": Out(1),
                "write": Out(WriteSignature(peers.address_bits)),
                "keep": Out(KEEP),
                "due": Out(DueSignature(peers.proxy_bits)),
                **{f"drop_{name}": Out(1) for name in ("unmatched", "old", "early", "busy", "invalid")},
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        i, meta = self.i.stream, self.i.meta
        word, little = i.payload.data, meta.flags[0]
        came, ended, good, empty = Signal(), Signal(), Signal(), Signal()
        is_data, is_gap, is_heartbeat, is_acknack = (Signal() for _ in range(4))
        m.d.comb += [
            came.eq(i.valid & ~i.payload.end),
            ended.eq(i.valid & i.payload.end),
            good.eq(ended & ~i.payload.bad),
            empty.eq(word == 0),
            # Their lowest bits tell the four kinds apart.
            *(
                one.eq(meta.id[:2] == kind & 3)
                for one, kind in (
                    (is_data, submessage.DATA),
                    (is_gap, submessage.GAP),
                    (is_heartbeat, submessage.HEARTBEAT),
                    (is_acknack, submessage.ACKNACK),
                )
            ),
        ]

        # What is known of this submessage
        for_any = Signal()  # reader id unknown
        reader_number = Signal(8)  # as its entity id has it, from 1 on
        builtin, builtin_kind, spdp = Signal(), Signal(2), Signal()
        found = Signal()  # a proxy; `endpoint` is the user's
        endpoint = Signal(range(self._peers.endpoints))
        info = Signal(32)
        local = info[tables.INFO_LOCAL : tables.INFO_LOCAL + 8]
        ours = local[: max(1, (self._readers - 1).bit_length())]
        skip, odd = Signal(14), Signal()  # words, and one more; or the bits of a set
        nothing, wrong = Signal(), Signal()  # of a number, the high word; a number that there is not
        gone, has_key = Signal(), Signal()
        # It has been done, or why not; for none of these it is invalid.
        done, unmatched, old, early, busy = (Signal() for _ in range(5))
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

        # The id of the peer's endpoint is put aside, and in its place numbers as they come, the high word first: one, or
        # two. What was asked of `numbers` is in `kept` two cycles later, as with `peers`: of the first or the `second`, the
        # low word, or the `high` one.
        m.submodules.numbers = numbers = Memory(shape=32, depth=4, init=[], attrs={"ram_style": "block"})
        aside, asked = numbers.write_port(), numbers.read_port()
        of_endpoint = Signal()  # octets, whatever their order
        number = Mux(little | of_endpoint, word, exchanged(word))
        place = Signal(2)
        second, high = Signal(), Signal()
        kept, step = Signal(32), Signal(3)
        m.d.comb += [aside.addr.eq(place), aside.data.eq(number), asked.addr.eq(Cat(~high, second))]
        m.d.sync += kept.eq(asked.data)
        # It is compared with what `peers` gives, the low words first. In JUDGE it is the number that is wanted, or before
        # it; what is wanted is known; and the low word was compared with LAST, too. The same subtraction makes what is put,
        # `kept` + `summand`: where `peers` gives ones, it is of -1 - `summand`, and of one more with `lends`. What is put is
        # one higher without that, as is a high word, `put_high`, that the low one carries to.
        ones = Signal(6)  # that the set of a GAP begins with
        nothing_asked = Signal()  # by an ACKNACK
        putting, lends, put_high = (Signal() for _ in range(3))
        total, borrowed, difference, carried = Signal(32), Signal(), Signal(32), Signal()
        equal, begun = Signal(), Signal()
        same, behind, known = Signal(), Signal(), Signal()
        summand = Signal(8)
        m.d.comb += [
            Cat(Signal(), total, borrowed).eq(
                Cat(C(0, 1), kept)
                - Cat(
                    lends | (put_high & ~carried & ~nothing_asked),
                    self.peers.data & ~Cat(summand, C(0, 24)),
                )
            ),
            equal.eq(difference == 0),
        ]
        m.d.sync += [
            Cat(difference, carried).eq(Cat(total, ~borrowed)),
            same.eq(equal & (same | begun)),
            behind.eq(~carried | (equal & behind & ~begun)),
            lends.eq(0),
            put_high.eq(0),
        ]

        # A word of the proxy is read or written
        what = Signal(3)
        at = Mux(
            builtin,
            self._peers.builtin(meta.slot, builtin_kind, what),
            self._peers.endpoint(endpoint, what),
        )
        reading = Signal()
        scanned = Signal.like(self.peers.addr)
        m.d.comb += self.peers.addr.eq(Mux(reading, at, scanned))
        m.d.comb += self.write.data.eq(total)
        with m.If(putting):
            m.d.comb += [self.write.en.eq(1), self.write.addr.eq(at)]

        def take(state: str) -> None:
            """Take a word and go on; a body that ends here is dropped."""
            with m.If(came):
                m.d.comb += i.ready.eq(1)
                m.d.sync += skip.eq(skip - 1)
                m.next = state
            with m.If(ended):
                m.next = "DROP"

        def put(word: int) -> list[object]:
            return [putting.eq(1), what.eq(word)]

        m.d.comb += [
            self.user.meta.reader.eq(local),
            self.user.stream.payload.data.eq(word),
            self.discovery.stream.payload.eq(i.payload),
            self.discovery.meta.kind.eq(Mux(spdp, ports.PARTICIPANTS, builtin_kind - 1)),
            self.discovery.meta.known.eq(meta.known),
            self.discovery.meta.slot.eq(meta.slot),
            self.discovery.meta.gone.eq(gone),
            self.discovery.meta.has_key.eq(has_key),
        ]

        with m.FSM() as fsm:
            with m.State("IDLE"):
                with m.If(ended):
                    m.next = "DROP"
                with m.Elif(i.valid):
                    m.next = "READER"
                    with m.If(is_data):
                        m.next = "DATA"
                    with m.If(is_acknack):
                        m.next = "FIND"
            with m.State("DATA"):
                to_qos = Mux(little, word[16:32], Cat(word[24:32], word[16:24]))
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
                    m.next = "DROP"
            with m.State("READER"):
                m.d.sync += [for_any.eq(empty), reader_number.eq(word[16:24])]
                take("FIND")
                with m.If(came & is_acknack):
                    m.next = "NUMBERS"
            with m.State("FIND"):  # `word` is the id of the peer's endpoint
                m.d.comb += [of_endpoint.eq(1), aside.en.eq(1)]
                with m.If(came):
                    m.next = "SCAN"
                    with m.If(~meta.known):
                        m.next = "FOUND"
                    self._builtins(m, spdp, builtin, builtin_kind, found)
                with m.If(ended):
                    m.next = "DROP"
            find_endpoint(
                m,
                self._peers,
                scanned,
                self.peers.data,
                self.matched,
                word,
                meta.slot,
                ~is_acknack,
                endpoint,
                info,
                found,
                "FOUND",
                equal,
            )
            # The word that was looked for is there still. One reader of a peer matches one writer of ours: its id is
            # skipped.
            with m.State("FOUND"):
                take("NUMBERS")
                with m.If(came & is_acknack):
                    m.next = "READER"
            with m.State("NUMBERS"):
                take("NUMBERS")
                m.d.comb += aside.en.eq(1)
                with m.If(came):
                    m.d.sync += place.eq(place + 1)
                    with m.If(~place[0]):
                        m.d.sync += [nothing.eq(empty), wrong.eq(wrong | number[31])]
                    with m.Else():
                        m.d.sync += wrong.eq(wrong | (nothing & empty & ~place[1] & ~is_acknack))
                        with m.If(is_data):
                            m.next = "SKIP"
                        with m.Elif(place[1] | is_acknack):
                            m.next = "SET"
            # -- DATA
            qos = skip_inline_qos(m, i, meta, self.keep, take, gone, has_key, skip, odd)
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
                    m.next = "REST"
            with m.State("DISCOVERY"):
                m.d.comb += self.discovery.stream.valid.eq(i.valid)
                with m.If(~i.payload.end):
                    m.d.comb += i.ready.eq(self.discovery.stream.ready)
                with m.Elif(i.valid & self.discovery.stream.ready):
                    m.d.sync += done.eq(1)
                    m.next = "REST"
                    with m.If(spdp):
                        m.next = "DROP"
            # -- sets of numbers; a heartbeat's count is in the place of their size
            with m.State("SET"):
                take("REST")
                m.d.sync += skip.eq(number[:9])
                with m.If(came & ~is_heartbeat):
                    with m.If(is_gap):
                        m.next = "RUN"
                    with m.If(~below(number, MAX_BITS) & (number != MAX_BITS)):
                        m.next = "DROP"
            with m.State("RUN"):  # ones that the first word begins with; what is behind is asked for again
                bit = word.bit_select(Cat(~ones[:3], ones[3:5] ^ little.replicate(2)), 1)
                with m.If(came & (skip != 0) & ~ones[5] & bit):
                    m.d.sync += [ones.eq(ones + 1), skip.eq(skip - 1)]
                with m.Elif(i.valid):
                    m.next = "REST"
            # -- what is left of it is skipped, and at a good end it is done
            with m.State("REST"):
                m.d.comb += i.ready.eq(came)
                m.d.sync += [
                    nothing_asked.eq(is_acknack & (skip == 0)),
                    done.eq(found & ~wrong),
                    unmatched.eq(~wrong),
                ]
                with m.If(ended):
                    m.next = "COMPARE"
                    with m.If(is_data | is_acknack):
                        m.next = "PUT NEXT"
                    with m.If(is_acknack & (skip != 0)):
                        m.d.sync += skip.eq(skip - 1)
                    with m.If(~found | wrong | i.payload.bad):
                        m.next = "DROP"
            with m.State("COMPARE"):  # what is read in a step is there in the next but one
                m.d.comb += [
                    reading.eq(1),
                    what.eq(Cat(step[:2], 1)),
                    high.eq(step == 1),
                    begun.eq(step == 3),
                    self.fill_peers.eq(step[2]),
                ]
                m.d.sync += step.eq(step + 1)
                with m.If(step[1]):
                    m.d.sync += known.eq((known & step[0]) | (self.peers.data != 0))
                with m.If(step == 4):
                    m.d.sync += [step.eq(0), lends.eq(1)]  # a heartbeat's last is put next, as it is
                    m.next = "JUDGE"
                    with m.If(is_gap):
                        m.next = "JUDGE GAP"
                    with m.If(is_heartbeat):
                        m.next = "JUDGE HEARTBEAT"
            told = Signal()  # a heartbeat told of a number behind this one
            with m.State("JUDGE"):
                room = self.room.bit_select(ours, 1)
                m.d.sync += told.eq(difference[31])
                m.next = "DROP"
                with m.If(wrong):
                    m.next = "DROP"
                with m.Elif(spdp):
                    m.next = "DISCOVERY"
                with m.Elif(~found | (~builtin & ~for_any & (reader_number != ours + 1))):
                    m.d.sync += unmatched.eq(1)
                with m.Elif(behind):
                    m.d.sync += old.eq(1)
                with m.Elif(reliable & ~same & known):
                    m.d.sync += early.eq(1)
                with m.Elif(builtin):
                    m.next = "DISCOVERY"
                with m.Elif(~(meta.flags & data_submessage.FLAG_D).any()):
                    # It was disposed, or has no content: there is nothing to tell.
                    m.next = "REST"
                with m.Elif(~room):
                    m.d.sync += busy.eq(1)
                with m.Else():
                    m.next = "ENCAPSULATION"
            with m.State("JUDGE GAP"):  # it must begin at what is wanted or before
                m.d.sync += second.eq(1)
                m.next = "DROP"
                with m.If(~second & (same | behind)):
                    m.next = "COMPARE"
                with m.If(second & ~behind):
                    m.next = "PUT NEXT"
            with m.State("JUDGE HEARTBEAT"):  # by its first, then by its last
                m.next = "COMPARE"
                with m.If(second):
                    m.d.comb += put(tables.LAST)
                    m.d.comb += self.due.en.eq((~(meta.flags & FLAG_F).any() | ~behind) & reliable)
                    m.next = "DROP"
                with m.Elif(~known):
                    m.d.sync += second.eq(1)
                    m.next = "PUT NEXT"
                with m.Elif(behind):
                    m.d.sync += second.eq(1)
                with m.Else():
                    m.next = "PUT NEXT"
            # What is kept of a peer's reader lies where that of a writer does: ACKED, ASK_FROM and, put first, ASK_TO.
            with m.State("PUT NEXT"):
                m.d.comb += [
                    self.fill_peers.eq(1),
                    high.eq((step == 1) & ~is_acknack),
                    putting.eq(step[1] | (step[0] & is_acknack)),
                    what.eq(Mux(step[1], Cat(step[0], C(2, 2)), tables.LAST)),
                ]
                m.d.sync += [
                    step.eq(step + 1),
                    summand.eq(Mux(step[0], ones, skip)),  # of a GAP, of an ACKNACK
                    # A first number is put as it is, and a DATA's or a heartbeat's last one higher.
                    lends.eq((step == 0) | ((step == 1) & ~is_data & ~(is_heartbeat & second))),
                    put_high.eq(step == 2),
                ]
                with m.If(step[1]):
                    m.d.sync += summand.eq(0)
                with m.If(step == 3):
                    m.d.comb += self.due.en.eq(is_acknack & ~(nothing_asked & (meta.flags & FLAG_F).any()))
                    m.d.sync += [step.eq(0), second.eq(1)]
                    m.next = "DROP"
                    with m.If(is_heartbeat):
                        m.next = "COMPARE"
                    with m.If(is_data & reliable & told):
                        m.d.sync += [more.eq(1), more_proxy.eq(proxy)]
            with m.State("DROP"):
                m.d.comb += i.ready.eq(1)
                with m.If(ended):
                    m.next = "IDLE"
                with m.If(good):
                    m.d.comb += [
                        self.drop_unmatched.eq(unmatched & ~done),
                        self.drop_old.eq(old),
                        self.drop_early.eq(early),
                        self.drop_busy.eq(busy),
                        self.drop_invalid.eq(~(done | unmatched | old | early | busy)),
                    ]
                    with m.If(early):
                        m.d.sync += [more.eq(1), more_proxy.eq(proxy)]
        with m.If(fsm.ongoing("SCAN")):  # for the endpoint's id
            m.d.comb += high.eq(1)
        with m.If(fsm.ongoing("IDLE")):
            m.d.sync += [
                *(one.eq(0) for one in (builtin, spdp, found, gone, has_key, wrong, odd, *qos, endpoint)),
                *(one.eq(0) for one in (place, second, ones, done, unmatched, old, early, busy)),
            ]
        return m

    def _builtins(self, m: Module, spdp: Value, builtin: Value, kind: Value, found: Value) -> None:
        """Whether the word is the id of an endpoint of discovery, of a reader in an ACKNACK and of a writer elsewhere."""
        word, meta = self.i.stream.payload.data, self.i.meta
        with m.If(word == _SPDP_WRITER):
            m.d.sync += spdp.eq(1)
            m.next = "FOUND"
        for value, number in _BUILTINS.items():
            is_writer = number >= tables.PUBLICATIONS_WRITER
            with m.If((word == value) & ((meta.id != submessage.ACKNACK) == is_writer)):
                m.d.sync += [builtin.eq(1), kind.eq(number), found.eq(meta.known)]
                m.next = "FOUND"
