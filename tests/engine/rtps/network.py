"""A simulated network in virtual time: seeded loss, duplication, reordering, delay and partitions.

Its arithmetic is its own, so that runs repeat on every interpreter. Runs on MicroPython.
"""

import heapq

from roslet.engine.rtps import events
from roslet.engine.rtps.participant import Participant
from roslet.wire.rtps import locator, qos
from roslet.wire.rtps.qos import Qos

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

GROUP = ("239.255.0.1", 7400)
MAX_STEPS = 400000

BLOCKING = 100000000
RELIABLE = Qos((qos.RELIABLE, BLOCKING), history=(qos.KEEP_LAST, 1000))
LATCHED = Qos((qos.RELIABLE, BLOCKING), qos.TRANSIENT_LOCAL, (qos.KEEP_LAST, 5))
BEST_EFFORT = Qos((qos.BEST_EFFORT, BLOCKING), history=(qos.KEEP_LAST, 10))


class Dice:
    """A linear congruential generator: the same everywhere."""

    def __init__(self, seed: int) -> None:
        self.state = seed * 2654435761 % (1 << 32)

    def roll(self) -> float:
        self.state = (self.state * 1664525 + 1013904223) % (1 << 32)
        return self.state / (1 << 32)


class Host:
    """One participant with an address of its own. `due`: when it next wants to be looked at."""

    def __init__(self, number: int, fields: "dict[str, Any]") -> None:
        self.number = number
        self.address = "10.0.%d.%d" % (number >> 8, number & 255)
        meta, user = locator.udp4(self.address, 7410), locator.udp4(self.address, 7411)
        prefix = b"\x01\x52" + bytes(6) + number.to_bytes(4, "big")
        self.participant = Participant(prefix, 0, (meta,), (user,), (GROUP,), **fields)
        self.events: list[Any] = []
        self.due: float | None = None

    def of(self, kind: type) -> "list[Any]":
        """The events of one kind so far."""
        return [event for event in self.events if isinstance(event, kind)]


