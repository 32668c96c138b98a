"""What a writer sends besides its samples in passing: bulk, fragments, gaps, and what a reader asks for again.

RTPS 2.3, 8.4.9.2 (reliable writer), 8.4.14.1 (fragments).
"""

from roslet.engine.rtps.outbox import WHOLE
from roslet.wire.rtps import number_set, times
from roslet.wire.rtps.data import FLAG_K, FLAG_Q, Preface
from roslet.wire.rtps.data_frag import FLAG_K as FRAGMENT_OF_KEY
from roslet.wire.rtps.data_frag import DataFrag
from roslet.wire.rtps.gap import Gap
from roslet.wire.rtps.guid import ENTITYID_UNKNOWN
from roslet.wire.rtps.heartbeat_frag import HeartbeatFrag
from roslet.wire.rtps.info_ts import InfoTimestamp
from roslet.wire.rtps.submessage import FLAG_E

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator

    from roslet.engine.rtps.common import Common
    from roslet.engine.rtps.history import Change
    from roslet.engine.rtps.outbox import Address, Bulk, Flow
    from roslet.engine.rtps.reader_proxy import ReaderProxy
    from roslet.engine.rtps.writer import Writer
    from roslet.wire.rtps.ack_nack import AckNack
    from roslet.wire.rtps.nack_frag import NackFrag

# Seconds in which a second request for the same sample by the same reader is taken for an echo of the first.
RESEND_SUPPRESSION = 0.005
# Octets of a datagram of several samples: what Ethernet takes in one frame.
PACKED = 1400
# Samples of which that is remembered, for one reader; beyond, an echo costs a datagram.
MAX_RESENT = 1024


