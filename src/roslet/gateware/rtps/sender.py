"""What is sent, when, and to whom. RTPS 2.3, 8.4 (behaviour of writers and readers), 8.5.3.2 (announcements)."""

from __future__ import annotations

from typing import Any

from amaranth.hdl import Array, C, Cat, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.rtps import tables
from roslet.gateware.rtps.composer import REGISTERS, SUBJECT
from roslet.gateware.rtps.ports import ReadSignature, WriteSignature
from roslet.gateware.rtps.rom import Rom
from roslet.gateware.rtps.tables import OwnMap, PeerMap
from roslet.gateware.words import MessageSignature
from roslet.wire.rtps import locator

GROUP = int.from_bytes(locator.SPDP_MULTICAST_ADDRESS, "little")


class Sender(wiring.Component):
    """Serves the proxies in turn, those for which something is due, and all of them when `sweep` is high for a cycle.

    Ports: `publish0` .. for each writer of the user, the first `users` of the tables' writers: its messages. `alive`,
    `matched`, `due`, `greet` as `Discovery` and `Submessages` have them, `due0`, `due1` one from each; `announce`, high for a
    cycle, has us announced to all at `group_port`; `peers` and `own`, read ports, and `write`; `template`, `start`, `done`, `registers`,
    `subject`, of the composer; `room`, `busy`, `finish`, `ip`, `port`, of the outbox; `writers`, `readers`, a bit
    for each of ours that is enabled.

    - When one is enabled or disabled, all of our endpoints are told of again, under new numbers: of those that are not enabled,
      that they are gone.
    - A message is kept, replacing the oldest that its writer keeps, and sent at once to each reader that matches, with a
      HEARTBEAT to those that are reliable.
    - A peer's writer gets an ACKNACK when it is due: what is missing up to its last, `window` of it at most, as peers put
      what they repeat into one datagram.
    - A peer's reader gets, when it is due, what it has asked for, of what is kept; a GAP for what is not; and a HEARTBEAT. In a
      sweep it gets a HEARTBEAT if it has not acknowledged everything.
    - A participant that is to be greeted gets our announcement, by itself.

    Dropped: `drop_long{n}`, a message of more words than its writer's.
    """

    def __init__(self, rom: Rom, peers: PeerMap, own: OwnMap, users: int, window: int = 3) -> None:
        self._window = window
        self._rom, self._peers, self._own, self._users = rom, peers, own, users
        super().__init__(
            {
                **{f"publish{n}": In(MessageSignature()) for n in range(users)},
                **{f"drop_long{n}": Out(1) for n in range(users)},
                "alive": In(peers.participants),
                "matched": In(peers.endpoints),
                **{
                    f"due{n}": In(wiring.Signature({"en": Out(1), "proxy": Out(range(peers.proxies))}))
                    for n in range(2)
                },
                "greet": In(1),
                "greet_slot": In(8),
                "announce": In(1),
                "sweep": In(1),
                "group_port": In(16),
                "peers": Out(ReadSignature(peers.address_bits)),
                "own": Out(ReadSignature(own.address_bits)),
                "write": Out(WriteSignature(own.address_bits)),
                "template": Out(range(len(rom.words))),
                "start": Out(1),
                "done": In(1),
                "registers": Out(REGISTERS),
                "subject": Out(SUBJECT),
                "room": In(1),
                "busy": In(1),
                "finish": Out(1),
                "ip": Out(32),
                "port": Out(16),
                **{
                    name: In(max(1, len(table)), init=(1 << max(1, len(table))) - 1)
                    for name, table in (("writers", own.writers), ("readers", own.readers))
                },
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        peers, own, rom = self._peers, self._own, self._rom
        many = peers.proxies
        registers, subject = self.registers, self.subject

        # Who is to be served
        due, greetings = Signal(many), Signal(peers.participants)
        cursor = Signal(range(many))
        left = Signal(range(many + 1))  # of a sweep
        asked = Signal()  # it was due, and not only its turn in a sweep
        announcing = Signal()
        served = Signal()
        with m.If(served):
            m.d.sync += due.bit_select(cursor, 1).eq(0)
        for source in (self.due0, self.due1):
            with m.If(source.en):
                m.d.sync += due.bit_select(source.proxy, 1).eq(1)
        with m.If(self.greet):
            m.d.sync += greetings.bit_select(self.greet_slot, 1).eq(1)

        # Whom it is about
        builtin, kind, slot = subject.builtin, subject.kind, subject.slot
        endpoint = subject.endpoint
        local = Signal(8)
        is_writer, reliable = Signal(), Signal()  # the peer's endpoint
        publishing = Signal()
        m.d.comb += subject.entity.eq(local + 1)

        # Numbers: of the writer, and of the reader that is served
        last, last_high = Signal(32), Signal(32)
        first, number = Signal(32), Signal(32)
        ask_from, ask_to, start = Signal(32), Signal(32), Signal(32)
        kept = Signal(16)
        acked = Signal(32)
        padding = Signal(2)
        m.d.comb += [
            registers.last.eq(last),
            registers.last_high.eq(last_high),
            registers.first.eq(first),
            # What is before the last number, and has a greater lower half, has a lower upper one.
            registers.first_high.eq(last_high - ((first > last) & (first != last + 1))),
            registers.number.eq(number),
            registers.number_high.eq(last_high - (number > last)),
            registers.encapsulation.eq(Cat(C(0x0100, 24), padding)),  # CDR_LE, and how many octets are not of it
        ]

        def behind(one: Value, other: Value) -> Value:
            """Whether `one` comes after `other`, by their difference."""
            return (other - one)[31]

        def writer_word(word: int) -> Value:
            return own.writer(local, word)

        def proxy_word(word: int) -> Value:
            return Mux(builtin, peers.builtin(slot, kind, word), peers.endpoint(endpoint, word))

        # -- composing: a template for `ip` and `port`, and then `after`
        after = Signal(4)
        states: list[str] = []

        def compose(template: Value | int, then: str) -> None:
            if then not in states:
                states.append(then)
            m.d.sync += [self.template.eq(template), after.eq(states.index(then))]
            m.next = "COMPOSE"

        sample = Signal(32)
        m.d.comb += subject.sample.eq(sample)
        strides = [own.stride(one) for one in own.writers] or [1]
        depths = [one.depth for one in own.writers] or [1]
        bases = own.samples or [0]

        def sample_of(sn: Value) -> Value:
            """Where a message lies."""
            places = [
                C(base) + (sn[: depth.bit_length() - 1] << (stride.bit_length() - 1))
                for base, stride, depth in zip(bases, strides, depths, strict=True)
            ]
            return Array(places)[local[: max(1, (len(places) - 1).bit_length())]]

        first_word = Mux(kind[0], own.own(tables.SUBSCRIPTIONS), own.own(tables.PUBLICATIONS))
        turn = Signal()
        streams = [getattr(self, f"publish{n}").stream for n in range(self._users)]
        pending = Cat(stream.valid for stream in streams) if streams else C(0)
        item: Any = None
        if streams:
            item = Array(streams)[local[: max(1, (len(streams) - 1).bit_length())]]
        words_kept = Signal(16)
        long = Signal()

        told = Signal(len(self.writers) + len(self.readers), init=-1)  # as peers have been told
        enabled = Cat(self.writers, self.readers)

        with m.FSM():
            with m.State("IDLE"):
                m.d.sync += [
                    cursor.eq(Mux(cursor == many - 1, 0, cursor + 1)),
                    turn.eq(0),
                    builtin.eq(cursor < tables.BUILTINS * peers.participants),
                    kind.eq(cursor),
                    slot.eq(cursor[2:]),
                    endpoint.eq(cursor - tables.BUILTINS * peers.participants),
                    publishing.eq(0),
                ]
                with m.If(left != 0):
                    m.d.sync += left.eq(left - 1)
                with m.If(enabled != told):
                    m.d.sync += [cursor.eq(cursor), left.eq(left), kind.eq(0)]
                    m.next = "CHANGED"
                with m.Elif(pending.any() & ~turn):
                    m.d.sync += [cursor.eq(cursor), left.eq(left), publishing.eq(1), builtin.eq(0)]
                    for n in reversed(range(self._users)):
                        with m.If(pending[n]):
                            m.d.sync += local.eq(n)
                    m.next = "PUBLISH"
                with m.Elif(due.bit_select(cursor, 1) | (left != 0)):
                    m.d.sync += [asked.eq(due.bit_select(cursor, 1)), cursor.eq(cursor)]
                    m.next = "SERVE"
                with m.Elif(greetings.any()):
                    for n in reversed(range(peers.participants)):
                        with m.If(greetings[n]):
                            m.d.sync += slot.eq(n)
                    m.d.sync += builtin.eq(1)
                    m.next = "GREET"
                with m.Elif(announcing):
                    m.next = "ANNOUNCE"
            # -- all endpoints are told of again, by new numbers: of writers, then of readers
            with m.State("CHANGED"):
                m.d.sync += told.eq(enabled)
                m.d.comb += self.own.addr.eq(first_word)
                m.next = "FROM"
            with m.State("FROM"):
                m.d.comb += self.own.addr.eq(first_word)
                m.next = "ON"
            with m.State("ON"):
                self._write(m, first_word, self.own.data + Mux(kind[0], len(own.readers), len(own.writers)))
                m.d.sync += kind.eq(1)
                m.next = "CHANGED"
                with m.If(kind[0]):
                    m.d.sync += left.eq(many)
                    m.next = "OVER"
            # -- announcements
            with m.State("ANNOUNCE"):
                m.d.sync += [announcing.eq(0), self.ip.eq(GROUP), self.port.eq(self.group_port)]
                m.d.comb += self.own.addr.eq(own.own(tables.SPDP_SN))
                m.next = "SPDP"
            with m.State("GREET"):
                m.d.sync += greetings.bit_select(slot, 1).eq(0)
                m.d.comb += self.peers.addr.eq(peers.participant(slot, tables.META_IP))
                m.next = "GREET IP"
            with m.State("GREET IP"):
                m.d.sync += self.ip.eq(self.peers.data)
                m.d.comb += self.peers.addr.eq(peers.participant(slot, tables.META_PORT))
                m.next = "GREET PORT"
            with m.State("GREET PORT"):
                m.d.sync += self.port.eq(self.peers.data)
                m.next = "SPDP"
            with m.State("SPDP"):  # the announcement never changes, nor does its number
                m.d.sync += [last.eq(1), last_high.eq(0), number.eq(1)]
                compose(rom.start["participant"], "IDLE")
            # -- a proxy: who, and where
            with m.State("SERVE"):
                m.d.comb += served.eq(asked)
                m.d.comb += self.peers.addr.eq(peers.endpoint(endpoint, tables.INFO))
                m.d.sync += cursor.eq(Mux(cursor == many - 1, 0, cursor + 1))
                m.next = "WHO"
                gone = Mux(builtin, ~self.alive.bit_select(slot, 1), ~self.matched.bit_select(endpoint, 1))
                with m.If(gone):
                    m.next = "OVER"
            with m.State("WHO"):
                info = self.peers.data
                with m.If(builtin):
                    m.d.sync += [is_writer.eq(kind[1]), reliable.eq(1)]
                    m.d.comb += self.peers.addr.eq(peers.participant(slot, tables.META_IP))
                with m.Else():
                    m.d.sync += [
                        is_writer.eq(info[tables.INFO_WRITER]),
                        reliable.eq(info[tables.INFO_RELIABLE]),
                        local.eq(info[tables.INFO_LOCAL : tables.INFO_LOCAL + 8]),
                        slot.eq(info[tables.INFO_SLOT : tables.INFO_SLOT + 8]),
                    ]
                    m.d.comb += self.peers.addr.eq(peers.endpoint(endpoint, tables.IP))
                m.next = "IP"
            with m.State("IP"):
                m.d.sync += self.ip.eq(self.peers.data)
                m.d.comb += self.peers.addr.eq(
                    Mux(
                        builtin,
                        peers.participant(slot, tables.META_PORT),
                        peers.endpoint(endpoint, tables.PORT),
                    )
                )
                m.next = "PORT"
            with m.State("PORT"):
                m.d.sync += self.port.eq(self.peers.data)
                m.d.comb += self.peers.addr.eq(proxy_word(tables.NEXT_LO))
                m.next = "OVER"
                with m.If(is_writer & asked):
                    m.next = "WANTED"
                with m.If(~is_writer & reliable):
                    m.next = "ACKED"
            # -- a peer's writer
            with m.State("WANTED"):
                m.d.sync += first.eq(self.peers.data)
                m.d.comb += self.peers.addr.eq(proxy_word(tables.LAST))
                m.next = "MISSING"
                with m.If(self.peers.data == 0):
                    m.next = "OVER"  # nothing has been heard of it
            with m.State("MISSING"):
                missing = Signal(32)
                m.d.comb += missing.eq(self.peers.data - first + 1)
                for n in range(min(self._window, 32)):
                    m.d.sync += registers.bitmap[31 - n].eq(~missing[31] & (missing > n))
                m.d.comb += self.own.addr.eq(own.own(tables.ACKNACK_COUNT))
                m.next = "ACKNACK"
            with m.State("ACKNACK"):
                m.d.sync += registers.count.eq(self.own.data + 1)
                self._write(m, own.own(tables.ACKNACK_COUNT), self.own.data + 1)
                compose(
                    Mux(
                        builtin,
                        Mux(kind[0], rom.start["subscription_acknack"], rom.start["publication_acknack"]),
                        rom.start["acknack"],
                    ),
                    "OVER",
                )
            # -- a peer's reader
            with m.State("ACKED"):
                m.d.sync += acked.eq(self.peers.data)
                m.d.comb += self.peers.addr.eq(proxy_word(tables.ASK_FROM))
                m.d.comb += self.own.addr.eq(
                    Mux(
                        builtin,
                        Mux(kind[0], own.own(tables.SUBSCRIPTIONS), own.own(tables.PUBLICATIONS)),
                        writer_word(tables.WRITER_COUNT),
                    )
                )
                m.next = "ASK FROM"
            with m.State("ASK FROM"):
                m.d.sync += [ask_from.eq(self.peers.data), first.eq(self.own.data), kept.eq(self.own.data)]
                m.d.comb += self.peers.addr.eq(proxy_word(tables.ASK_TO))
                m.d.comb += self.own.addr.eq(writer_word(tables.WRITER_LAST))
                m.next = "ASK TO"
            with m.State("ASK TO"):
                m.d.sync += ask_to.eq(self.peers.data)
                m.d.sync += last.eq(
                    Mux(
                        builtin,
                        first + Mux(kind[0], len(own.readers) - 1, len(own.writers) - 1),
                        self.own.data,
                    )
                )
                m.d.comb += self.peers.addr.eq(proxy_word(tables.START))
                m.d.comb += self.own.addr.eq(writer_word(tables.WRITER_LAST_HI))
                m.next = "START"
            with m.State("START"):
                m.d.sync += start.eq(Mux(builtin, first, self.peers.data))
                m.d.sync += last_high.eq(Mux(builtin, 0, self.own.data))
                with m.If(~builtin):
                    m.d.sync += first.eq(last - kept + 1)
                m.next = "RANGE"
            with m.State("RANGE"):
                with m.If(behind(start, first)):
                    m.d.sync += first.eq(start)
                m.next = "JUDGE"
            with m.State("JUDGE"):
                m.d.sync += number.eq(ask_from)
                with m.If(behind(ask_to, last)):
                    m.d.sync += ask_to.eq(last)
                m.next = "OVER"
                with m.If(asked):
                    m.next = "RESEND"
                    with m.If(behind(first, ask_from)):
                        m.d.sync += ask_from.eq(first)
                        with m.If(~behind(ask_from, ask_to) & ~behind(start, ask_from) & ~builtin):
                            compose(rom.start["gap"], "RESEND")
                with m.Elif(~behind(acked, last)):
                    m.next = "HEARTBEAT"
            with m.State("RESEND"):
                m.d.sync += number.eq(ask_from)
                m.next = "AGAIN"
            with m.State("AGAIN"):
                index = (number - first)[:8]
                m.d.comb += self.own.addr.eq(sample_of(number))
                m.d.sync += sample.eq(sample_of(number))
                m.next = "SAMPLE"
                with m.If(behind(number, ask_to)):
                    m.next = "HEARTBEAT"
                with m.Elif(builtin):
                    m.d.sync += local.eq(index)
                    m.next = "DISCOVERY"
            with m.State("DISCOVERY"):
                starts = [
                    Array(
                        C(rom.start[f"{name}{n}"]) for n in range(len(table))
                    )[local[: max(1, (len(table) - 1).bit_length())]]
                    if table
                    else C(0)
                    for name, table in (("publication", own.writers), ("subscription", own.readers))
                ]
                gone = rom.start["publication_gone"], rom.start["subscription_gone"]
                here = (bits.bit_select(local[: len(bits).bit_length()], 1) for bits in (self.writers, self.readers))
                told_of = [Mux(bit, start, C(end)) for bit, start, end in zip(here, starts, gone, strict=True)]
                compose(Mux(kind[0], told_of[1], told_of[0]), "NEXT")
            with m.State("SAMPLE"):
                m.d.sync += [subject.words.eq(self.own.data[:16]), padding.eq(self.own.data[16:18])]
                compose(rom.start["message"], "NEXT")
            with m.State("NEXT"):
                m.d.sync += number.eq(number + 1)
                m.next = "AGAIN"
            with m.State("HEARTBEAT"):
                m.d.comb += self.own.addr.eq(own.own(tables.HEARTBEAT_COUNT))
                m.next = "COUNT"
            with m.State("COUNT"):
                m.d.sync += registers.count.eq(self.own.data + 1)
                self._write(m, own.own(tables.HEARTBEAT_COUNT), self.own.data + 1)
                with m.If(publishing):
                    compose(rom.start["message_heartbeat"], "NEXT READER")
                with m.Else():
                    compose(
                        Mux(
                            builtin,
                            Mux(
                                kind[0],
                                rom.start["subscription_heartbeat"],
                                rom.start["publication_heartbeat"],
                            ),
                            rom.start["heartbeat"],
                        ),
                        "OVER",
                    )
            with m.State("OVER"):
                m.d.sync += turn.eq(0)
                m.next = "IDLE"
            # -- a message of the user's
            if streams:
                self._publish(
                    m, item, streams, local, endpoint, slot, last, last_high, first, kept, number, sample,
                    sample_of, words_kept, padding, long, reliable, behind, compose, writer_word, turn,
                )  # fmt: skip
            with m.State("COMPOSE"):
                with m.If(self.room & ~self.busy):
                    m.d.comb += self.start.eq(1)
                    m.next = "COMPOSING"
            with m.State("COMPOSING"):
                m.d.comb += self.finish.eq(self.done)
                with m.If(self.done):
                    with m.Switch(after):
                        for n, state in enumerate(states):
                            with m.Case(n):
                                m.next = state
        with m.If(self.announce):
            m.d.sync += announcing.eq(1)
        with m.If(self.sweep):
            m.d.sync += left.eq(many)
        return m

    def _write(self, m: Module, address: Value | int, value: Value) -> None:
        m.d.comb += [self.write.en.eq(1), self.write.addr.eq(address), self.write.data.eq(value)]

    def _publish(
        self, m: Module, item: Any, streams: Any, local: Any, endpoint: Any, slot: Any, last: Any, last_high: Any, first: Any,
        kept: Any, number: Any, sample: Any, sample_of: Any, words_kept: Any, padding: Any, long: Any, reliable: Any,
        behind: Any, compose: Any, writer_word: Any, turn: Any,
    ) -> None:  # fmt: skip
        peers, own, rom, subject = self._peers, self._own, self._rom, self.subject
        limits = Array(C(one.words, 16) for one in own.writers)
        depths = Array(C(one.depth, 16) for one in own.writers)
        index = local[: max(1, (len(own.writers) - 1).bit_length())]
        with m.State("PUBLISH"):
            m.d.comb += self.own.addr.eq(writer_word(tables.WRITER_LAST))
            m.d.sync += [words_kept.eq(0), long.eq(0)]
            m.next = "LAST"
        with m.State("LAST"):
            m.d.sync += [last.eq(self.own.data + 1), number.eq(self.own.data + 1)]
            m.d.comb += self.own.addr.eq(writer_word(tables.WRITER_LAST_HI))
            m.next = "LAST HIGH"
        with m.State("LAST HIGH"):
            m.d.sync += [last_high.eq(self.own.data + (last == 0)), sample.eq(sample_of(number))]
            m.d.comb += self.own.addr.eq(writer_word(tables.WRITER_COUNT))
            m.next = "KEPT"
        with m.State("KEPT"):
            m.d.sync += kept.eq(Mux(self.own.data[:16] == depths[index], self.own.data[:16], self.own.data[:16] + 1))
            m.next = "KEEP"
        with m.State("KEEP"):
            full = words_kept == limits[index]
            for n, stream in enumerate(streams):
                with m.If(local == n):
                    m.d.comb += stream.ready.eq(1)
            m.d.sync += padding.eq(item.payload.padding)
            m.d.sync += first.eq(last - kept + 1)
            with m.If(item.valid & ~item.payload.end):
                m.d.sync += words_kept.eq(words_kept + ~full)
                self._write(m, sample + 1 + words_kept, item.payload.data)
                with m.If(full):
                    m.d.comb += self.write.en.eq(0)
                    m.d.sync += long.eq(1)
            with m.If(item.valid & item.payload.end):
                m.next = "SIZE"
                with m.If(item.payload.bad | long):
                    for n in range(self._users):
                        m.d.comb += getattr(self, f"drop_long{n}").eq((local == n) & ~item.payload.bad)
                    m.d.sync += turn.eq(1)
                    m.next = "IDLE"
        with m.State("SIZE"):
            self._write(m, sample, Cat(words_kept, padding))
            m.d.sync += [subject.words.eq(words_kept), endpoint.eq(0)]
            m.next = "STORE"
        with m.State("STORE"):
            self._write(m, writer_word(tables.WRITER_LAST), last)
            m.next = "STORE HIGH"
        with m.State("STORE HIGH"):
            self._write(m, writer_word(tables.WRITER_LAST_HI), last_high)
            m.next = "STORE KEPT"
        with m.State("STORE KEPT"):
            self._write(m, writer_word(tables.WRITER_COUNT), kept)
            m.d.comb += self.peers.addr.eq(peers.endpoint(endpoint, tables.INFO))
            m.next = "READER"
        with m.State("READER"):
            info = self.peers.data
            m.d.sync += [
                slot.eq(info[tables.INFO_SLOT : tables.INFO_SLOT + 8]),
                reliable.eq(info[tables.INFO_RELIABLE]),
                first.eq(last - kept + 1),
            ]
            ours = (
                self.matched.bit_select(endpoint[: peers.endpoint_bits], 1)
                & ~info[tables.INFO_WRITER]
                & (info[tables.INFO_LOCAL : tables.INFO_LOCAL + 8] == local)
            )
            m.d.comb += self.peers.addr.eq(peers.endpoint(endpoint, tables.IP))
            m.next = "READER IP"
            with m.If(~ours):
                m.d.comb += self.peers.addr.eq(peers.endpoint(endpoint + 1, tables.INFO))
                m.d.sync += endpoint.eq(endpoint + 1)
                m.next = "READER"
                with m.If(endpoint == peers.endpoints - 1):
                    m.d.sync += turn.eq(1)
                    m.next = "IDLE"
        with m.State("READER IP"):
            m.d.sync += self.ip.eq(self.peers.data)
            m.d.comb += self.peers.addr.eq(peers.endpoint(endpoint, tables.PORT))
            m.next = "READER PORT"
        with m.State("READER PORT"):
            m.d.sync += self.port.eq(self.peers.data)
            m.d.comb += self.peers.addr.eq(peers.endpoint(endpoint, tables.START))
            m.next = "READER START"
        with m.State("READER START"):
            with m.If(behind(self.peers.data, first)):
                m.d.sync += first.eq(self.peers.data)
            with m.If(reliable):
                m.next = "HEARTBEAT"
            with m.Else():
                compose(rom.start["message"], "NEXT READER")
        with m.State("NEXT READER"):
            m.d.sync += endpoint.eq(endpoint + 1)
            m.d.comb += self.peers.addr.eq(peers.endpoint(endpoint + 1, tables.INFO))
            m.next = "READER"
            with m.If(endpoint == peers.endpoints - 1):
                m.d.sync += turn.eq(1)
                m.next = "IDLE"