class Network:
    """`loss`, `twice` (duplication) and `late` (reordering) are probabilities; `delay` is one way, in seconds.

    `sent` and `bytes` count what was sent, a multicast datagram once; `received` what arrived. With `deaf` the events of
    hosts are thrown away, where they would be too many to keep.
    """

    def __init__(
        self, seed: int = 1, loss: float = 0.0, twice: float = 0.0, late: float = 0.0, delay: float = 0.0002
    ) -> None:
        self.now = 0.0
        self.loss = loss
        self.twice = twice
        self.late = late
        self.delay = delay
        self.hosts: list[Host] = []
        self.apart: set[str] = set()  # addresses on the other side of a partition
        self.sent = 0
        self.bytes = 0
        self.received = 0
        self.seen: list[bytes] = []
        self.keep = False
        self.deaf = False
        self.max_steps = MAX_STEPS
        self._dice = Dice(seed)
        self._flying: list[tuple[float, int, str, bytes, tuple[str, int]]] = []  # a heap
        self._timers: list[
            tuple[float, int]
        ] = []  # a heap of (due, number of the host), of which some are stale
        self._by_number: dict[int, Host] = {}
        self._by_address: dict[str, Host] = {}
        self._serial = 0
        self._hosts_ever = 0

    def host(self, **fields: "Any") -> Host:
        """A new participant, started now."""
        self._hosts_ever += 1
        host = Host(self._hosts_ever, fields)
        self.hosts.append(host)
        self._by_number[host.number] = self._by_address[host.address] = host
        host.participant.start(self.now)
        return host

    def remove(self, host: Host) -> None:
        """It is gone without a word."""
        self._collect(host)
        self.hosts.remove(host)
        del self._by_number[host.number]
        del self._by_address[host.address]

    def _collect(self, host: Host) -> None:
        """Send what a host has to send, take its events, and note when it is due."""
        participant = host.participant
        for parts, addresses in participant.datagrams_to_send(self.now):
            datagram = b"".join([bytes(part) for part in parts])
            assert len(datagram) <= 65507
            if self.keep:
                self.seen.append(datagram)
            for address in addresses:
                self._send(host, datagram, address)
        found = participant.take_events()
        if not self.deaf:
            for event in found:
                if hasattr(event, "payload"):
                    event.payload = bytes(event.payload)
                host.events.append(event)
        due = participant.deadline()
        if due is not None and due != host.due:
            heapq.heappush(self._timers, (due, host.number))
        host.due = due

    def _send(self, source: Host, datagram: bytes, address: "tuple[str, int]") -> None:
        self.sent += 1
        self.bytes += len(datagram)
        if address == GROUP:
            targets = [one for one in self.hosts if one is not source]
        else:
            target = self._by_address.get(address[0])
            targets = [] if target is None else [target]
        dice = self._dice
        for target in targets:
            if (source.address in self.apart) != (target.address in self.apart):
                continue
            if self.loss and dice.roll() < self.loss:
                continue
            copies = 2 if self.twice and dice.roll() < self.twice else 1
            for _ in range(copies):
                at = self.now + self.delay
                if self.late and dice.roll() < self.late:
                    at += dice.roll() * 0.02
                self._serial += 1
                entry = (at, self._serial, target.address, datagram, (source.address, 7410))
                heapq.heappush(self._flying, entry)

    def _next(self) -> "float | None":
        """When something next happens."""
        timers = self._timers
        while timers:
            host = self._by_number.get(timers[0][1])
            if host is not None and host.due == timers[0][0]:
                break
            heapq.heappop(timers)
        times = [heap[0][0] for heap in (self._flying, timers) if heap]
        return min(times) if times else None

    def _step(self) -> None:
        """Deliver the datagrams that have arrived and serve the hosts that are due."""
        now = self.now
        touched: dict[int, Host] = {}
        flying, timers = self._flying, self._timers
        while flying and flying[0][0] <= now:
            _, _, address, datagram, source = heapq.heappop(flying)
            host = self._by_address.get(address)
            if host is not None:
                self.received += 1
                host.participant.receive_datagram(datagram, source, now)
                touched[host.number] = host
        while timers and timers[0][0] <= now:
            due, number = heapq.heappop(timers)
            waiting = self._by_number.get(number)
            if waiting is not None and waiting.due == due:
                waiting.due = None
                touched[number] = waiting
        for number in sorted(touched):
            touched[number].participant.handle_deadline(now)
            self._collect(touched[number])

    def run(self, seconds: float, until: "Any" = None) -> bool:
        """Let virtual time pass, at most `seconds`; True as soon as `until()` is, if it ever is."""
        end = self.now + seconds
        for host in self.hosts:
            # What its owner did since the last run.
            host.participant.handle_deadline(self.now)
            self._collect(host)
        for _ in range(self.max_steps):
            if until is not None and until():
                return True
            at = self._next()
            if at is None or at > end:
                self.now = end
                return until is not None and bool(until())
            self.now = max(self.now, at)
            self._step()
        raise AssertionError("no end after %d steps, at %g s" % (self.max_steps, self.now))


def body(number: int, size: int = 12) -> bytes:
    return b"\0\1\0\0" + number.to_bytes(4, "little") + bytes([number & 255]) * (size - 8)


def numbers(host: Host) -> "list[int]":
    return [int.from_bytes(one.payload[4:8], "little") for one in host.of(events.SampleReceived)]


def pair(network: Network, offered: "Any", requested: "Any") -> "Any":
    one, other = network.host(), network.host()
    writer = one.participant.create_writer("t", "T", offered, network.now)
    reader = other.participant.create_reader("t", "T", requested, network.now)
    return one, other, writer, reader


def matched(network: Network, writer: "Any", reader: "Any") -> bool:
    return network.run(30, lambda: bool(writer.proxies and reader.proxies))


def leased(kind: int, seconds: float) -> "Any":
    return RELIABLE.replace(liveliness=(kind, int(seconds * 1000000000)))
