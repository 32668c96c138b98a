"""Who is there, and which of their endpoints match ours: SPDP and SEDP. RTPS 2.3, 8.5.3, 8.5.4; DDS 1.4, 2.2.3."""

from __future__ import annotations

from amaranth.hdl import C, Cat, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from roslet.gateware.meta import ADDRESSES
from roslet.gateware.rtps import ports, tables
from roslet.gateware.rtps.parameters import Parameters
from roslet.gateware.rtps.ports import (
    DISCOVERY,
    KEEP,
    READ_LATENCY,
    DueSignature,
    ReadSignature,
    WriteSignature,
)
from roslet.gateware.rtps.scan import find_endpoint
from roslet.gateware.rtps.tables import MAX_HISTORY, OwnMap, PeerMap
from roslet.gateware.words import MessageSignature
from roslet.wire.rtps.qos import TRANSIENT_LOCAL, VOLATILE


class Discovery(wiring.Component):
    """The table of participants, and that of their endpoints that match ours.

    Ports: `i`, parameter lists (`Submessages`); `alive` and `matched`, a bit for each participant and user proxy there is;
    `peers`, `own`, read ports, and `write`; `keep`, as `Parameters` has it; `addresses`, `group_port`, `domain`, ours;
    `heard` with `heard_slot`, a sign of life, for a cycle in which no list is done; `tick`, high for a cycle each second;
    `hold` and `idle`, of the walker, which waits while leases are looked at; `due`, something must be sent for a proxy;
    `greet` with `greet_slot`, this participant must hear of us, as it is new.

    - A participant that announces itself has the first free slot, with proxies of its discovery endpoints, from which all
      is wanted and to which all is sent. Its next announcements, in other datagrams, move it. It goes, and its endpoints
      with it, when it says so or when nothing good was heard of it for its lease, and two or three seconds.
    - An endpoint whose topic and type are one of ours, and whose QoS agrees, gets a proxy; one that we know moves, or goes
      where it agrees no more. It goes when it is disposed. Our endpoints' QoS other than reliability and durability are the
      defaults.

    Nobody alive makes room for somebody new. Good, and dropped: `drop_full`, no free slot or proxy; `drop_incomplete`, what
    makes a participant or endpoint is not all there; `drop_refused`, another domain; `drop_qos`, the topic and type are
    ours, and the QoS does not agree; and `drop_malformed` of `Parameters`.
    """

    def __init__(self, peers: PeerMap, own: OwnMap, judge_domain: bool = True) -> None:
        self._peers, self._own = peers, own
        self._parameters = Parameters(peers, own, judge_domain)
        super().__init__(
            {
                "i": In(MessageSignature(DISCOVERY)),
                "alive": Out(peers.participants),
                "matched": Out(peers.endpoints),
                "peers": Out(ReadSignature(peers.address_bits)),
                "own": Out(ReadSignature(own.address_bits)),
                "write": Out(WriteSignature(peers.address_bits)),
                "keep": In(KEEP),
                "addresses": In(ADDRESSES),
                "group_port": In(16),
                "domain": In(8),
                "heard": In(1),
                "heard_slot": In(8),
                "tick": In(1),
                "hold": Out(1),
                "idle": In(1),
                "due": Out(DueSignature(peers.proxy_bits)),
                "greet": Out(1),
                "greet_slot": Out(8),
                **{f"drop_{name}": Out(1) for name in ("full", "incomplete", "refused", "qos", "malformed")},
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        peers = self._peers
        m.submodules.parameters = parameters = self._parameters
        connect(m, flipped(self.i), parameters.i)
        read, meta = parameters.read, self.i.meta
        is_participant = meta.kind == ports.PARTICIPANTS

        # Who comes and goes, and gives a sign of life, or is silent again
        self._joins, self._parts, self._comes, self._goes, silent = (Signal() for _ in range(5))
        heard, who = Signal(peers.participants), Signal(peers.slot_bits)
        # Whom it is about
        self._slot = slot = Signal(range(peers.participants + 1))
        self._endpoint, self._found = Signal(range(peers.endpoints)), Signal()
        self._entity, info = Signal(32), Signal(32)
        self._step = step = Signal(range(max(16, peers.endpoints) + READ_LATENCY))
        self._counts = counts = Signal()  # the step grows; else it is 0
        # What the memory gives next, and now
        addressed, before = Signal.like(step), Signal.like(step)
        self._before = before
        ticked, sweeping = Signal(), Signal()
        arrived = Signal()  # in this datagram somebody, who is not known by its walker yet
        with m.If(self.idle):
            m.d.sync += arrived.eq(0)
        with m.If(self.greet):
            m.d.sync += arrived.eq(1)
        m.d.sync += [step.eq(step + 1), addressed.eq(step), before.eq(addressed)]
        with m.If(~counts):
            m.d.sync += step.eq(0)
        with m.If(self.tick):
            m.d.sync += ticked.eq(1)
        current = slot[: len(who)]
        m.d.comb += who.eq(Mux(self.heard, self.heard_slot, current))
        for bits, number, rise, fall in (
            (self.matched, self._endpoint, self._joins, self._parts),
            (self.alive, current, self._comes, self._goes),
            (heard, who, self.heard | self._comes, silent),
        ):
            with m.If(rise | fall):
                m.d.sync += bits.bit_select(number, 1).eq(rise)
        m.d.comb += [
            parameters.keep.eq(self.keep),
            parameters.addresses.eq(self.addresses),
            parameters.group_port.eq(self.group_port),
            parameters.domain.eq(self.domain),
            self.drop_malformed.eq(parameters.drop_malformed),
            parameters.own.data.eq(self.own.data),
            parameters.peers.data.eq(self.peers.data),
            self.greet_slot.eq(slot),
        ]
        # Our own use of the memories, by turns with that of the parameters
        self._address, self._own_address = Signal(peers.address_bits), Signal(self._own.address_bits)
        m.d.comb += [
            self.peers.addr.eq(self._address | parameters.peers.addr),
            self.own.addr.eq(self._own_address | parameters.own.addr),
        ]
        self._writing(m)

        with m.FSM() as fsm:
            m.d.comb += self.hold.eq((fsm.ongoing("IDLE") & ticked) | sweeping)
            with m.State("IDLE"):
                m.d.sync += [self._found.eq(0), slot.eq(meta.slot)]
                with m.If(parameters.done):  # then nobody else asks, whatever follows
                    m.d.comb += self._address.eq(peers.scratch(tables.SCRATCH_ENTITY))
                with m.If(ticked & self.idle):
                    m.d.sync += [ticked.eq(0), sweeping.eq(1), slot.eq(0)]
                    m.next = "SWEEP"
                with m.Elif(parameters.done & is_participant):
                    m.next = "PARTICIPANT"
                with m.Elif(parameters.done):
                    m.next = "KEY"
            with m.State("PROCEED"):
                m.d.comb += parameters.proceed.eq(1)
                m.next = "IDLE"
            self._participant(m, arrived)
            with m.State("KEY"):
                m.next = "ENTITY"
            with m.State("ENTITY"):
                m.next = "SCAN"
                m.d.sync += self._entity.eq(self.peers.data)
                with m.If(~read.guid & ~(meta.gone & meta.has_key)):
                    m.d.comb += self.drop_incomplete.eq(1)
                    m.next = "PROCEED"
            find_endpoint(
                m,
                peers,
                self._address,
                self.peers.data,
                self.matched,
                self._entity,
                meta.slot[: len(slot)],
                meta.kind == ports.PUBLICATIONS,
                self._endpoint,
                info,
                self._found,
                "ENDPOINT",
            )
            self._match(m)
            # -- who is silent
            with m.State("SWEEP"):
                m.d.comb += self._address.eq(peers.participant(slot, tables.LEASE))
                with m.If(slot == peers.participants):
                    m.d.sync += sweeping.eq(0)
                    m.next = "IDLE"
                with m.Elif(~self.alive.bit_select(slot[: len(who)], 1)):
                    m.d.sync += slot.eq(slot + 1)
                with m.Else():
                    m.next = "ADDRESSED"
            with m.State("ADDRESSED"):
                m.d.comb += self._address.eq(peers.participant(slot, tables.LEFT))
                m.next = "LEASE"
            with m.State("LEASE"):
                m.next = "LEFT"
                lively = heard.bit_select(slot[: len(who)], 1)
                self._write(m, peers.participant(slot, tables.LEFT), self._passes, when=lively)
                with m.If(lively):
                    m.d.comb += silent.eq(1)
                    m.d.sync += slot.eq(slot + 1)
                    m.next = "SWEEP"
            with m.State("LEFT"):
                m.next = "REMOVE"
                some = ~self.peers.data[tables.LEASE_BITS]  # it was not 0 before
                self._write(m, peers.participant(slot, tables.LEFT), self._passes, self._less, when=some)
                with m.If(some):
                    m.d.sync += slot.eq(slot + 1)
                    m.next = "SWEEP"
            with m.State("REMOVE"):  # the participant, and each of its endpoints
                m.d.comb += [counts.eq(1), self._address.eq(peers.endpoint(step, tables.INFO))]
                is_its = self.peers.data[tables.INFO_SLOT : tables.INFO_SLOT + len(slot)] == slot
                m.d.comb += self._goes.eq(1)
                with m.If(step >= READ_LATENCY):
                    m.d.comb += self._parts.eq(is_its)
                    m.d.sync += self._endpoint.eq(self._endpoint + 1)
                with m.If(step == peers.endpoints + READ_LATENCY - 1):
                    m.next = "PROCEED"
                    with m.If(sweeping):
                        m.d.sync += slot.eq(slot + 1)
                        m.next = "SWEEP"
        starts = ("IDLE", "SWEEP", "MATCH")
        with m.If(Cat(fsm.ongoing(state) for state in starts).any() & ~self._found):
            m.d.sync += self._endpoint.eq(0)
        return m

    def _writing(self, m: Module) -> None:
        """What is written, in the cycle after: registers of which those are zero that are not meant."""
        kept = self._parameters.write
        # A word that was read, with what is added to it: 1; one less; everything; or that makes it a number before all that
        # is kept. A word of our own. What is known of an endpoint, or stands beside a port.
        self._target = Signal(len(self.write.addr))
        self._writes, self._passes, self._copies = (Signal() for _ in range(3))
        self._one, self._less, self._everything, self._before_all = (Signal() for _ in range(4))
        self._beside = Signal(18)
        middle = MAX_HISTORY.bit_length() - 1
        low, high = self._less | self._everything, self._less | self._before_all
        more = Cat(low | self._one, low.replicate(middle - 1), (low | high).replicate(31 - middle), high)
        en, target, beside = Signal(), Signal.like(self._target), Signal.like(self._beside)
        read, added, copied = (Signal(32) for _ in range(3))
        m.d.sync += [en.eq(self._writes), beside.eq(self._beside)]
        for register, value, meant in (
            (target, self._target, self._writes),
            (read, self.peers.data, self._passes),
            (added, more, self._passes),
            (copied, self.own.data, self._copies),
        ):
            m.d.sync += register.eq(value)
            with m.If(~meant):
                m.d.sync += register.eq(0)
        m.d.comb += [
            self.write.en.eq(en | kept.en),
            self.write.addr.eq(target | kept.addr),
            self.write.data.eq(read + added | copied | kept.data | beside),
        ]

    def _write(self, m: Module, target: Value, *what: Signal, when: Value | int = 1) -> None:
        """A word, of what is `beside` and these."""
        m.d.comb += [self._target.eq(target), *(one.eq(when) for one in (self._writes, *what))]

    def _participant(self, m: Module, arrived: Value) -> None:
        """An announcement, or a farewell."""
        peers, meta, read = self._peers, self.i.meta, self._parameters.read
        slot, step, counts, before = self._slot, self._step, self._counts, self._before
        fresh = Signal()
        with m.State("PARTICIPANT"):
            m.d.sync += fresh.eq(~meta.known)
            m.next = "PROCEED"
            with m.If(meta.gone), m.If(meta.known):
                m.next = "REMOVE"
            with m.Elif(read.refused):
                m.d.comb += self.drop_refused.eq(1)
            with m.Elif(~read.guid | ~read.meta):
                m.d.comb += self.drop_incomplete.eq(1)
            with m.Elif(meta.known):
                m.next = "COPY"
            with m.Elif(~arrived):  # else most likely it says so twice
                m.d.sync += slot.eq(0)
                m.next = "SLOT"
        with m.State("SLOT"):  # the first that is free
            with m.If(slot == peers.participants):
                m.d.comb += self.drop_full.eq(1)
                m.next = "PROCEED"
            with m.Elif(self.alive.bit_select(slot[: peers.slot_bits], 1)):
                m.d.sync += slot.eq(slot + 1)
            with m.Else():
                m.next = "COPY"
        with m.State("COPY"):  # the scratch area, behind what is read
            source = Signal(4)
            m.d.comb += [counts.eq(1), source.eq(step)]
            with m.If(~read.user & (step[1:3] == tables.USER_IP >> 1)):
                m.d.comb += source.eq(Cat(step[0], C(tables.META_IP >> 1)))
            m.d.comb += self._address.eq(peers.scratch(source))
            near, listens = self._parameters.near, self._parameters.listens
            self._write(m, peers.participant(slot, before), self._passes, when=step >= READ_LATENCY)
            with m.If(before == tables.USER_PORT):
                m.d.comb += self._beside[tables.PORT_GROUP :].eq(Cat(near & listens, near))
            # As it was heard, the next sweep writes what is left.
            with m.If(step == tables.USER_PORT + READ_LATENCY):
                m.d.comb += [counts.eq(0), self._comes.eq(1)]
                m.next = "PROCEED"
                with m.If(fresh):
                    m.d.comb += self.greet.eq(1)
                    m.next = "BUILTINS"
        with m.State("BUILTINS"):  # the last four words of each proxy
            of_writer, word = before[3], Cat(before[:2], C(1, 1))
            m.d.comb += [
                counts.eq(1),
                self._address.eq(peers.scratch(tables.SCRATCH_ZERO)),
                self._one.eq(Mux(of_writer, word == tables.NEXT_LO, word == tables.ASK_FROM)),
                self._everything.eq(~of_writer & (word == tables.ASK_TO)),
            ]
            there = step >= READ_LATENCY
            self._write(m, peers.builtin(slot, before[2:4], word), self._passes, when=there)
            with m.If(there):
                m.d.comb += [
                    self.due.en.eq(before[:2] == 3),
                    self.due.proxy.eq(Cat(before[2:4], slot)[: len(self.due.proxy) - 1]),
                ]
            with m.If(step == 15 + READ_LATENCY):
                m.next = "PROCEED"

    def _match(self, m: Module) -> None:
        """An endpoint, which was looked for among those that match ours."""
        peers, meta, own, read = self._peers, self.i.meta, self._own, self._parameters.read
        slot, step, before, endpoint, found = (
            self._slot,
            self._step,
            self._before,
            self._endpoint,
            self._found,
        )
        local, agreed = Signal(max(1, own.local_bits)), Signal()
        is_writer = meta.kind == ports.PUBLICATIONS
        same = self._parameters.same
        # What each of ours has to say to its QoS: a peer's reader must not ask for more than our writer offers, and so on.
        agree = Signal(len(same))
        for n in range(len(same)):
            fits: list[Value] = []  # to our reader, to our writer
            for table, offered in ((own.readers, True), (own.writers, False)):
                if n >= len(table):
                    fits.append(C(0))
                    continue
                reliable_here, transient_here = table[n].reliable, table[n].transient_local
                if offered:
                    durable = (read.durability != VOLATILE) | C(not transient_here, 1)
                    fits.append((read.reliable | C(not reliable_here, 1)) & durable)
                else:
                    durable = (read.durability == VOLATILE) | (
                        (read.durability == TRANSIENT_LOCAL) & C(transient_here, 1)
                    )
                    fits.append((~read.reliable | C(reliable_here, 1)) & durable)
            m.d.comb += agree[n].eq(Mux(is_writer, fits[0], fits[1]) & ~read.refused)
        transient = Signal()  # it gets, or gives, what was there before it
        reliable = Signal()
        with m.State("ENDPOINT"):
            for n in reversed(range(len(same))):
                with m.If(same[n]):
                    ours = [table[n] if n < len(table) else None for table in (own.writers, own.readers)]
                    flags = [
                        (C(bool(one and one.reliable), 1), C(bool(one and one.transient_local), 1))
                        for one in ours
                    ]
                    m.d.sync += [
                        local.eq(n),
                        reliable.eq(read.reliable & Mux(is_writer, flags[1][0], flags[0][0])),
                        transient.eq(
                            (read.durability != VOLATILE) & Mux(is_writer, flags[1][1], flags[0][1])
                        ),
                        agreed.eq(agree[n]),
                    ]
            m.next = "PROCEED"
            m.d.comb += self._parts.eq(
                found & (meta.gone | (read.guid & read.topic & read.type & ~same.any()))
            )
            with m.If(meta.gone):
                pass
            with m.Elif(~read.guid | ~read.topic | ~read.type):
                m.d.comb += self.drop_incomplete.eq(1)
            with m.Elif(same.any()):
                m.next = "MATCH"
        # Looked at in both states before it is needed: a cycle in which it is written gives what there was before.
        last = own.writer(local, tables.WRITER_LAST)
        with m.State("MATCH"):
            m.d.comb += self._own_address.eq(last)
            m.next = "PROCEED"
            with m.If(~agreed):
                m.d.comb += [self.drop_qos.eq(1), self._parts.eq(found)]
            with m.Elif(found):
                m.next = "PROXY"
            with m.Else():
                m.next = "PLACE"
        with m.State("PLACE"):  # the first that is free
            m.d.comb += self._own_address.eq(last)
            m.next = "PROXY"
            with m.If(self.matched.bit_select(endpoint, 1)):
                m.d.sync += endpoint.eq(endpoint + 1)
                m.next = "PLACE"
                with m.If(endpoint == peers.endpoints - 1):
                    m.d.comb += self.drop_full.eq(1)
                    m.next = "PROCEED"
        with m.State("PROXY"):  # behind what is read; our writer's last comes by way of the scratch area
            # Before all that is kept, where it gets what was before it: numbers are compared by their difference. Of a
            # writer the first that is wanted is 1, or any.
            m.d.comb += self._counts.eq(1)
            with m.If(is_writer):
                m.d.comb += self._one.eq(transient & (before[:3] == tables.NEXT_LO))
            with m.Elif(before[2] & (before[:2] != tables.ASK_TO & 3)):
                m.d.comb += [self._one.eq(~transient), self._before_all.eq(transient)]
            where = Cat(step[0], C(tables.USER_IP >> 1))  # for IP, 2, and PORT, 3
            its = Mux(read.user, peers.scratch(where), peers.participant(slot, where))
            kept = Mux(step[2], tables.SCRATCH_LAST, tables.SCRATCH_ENTITY)
            m.d.comb += self._address.eq(Mux(step[1] & ~step[2], its, peers.scratch(kept)))
            near = Mux(read.user, self._parameters.near, self.peers.data[tables.PORT_NEAR])
            group = self._parameters.listens & near
            there = step >= READ_LATENCY
            self._write(m, peers.endpoint(endpoint, before[:3]), when=there)
            with m.If(step == 1):
                self._write(m, peers.scratch(tables.SCRATCH_LAST))
                m.d.comb += self._copies.eq(~is_writer)
            with m.If(there & (before[:3] == tables.INFO)):
                of_ours = Cat(local, C(0, 8 - len(local)), is_writer, reliable)
                m.d.comb += self._beside.eq(Cat(slot, C(0, 8 - len(slot)), of_ours))
            with m.Elif(there):
                m.d.comb += self._passes.eq(1)
                with m.If(before[:3] == tables.PORT):
                    m.d.comb += self._beside[tables.PORT_GROUP].eq(group)
            with m.If((step == tables.PORT + READ_LATENCY) & found):
                m.next = "PROCEED"  # it has only moved
            with m.If(step == tables.PROXY - 1 + READ_LATENCY):
                m.d.comb += [
                    self._joins.eq(1),
                    self.due.en.eq(1),
                    self.due.proxy.eq(Cat(endpoint, C(0, len(self.due.proxy) - 1 - len(endpoint)), C(1, 1))),
                ]
                m.next = "PROCEED"
