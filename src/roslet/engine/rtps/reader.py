"""A reader and what it knows of its writers. RTPS 2.3, 8.4.10, 8.4.12 (behaviour), 8.4.2.3 (what any reader must do).

Of a reliable writer every sample is delivered once and in order, or reported lost when the writer no longer has it; of a
best-effort one what comes, never backwards.
"""

from roslet.engine.rtps.events import DeadlineMissed, SampleReceived, SampleRejected, SamplesLost
from roslet.engine.rtps.fragments import Assembly, cost
from roslet.engine.rtps.instances import Instances
from roslet.engine.rtps.schedule import Alarm
from roslet.wire.rtps import guid as guids
from roslet.wire.rtps import info_dst, inline_qos, number_set
from roslet.wire.rtps.ack_nack import AckNack
from roslet.wire.rtps.data import FLAG_D, FLAG_K, Data
from roslet.wire.rtps.data_frag import FLAG_K as FRAGMENT_OF_KEY
from roslet.wire.rtps.guid import VENDORID_EPROSIMA, VENDORID_ROSLET
from roslet.wire.rtps.nack_frag import NackFrag
from roslet.wire.rtps.qos import KEEP_ALL
from roslet.wire.rtps.times import INFINITE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from roslet.engine.rtps.common import Common
    from roslet.engine.rtps.outbox import Address
    from roslet.wire.rtps.data_frag import DataFrag
    from roslet.wire.rtps.endpoint_data import EndpointData
    from roslet.wire.rtps.gap import Gap
    from roslet.wire.rtps.heartbeat import Heartbeat
    from roslet.wire.rtps.heartbeat_frag import HeartbeatFrag

    Sink = Callable[["WriterProxy", Data, "int | None"], None]
    KeyOf = Callable[[Data], bytes]

# Seconds between two requests to one writer: what was asked for is on its way meanwhile.
NACK_INTERVAL = 0.005
# Seconds until what was asked for and did not come is asked for again without a heartbeat, doubled up to the longest while
# nothing comes: the request or all of the answer may be lost, and the writer's next heartbeat too. Of roslet's writers
# only: 8.4.2.3 has readers answer heartbeats, and others may hold to it.
RETRY_DELAY = 0.05
RETRY_LONGEST = 0.8
# Seconds until a writer that has not told where it is gets asked, doubled each time, and how often.
HELLO_DELAY = 0.1
HELLO_TIMES = 8


class WriterProxy:
    """A matched remote writer. `next`: the lowest number not yet delivered; `last`: the highest it said to have;
    `vendor`: the vendor id of its participant."""

    __slots__ = (
        "ack_at",
        "addresses",
        "alarm",
        "asked",
        "assemblies",
        "count",
        "data",
        "frag_count",
        "guid",
        "heartbeat",
        "held",
        "held_bytes",
        "hello_at",
        "hellos",
        "info_dst",
        "last",
        "lifespan",
        "nacked_at",
        "nacked_next",
        "next",
        "plain",
        "reliable",
        "reply",
        "retry",
        "retry_at",
        "synced",
        "vendor",
    )  # fmt: skip

    def __init__(
        self, remote: "EndpointData", addresses: "tuple[Address, ...]", reliable: bool, vendor: bytes
    ) -> None:
        self.alarm: Alarm
        self.plain = False  # whether there is neither LIFESPAN nor a key to look at
        self.guid = remote.guid
        self.reliable = reliable
        self.next = 1
        self.last = 0
        self.synced = False  # whether the writer has told where its samples begin
        self.held: dict[int, Any] = {}  # what came too early: Data and time, or None for what never comes
        self.held_bytes = 0
        self.assemblies: dict[int, Assembly] = {}
        self.heartbeat = -1
        self.count = 0
        self.frag_count = 0
        self.ack_at: float | None = None
        self.asked = False  # whether a heartbeat waits for an answer
        self.nacked_at = -1.0
        self.nacked_next = 0  # what `next` was then
        self.retry = RETRY_DELAY
        self.retry_at: float | None = None
        self.hellos = 0
        self.hello_at: float | None = None
        self.reply: tuple[Address, ...] = ()  # where the next answer goes, if an INFO_REPLY said so
        self.vendor = vendor
        self.info_dst = bytes(info_dst.InfoDestination(remote.guid[:12]).emit())
        self.update(remote, addresses)

    def update(self, remote: "EndpointData", addresses: "tuple[Address, ...]") -> None:
        """It was announced anew."""
        self.data = remote
        self.addresses = addresses
        self.lifespan: int | None = remote.qos.lifespan if remote.qos.lifespan < INFINITE else None


