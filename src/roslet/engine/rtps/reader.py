"""A reader and what it knows of its writers. RTPS 2.3, 8.4.10, 8.4.12 (behaviour), 8.4.2.3 (what any reader must do).

Of a reliable writer every sample is delivered once and in order, or reported lost when the writer no longer has it; of a
best-effort one what comes, never backwards.
"""

from roslet.engine.rtps.events import DeadlineMissed, SampleReceived, SamplesLost
from roslet.engine.rtps.fragments import Assembly
from roslet.wire.rtps import info_dst, number_set
from roslet.wire.rtps.ack_nack import AckNack
from roslet.wire.rtps.data import FLAG_D, FLAG_K, Data
from roslet.wire.rtps.data_frag import FLAG_K as FRAGMENT_OF_KEY
from roslet.wire.rtps.nack_frag import NackFrag
from roslet.wire.rtps.times import INFINITE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from roslet.engine.rtps.fragments import Budget
    from roslet.engine.rtps.limits import Limits
    from roslet.engine.rtps.outbox import Address, Outbox
    from roslet.wire.rtps.data_frag import DataFrag
    from roslet.wire.rtps.endpoint_data import EndpointData
    from roslet.wire.rtps.gap import Gap
    from roslet.wire.rtps.heartbeat import Heartbeat
    from roslet.wire.rtps.heartbeat_frag import HeartbeatFrag

    Sink = Callable[["WriterProxy", Data, "int | None"], None]

# Seconds between two requests to one writer: what was asked for is on its way meanwhile.
NACK_INTERVAL = 0.005
# Seconds until a writer that has not told where it is gets asked, doubled each time, and how often.
HELLO_DELAY = 0.1
HELLO_TIMES = 8


class WriterProxy:
    """A matched remote writer. `next`: the lowest number not yet delivered; `last`: the highest it said to have."""

    __slots__ = (
        "ack_at",
        "addresses",
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
        "nacked_at",
        "next",
        "reliable",
        "synced",
    )  # fmt: skip

    def __init__(
        self, remote: "EndpointData", addresses: "tuple[Address, ...]", reliable: bool, now: float
    ) -> None:
        self.data = remote
        self.guid = remote.guid
        self.addresses = addresses
        self.reliable = reliable
        self.next = 1
        self.last = 0
        self.synced = False  # whether the writer has told where its samples begin
        self.held: dict[int, Any] = {}  # what came too early: Data, or None for what never comes
        self.held_bytes = 0
        self.assemblies: dict[int, Assembly] = {}
        self.heartbeat = -1
        self.count = 0
        self.frag_count = 0
        self.ack_at: float | None = None
        self.nacked_at = -1.0
        self.hellos = 0
        self.hello_at: float | None = now if reliable else None
        self.info_dst = bytes(info_dst.InfoDestination(remote.guid[:12]).emit())


