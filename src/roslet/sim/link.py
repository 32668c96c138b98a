"""Where frames go: the one interface of everything that carries them, a hub, and what wraps a link.

A frame is `bytes` from the Ethernet header on, without FCS. `Damaged` ones have a wrong FCS, which only pins can show: a
host never sees them. Times are seconds of the wire. What wraps a link is a link, so that wrappers can wrap each other.
"""

from __future__ import annotations

import heapq
import random
from collections.abc import Callable

from roslet.errors import ProtocolError
from roslet.wire.net import arp, ethernet, ipv4

# Frames that wait in a hub for one port: the port's owner is stuck, or the wire is a storm.
MAX_WAITING = 4096


class Damaged(bytes):
    """A frame whose FCS is wrong."""


class Link:
    """An end of a cable, as a station has it."""

    def send(self, frame: bytes, now: float) -> None:
        """Away from the station."""
        raise NotImplementedError

    def receive(self, now: float) -> list[bytes]:
        """What has arrived for the station by now."""
        raise NotImplementedError

    def deadline(self) -> float | None:
        """When there is something to receive, as far as is known."""
        return None

    def fileno(self) -> int | None:
        """What to wait for where frames come from outside."""
        return None

    def close(self) -> None:
        """Give back what it holds."""


class Hub:
    """Everything that one port sends reaches all others, `delay` seconds later. `listeners` hear of each frame once.
    `dropped` counts frames for ports that hold MAX_WAITING."""

    def __init__(self, delay: float = 1e-6) -> None:
        self.delay = delay
        self.dropped = 0
        self.listeners: list[Callable[[bytes, float], None]] = []
        self._ports: list[_Port] = []
        self._serial = 0

    def port(self) -> Link:
        """One more."""
        made = _Port(self)
        self._ports.append(made)
        return made

    def carry(self, sender: Link, frame: bytes, now: float) -> None:
        """From one port to the others."""
        for listener in self.listeners:
            listener(frame, now)
        for port in self._ports:
            if port is sender:
                continue
            if len(port.coming) >= MAX_WAITING:
                self.dropped += 1
                continue
            self._serial += 1
            heapq.heappush(port.coming, (now + self.delay, self._serial, frame))


class _Port(Link):
    def __init__(self, hub: Hub) -> None:
        self.coming: list[tuple[float, int, bytes]] = []
        self._hub = hub

    def send(self, frame: bytes, now: float) -> None:
        self._hub.carry(self, frame, now)

    def receive(self, now: float) -> list[bytes]:
        found = []
        while self.coming and self.coming[0][0] <= now:
            found.append(heapq.heappop(self.coming)[2])
        return found

    def deadline(self) -> float | None:
        return self.coming[0][0] if self.coming else None


class Wrapper(Link):
    """A link around another, which changes nothing."""

    def __init__(self, inner: Link) -> None:
        self.inner = inner

    def send(self, frame: bytes, now: float) -> None:
        self.inner.send(frame, now)

    def receive(self, now: float) -> list[bytes]:
        return self.inner.receive(now)

    def deadline(self) -> float | None:
        return self.inner.deadline()

    def fileno(self) -> int | None:
        return self.inner.fileno()

    def close(self) -> None:
        self.inner.close()