class Reader:
    """Made by `Participant.create_reader`. Samples go to `sink` where there is one, else to events."""

    def __init__(
        self,
        endpoint: "EndpointData",
        common: "Common",
        sink: "Sink | None" = None,
        key_of: "KeyOf | None" = None,
    ) -> None:
        self.data = endpoint
        self.entity_id = endpoint.guid[12:]
        self.qos = endpoint.qos
        self.reliable = self.qos.reliable
        self.sink = sink
        self.proxies: dict[bytes, WriterProxy] = {}
        self._common = common
        self._limits = common.limits
        self._count = common.count
        self._key_of = key_of
        samples, instances, self._an_instance = self.qos.resource_limits
        self._max_held = self._limits.held_samples
        if self.qos.history[0] == KEEP_ALL and samples > 0:
            self._max_held = min(self._max_held, samples)
        self._period = self.qos.deadline / 1e9 if self.qos.deadline < INFINITE else None
        self._miss_at: float | None = None
        self._alarm = Alarm(common.schedule, self._missed)
        self.instances: Instances | None = None
        if guids.is_keyed(endpoint.guid) and not guids.is_builtin(endpoint.guid):
            limit = min(instances, self._limits.instances) if instances > 0 else self._limits.instances
            self.instances = Instances(self.entity_id, limit, self._period, common.deliver)

    # -- matching

    def match(
        self, remote: "EndpointData", addresses: "tuple[Address, ...]", now: float, vendor: bytes = b"\0\0"
    ) -> bool:
        """A writer that goes together with us. False where it was matched already; its addresses may be new."""
        known = self.proxies.get(remote.guid)
        if known is not None:
            known.update(remote, addresses)
            known.plain = self.instances is None and known.lifespan is None
            return False
        proxy = WriterProxy(remote, addresses, self.reliable and remote.qos.reliable, vendor)
        proxy.plain = self.instances is None and proxy.lifespan is None
        proxy.alarm = Alarm(self._common.schedule, lambda now: self._due(proxy, now))
        self.proxies[remote.guid] = proxy
        if proxy.reliable:
            proxy.hello_at = now
            proxy.alarm.set(now)
        return True

    def unmatch(self, guid: bytes, now: float = 0.0) -> "WriterProxy | None":
        """Forget a writer."""
        proxy = self.proxies.pop(guid, None)
        if proxy is not None:
            proxy.alarm.cancel()
            for sequence in list(proxy.assemblies):
                self._drop_assembly(proxy, sequence)
            for sequence in list(proxy.held):
                self._take_held(proxy, sequence)
            if self.instances is not None:
                self.instances.writer_lost(guid)
        return proxy

    def close(self) -> None:
        """It is deleted."""
        self._alarm.cancel()

    # -- samples

    def handle_data(self, proxy: WriterProxy, value: "Data", time: "int | None", now: float) -> None:
        """A DATA of a matched writer."""
        sequence = value.sequence
        if self._period is not None:
            self.note_sample(now)
        if sequence == proxy.next and (proxy.synced or not proxy.reliable or sequence == 1):
            # The ordinary case first. There is nothing before the first sample, whatever the writer has told us.
            if proxy.plain and self.sink is not None:
                proxy.next = sequence + 1
                proxy.synced = True
                self.sink(proxy, value, time)
            elif self._hand_over(proxy, value, time, now):
                proxy.synced = True
            if proxy.held:
                self._drain(proxy, now)
            return
        if sequence < proxy.next:
            self._count("sample-repeated")
            return
        if not proxy.reliable:
            if proxy.synced:
                self._common.deliver(SamplesLost(self.entity_id, proxy.guid, sequence - proxy.next))
            proxy.synced = True
            proxy.next = sequence
            self._hand_over(proxy, value, time, now)
            return
        self._hold(proxy, sequence, value, time)
        if not proxy.synced and proxy.ack_at is None:
            # Its heartbeat was lost, or came before we knew it, and the next one may be seconds away.
            proxy.last = max(proxy.last, sequence)
            self._answer_at(proxy, max(now, proxy.nacked_at + NACK_INTERVAL))

    def _hold(self, proxy: WriterProxy, sequence: int, value: "Data", time: "int | None") -> None:
        if sequence in proxy.held:
            self._count("sample-repeated")
            return
        size = len(value.payload)
        if (
            len(proxy.held) >= self._max_held
            or proxy.held_bytes + size > self._limits.held_bytes
            or (self._an_instance > 0 and self._waiting(proxy, value) >= self._an_instance)
        ):
            self._count("held-samples-full")
            return
        if not self._common.holding.take(proxy.guid[:12], size + len(value.inline_qos)):
            self._count("held-bytes-full")
            return
        # The datagram's buffer is not ours to keep.
        value = Data(
            value.reader_id,
            value.writer_id,
            sequence,
            bytes(value.payload),
            bytes(value.inline_qos),
            value.flags,
            value.little,
        )
        proxy.held[sequence] = (value, time)
        proxy.held_bytes += size

    def _waiting(self, proxy: WriterProxy, value: "Data") -> int:
        """How many held samples are of the same instance."""
        key = self._key(value)[0]
        return len([one for one in proxy.held.values() if one is not None and self._key(one[0])[0] == key])

    def _take_held(self, proxy: WriterProxy, sequence: int) -> "Any":
        """(value, time), or None for what never comes."""
        one = proxy.held.pop(sequence)
        if one is not None:
            size = len(one[0].payload)
            proxy.held_bytes -= size
            self._common.holding.give(proxy.guid[:12], size + len(one[0].inline_qos))
        return one

    def _key(self, value: "Data") -> "tuple[bytes, int]":
        said = inline_qos.parse(value.inline_qos, value.little)
        key = said.key_hash
        if not key and self._key_of is not None:
            key = self._key_of(value)
        return key, said.status

    def _hand_over(self, proxy: WriterProxy, value: "Data", time: "int | None", now: float) -> bool:
        """Deliver the sample at `proxy.next`; false where there is no room for it, and it stays the next one."""
        if not proxy.plain:
            if proxy.lifespan is not None and time is not None:
                here = self._common.epoch + int(now * 1000000000)
                if here > time + proxy.lifespan:
                    self._count("sample-expired")
                    proxy.next = value.sequence + 1
                    return True
            if self.instances is not None:
                key, status = self._key(value)
                if not status and not self.instances.room(key):
                    self._count("instances-full")
                    self._common.deliver(SampleRejected(self.entity_id, proxy.guid, key))
                    if not proxy.reliable:
                        proxy.next = value.sequence + 1
                    return False
                self.instances.note(key, status, proxy.guid, now)
                if self._period is not None and self._miss_at is None:
                    self._miss_at = now + self._period
                    self._alarm.set(self._miss_at)
        proxy.next = value.sequence + 1
        if self.sink is not None:
            self.sink(proxy, value, time)
            return True
        self._common.deliver(
            SampleReceived(
                self.entity_id,
                proxy.guid,
                value.sequence,
                value.payload,
                time,
                value.flags,
                value.inline_qos,
                value.little,
            )
        )
        return True

    def _drain(self, proxy: WriterProxy, now: float) -> None:
        """Deliver what was held and is now in order."""
        while proxy.next in proxy.held:
            sequence = proxy.next
            one = self._take_held(proxy, sequence)
            if one is None:
                proxy.next = sequence + 1
            elif not self._hand_over(proxy, one[0], one[1], now):
                break

    # -- DEADLINE

    def note_sample(self, now: float) -> None:
        """A sample came: of a topic without a key it is due again a period from now."""
        if self.instances is None and self._period is not None:
            self._miss_at = now + self._period
            self._alarm.set(self._miss_at)

    def _missed(self, now: float) -> None:
        if self._miss_at is None or self._period is None:
            return
        if now >= self._miss_at:
            if self.instances is not None:
                self._miss_at = self.instances.missed(now)
            else:
                self._miss_at = now + self._period
                self._common.deliver(DeadlineMissed(self.entity_id))
        if self._miss_at is not None:
            self._alarm.set(self._miss_at)

    # -- fragments

    def handle_data_frag(self, proxy: WriterProxy, value: "DataFrag", time: "int | None", now: float) -> None:
        """A DATA_FRAG of a matched writer."""
        sequence = value.sequence
        if sequence < proxy.next or sequence in proxy.held:
            self._count("sample-repeated")
            return
        assembly = proxy.assemblies.get(sequence)
        if assembly is None:
            if value.sample_size > self._limits.sample_bytes:
                self._count("sample-too-large")
                return
            if len(proxy.assemblies) >= self._limits.assemblies:
                # Best effort gives up the oldest; of a reliable writer the earlier is needed first, and the later
                # will be sent again.
                latest = max(proxy.assemblies)
                self._count("assemblies-full")
                if proxy.reliable and sequence > latest:
                    return
                self._drop_assembly(proxy, latest if proxy.reliable else min(proxy.assemblies))
            if not self._common.assembling.take(
                proxy.guid[:12], cost(value.sample_size, value.fragment_size)
            ):
                self._count("assembly-bytes-full")
                return
            assembly = proxy.assemblies[sequence] = Assembly(value, time)
        if not assembly.add(value):
            self._count("fragment-of-another-size")
            return
        if assembly.left:
            return
        self._drop_assembly(proxy, sequence)
        flags = FLAG_K if assembly.flags & FRAGMENT_OF_KEY else FLAG_D
        whole = value_of(value, assembly, flags)
        self.handle_data(proxy, whole, assembly.time, now)

    def _drop_assembly(self, proxy: WriterProxy, sequence: int) -> None:
        assembly = proxy.assemblies.pop(sequence, None)
        if assembly is not None:
            self._common.assembling.give(proxy.guid[:12], cost(assembly.size, assembly.fragment_size))

    # -- what writers say

    def handle_heartbeat(
        self, proxy: WriterProxy, value: "Heartbeat", now: float, reply: "tuple[Address, ...]" = ()
    ) -> None:
        """A HEARTBEAT of a matched writer: what it no longer has is lost, what we lack is asked for, at `reply` if any."""
        if not proxy.reliable:
            return
        if value.count == proxy.heartbeat:
            self._count("heartbeat-repeated")
            return
        proxy.heartbeat = value.count
        if value.first > proxy.next:
            self._skip_to(proxy, value.first, proxy.synced, now)
        proxy.synced = True
        proxy.hello_at = None
        if value.last > proxy.last:
            proxy.last = value.last
        if proxy.held:
            self._drain(proxy, now)
        if not value.final or proxy.next <= proxy.last:
            proxy.reply = reply
            proxy.asked = True
            if proxy.ack_at is None:
                lacks = proxy.next <= proxy.last
                self._answer_at(proxy, max(now, proxy.nacked_at + NACK_INTERVAL) if lacks else now)

    def handle_heartbeat_frag(
        self, proxy: WriterProxy, value: "HeartbeatFrag", now: float, reply: "tuple[Address, ...]" = ()
    ) -> None:
        """A HEARTBEAT_FRAG of a matched writer: ask for what is missing of that sample."""
        assembly = proxy.assemblies.get(value.sequence)
        if proxy.reliable and assembly is not None:
            assembly.told = max(assembly.told, value.last_fragment)
            assembly.asked = proxy.vendor == VENDORID_ROSLET
            proxy.reply = reply
            if proxy.ack_at is None:
                lacks = assembly.missing(assembly.told).bits
                self._answer_at(proxy, max(now, proxy.nacked_at + NACK_INTERVAL) if lacks else now)

    def handle_gap(self, proxy: WriterProxy, value: "Gap", now: float) -> None:
        """A GAP of a matched writer: those numbers never come."""
        if not proxy.reliable:
            return
        start, base = value.start, value.gaps.base
        if start <= proxy.next:
            if base > proxy.next:
                self._skip_to(proxy, base, False, now)
            proxy.synced = True  # everything below is accounted for
        else:
            for sequence in range(start, min(base, start + number_set.MAX_BITS)):
                self._never(proxy, sequence)
        for sequence in value.gaps.numbers():
            self._never(proxy, sequence)
        if proxy.next > proxy.last:
            proxy.last = proxy.next - 1
        if proxy.synced:
            self._drain(proxy, now)

    def _never(self, proxy: WriterProxy, sequence: int) -> None:
        if sequence < proxy.next or sequence in proxy.held or len(proxy.held) >= self._limits.held_samples:
            return
        proxy.held[sequence] = None
        self._drop_assembly(proxy, sequence)

    def _skip_to(self, proxy: WriterProxy, first: int, lost: bool, now: float) -> None:
        """Deliver what is held below `first`, in order, and go on from there."""
        missing = first - proxy.next
        for sequence in sorted([number for number in proxy.held if number < first]):
            if sequence not in proxy.held:
                return  # the sink has deleted this reader
            one = self._take_held(proxy, sequence)
            missing -= 1
            if one is not None:
                self._hand_over(proxy, one[0], one[1], now)
        for sequence in [number for number in proxy.assemblies if number < first]:
            self._drop_assembly(proxy, sequence)
        proxy.next = first
        if lost and missing:
            self._common.deliver(SamplesLost(self.entity_id, proxy.guid, missing))

    # -- answers

    def _answer_at(self, proxy: WriterProxy, at: float) -> None:
        proxy.ack_at = at
        proxy.alarm.set(at)

    def _due(self, proxy: WriterProxy, now: float) -> None:
        """Send the acknowledgement or request that is due."""
        if self.proxies.get(proxy.guid) is not proxy:
            return
        if proxy.ack_at is not None and now >= proxy.ack_at:
            proxy.ack_at = None
            self._answer(proxy, now)
        elif proxy.retry_at is not None and now >= proxy.retry_at:
            proxy.retry_at = None
            if proxy.next <= proxy.last:
                self._answer(proxy, now)
        elif proxy.hello_at is not None and now >= proxy.hello_at:
            proxy.hellos += 1
            delay = HELLO_DELAY * (1 << proxy.hellos)
            proxy.hello_at = now + delay if proxy.hellos < HELLO_TIMES else None
            # Fast DDS answers at once only to this form, which the specification does not have.
            base = 0 if proxy.vendor == VENDORID_EPROSIMA and proxy.next == 1 else proxy.next
            self._send_acknack(proxy, base, [], False)
        for at in (proxy.ack_at, proxy.retry_at, proxy.hello_at):
            if at is not None:
                proxy.alarm.set(at)

    def _answer(self, proxy: WriterProxy, now: float) -> None:
        missing = []
        if proxy.next <= proxy.last:
            # No more than can be kept: where heap is short, to note them all may take too much of it.
            most = min(number_set.MAX_BITS, self._limits.held_samples)
            for sequence in range(proxy.next, min(proxy.last + 1, proxy.next + most)):
                if sequence not in proxy.held and sequence not in proxy.assemblies:
                    missing.append(sequence)
        partial = []
        for sequence, assembly in proxy.assemblies.items():
            # What the writer has not yet said to have sent is on its way.
            lacks = assembly.missing(assembly.count if sequence <= proxy.last else assembly.told)
            if lacks.bits or assembly.asked:
                assembly.asked = False
                partial.append((sequence, lacks))
        lacking = bool(missing or [one for one in partial if one[1].bits])
        if lacking:
            proxy.nacked_at = now
            proxy.retry = (
                RETRY_DELAY if proxy.next != proxy.nacked_next else min(2 * proxy.retry, RETRY_LONGEST)
            )
            proxy.nacked_next = proxy.next
            if proxy.vendor == VENDORID_ROSLET:
                proxy.retry_at = now + proxy.retry
        if proxy.asked or missing or not partial:
            proxy.asked = False
            self._send_acknack(proxy, proxy.next, missing, not lacking)
        for sequence, lacks in partial:
            proxy.frag_count += 1
            request = NackFrag(self.entity_id, proxy.guid[12:], sequence, lacks, proxy.frag_count)
            self._common.outbox.send(
                (self._common.header, proxy.info_dst, request.emit()), proxy.reply or proxy.addresses
            )
        proxy.reply = ()

    def _send_acknack(self, proxy: WriterProxy, base: int, missing: "list[int]", final: bool) -> None:
        proxy.count += 1
        # Who has the last number that there is cannot say so.
        state = number_set.of(min(base, number_set.MAX_NUMBER), missing)
        answer = AckNack(self.entity_id, proxy.guid[12:], state, proxy.count, final)
        self._common.outbox.send(
            (self._common.header, proxy.info_dst, answer.emit()), proxy.reply or proxy.addresses
        )


def value_of(fragment: "DataFrag", assembly: Assembly, flags: int) -> "Data":
    """The DATA that the writer would have sent, had the sample fitted a datagram."""
    return Data(
        fragment.reader_id,
        fragment.writer_id,
        fragment.sequence,
        memoryview(assembly.data),
        assembly.inline_qos,
        flags,
        assembly.little,
    )
