"""A simulated network in virtual time: seeded loss, duplication, reordering, delay and partitions.

Its arithmetic is its own, so that runs repeat on every interpreter. Runs on MicroPython.
"""

from roslet.engine.rtps.participant import Participant
from roslet.wire.rtps import locator

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

GROUP = ("239.255.0.1", 7400)
MAX_STEPS = 400000


class Dice:
    """A linear congruential generator: the same everywhere."""

    def __init__(self, seed: int) -> None:
        self.state = seed * 2654435761 % (1 << 32)

    def roll(self) -> float:
        self.state = (self.state * 1664525 + 1013904223) % (1 << 32)
        return self.state / (1 << 32)


class Host:
    """One participant with an address of its own."""

    def __init__(self, network: "Network", number: int, fields: "dict[str, Any]") -> None:
        self.address = "10.0.%d.%d" % (number >> 8, number & 255)
        meta, user = locator.udp4(self.address, 7410), locator.udp4(self.address, 7411)
        prefix = b"\x01\x52" + bytes(6) + number.to_bytes(4, "big")
        self.participant = Participant(prefix, 0, (meta,), (user,), (GROUP,), **fields)
        self.events: list[Any] = []

    def of(self, kind: type) -> "list[Any]":
        """The events of one kind so far."""
        return [event for event in self.events if isinstance(event, kind)]


class Network:
    """`loss`, `twice` (duplication) and `late` (reordering) are probabilities; `delay` is one way, in seconds."""

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
        self._dice = Dice(seed)
        self._flying: list[tuple[float, int, str, bytes, tuple[str, int]]] = []
        self._serial = 0
        self._hosts_ever = 0
        self.seen: list[bytes] = []
        self.keep = False

    def host(self, **fields: "Any") -> Host:
        """A new participant, started now."""
        self._hosts_ever += 1
        host = Host(self, self._hosts_ever, fields)
        self.hosts.append(host)
        host.participant.start(self.now)
        return host

    def remove(self, host: Host) -> None:
        """It is gone without a word."""
        self._collect(host)
        self.hosts.remove(host)

    def _collect(self, host: Host) -> None:
        for parts, addresses in host.participant.datagrams_to_send(self.now):
            datagram = b"".join([bytes(part) for part in parts])
            assert len(datagram) <= 65507
            if self.keep:
                self.seen.append(datagram)
            for address in addresses:
                self._send(host, datagram, address)
        for event in host.participant.take_events():
            if hasattr(event, "payload"):
                event.payload = bytes(event.payload)
            host.events.append(event)

    def _send(self, source: Host, datagram: bytes, address: "tuple[str, int]") -> None:
        self.sent += 1
        self.bytes += len(datagram)
        if address == GROUP:
            targets = [one for one in self.hosts if one is not source]
        else:
            targets = [one for one in self.hosts if one.address == address[0]]
        dice = self._dice
        for target in targets:
            if (source.address in self.apart) != (target.address in self.apart):
                continue
            if dice.roll() < self.loss:
                continue
            copies = 2 if dice.roll() < self.twice else 1
            for _ in range(copies):
                at = self.now + self.delay
                if dice.roll() < self.late:
                    at += dice.roll() * 0.02
                self._serial += 1
                self._flying.append((at, self._serial, target.address, datagram, (source.address, 7410)))

    def run(self, seconds: float, until: "Any" = None) -> bool:
        """Let virtual time pass, at most `seconds`; True as soon as `until()` is, if it ever is."""
        end = self.now + seconds
        for _ in range(MAX_STEPS):
            for host in self.hosts:
                host.participant.handle_deadline(self.now)
                self._collect(host)
            if until is not None and until():
                return True
            times = [entry[0] for entry in self._flying]
            for host in self.hosts:
                at = host.participant.deadline()
                if at is not None:
                    times.append(at)
            if not times or min(times) > end:
                self.now = end
                return until is not None and bool(until())
            self.now = max(self.now, min(times))
            due = sorted([entry for entry in self._flying if entry[0] <= self.now])
            self._flying = [entry for entry in self._flying if entry[0] > self.now]
            for _, _, address, datagram, source in due:
                for host in self.hosts:
                    if host.address == address:
                        host.participant.receive_datagram(datagram, source, self.now)
        raise AssertionError("no end after %d steps, at %g s" % (MAX_STEPS, self.now))