class Faults(Wrapper):
    """What a bad cable does to frames in both directions, by a seeded die: each number is a probability.

    loss       a frame does not arrive
    bit_error  a frame has one bit turned, and so a wrong FCS
    duplicate  a frame arrives twice
    reorder    a frame arrives up to `late` seconds later than it would
    truncate   a frame ends early, and so has a wrong FCS

    `counts` says how often each happened.
    """

    def __init__(
        self,
        inner: Link,
        seed: int = 0,
        loss: float = 0.0,
        bit_error: float = 0.0,
        duplicate: float = 0.0,
        reorder: float = 0.0,
        truncate: float = 0.0,
        late: float = 1e-3,
    ) -> None:
        super().__init__(inner)
        self.rates = {
            "loss": loss,
            "truncate": truncate,
            "bit_error": bit_error,
            "duplicate": duplicate,
            "reorder": reorder,
        }
        for name, rate in self.rates.items():
            if not 0 <= rate <= 1:
                raise ValueError(f"{name} is a probability, from 0 to 1, not {rate}")
        self.late = late
        self.counts = dict.fromkeys(self.rates, 0)
        self._dice = random.Random(seed)
        self._serial = 0
        self._leaving: list[tuple[float, int, bytes]] = []
        self._coming: list[tuple[float, int, bytes]] = []

    def _happens(self, name: str) -> bool:
        # The die is rolled for each, so that one rate does not change when another fault falls.
        happens = self._dice.random() < self.rates[name]
        self.counts[name] += happens
        return happens

    def _put(self, queue: list[tuple[float, int, bytes]], frame: bytes, now: float) -> None:
        if self._happens("loss"):
            return
        if self._happens("truncate"):
            frame = Damaged(frame[: self._dice.randrange(1, max(len(frame), 2))])
        if self._happens("bit_error"):
            turned = bytearray(frame)
            bit = self._dice.randrange(8 * len(turned))
            turned[bit >> 3] ^= 1 << (bit & 7)
            frame = Damaged(turned)
        for _ in range(2 if self._happens("duplicate") else 1):
            at = now + self._dice.random() * self.late if self._happens("reorder") else now
            self._serial += 1
            heapq.heappush(queue, (at, self._serial, frame))

    def _leave(self, now: float) -> None:
        while self._leaving and self._leaving[0][0] <= now:
            self.inner.send(heapq.heappop(self._leaving)[2], now)

    def send(self, frame: bytes, now: float) -> None:
        self._put(self._leaving, frame, now)
        self._leave(now)

    def receive(self, now: float) -> list[bytes]:
        self._leave(now)
        for frame in self.inner.receive(now):
            self._put(self._coming, frame, now)
        found = []
        while self._coming and self._coming[0][0] <= now:
            found.append(heapq.heappop(self._coming)[2])
        return found

    def deadline(self) -> float | None:
        times = [queue[0][0] for queue in (self._leaving, self._coming) if queue]
        inner = self.inner.deadline()
        if inner is not None:
            times.append(inner)
        return min(times) if times else None


class Listened(Wrapper):
    """`hear(frame, now, outwards)` is called for each frame in either direction."""

    def __init__(self, inner: Link, hear: Callable[[bytes, float, bool], None]) -> None:
        super().__init__(inner)
        self._hear = hear

    def send(self, frame: bytes, now: float) -> None:
        self._hear(frame, now, True)
        self.inner.send(frame, now)

    def receive(self, now: float) -> list[bytes]:
        found = self.inner.receive(now)
        for frame in found:
            self._hear(frame, now, False)
        return found


def trace(inner: Link, name: str, say: Callable[[str], None] = print) -> Link:
    """A link that says a line for each frame: time, `name`, direction, what it is."""

    def hear(frame: bytes, now: float, outwards: bool) -> None:
        say(f"{now:12.6f} {name} {'->' if outwards else '<-'} {describe(frame)}")

    return Listened(inner, hear)


def describe(frame: bytes) -> str:
    """A frame in a few words."""
    damaged = " damaged" if isinstance(frame, Damaged) else ""
    try:
        outer = ethernet.parse(frame)
        text = f"{ethernet.text_of(outer.source)} > {ethernet.text_of(outer.destination)}"
        if outer.kind == ethernet.ARP:
            message = arp.parse(outer.payload)
            asks = message.operation == arp.REQUEST
            said = f"who has {ipv4.text_of(message.target_ip)}" if asks else "I have it"
            return f"{text} ARP {ipv4.text_of(message.sender_ip)}: {said}{damaged}"
        if outer.kind == ethernet.IPV4:
            packet = ipv4.parse(outer.payload)
            names = {ipv4.UDP: "UDP", ipv4.ICMP: "ICMP", ipv4.IGMP: "IGMP"}
            kind = names.get(packet.protocol, f"protocol {packet.protocol}")
            part = f" at {packet.offset}" if packet.is_fragment else ""
            ends = f"{ipv4.text_of(packet.source)} > {ipv4.text_of(packet.destination)}"
            return f"{text} {kind} {ends}, {len(packet.payload)} octets{part}{damaged}"
        return f"{text} type 0x{outer.kind:04x}, {len(frame)} octets{damaged}"
    except ProtocolError as error:
        return f"{len(frame)} octets ({error.reason}){damaged}"