class Reader:
    """Made by `Participant.create_reader`. `deliver` gets events; samples go to `sink` instead where there is one."""

    def __init__(
        self,
        endpoint: "EndpointData",
        header: bytes,
        outbox: "Outbox",
        counters: "dict[str, int]",
        limits: "Limits",
        budget: "Budget",
        deliver: "Callable[[Any], None]",
        sink: "Sink | None" = None,
    ) -> None:
        self.data = endpoint
        self.entity_id = endpoint.guid[12:]
        self.qos = endpoint.qos
        self.reliable = self.qos.reliable
        self.proxies: dict[bytes, WriterProxy] = {}
        self._header = header
        self._outbox = outbox
        self._counters = counters
        self._limits = limits
        self._budget = budget
        self._deliver = deliver
        self.sink = sink
        self._period = self.qos.deadline / 1e9 if self.qos.deadline < INFINITE else None
        self._miss_at: float | None = None

    # -- matching

    def match(self, remote: "EndpointData", addresses: "tuple[Address, ...]", now: float) -> bool:
        """A writer that goes together with us. False where it was matched already; its addresses may be new."""
        known = self.proxies.get(remote.guid)
        if known is not None:
            known.addresses = addresses
            known.data = remote
            return False
        self.proxies[remote.guid] = WriterProxy(remote, addresses, self.reliable and remote.qos.reliable, now)
        return True

    def unmatch(self, guid: bytes) -> "WriterProxy | None":
        """Forget a writer."""
        proxy = self.proxies.pop(guid, None)
        if proxy is not None:
            for assembly in proxy.assemblies.values():
                self._budget.left += assembly.size
            proxy.assemblies = {}
        return proxy

    # -- samples

    def handle_data(self, proxy: WriterProxy, value: "Data", time: "int | None", now: float) -> None:
        """A DATA of a matched writer."""
        sequence = value.sequence
        if self._period is not None:
            self._miss_at = now + self._period
        if sequence == proxy.next and (proxy.synced or not proxy.reliable):
            # The ordinary case first.
            proxy.next = sequence + 1
            proxy.synced = True
            self._hand_over(proxy, value, time)
            if proxy.held:
                self._drain(proxy)
            return
        if sequence < proxy.next:
            self._count("sample-repeated")
            return
        if not proxy.reliable:
            if proxy.synced:
                self._deliver(SamplesLost(self.entity_id, proxy.guid, sequence - proxy.next))
            proxy.synced = True
            proxy.next = sequence + 1
            self._hand_over(proxy, value, time)
            return
        self._hold(proxy, sequence, value, time)

    def _hold(self, proxy: WriterProxy, sequence: int, value: "Data", time: "int | None") -> None:
        if sequence in proxy.held:
            self._count("sample-repeated")
            return
        size = len(value.payload)
        if len(proxy.held) >= self._limits.held_samples or proxy.held_bytes + size > self._limits.held_bytes:
            self._count("held-samples-full")
            return
        # The datagram's buffer is not ours to keep.
        value.payload = bytes(value.payload)
        value.inline_qos = bytes(value.inline_qos)
        proxy.held[sequence] = (value, time)
        proxy.held_bytes += size

    def _hand_over(self, proxy: WriterProxy, value: "Data", time: "int | None") -> None:
        if self.sink is not None:
            self.sink(proxy, value, time)
            return
        self._deliver(
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

    def _drain(self, proxy: WriterProxy) -> None:
        """Deliver what was held and is now in order."""
        held = proxy.held
        while proxy.next in held:
            one = held.pop(proxy.next)
            proxy.next += 1
            if one is not None:
                proxy.held_bytes -= len(one[0].payload)
                self._hand_over(proxy, one[0], one[1])

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
            if value.sample_size > self._budget.left:
                self._count("assembly-bytes-full")
                return
            self._budget.left -= value.sample_size
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
            self._budget.left += assembly.size

    # -- what writers say

    def handle_heartbeat(self, proxy: WriterProxy, value: "Heartbeat", now: float) -> None:
        """A HEARTBEAT of a matched writer: what it no longer has is lost, what we lack is asked for."""
        if not proxy.reliable:
            return
        if value.count == proxy.heartbeat:
            self._count("heartbeat-repeated")
            return
        proxy.heartbeat = value.count
        if value.first > proxy.next:
            self._skip_to(proxy, value.first, proxy.synced)
        proxy.synced = True
        proxy.hello_at = None
        if value.last > proxy.last:
            proxy.last = value.last
        self._drain(proxy)
        if not value.final or proxy.next <= proxy.last:
            self._acknowledge_at(proxy, now)

    def handle_heartbeat_frag(self, proxy: WriterProxy, value: "HeartbeatFrag", now: float) -> None:
        """A HEARTBEAT_FRAG of a matched writer: ask for what is missing of that sample."""
        assembly = proxy.assemblies.get(value.sequence)
        if proxy.reliable and assembly is not None:
            assembly.told = max(assembly.told, value.last_fragment)
            if proxy.ack_at is None:
                proxy.ack_at = max(now, proxy.nacked_at + NACK_INTERVAL)

    def handle_gap(self, proxy: WriterProxy, value: "Gap", now: float) -> None:
        """A GAP of a matched writer: those numbers never come."""
        if not proxy.reliable:
            return
        start, base = value.start, value.gaps.base
        if start <= proxy.next:
            if base > proxy.next:
                self._skip_to(proxy, base, False)
        else:
            for sequence in range(start, min(base, start + number_set.MAX_BITS)):
                self._never(proxy, sequence)
        for sequence in value.gaps.numbers():
            self._never(proxy, sequence)
        if proxy.next > proxy.last:
            proxy.last = proxy.next - 1
        if proxy.synced:
            self._drain(proxy)

    def _never(self, proxy: WriterProxy, sequence: int) -> None:
        if sequence < proxy.next or sequence in proxy.held or len(proxy.held) >= self._limits.held_samples:
            return
        proxy.held[sequence] = None
        self._drop_assembly(proxy, sequence)

    def _skip_to(self, proxy: WriterProxy, first: int, lost: bool) -> None:
        """Deliver what is held below `first`, in order, and go on from there."""
        missing = first - proxy.next
        for sequence in sorted([number for number in proxy.held if number < first]):
            one = proxy.held.pop(sequence)
            missing -= 1
            if one is not None:
                proxy.held_bytes -= len(one[0].payload)
                self._hand_over(proxy, one[0], one[1])
        for sequence in [number for number in proxy.assemblies if number < first]:
            self._drop_assembly(proxy, sequence)
        proxy.next = first
        if lost and missing:
            self._deliver(SamplesLost(self.entity_id, proxy.guid, missing))

    # -- answers

    def _acknowledge_at(self, proxy: WriterProxy, now: float) -> None:
        if proxy.ack_at is None:
            lacks = proxy.next <= proxy.last
            proxy.ack_at = max(now, proxy.nacked_at + NACK_INTERVAL) if lacks else now

    def deadline(self) -> "float | None":
        """When `handle_deadline` has something to do."""
        found = self._miss_at
        for proxy in self.proxies.values():
            for at in (proxy.ack_at, proxy.hello_at):
                if at is not None and (found is None or at < found):
                    found = at
        return found

    def handle_deadline(self, now: float) -> None:
        """Send the acknowledgements and requests that are due; notice a missed DEADLINE."""
        if self._miss_at is not None and self._period is not None and now >= self._miss_at:
            self._miss_at = now + self._period
            self._deliver(DeadlineMissed(self.entity_id))
        for proxy in self.proxies.values():
            if proxy.ack_at is not None and now >= proxy.ack_at:
                proxy.ack_at = None
                self._answer(proxy, now)
            elif proxy.hello_at is not None and now >= proxy.hello_at:
                proxy.hellos += 1
                delay = HELLO_DELAY * (1 << proxy.hellos)
                proxy.hello_at = now + delay if proxy.hellos < HELLO_TIMES else None
                self._send_acknack(proxy, [], False)

    def _answer(self, proxy: WriterProxy, now: float) -> None:
        missing = []
        for sequence in range(proxy.next, min(proxy.last + 1, proxy.next + number_set.MAX_BITS)):
            if sequence not in proxy.held and sequence not in proxy.assemblies:
                missing.append(sequence)
        partial = []
        for sequence, assembly in proxy.assemblies.items():
            # What the writer has not yet said to have sent is on its way.
            lacks = assembly.missing(assembly.count if sequence <= proxy.last else assembly.told)
            if lacks.bits:
                partial.append((sequence, lacks))
        if missing or partial:
            proxy.nacked_at = now
        self._send_acknack(proxy, missing, not missing and not partial)
        for sequence, lacks in partial:
            proxy.frag_count += 1
            request = NackFrag(self.entity_id, proxy.guid[12:], sequence, lacks, proxy.frag_count)
            self._outbox.send((self._header, proxy.info_dst, request.emit()), proxy.addresses)

    def _send_acknack(self, proxy: WriterProxy, missing: "list[int]", final: bool) -> None:
        proxy.count += 1
        # Who has the last number that there is cannot say so.
        state = number_set.of(min(proxy.next, number_set.MAX_NUMBER), missing)
        answer = AckNack(self.entity_id, proxy.guid[12:], state, proxy.count, final)
        self._outbox.send((self._header, proxy.info_dst, answer.emit()), proxy.addresses)

    def _count(self, reason: str) -> None:
        self._counters[reason] = self._counters.get(reason, 0) + 1


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
