"""A writer and what it knows of its readers. RTPS 2.3, 8.4.7, 8.4.9 (behaviour), 8.4.2.2 (what any writer must do).

One class for best effort and reliable: a best-effort reader is simply one that never answers. The number of a sample
belongs to the writer, so a sample goes once to each distinct address, to whichever readers are there.
"""

from roslet.engine.rtps.events import DeadlineMissed
from roslet.engine.rtps.history import Change, History
from roslet.wire.rtps import gap, info_dst, number_set, times
from roslet.wire.rtps.data import FLAG_D, FLAG_K, FLAG_Q, Preface
from roslet.wire.rtps.data_frag import FLAG_K as FRAGMENT_OF_KEY
from roslet.wire.rtps.data_frag import DataFrag
from roslet.wire.rtps.gap import Gap
from roslet.wire.rtps.guid import ENTITYID_UNKNOWN
from roslet.wire.rtps.heartbeat import Heartbeat
from roslet.wire.rtps.heartbeat_frag import HeartbeatFrag
from roslet.wire.rtps.info_ts import InfoTimestamp
from roslet.wire.rtps.qos import TRANSIENT_LOCAL
from roslet.wire.rtps.submessage import FLAG_E
from roslet.wire.rtps.times import INFINITE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from typing import Any

    from roslet.engine.rtps.outbox import Address, Datagram, Outbox
    from roslet.wire.rtps.ack_nack import AckNack
    from roslet.wire.rtps.endpoint_data import EndpointData
    from roslet.wire.rtps.nack_frag import NackFrag

# Every so many samples a heartbeat rides along, so that a fast writer hears of losses without a timer.
PIGGYBACK = 16
# Seconds from a sample to the heartbeat that asks for its acknowledgement, doubled up to the longest while nobody answers.
HEARTBEAT_DELAY = 0.02
HEARTBEAT_LONGEST = 0.25
# Seconds in which a second request for the same sample by the same reader is taken for an echo of the first.
RESEND_SUPPRESSION = 0.005
# Samples of which that is remembered, for one reader; beyond, an echo costs a datagram.
MAX_RESENT = 1024
# Octets of sample in one datagram: below the limit of UDP over IPv4 with room for the submessages before it.
FRAGMENT_SIZE = 60000


class ReaderProxy:
    """A matched remote reader. `acked`: it has every sample up to this number."""

    __slots__ = (
        "acked",
        "addresses",
        "count",
        "data",
        "frag_count",
        "guid",
        "info_dst",
        "preface",
        "reliable",
        "resent",
        "sent",
        "start",
    )

    def __init__(self, remote: "EndpointData", addresses: "tuple[Address, ...]", start: int) -> None:
        self.data = remote
        self.guid = remote.guid
        self.addresses = addresses
        self.reliable = remote.qos.reliable
        self.start = start  # samples before this one are not for it
        self.acked = start - 1
        self.sent = start - 1  # up to here it was told of every number, where some were for others
        self.count = -1
        self.frag_count = -1
        self.info_dst = bytes(info_dst.InfoDestination(remote.guid[:12]).emit())
        self.preface: Preface | None = None
        self.resent: dict[int, float] = {}