class Repairs:
    """Belongs to one writer."""

    def __init__(self, writer: "Writer", common: "Common", flow: "Flow") -> None:
        self._writer = writer
        self._common = common
        self._outbox = common.outbox
        self._flow = flow
        self._paced: dict[int, int] = {}  # sequence number -> runs of its fragments that the flow still holds
        self._lossless = True  # nobody asked again for what was sent up to here:
        self._round = 0
        self._mending: set[int] = set()  # samples of which lost fragments wait to be sent again

    @property
    def busy(self) -> bool:
        """Whether bulk waits for its turn."""
        return bool(self._paced)

    # -- to all, or one

    def send_bulk(self, change: "Change", proxy: "ReaderProxy | None") -> None:
        """A large sample, to all readers (`proxy` None) or one."""
        self._pace(change, proxy, None, self._writer.addresses if proxy is None else proxy.addresses)

    def _pace(
        self,
        change: "Change",
        proxy: "ReaderProxy | None",
        numbers: "list[int] | None",
        addresses: "tuple[Address, ...]",
        repair: bool = False,
    ) -> None:
        self._paced[change.sequence] = self._paced.get(change.sequence, 0) + 1
        make = self._fragments if len(change.payload) > change.fragment else self._whole
        self._flow.add(make(change, proxy, numbers, addresses), repair)

    def _front(self, change: "Change", proxy: "ReaderProxy | None") -> "tuple[bytes, bytes]":
        stamp = bytes(InfoTimestamp(change.time).emit())
        if proxy is None:
            return self._common.header + stamp, ENTITYID_UNKNOWN
        return self._common.header + proxy.info_dst + stamp, proxy.guid[12:]

    def _whole(
        self,
        change: "Change",
        proxy: "ReaderProxy | None",
        numbers: "list[int] | None",
        addresses: "tuple[Address, ...]",
    ) -> "Iterator[Bulk]":
        """The one datagram of a sample that fits, with a heartbeat behind it."""
        writer = self._writer
        superseded = self._superseded(change)
        if not superseded:
            yield from self._introductions(proxy)
            size = len(change.inline_qos) + len(change.payload)
            pad = bytes(-size & 3)
            front = self._preface(proxy, change, size + len(pad)) + change.inline_qos
            if writer.any_reliable:
                reader_id = ENTITYID_UNKNOWN if proxy is None else proxy.guid[12:]
                pad += writer.heartbeat(reader_id, False, change.sequence).emit()
            yield (front, change.payload, pad), addresses, self._mark(change.sequence, WHOLE)
        self._done(change)
        if superseded and writer.any_reliable:
            yield from self._ask(change, proxy, addresses)

    def _fragments(
        self,
        change: "Change",
        proxy: "ReaderProxy | None",
        numbers: "list[int] | None",
        addresses: "tuple[Address, ...]",
    ) -> "Iterator[Bulk]":
        size = change.fragment
        total = len(change.payload)
        count = (total + size - 1) // size
        view = memoryview(change.payload)
        front, reader_id = self._front(change, proxy)
        flags = FRAGMENT_OF_KEY if change.flags & FLAG_K else 0
        entity_id, sequence, said = self._writer.entity_id, change.sequence, change.inline_qos
        untold = 0
        for number in numbers if numbers is not None else range(1, count + 1):
            if number > count or self._superseded(change):
                break
            part = view[(number - 1) * size : number * size]
            piece = DataFrag(reader_id, entity_id, sequence, number, 1, size, total, part, said, flags)
            untold += len(part)
            if untold < self._flow.window // 4 or not self._writer.tells or len(part) & 3:
                yield (front + piece.emit_front(), part), addresses, None
                continue
            # Readers of our own kind say at once how far they are, which opens the window.
            untold = 0
            told = HeartbeatFrag(reader_id, entity_id, sequence, number, self._writer.next_count()).emit()
            yield (front + piece.emit_front(), part, told), addresses, (sequence, number)
        self._done(change)
        if self._writer.any_reliable:
            yield from self._ask(change, proxy, addresses, count)

    def _ask(
        self,
        change: "Change",
        proxy: "ReaderProxy | None",
        addresses: "tuple[Address, ...]",
        count: int = 0,
    ) -> "Iterator[Bulk]":
        """Heartbeats of no more than this sample: the readers would ask for those that wait behind it."""
        writer = self._writer
        yield from self._introductions(proxy)
        reader_id = ENTITYID_UNKNOWN if proxy is None else proxy.guid[12:]
        parts = [self._common.header, proxy.info_dst if proxy is not None else b""]
        if count:
            told = HeartbeatFrag(reader_id, writer.entity_id, change.sequence, count, writer.next_count())
            parts.append(bytes(told.emit()))
        parts.append(bytes(writer.heartbeat(reader_id, False, change.sequence).emit()))
        yield (b"".join(parts),), addresses, self._mark(change.sequence, WHOLE)

    def _introductions(self, proxy: "ReaderProxy | None") -> "Iterator[Bulk]":
        """Before a heartbeat to all (`proxy` None): see `Writer.strangers`."""
        for one in self._writer.strangers() if proxy is None else ():
            yield self._introduction(one), one.addresses, None

    def ask_for(self, sent: "tuple[int, int]") -> None:
        """Ask for what has gone out; more is on its way."""
        writer = self._writer
        for one in writer.strangers():
            self.introduce(one)
        sequence, fragment = sent
        if fragment == WHOLE:
            beat = writer.heartbeat(ENTITYID_UNKNOWN, False, sequence).emit()
        else:
            count = writer.next_count()
            beat = HeartbeatFrag(ENTITYID_UNKNOWN, writer.entity_id, sequence, fragment, count).emit()
        self._outbox.send((self._common.header, beat), writer.addresses)

    def _mark(self, sequence: int, fragment: int) -> "tuple[int, int] | None":
        return (sequence, fragment) if self._writer.any_reliable else None

    def _done(self, change: "Change") -> None:
        left = self._paced[change.sequence] - 1
        if left:
            self._paced[change.sequence] = left
        else:
            del self._paced[change.sequence]
        self._mending.discard(change.sequence)

    def _superseded(self, change: "Change") -> bool:
        """Whether nobody needs the rest of a sample: acknowledged, expired, or overwritten while it waited its turn."""
        writer = self._writer
        if writer.keeps or writer.any_reliable:
            return writer.history.get(change.sequence) is None
        return not writer.history.keep_all and writer.last - change.sequence >= writer.history.depth

    def acknowledged(self, sequence: int) -> None:
        """Every reliable reader has the samples up to this one."""
        self._flow.acknowledged(sequence)
        if sequence >= self._round:
            if self._lossless:
                self._flow.widen()
            self._lossless = True
            self._round = self._writer.last

    def _lost(self) -> None:
        """Once for all that was under way at a time: what one overrun took is reported piece by piece."""
        if self._lossless:
            self._lossless = False
            self._flow.narrow()
            self._round = self._writer.last

    # -- to one reader

    def introduce(self, proxy: "ReaderProxy", addresses: "tuple[Address, ...]" = ()) -> None:
        """Tell a reader where it begins, and where we are; it asks for what it lacks. What is not for it is a gap."""
        self._outbox.send(self._introduction(proxy), addresses or proxy.addresses)

    def _introduction(self, proxy: "ReaderProxy") -> "tuple[bytes | bytearray, ...]":
        writer = self._writer
        reader_id = proxy.guid[12:]
        parts: list[bytes | bytearray] = [self._common.header, proxy.info_dst]
        if 1 < proxy.start <= writer.last + 1:
            parts.append(Gap(reader_id, writer.entity_id, 1, number_set.NumberSet(proxy.start)).emit())
        if not proxy.late:
            parts.append(writer.heartbeat(reader_id, False, proxy.start - 1).emit())
        if proxy.late or (proxy.start <= writer.last and not self.busy):
            parts.append(writer.heartbeat(reader_id, False).emit())
        return tuple(parts)

    def tell_skipped(self, only: bytes, last: int) -> None:
        """A GAP, to reader `only` or to all, over what went to others only, up to number `last`."""
        writer = self._writer
        for proxy in writer.proxies.values() if not only else (writer.proxies[only],):
            if proxy.sent < last and proxy.reliable:
                skipped = number_set.NumberSet(last + 1)
                message = Gap(proxy.guid[12:], writer.entity_id, proxy.sent + 1, skipped)
                self._outbox.send((self._common.header, proxy.info_dst, message.emit()), proxy.addresses)
            proxy.sent = writer.last

    def send_all(self, proxy: "ReaderProxy", numbers: "list[int]", addresses: "tuple[Address, ...]") -> None:
        """Those samples that we have and that are for this reader, as many in a datagram as fit."""
        writer = self._writer
        parts: list[bytes | bytearray] = []
        size = 0
        for number in numbers:
            change = writer.history.get(number)
            if change is None or change.to not in (b"", proxy.guid):
                continue
            if writer.is_bulk(change.payload):
                self._pace(change, proxy, None, addresses, True)
                continue
            body = len(change.inline_qos) + len(change.payload)
            need = writer.preface.size + body
            if parts and size + need > PACKED:
                self._outbox.send((b"".join(parts),), addresses)
                parts = []
            if not parts:
                parts = [self._common.header, proxy.info_dst]
                size = len(parts[0]) + len(parts[1])
            if proxy.next_preface is None:
                proxy.next_preface = Preface(b"", writer.entity_id, proxy.guid[12:])
            parts += [_emit(proxy.next_preface, change, body), change.inline_qos, bytes(change.payload)]
            # What is no multiple of 4 must be the last: the payload would end with its padding.
            size += need if not body & 3 else PACKED
        if parts:
            self._outbox.send((b"".join(parts),), addresses)

    def send_change(self, proxy: "ReaderProxy", change: "Change", addresses: "tuple[Address, ...]") -> None:
        """A sample that fits a datagram, at once."""
        size = len(change.inline_qos) + len(change.payload)
        front = self._preface(proxy, change, size)
        self._outbox.send((front, change.inline_qos, change.payload), addresses)

    def _preface(self, proxy: "ReaderProxy | None", change: "Change", size: int) -> bytes:
        if proxy is None:
            return _emit(self._writer.preface, change, size)
        if proxy.preface is None:
            proxy.preface = Preface(
                self._common.header, self._writer.entity_id, proxy.guid[12:], proxy.info_dst
            )
        return _emit(proxy.preface, change, size)

    # -- what is asked for

    def send_again(
        self, proxy: "ReaderProxy", value: "AckNack", now: float, addresses: "tuple[Address, ...]"
    ) -> bool:
        """What an ACKNACK asks for; whether it asks for anything that exists."""
        writer = self._writer
        asked = [number for number in value.state.numbers() if number <= writer.last]
        if not asked:
            return False
        absent = []
        again = []
        for number in asked:
            if number in self._paced:
                continue
            change = writer.history.get(number)
            if number < proxy.start or change is None or change.to not in (b"", proxy.guid):
                absent.append(number)
            elif now - proxy.resent.get(number, -1.0) >= RESEND_SUPPRESSION:
                if len(proxy.resent) > MAX_RESENT:
                    proxy.resent.clear()
                proxy.resent[number] = now
                again.append(number)
        self.send_all(proxy, again, addresses)
        if again:
            self._lost()
        if absent:
            self._send_gaps(proxy, absent, addresses)
        if not self._paced:
            # Behind what it asked for, so that the next request need not wait for a timer.
            beat = writer.heartbeat(proxy.guid[12:], False)
            self._outbox.send((self._common.header, proxy.info_dst, beat.emit()), addresses)
        return True

    def send_fragments_again(
        self, proxy: "ReaderProxy", value: "NackFrag", now: float, addresses: "tuple[Address, ...]"
    ) -> None:
        """What a NACK_FRAG asks for."""
        writer = self._writer
        change = writer.history.get(value.sequence)
        if change is None or change.to not in (b"", proxy.guid):
            self._send_gaps(proxy, [value.sequence], addresses)
            return
        numbers = value.state.numbers()
        if writer.tells:
            done = numbers[-1] if numbers else value.state.base - 1
            proxy.parts = (value.sequence, done)
            least = min([one.progress for one in writer.proxies.values() if one.reliable])
            self._flow.acknowledged(least[0], least[1])
        if not numbers:
            return
        if value.sequence in self._mending or (value.sequence in self._paced and not writer.tells):
            # What it lacks may be on its way; the run ends with another heartbeat.
            self._common.count("nack-frag-early")
        else:
            self._lost()
            self._mending.add(value.sequence)
            self._pace(change, proxy, numbers, addresses, True)
        writer.ask_soon(now)

    def _send_gaps(self, proxy: "ReaderProxy", absent: "list[int]", addresses: "tuple[Address, ...]") -> None:
        """GAPs over numbers, in order: the run they begin with as a range, the rest as a set."""
        start = base = absent[0]
        at = 0
        while at < len(absent) and absent[at] == base:
            base += 1
            at += 1
        message = Gap(proxy.guid[12:], self._writer.entity_id, start, number_set.of(base, absent[at:]))
        self._outbox.send((self._common.header, proxy.info_dst, message.emit()), addresses)


def _emit(preface: Preface, change: "Change", size: int) -> bytes:
    seconds, fraction = times.split(change.time)
    flags = change.flags | FLAG_E | (FLAG_Q if change.inline_qos else 0)
    return preface.emit(change.sequence, size, seconds, fraction, flags)
