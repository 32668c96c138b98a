"""A participant: RTPS between UDP and the user's messages."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from amaranth.hdl import Module, Mux, Signal, Value
from amaranth.lib import memory, wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from roslet.gateware.fifo import MessageRegister
from roslet.gateware.meta import ADDRESSES, UDP_RX, UDP_TX, LookupSignature
from roslet.gateware.rtps import tables
from roslet.gateware.rtps.composer import Composer
from roslet.gateware.rtps.discovery import Discovery
from roslet.gateware.rtps.outbox import Outbox
from roslet.gateware.rtps.ports import DISCOVERY, KEEP, SUBMESSAGE, USER, WriteSignature
from roslet.gateware.rtps.queue import DatagramQueue
from roslet.gateware.rtps.rom import Rom
from roslet.gateware.rtps.sender import Sender
from roslet.gateware.rtps.submessages import Submessages
from roslet.gateware.rtps.tables import Local, OwnMap, PeerMap
from roslet.gateware.rtps.turns import Turns
from roslet.gateware.rtps.walker import Walker
from roslet.gateware.stream import FrameSignature
from roslet.gateware.words import MessageSignature

DISCOVERY_SIZE = 900
"""Octets of a DATA of SEDP, at most in practice: what peers repeat together must fit a datagram that we can receive."""


class Participant(wiring.Component):
    """A participant with fixed writers and readers.

    writers, readers    the user's, in the order of their numbers
    kept                further writers, whose only message is there from the beginning: its octets, without the
                        encapsulation header
    prefix              our GUID prefix
    address, ports      ours, of discovery and of the user's messages
    domain              its number, or None: it is not told, and that of others not looked at
    participants, endpoints
                        how many others, and how many of their endpoints that match ours, are known at once
    longest             octets of the longest datagram that is received
    lease               seconds, which peers are told

    Ports: `udp_rx` and `udp_tx`, data of datagrams, `lookup`; `publish0` .., messages; `receive0` ..,
    messages, with what is known of them; `room`, a bit for each reader, as `Submessages` has it; `addresses`; `tick`,
    `announce`, `sweep`, high for a cycle each second, when we shall be announced, and when readers shall be reminded;
    `drop_<block>_<reason>`.

    What is known at run time only: `own`, writes our own memory, for which nothing of this may be going on: hold it in reset
    meanwhile; `group_port`, where others are announced to, as GROUP_PORT_OWN says in our memory of us: who sets the one
    writes the other; `source_port`, what we send from; `writers_enabled`, `readers_enabled`, as `Sender` has them. `own_map`
    says what lies where, and `most`, how many octets the longest datagram has that is sent.
    """

    def __init__(
        self,
        writers: Sequence[Local],
        readers: Sequence[Local],
        prefix: bytes,
        address: bytes,
        ports: tuple[int, int, int],
        domain: int | None,
        kept: Sequence[tuple[Local, bytes]] = (),
        participants: int = 8,
        endpoints: int = 16,
        longest: int = 2952,
        lease: float = 20.0,
    ) -> None:
        self._peers = peers = PeerMap(participants, endpoints)
        self.own_map = self._own = own = OwnMap([*writers, *(local for local, _ in kept)], readers)
        self._domain = domain
        group_port, meta_port, user_port = ports
        self._init = own.init(prefix, address, meta_port, user_port, group_port)
        for n, (local, octets) in enumerate(kept, len(writers)):
            words = [int.from_bytes(octets[at : at + 4], "little") for at in range(0, len(octets), 4)]
            at = own.samples[n] + own.stride(local) * (1 % local.depth)
            self._init[at : at + 1 + len(words)] = [len(words) | (-len(octets) % 4) << 16, *words]
            self._init[own.writer_address(n, tables.WRITER_LAST)] = 1
            self._init[own.writer_address(n, tables.WRITER_OLDEST)] = 0
        self._rom = Rom(own, domain, lease)
        most = 4 * max(self._rom.size[name] for name in self._rom.size)
        most += 4 * max((local.words for local in own.writers), default=0)
        self.most = most
        self._users, self._readers = len(writers), len(readers)
        window = max(1, longest // DISCOVERY_SIZE)
        self._composer = Composer(self._rom, peers, own, window)
        self._blocks: dict[str, Any] = {
            "queue": DatagramQueue(longest),
            "walker": Walker(peers, own),
            "submessages": Submessages(peers, own),
            "discovery": Discovery(peers, own, domain is not None),
            "turns": Turns(peers),
            "sender": Sender(self._rom, peers, own, len(writers), window),
            "outbox": Outbox(most),
        }
        self.drops = [
            (block, name)
            for block, component in self._blocks.items()
            for name in component.signature.members
            if name.startswith("drop_")
        ]
        super().__init__(
            {
                "udp_rx": In(FrameSignature(UDP_RX)),
                "udp_tx": Out(FrameSignature(UDP_TX)),
                "lookup": Out(LookupSignature()),
                **{f"publish{n}": In(MessageSignature()) for n in range(len(writers))},
                **{f"receive{n}": Out(MessageSignature(USER)) for n in range(len(readers))},
                "room": In(max(1, len(readers))),
                "addresses": In(ADDRESSES),
                "tick": In(1),
                "announce": In(1),
                "sweep": In(1),
                "alive": Out(participants),
                "matched": Out(endpoints),
                "own": In(WriteSignature(own.address_bits)),
                "group_port": In(16, init=group_port),
                "source_port": In(16, init=meta_port),
                "writers_enabled": self._blocks["sender"].signature.members["writers"],
                "readers_enabled": self._blocks["sender"].signature.members["readers"],
                **{self.drop_name(block, name): Out(1) for block, name in self.drops},
            }
        )

    @staticmethod
    def drop_name(block: str, name: str) -> str:
        """The port for the output `drop_<reason>` of a block."""
        return f"drop_{block}_{name.removeprefix('drop_')}"

    def elaborate(self, platform: object) -> Module:
        m = Module()
        for name, block in self._blocks.items():
            m.submodules[name] = block
        for block, name in self.drops:
            m.d.comb += getattr(self, self.drop_name(block, name)).eq(getattr(self._blocks[block], name))
        blocks = self._blocks
        queue, walker, submessages = blocks["queue"], blocks["walker"], blocks["submessages"]
        discovery, turns, sender, outbox = (
            blocks[name] for name in ("discovery", "turns", "sender", "outbox")
        )
        m.submodules.composer = composer = self._composer

        connect(m, flipped(self.udp_rx), queue.i)
        connect(m, queue.o, walker.i)
        m.submodules.bodies = bodies = MessageRegister(SUBMESSAGE)
        connect(m, walker.o, bodies.i)
        connect(m, bodies.o, submessages.i)
        m.submodules.lists = lists = MessageRegister(DISCOVERY)
        connect(m, submessages.discovery, lists.i)
        connect(m, lists.o, discovery.i)
        connect(m, outbox.o, flipped(self.udp_tx))
        connect(m, outbox.lookup, flipped(self.lookup))
        for n in range(self._users):
            connect(m, flipped(getattr(self, f"publish{n}")), getattr(sender, f"publish{n}"))
        user = submessages.user
        if self._readers > 1:  # from here on it goes far
            m.submodules.user = register = MessageRegister(USER)
            connect(m, user, register.i)
            user = register.o
        for n in range(self._readers):
            receive = getattr(self, f"receive{n}")
            m.d.comb += [receive.stream.payload.eq(user.stream.payload), receive.meta.eq(user.meta)]
            with m.If(user.meta.reader == n):
                m.d.comb += [
                    receive.stream.valid.eq(user.stream.valid),
                    user.stream.ready.eq(receive.stream.ready),
                ]
        m.d.comb += [
            walker.known.eq(queue.known),
            walker.good.eq(queue.good),
            walker.alive.eq(discovery.alive),
            walker.hold.eq(discovery.hold),
            discovery.idle.eq(walker.idle),
            discovery.heard.eq(walker.heard),
            discovery.heard_slot.eq(walker.heard_slot),
            discovery.addresses.eq(self.addresses),
            discovery.group_port.eq(self.group_port),
            discovery.domain.eq(0 if self._domain is None else self._domain),
            discovery.tick.eq(self.tick),
            submessages.room.eq(self.room),
            submessages.over.eq(walker.idle),
            *(block.alive.eq(discovery.alive) for block in (submessages, turns)),
            *(block.matched.eq(discovery.matched) for block in (submessages, turns, sender)),
            turns.greet.eq(discovery.greet),
            turns.greet_slot.eq(discovery.greet_slot),
            turns.announce.eq(self.announce),
            turns.sweep.eq(self.sweep | sender.again),
            turns.taken.eq(sender.taken),
            sender.job.eq(turns.job),
            sender.valid.eq(turns.valid),
            composer.at.eq(sender.template),
            composer.load.eq(sender.load),
            composer.start.eq(sender.go),
            composer.borrow.eq(sender.borrow),
            composer.subject.eq(sender.subject),
            sender.word.eq(composer.word),
            sender.do.eq(composer.do),
            sender.done.eq(composer.done),
            sender.room.eq(outbox.room),
            outbox.push.eq(composer.push),
            outbox.word.eq(composer.word),
            outbox.finish.eq(composer.send),
            outbox.source_port.eq(self.source_port),
            sender.writers.eq(self.writers_enabled),
            sender.readers.eq(self.readers_enabled),
            self.alive.eq(discovery.alive),
            self.matched.eq(discovery.matched),
        ]
        connect(m, discovery.due, turns.due0)
        connect(m, submessages.due, turns.due1)
        self._memories(m, composer)
        return m

    def _memories(self, m: Module, composer: Any) -> None:
        """Who is received writes of peers, who sends of ourselves; both read both."""
        blocks = self._blocks
        m.submodules.peers = peers = memory.Memory(shape=32, depth=self._peers.depth, init=[])
        m.submodules.own = own = memory.Memory(shape=32, depth=self._own.depth, init=self._init)
        walker, submessages, discovery, sender = (
            blocks[name] for name in ("walker", "submessages", "discovery", "sender")
        )
        given: dict[tuple[str, str], tuple[Value, Signal]] = {}
        for side, group in (("receiving", (walker, submessages, discovery)), ("sending", (composer,))):
            for mem, name in ((peers, "peers"), (own, "own")):
                users = [getattr(block, name) for block in group if name in block.signature.members]
                read, word = mem.read_port(), Signal(32, init=0xFFFFFFFF if side == "receiving" else 0)
                m.d.sync += word.eq(read.data)
                m.d.comb += read.addr.eq(_either(user.addr for user in users))
                m.d.comb += [user.data.eq(word) for user in users]
                given[side, name] = read.addr, word
        write, ours = peers.write_port(), own.write_port()
        # What is kept of a word that passes is written where it is two registers later: a word at the walker is in `bodies`
        # in the next cycle, and in `lists` in the one behind it, as nothing is valid in either meanwhile.
        in_bodies = Signal(KEEP)
        m.d.sync += [
            in_bodies.eq(walker.keep),
            discovery.keep.eq(in_bodies.as_value() | Value.cast(submessages.keep)),
        ]
        # In the cycle after, as what is written takes long; what discovery writes has waited, and what comes from outside
        # does so while all others are held in reset. One of the two is zero.
        for port, block, other in ((write, submessages, discovery.write), (ours, sender, self.own)):
            enabled = Signal()
            m.d.sync += enabled.eq(block.write.en)
            m.d.comb += port.en.eq(enabled | other.en)
            for name in ("addr", "data"):
                later = Signal.like(getattr(port, name))
                m.d.sync += later.eq(getattr(block.write, name))
                m.d.comb += getattr(port, name).eq(Mux(enabled, later, 0) | getattr(other, name))
        # Block RAM gives anything of a word that is being written. Each side may read one of the other's: of peers it gets
        # the new. Of ours, where who receives looks at the same word for some cycles, it keeps what it had.
        for port, side, name in ((write, "sending", "peers"), (ours, "receiving", "own")):
            address, word = given[side, name]
            looked_at, written, wrote, new = Signal.like(address), Signal.like(address), Signal(), Signal(32)
            m.d.sync += [
                looked_at.eq(address),
                written.eq(port.addr),
                wrote.eq(port.en),
                new.eq(port.data),
            ]
            with m.If(wrote & (looked_at == written)):
                m.d.sync += word.eq(new if port is write else word)
        for hidden, name in ((composer.hide_peers, "peers"), (composer.hide_own, "own")):
            with m.If(hidden):
                m.d.sync += given["sending", name][1].eq(0)
        with m.If(submessages.fill_peers):
            m.d.sync += given["receiving", "peers"][1].eq(-1)


def _either(values: Any) -> Any:
    """All of them but one are zero."""
    found = 0
    for value in values:
        found = value | found
    return found
