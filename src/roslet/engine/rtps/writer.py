"""A writer and what it knows of its readers. RTPS 2.3, 8.4.7, 8.4.9 (behaviour), 8.4.2.2 (what any writer must do).

One class for best effort and reliable: a best-effort reader is simply one that never answers. The number of a sample
belongs to the writer, so a sample goes once to each distinct address, to whichever readers are there.
"""

from roslet.engine.rtps.events import DeadlineMissed, LivelinessLost, LivelinessRegained, WriterReady
from roslet.engine.rtps.history import Change, History, HistoryFull
from roslet.engine.rtps.outbox import Flow
from roslet.engine.rtps.reader_proxy import ReaderProxy, addresses_for_all
from roslet.engine.rtps.repairs import Repairs
from roslet.engine.rtps.schedule import Alarm
from roslet.wire.primitives import CPYTHON
from roslet.wire.rtps import guid as guids
from roslet.wire.rtps import inline_qos as inline
from roslet.wire.rtps import times
from roslet.wire.rtps.data import FLAG_D, FLAG_K, FLAG_Q, Preface
from roslet.wire.rtps.guid import ENTITYID_UNKNOWN, VENDORID_ROSLET
from roslet.wire.rtps.heartbeat import Heartbeat
from roslet.wire.rtps.inline_qos import STATUS_DISPOSED, STATUS_UNREGISTERED
from roslet.wire.rtps.qos import AUTOMATIC, KEEP_ALL, TRANSIENT_LOCAL
from roslet.wire.rtps.submessage import FLAG_E
from roslet.wire.rtps.times import INFINITE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable

    from roslet.engine.rtps.common import Common
    from roslet.engine.rtps.outbox import Address
    from roslet.wire.rtps.ack_nack import AckNack
    from roslet.wire.rtps.endpoint_data import EndpointData
    from roslet.wire.rtps.nack_frag import NackFrag

# Every so many samples a heartbeat rides along, so that a fast writer hears of losses without a timer.
PIGGYBACK = 16
# Before how many of its first samples a reliable reader that has never answered is introduced to us.
GREETINGS = 8
# Seconds from a sample to the heartbeat that asks for its acknowledgement, doubled up to the longest while nobody answers.
HEARTBEAT_DELAY = 0.02
HEARTBEAT_LONGEST = 0.25
# The same for bulk, of which a datagram is worth some heartbeats; and its last one may be lost with the heartbeat behind it.
BULK_DELAY = 0.005
# Octets of sample in one datagram: below the limit of UDP over IPv4 with room for the submessages before it.
FRAGMENT_SIZE = 65000
# The same where a reader is on another host: what Ethernet takes in one frame. Of a larger datagram a lost frame loses all,
# and Linux keeps the rest for 30 s, until 4 MiB of those are full and nothing large gets through.
FAR_FRAGMENT_SIZE = 1400
# Samples from this size on go within the window of the writer's flow, unless little is under way; smaller ones never wait.
BULK = 8192
# Octets that a small datagram takes of a socket's buffer, besides twice its size, on Linux.
OVERHEAD = 768
# Payloads up to this size are copied behind their header: one buffer is sent faster than two.
JOINED = 2048