class Writer:
    """Made by `Participant.create_writer`. `counters` are the participant's."""

    def __init__(
        self,
        endpoint: "EndpointData",
        header: bytes,
        outbox: "Outbox",
        counters: "dict[str, int]",
        deliver: "Callable[[Any], None]",
        epoch: int = 0,
        fragment_size: int = FRAGMENT_SIZE,
    ) -> None:
        self.data = endpoint
        self.entity_id = endpoint.guid[12:]
        self.qos = endpoint.qos
        self.reliable = self.qos.reliable
        self.keeps = self.qos.durability >= TRANSIENT_LOCAL
        self.history = History(self.qos)
        self.proxies: dict[bytes, ReaderProxy] = {}
        self.last = 0
        self.accepts: Callable[[EndpointData], bool] | None = None  # which readers are matched, where not all
        self.fragment_size = fragment_size
        self._header = header
        self._outbox = outbox
        self._counters = counters
        self._deliver = deliver
        self._epoch = epoch
        self._lifespan = self.qos.lifespan / 1e9 if self.qos.lifespan < INFINITE else None
        self._period = self.qos.deadline / 1e9 if self.qos.deadline < INFINITE else None
        self._miss_at: float | None = None
        self._paced: dict[int, int] = {}  # sequence number -> fragment runs that the outbox still holds
        self._preface = Preface(header, self.entity_id)
        self._addresses: tuple[Address, ...] = ()
        self._any_reliable = False
        self._directed = False  # whether any sample was for one reader alone
        self._since_heartbeat = 0
        self._heartbeats = 0
        self._heartbeat_at: float | None = None
        self._large = 0  # the last sample that went in fragments, until somebody has it
        self._large_whole = True  # and nobody asked for a part of it again
        self._delay = HEARTBEAT_DELAY

    # -- what its owner does

    def full(self, size: int = 0) -> bool:
        """Whether `write` of `size` octets would raise HistoryFull."""
        return self._any_reliable and self.history.full(size)

    def write(
        self,
        payload: "bytes | bytearray | memoryview",
        now: float,
        time: "int | None" = None,
        inline_qos: bytes = b"",
        key: bytes = b"",
        flags: int = FLAG_D,
        to: bytes = b"",
    ) -> int:
        """Send a sample to the matched readers, and keep it as the QoS says. Returns its sequence number.

        `payload` begins with its encapsulation header and may be reused as soon as the datagrams are out; `time` is
        the source's, now where None. `to`: the GUID of the one matched reader that it is for; the others learn, when
        next something is sent to them, that they miss nothing. Such samples are an instance of their own for
        KEEP_LAST, unless there is a `key`. If it is not matched nothing is sent, and 0 is returned. Raises HistoryFull.
        """
        if to and to not in self.proxies:
            self._count("write-to-unmatched-reader")
            return 0
        if time is None:
            time = self._epoch + int(now * 1000000000)
        if self._lifespan is not None:
            self.history.forget_expired(now)
        if self._period is not None:
            self._miss_at = now + self._period
        sequence = self.last + 1
        kept = self.keeps or self._any_reliable
        large = len(payload) > self.fragment_size
        if kept or large:
            payload = bytes(payload)
            change = Change(sequence, payload, inline_qos, flags, time, key or to, to)
            if self._lifespan is not None:
                change.expires = now + self._lifespan
            if kept:
                self.history.add(change)
        self.last = sequence
        if not self._addresses:
            return sequence
        if to or self._directed:
            if not self._directed:
                self._directed = True
                for proxy in self.proxies.values():
                    proxy.sent = sequence - 1
            self._tell_skipped(to, sequence - 1)
        if to and not large:
            self._send_change(
                self.proxies[to], Change(sequence, bytes(payload), inline_qos, flags, time, key, to)
            )
            self._ask_soon(now)
            return sequence
        if large:
            self._large = sequence
            self._large_whole = True
            self._pace(change, self.proxies[to] if to else None, None)
            self._ask_soon(now)
            return sequence
        seconds, fraction = times.split(time)
        size = len(inline_qos) + len(payload)
        wire_flags = flags | FLAG_E | (FLAG_Q if inline_qos else 0)
        if not self._any_reliable:
            front = self._preface.emit(sequence, size, seconds, fraction, wire_flags)
            self._outbox.send(
                (front, inline_qos, payload) if inline_qos else (front, payload), self._addresses
            )
            return sequence
        self._since_heartbeat += 1
        if self._since_heartbeat >= PIGGYBACK:
            pad = bytes(-size & 3)
            front = self._preface.emit(sequence, size + len(pad), seconds, fraction, wire_flags)
            parts = (front, inline_qos, payload, pad, self._heartbeat(ENTITYID_UNKNOWN, False).emit())
            self._outbox.send(parts, self._addresses)
            self._since_heartbeat = 0
        else:
            front = self._preface.emit(sequence, size, seconds, fraction, wire_flags)
            self._outbox.send(
                (front, inline_qos, payload) if inline_qos else (front, payload), self._addresses
            )
        self._ask_soon(now)
        return sequence

    def acknowledged(self, sequence: int) -> bool:
        """Whether every matched reliable reader has all samples up to `sequence`."""
        return not [one for one in self.proxies.values() if one.reliable and one.acked < sequence]

    def assert_liveliness(self) -> None:
        """Say that this MANUAL_BY_TOPIC writer is alive, without a sample. Reliable writers only: it is a heartbeat."""
        beat = self._heartbeat(ENTITYID_UNKNOWN, True)
        beat.liveliness = True
        self._outbox.send((self._header, beat.emit()), self._addresses)

    # -- matching

    def match(self, remote: "EndpointData", addresses: "tuple[Address, ...]", now: float) -> bool:
        """A reader that goes together with us. False where it was matched already; its addresses may be new."""
        known = self.proxies.get(remote.guid)
        if known is not None:
            known.addresses = addresses
            known.data = remote
            self._refresh()
            return False
        if self._lifespan is not None:
            self.history.forget_expired(now)
        late = self.keeps and remote.qos.durability >= TRANSIENT_LOCAL
        proxy = ReaderProxy(remote, addresses, self.history.first(self.last + 1) if late else self.last + 1)
        proxy.reliable = proxy.reliable and self.reliable
        proxy.sent = self.last
        self.proxies[remote.guid] = proxy
        self._refresh()
        if late:
            for number in self.history.numbers():
                self._send_to(proxy, number, now)
        if proxy.reliable:
            self._introduce(proxy)
            if late and len(self.history):
                self._ask_soon(now)
        return True

    def unmatch(self, guid: bytes) -> "ReaderProxy | None":
        """Forget a reader."""
        proxy = self.proxies.pop(guid, None)
        if proxy is not None:
            self._refresh()
            self._forget_acknowledged()
        return proxy

    def _refresh(self) -> None:
        addresses: list[Address] = []
        self._any_reliable = False
        for proxy in self.proxies.values():
            self._any_reliable = self._any_reliable or proxy.reliable
            for address in proxy.addresses:
                if address not in addresses:
                    addresses.append(address)
        self._addresses = tuple(addresses)
        if not self._any_reliable:
            self._heartbeat_at = None

    # -- heartbeats

    def _heartbeat(self, reader_id: bytes, final: bool) -> Heartbeat:
        self._heartbeats += 1
        first = self.history.first(self.last + 1)
        return Heartbeat(reader_id, self.entity_id, first, self.last, self._heartbeats, final)

    def _introduce(self, proxy: ReaderProxy) -> None:
        """Tell one reader where we are; it asks for what it lacks. What is not for it is a gap."""
        parts: list[bytes | bytearray] = [self._header, proxy.info_dst]
        if 1 < proxy.start <= self.last + 1:
            parts.append(Gap(proxy.guid[12:], self.entity_id, 1, number_set.NumberSet(proxy.start)).emit())
        parts.append(self._heartbeat(proxy.guid[12:], False).emit())
        self._outbox.send(tuple(parts), proxy.addresses)

    def _ask_soon(self, now: float) -> None:
        if self._any_reliable and self._heartbeat_at is None:
            self._heartbeat_at = now + self._delay

    def deadline(self) -> "float | None":
        """When `handle_deadline` has something to do."""
        if self._miss_at is None:
            return self._heartbeat_at
        return self._miss_at if self._heartbeat_at is None else min(self._miss_at, self._heartbeat_at)

    def handle_deadline(self, now: float) -> None:
        """Ask for acknowledgements, ever more rarely while none come; notice a missed DEADLINE."""
        if self._miss_at is not None and self._period is not None and now >= self._miss_at:
            self._miss_at = now + self._period
            self._deliver(DeadlineMissed(self.entity_id))
        if self._heartbeat_at is None or now < self._heartbeat_at:
            return
        if self._paced:
            # Whoever is asked now would ask for fragments that are on their way.
            self._heartbeat_at = now + HEARTBEAT_DELAY
            return
        self._heartbeat_at = None
        behind = [one for one in self.proxies.values() if one.reliable and one.acked < self.last]
        if not behind:
            return
        if self._directed:
            for one in behind:
                self._tell_skipped(one.guid, self.last)
                parts = (self._header, one.info_dst, self._heartbeat(one.guid[12:], False).emit())
                self._outbox.send(parts, one.addresses)
        elif len(behind) == 1:
            parts = (self._header, behind[0].info_dst, self._heartbeat(behind[0].guid[12:], False).emit())
            self._outbox.send(parts, behind[0].addresses)
        else:
            self._outbox.send(
                (self._header, self._heartbeat(ENTITYID_UNKNOWN, False).emit()), self._addresses
            )
        self._since_heartbeat = 0
        self._delay = min(2 * self._delay, HEARTBEAT_LONGEST)
        self._heartbeat_at = now + self._delay

    # -- what readers say

    def handle_acknack(self, value: "AckNack", guid: bytes, now: float) -> None:
        """An ACKNACK of reader `guid`: note what it has, send again what it lacks."""
        proxy = self.proxies.get(guid)
        if proxy is None or not proxy.reliable:
            self._count("acknack-of-unmatched-reader")
            return
        if value.count == proxy.count:
            self._count("acknack-repeated")
            return
        proxy.count = value.count
        if self._lifespan is not None:
            self.history.forget_expired(now)
        acked = min(value.state.base - 1, self.last)
        if acked > proxy.acked:
            if proxy.acked < self._large <= acked:
                if self._large_whole:
                    self._outbox.widen()
                self._large = 0
            proxy.acked = acked
            self._delay = HEARTBEAT_DELAY
            if proxy.resent:
                proxy.resent = {number: at for number, at in proxy.resent.items() if number > acked}
            self._forget_acknowledged()
        asked = [number for number in value.state.numbers() if number <= self.last]
        if asked:
            absent = []
            for number in asked:
                if number in self._paced:
                    continue
                change = self.history.get(number)
                if number < proxy.start or change is None or change.to not in (b"", guid):
                    absent.append(number)
                elif now - proxy.resent.get(number, -1.0) >= RESEND_SUPPRESSION:
                    if len(proxy.resent) > MAX_RESENT:
                        proxy.resent.clear()
                    proxy.resent[number] = now
                    self._send_to(proxy, number, now)
            if absent:
                self._send_gaps(proxy, absent)
            if not self._paced:
                # Behind what it asked for, so that the next request need not wait for a timer.
                beat = self._heartbeat(proxy.guid[12:], False)
                self._outbox.send((self._header, proxy.info_dst, beat.emit()), proxy.addresses)
            self._delay = HEARTBEAT_DELAY
            self._heartbeat_at = None
            self._ask_soon(now)
        elif not value.final:
            message = (
                self._header,
                proxy.info_dst,
                self._heartbeat(proxy.guid[12:], proxy.acked >= self.last).emit(),
            )
            self._outbox.send(message, proxy.addresses)

    def handle_nack_frag(self, value: "NackFrag", guid: bytes, now: float) -> None:
        """A NACK_FRAG of reader `guid`: send those fragments again."""
        proxy = self.proxies.get(guid)
        if proxy is None or not proxy.reliable:
            self._count("nack-frag-of-unmatched-reader")
            return
        if value.count == proxy.frag_count:
            self._count("nack-frag-repeated")
            return
        proxy.frag_count = value.count
        if value.sequence > self.last:
            # A GAP over what is yet to be written would lose it.
            self._count("nack-frag-of-unwritten-sample")
            return
        change = self.history.get(value.sequence)
        if change is None:
            self._send_gaps(proxy, [value.sequence])
            return
        self._large_whole = False
        if value.sequence in self._paced:
            self._count(
                "nack-frag-early"
            )  # what it lacks may be on its way; the run ends with another heartbeat
        else:
            self._outbox.narrow()
            self._pace(change, proxy, value.state.numbers())
        self._delay = HEARTBEAT_DELAY
        self._ask_soon(now)

    def _forget_acknowledged(self) -> None:
        least = self.last
        for proxy in self.proxies.values():
            if proxy.reliable and proxy.acked < least:
                least = proxy.acked
        if self.keeps:
            self.history.forget_ended(least)
        else:
            self.history.remove_through(least)

    def _tell_skipped(self, only: bytes, last: int) -> None:
        """A GAP, to reader `only` or to all, over what went to others only, up to number `last`."""
        for proxy in self.proxies.values() if not only else (self.proxies[only],):
            if proxy.sent < last and proxy.reliable:
                message = Gap(proxy.guid[12:], self.entity_id, proxy.sent + 1, number_set.NumberSet(last + 1))
                self._outbox.send((self._header, proxy.info_dst, message.emit()), proxy.addresses)
            proxy.sent = self.last

    def _send_gaps(self, proxy: ReaderProxy, absent: "list[int]") -> None:
        """GAPs over numbers, in order: the run they begin with as a range, the rest as a set."""
        start = base = absent[0]
        while absent and absent[0] == base:
            base += 1
            absent = absent[1:]
        message = gap.Gap(proxy.guid[12:], self.entity_id, start, number_set.of(base, absent))
        self._outbox.send((self._header, proxy.info_dst, message.emit()), proxy.addresses)

    # -- sending again

    def _send_to(self, proxy: ReaderProxy, number: int, now: float) -> None:
        change = self.history.get(number)
        if change is None or change.to not in (b"", proxy.guid):
            return
        if len(change.payload) > self.fragment_size:
            self._pace(change, proxy, None)
        else:
            self._send_change(proxy, change)

    def _send_change(self, proxy: ReaderProxy, change: Change) -> None:
        if proxy.preface is None:
            proxy.preface = Preface(self._header, self.entity_id, proxy.guid[12:], proxy.info_dst)
        seconds, fraction = times.split(change.time)
        flags = change.flags | FLAG_E | (FLAG_Q if change.inline_qos else 0)
        size = len(change.inline_qos) + len(change.payload)
        front = proxy.preface.emit(change.sequence, size, seconds, fraction, flags)
        self._outbox.send((front, change.inline_qos, change.payload), proxy.addresses)

    def _pace(self, change: Change, proxy: "ReaderProxy | None", numbers: "list[int] | None") -> None:
        self._paced[change.sequence] = self._paced.get(change.sequence, 0) + 1
        self._outbox.send_paced(self._fragments(change, proxy, numbers), numbers is not None)

    def _fragments(
        self, change: Change, proxy: "ReaderProxy | None", numbers: "list[int] | None"
    ) -> "Iterator[Datagram]":
        """Datagrams of fragments; to all readers (`proxy` None) or one; all of them, or those in `numbers`."""
        size = self.fragment_size
        total = len(change.payload)
        count = (total + size - 1) // size
        view = memoryview(change.payload)
        front = self._header
        reader_id = ENTITYID_UNKNOWN
        if proxy is not None:
            front += proxy.info_dst
            reader_id = proxy.guid[12:]
        front += bytes(InfoTimestamp(change.time).emit())
        flags = FRAGMENT_OF_KEY if change.flags & FLAG_K else 0
        for number in numbers if numbers is not None else range(1, count + 1):
            if number > count or self._superseded(change):
                break
            part = view[(number - 1) * size : number * size]
            piece = DataFrag(
                reader_id,
                self.entity_id,
                change.sequence,
                number,
                1,
                size,
                total,
                part,
                change.inline_qos,
                flags,
            )
            yield (front + piece.emit_front(), part), self._addresses if proxy is None else proxy.addresses
        left = self._paced[change.sequence] - 1
        if left:
            self._paced[change.sequence] = left
        else:
            del self._paced[change.sequence]
        if self._any_reliable:
            # It says no more than this sample: the readers would ask for those that wait behind it.
            self._heartbeats += 2
            first = min(self.history.first(self.last + 1), change.sequence + 1)
            fragments = HeartbeatFrag(reader_id, self.entity_id, change.sequence, count, self._heartbeats - 1)
            beat = Heartbeat(reader_id, self.entity_id, first, change.sequence, self._heartbeats)
            to = proxy.info_dst if proxy is not None else b""
            parts = (self._header, to, fragments.emit(), beat.emit())
            yield parts, self._addresses if proxy is None else proxy.addresses

    def _superseded(self, change: Change) -> bool:
        """Whether nobody needs the rest of a sample: acknowledged, expired, or overwritten while it waited its turn."""
        if self.keeps or self._any_reliable:
            return self.history.get(change.sequence) is None
        return not self.history.keep_all and self.last - change.sequence >= self.history.depth

    def _count(self, reason: str) -> None:
        self._counters[reason] = self._counters.get(reason, 0) + 1