class Writer:
    """Made by `Participant.create_writer`."""

    def __init__(
        self,
        endpoint: "EndpointData",
        common: "Common",
        fragment_size: int = FRAGMENT_SIZE,
        far_fragment_size: int = FAR_FRAGMENT_SIZE,
        wrote: "Callable[[float], None] | None" = None,
    ) -> None:
        limits = common.limits
        self.data = endpoint
        self.entity_id = endpoint.guid[12:]
        self.qos = endpoint.qos
        self.reliable = self.qos.reliable
        self.keeps = self.qos.durability >= TRANSIENT_LOCAL
        self.keyed = guids.is_keyed(endpoint.guid) and not guids.is_builtin(endpoint.guid)
        self._blocks = backlog = self.qos.history[0] == KEEP_ALL and not self.keeps
        self.history = History(
            self.qos,
            min(limits.backlog_bytes, limits.history_bytes) if backlog else limits.history_bytes,
            limits.instances if self.keyed else 1 << 30,
        )
        self.proxies: dict[bytes, ReaderProxy] = {}
        self.last = 0
        self.accepts: Callable[[EndpointData], bool] | None = None  # which readers are matched, where not all
        self.fragment_size = self._near_size = fragment_size
        self._far_size = min(far_fragment_size, fragment_size)
        self._common = common
        self._outbox = common.outbox
        self._wrote = wrote  # told of each sample, where liveliness depends on it
        self._lifespan = self.qos.lifespan / 1e9 if self.qos.lifespan < INFINITE else None
        self._period = self.qos.deadline / 1e9 if self.qos.deadline < INFINITE else None
        self._due: dict[bytes, float] = {}  # by instance: when the next sample of it is
        self._miss_alarm = Alarm(common.schedule, self._missed)
        kind, lease = self.qos.liveliness
        self.manual = kind != AUTOMATIC and lease < INFINITE
        self._lease = lease / 1e9
        self._asserted = 0.0
        self._alive = True
        self._lease_alarm = Alarm(common.schedule, self._lease_over)
        self._flow = Flow(common.outbox)
        self.preface = Preface(common.header, self.entity_id)
        self._addresses: tuple[Address, ...] = ()
        self._any_reliable = False
        self._tells = False
        self._stale = False  # whether the three above are to be found anew
        self._directed = False  # whether any sample was for one reader alone
        self._wanted = False  # whether somebody waits for room
        self._strangers = False  # whether a reader may not know us yet: see _greet
        self._least = 0  # every reliable reader has the samples up to this one
        self._since_heartbeat = 0
        self._heartbeats = 0
        self._heartbeat_at: float | None = None
        self._heartbeat_alarm = Alarm(common.schedule, self._ask)
        self._delay = HEARTBEAT_DELAY
        self._repairs = Repairs(self, common, self._flow)

    # -- what its owner does

    def full(self, size: int = 0, key: bytes = b"") -> bool:
        """Whether `write` of `size` octets (of instance `key`) would raise HistoryFull, or run over what the readers of this
        KEEP_ALL writer have been seen to take.

        Once it was, by this or by `write`, a WriterReady event tells when there is room; how long to wait for it is the
        owner's affair (RELIABILITY's max_blocking_time).
        """
        if self._stale:
            self._refresh()
        if not (self.keeps or self._any_reliable):
            return False
        history = self.history
        if not history.full(size, key):
            if not self._blocks or size >= BULK or not len(history):
                return False
            # Small samples never wait in the flow; but who is ready to wait can do so before they overrun the readers.
            under_way = 2 * history.bytes + OVERHEAD * len(history)
            if under_way > self._flow.high:
                self._flow.high = under_way
            if under_way < self._flow.window:
                return False
        self._wanted = True
        return True

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

        `payload` begins with its encapsulation header and may be reused as soon as the datagrams are out; `bytes` are not
        copied. `time` is the source's, now where None. `key` tells the instances of a keyed topic apart: the key hash,
        which `inline_qos` should carry. `to`: the GUID of the one matched reader that it is for; the others learn, when
        next something is sent to them, that they miss nothing. Such samples are an instance of their own for
        KEEP_LAST, unless there is a `key`. If it is not matched nothing is sent, and 0 is returned. Raises HistoryFull.
        """
        if self._stale:
            self._refresh()
        if to and to not in self.proxies:
            self._common.count("write-to-unmatched-reader")
            return 0
        if time is None:
            time = self._common.epoch + int(now * 1000000000)
        sequence = self.last + 1
        size = len(payload)
        kept = self.keeps or self._any_reliable
        bulk = size >= BULK and (
            size > self.fragment_size or to != b"" or not self._flow.spare(size * len(self.addresses), now)
        )
        change: Change | None = None
        if kept or bulk or to:
            if self._lifespan is not None:
                self.history.forget_expired(now)
            if not CPYTHON and not (bulk or to or key or inline_qos) and flags == FLAG_D:
                change = self.history.spare(sequence, payload, time, self.fragment_size, self._outbox.idle)
            if change is None:
                payload = bytes(payload)
                change = Change(sequence, payload, inline_qos, flags, time, key or to, to, self.fragment_size)
            if self._lifespan is not None:
                change.expires = now + self._lifespan
            if kept:
                try:
                    self.history.add(change)
                except HistoryFull:
                    self._wanted = True
                    raise
        if self._strangers:
            self._greet(sequence)
        self.last = sequence
        if self._period is not None:
            self._note_deadline(key, flags, now)
        if self.manual:
            self._assert(now)
            if self._wrote is not None:
                self._wrote(now)
        if not self._addresses:
            return sequence
        if to or self._directed:
            if not self._directed:
                self._directed = True
                for proxy in self.proxies.values():
                    proxy.sent = sequence - 1
            self._repairs.tell_skipped(to, sequence - 1)
        if bulk and change is not None:
            self._repairs.send_bulk(change, self.proxies[to] if to else None)
        elif to and change is not None:
            self._repairs.send_change(self.proxies[to], change, self.proxies[to].addresses)
        else:
            self._send_small(sequence, payload, inline_qos, time, flags)
        if self._any_reliable and self._heartbeat_at is None:
            self._ask_at(now + (BULK_DELAY if bulk else self._delay))
        return sequence

    def _send_small(
        self,
        sequence: int,
        payload: "bytes | bytearray | memoryview",
        inline_qos: bytes,
        time: int,
        flags: int,
    ) -> None:
        size = len(payload) + len(inline_qos)
        if not CPYTHON and self._goes_at_once(size, inline_qos, flags):
            filled = self.preface.fill(sequence, size, time)
            self._outbox.at_once(filled, payload, self._addresses)  # type: ignore[misc]
            return
        seconds, fraction = times.split(time)
        wire_flags = flags | FLAG_E | (FLAG_Q if inline_qos else 0)
        pad = beat = b""
        if self._any_reliable:
            self._since_heartbeat += 1 + size // BULK
            if self._since_heartbeat >= PIGGYBACK:
                self._since_heartbeat = 0
                pad = bytes(-size & 3)
                beat = bytes(self.heartbeat(ENTITYID_UNKNOWN, False).emit())
        front = self.preface.emit(sequence, size + len(pad), seconds, fraction, wire_flags)
        if size > JOINED:
            self._outbox.send((front + inline_qos, payload, pad + beat), self._addresses)
        elif beat or inline_qos:
            self._outbox.send((b"".join((front, inline_qos, bytes(payload), pad, beat)),), self._addresses)
        else:
            self._outbox.send((front + payload,), self._addresses)

    def _goes_at_once(self, size: int, inline_qos: bytes, flags: int) -> bool:
        """Whether a small sample need not be queued: nothing is to go with it, or before it."""
        outbox = self._outbox
        if outbox.at_once is None or not outbox.idle or size > JOINED or inline_qos or flags != FLAG_D:
            return False
        if self._any_reliable:
            if self._since_heartbeat + 1 >= PIGGYBACK:
                return False
            self._since_heartbeat += 1
        return True

    def dispose(
        self, key: bytes, now: float, payload: "bytes | None" = None, time: "int | None" = None
    ) -> int:
        """Say that instance `key` (its key hash, 16 octets) is gone; `payload`: its serialised key, if readers need it."""
        return self._end(key, STATUS_DISPOSED, now, payload, time)

    def unregister(
        self, key: bytes, now: float, payload: "bytes | None" = None, time: "int | None" = None
    ) -> int:
        """Say that we write instance `key` no longer; as `dispose`."""
        return self._end(key, STATUS_UNREGISTERED, now, payload, time)

    def _end(self, key: bytes, status: int, now: float, payload: "bytes | None", time: "int | None") -> int:
        said = inline.InlineQos(key, status).emit()
        flags = 0 if payload is None else FLAG_K
        return self.write(payload or b"", now, time, said, key, flags)

    def is_bulk(self, payload: "bytes | bytearray | memoryview") -> bool:
        """Whether it goes within the window."""
        return len(payload) >= BULK or len(payload) > self.fragment_size

    def acknowledged(self, sequence: int) -> bool:
        """Whether every matched reliable reader has all samples up to `sequence`."""
        return not [one for one in self.proxies.values() if one.reliable and one.acked < sequence]

    def assert_liveliness(self, now: float) -> None:
        """Say that this writer is alive, without a sample. Readers hear of it if it is reliable: it is a heartbeat."""
        self._assert(now)
        beat = self.heartbeat(ENTITYID_UNKNOWN, True)
        beat.liveliness = True
        if self._stale:
            self._refresh()
        for one in self.strangers():
            self._repairs.introduce(one)
        self._outbox.send((self._common.header, beat.emit()), self._addresses)

    def close(self) -> None:
        """It is deleted."""
        self._miss_alarm.cancel()
        self._lease_alarm.cancel()
        self._heartbeat_alarm.cancel()
        self._flow.waiting = []
        self._flow.repairs = []

    # -- matching

    def match(
        self, remote: "EndpointData", addresses: "tuple[Address, ...]", now: float, vendor: bytes = b"\0\0"
    ) -> bool:
        """A reader that goes together with us. False where it was matched already; its addresses may be new."""
        self._stale = True
        known = self.proxies.get(remote.guid)
        if known is not None:
            known.addresses = addresses
            known.data = remote
            return False
        if self._lifespan is not None:
            self.history.forget_expired(now)
        late = self.keeps and remote.qos.durability >= TRANSIENT_LOCAL
        start = self.history.first(self.last + 1) if late else self.last + 1
        proxy = ReaderProxy(remote, addresses, start, remote.qos.reliable and self.reliable, vendor, late)
        proxy.sent = self.last
        self._least = min(self._least, proxy.acked) if proxy.reliable else self._least
        self.proxies[remote.guid] = proxy
        if late:
            self._repairs.send_all(proxy, self.history.numbers(), proxy.addresses)
        if proxy.reliable:
            self._repairs.introduce(proxy)
            self._strangers = not guids.is_builtin(self.data.guid)
            if late and len(self.history) and self._heartbeat_at is None:
                self._ask_at(now + self._delay)
        return True

    def _greet(self, sequence: int) -> None:
        """Before sample `sequence`, introduce us again to readers that have said nothing yet: the first introduction may
        have come before they knew of us. A volatile reader of Cyclone takes for history, of which it has no use, what the
        first heartbeat that it sees tells of, so until it answers each one says where it begins."""
        self._strangers = False
        beats = self._since_heartbeat + 1 >= PIGGYBACK
        for proxy in self.proxies.values():
            if proxy.reliable and proxy.count < 0:
                self._strangers = True
                if beats or sequence - proxy.start < GREETINGS:
                    self._repairs.introduce(proxy)

    def strangers(self) -> "list[ReaderProxy]":
        """The reliable readers that have said nothing yet and for which there are samples: see `_greet`."""
        if not self._strangers:
            return []
        return [
            one
            for one in self.proxies.values()
            if one.reliable and one.count < 0 and not one.late and one.start <= self.last
        ]

    def moved(self) -> None:
        """Our host's addresses have changed."""
        self._stale = True

    def unmatch(self, guid: bytes, now: float = 0.0) -> "ReaderProxy | None":
        """Forget a reader."""
        proxy = self.proxies.pop(guid, None)
        if proxy is not None:
            self._refresh()
            self._forget_acknowledged()
        return proxy

    def _refresh(self) -> None:
        self._stale = False
        proxies = list(self.proxies.values())
        self._addresses = addresses_for_all(proxies)
        here = self._common.here
        near = not [host for host, _ in self._addresses if not here(host)]
        self.fragment_size = self._near_size if near else self._far_size
        reliable = [one for one in proxies if one.reliable]
        self._any_reliable = bool(reliable)
        self._tells = self._any_reliable and not [one for one in reliable if one.vendor != VENDORID_ROSLET]
        if not self._any_reliable:
            self._heartbeat_at = None

    @property
    def addresses(self) -> "tuple[Address, ...]":
        """Where a sample for all readers goes."""
        if self._stale:
            self._refresh()
        return self._addresses

    @property
    def any_reliable(self) -> bool:
        """Whether a matched reader acknowledges."""
        if self._stale:
            self._refresh()
        return self._any_reliable

    @property
    def tells(self) -> bool:
        """Whether all who acknowledge are roslet's: they say how far a large sample has come."""
        if self._stale:
            self._refresh()
        return self._tells

    # -- heartbeats

    def heartbeat(self, reader_id: bytes, final: bool, last: "int | None" = None) -> Heartbeat:
        """The next one, of the samples up to `last`, all of them where None."""
        self._heartbeats += 1
        first = self.history.first(self.last + 1)
        if last is None:
            last = self.last
        return Heartbeat(reader_id, self.entity_id, min(first, last + 1), last, self._heartbeats, final)

    def next_count(self) -> int:
        """For a HEARTBEAT_FRAG."""
        self._heartbeats += 1
        return self._heartbeats

    def ask_soon(self, now: float) -> None:
        """There is something to acknowledge, and somebody who does."""
        self._delay = HEARTBEAT_DELAY
        if self.any_reliable:
            self._ask_at(now + self._delay)

    def _ask_at(self, at: float) -> None:
        self._heartbeat_at = at
        self._heartbeat_alarm.set(at)

    def _ask(self, now: float) -> None:
        """Ask for acknowledgements, ever more rarely while none come."""
        if self._heartbeat_at is None:
            return
        if now < self._heartbeat_at:
            self._heartbeat_alarm.set(self._heartbeat_at)
            return
        if self._repairs.busy:
            # Whoever is asked for all now would ask for what is on its way.
            if self._flow.last_sent is not None:
                self._repairs.ask_for(self._flow.last_sent)
            self._ask_at(now + BULK_DELAY)
            return
        self._heartbeat_at = None
        behind = [one for one in self.proxies.values() if one.reliable and one.acked < self.last]
        if not behind:
            return
        strangers = self.strangers()
        if strangers or self._directed or len(behind) == 1 or 2 * len(behind) <= len(self.addresses):
            # Whoever has everything would answer too.
            for one in behind:
                if self._directed:
                    self._repairs.tell_skipped(one.guid, self.last)
                if one in strangers:
                    self._repairs.introduce(one)
                    continue
                beat = self.heartbeat(one.guid[12:], False).emit()
                self._outbox.send((self._common.header, one.info_dst, beat), one.addresses)
        else:
            beat = self.heartbeat(ENTITYID_UNKNOWN, False).emit()
            self._outbox.send((self._common.header, beat), self.addresses)
        self._since_heartbeat = 0
        self._delay = min(2 * self._delay, HEARTBEAT_LONGEST)
        self._ask_at(now + self._delay)

    # -- what readers say

    def handle_acknack(
        self, value: "AckNack", guid: bytes, now: float, reply: "tuple[Address, ...]" = ()
    ) -> None:
        """An ACKNACK of reader `guid`: note what it has, send again what it lacks, to `reply` if an INFO_REPLY says so."""
        proxy = self.proxies.get(guid)
        if proxy is None or not proxy.reliable:
            self._common.count("acknack-of-unmatched-reader")
            return
        if value.count == proxy.count:
            self._common.count("acknack-repeated")
            return
        first = proxy.count < 0
        proxy.count = value.count
        if self._lifespan is not None:
            self.history.forget_expired(now)
        acked = min(value.state.base - 1, self.last)
        if acked > proxy.acked:
            before = proxy.acked
            proxy.acked = acked
            self._delay = HEARTBEAT_DELAY
            if proxy.resent:
                proxy.resent = {number: at for number, at in proxy.resent.items() if number > acked}
            if before <= self._least:
                self._forget_acknowledged()
        if value.state.bits and self._repairs.send_again(proxy, value, now, reply or proxy.addresses):
            self._delay = HEARTBEAT_DELAY
            self._ask_at(now + self._delay)
        elif first and not proxy.late and proxy.acked < self.last:
            # It knows of us only now.
            self._repairs.introduce(proxy, reply or proxy.addresses)
        elif not value.final and not self._repairs.busy:
            beat = self.heartbeat(proxy.guid[12:], proxy.acked >= self.last).emit()
            self._outbox.send((self._common.header, proxy.info_dst, beat), reply or proxy.addresses)

    def handle_nack_frag(
        self, value: "NackFrag", guid: bytes, now: float, reply: "tuple[Address, ...]" = ()
    ) -> None:
        """A NACK_FRAG of reader `guid`: send those fragments again."""
        proxy = self.proxies.get(guid)
        if proxy is None or not proxy.reliable:
            self._common.count("nack-frag-of-unmatched-reader")
            return
        if value.count == proxy.frag_count:
            self._common.count("nack-frag-repeated")
            return
        proxy.frag_count = value.count
        if value.sequence > self.last:
            # A GAP over what is yet to be written would lose it.
            self._common.count("nack-frag-of-unwritten-sample")
            return
        self._repairs.send_fragments_again(proxy, value, now, reply or proxy.addresses)

    def _forget_acknowledged(self) -> None:
        least = self.last
        for proxy in self.proxies.values():
            if proxy.reliable and proxy.acked < least:
                least = proxy.acked
        self._least = least
        if self.keeps:
            self.history.forget_ended(least)
        else:
            self.history.remove_through(least)
        self._repairs.acknowledged(least)
        if self._wanted and not self.full(0):
            self._wanted = False
            self._common.deliver(WriterReady(self.entity_id))

    # -- DEADLINE and LIVELINESS

    def _note_deadline(self, key: bytes, flags: int, now: float) -> None:
        if self._period is None:
            return
        if not self.keyed:
            key = b""
        elif not flags & FLAG_D:
            self._due.pop(key, None)
            return
        elif key not in self._due and len(self._due) >= self._common.limits.instances:
            self._common.count("instances-full")
            return
        self._due[key] = now + self._period
        self._miss_alarm.set(now + self._period)

    def _missed(self, now: float) -> None:
        if self._period is None:
            return
        for key, due in list(self._due.items()):
            if now >= due:
                self._due[key] = now + self._period
                self._common.deliver(DeadlineMissed(self.entity_id, key))
            self._miss_alarm.set(self._due[key])

    def watch_liveliness(self, now: float) -> None:
        """From now on its owner must assert it, or LivelinessLost is told."""
        self._assert(now)

    def _assert(self, now: float) -> None:
        if not self.manual:
            return
        self._asserted = now
        self._lease_alarm.set(now + self._lease)
        if not self._alive:
            self._alive = True
            self._common.deliver(LivelinessRegained(self.entity_id, self.data.guid))

    def _lease_over(self, now: float) -> None:
        if now < self._asserted + self._lease:
            self._lease_alarm.set(self._asserted + self._lease)
        elif self._alive:
            self._alive = False
            self._common.deliver(LivelinessLost(self.entity_id, self.data.guid))
