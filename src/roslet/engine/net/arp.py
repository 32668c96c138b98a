"""Who has which hardware address: the cache, and what waits for an answer. RFC 826; RFC 1122, 2.3.2."""

from roslet.wire.net import arp
from roslet.wire.net.arp import Arp
from roslet.wire.net.ethernet import BROADCAST

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable

    from roslet.engine.net.limits import Limits

# Seconds between two requests, and how many there are (RFC 1122, 2.3.2.1: at most one a second).
INTERVAL = 1.0
TRIES = 3
# Seconds for which an answer is believed in.
LIFETIME = 60.0
_NOBODY = bytes(6)


class Neighbour:
    """An address: known, where `mac` is set; otherwise asked for. `until`: when it is forgotten, or asked for again."""

    __slots__ = ("mac", "tries", "until", "waiting")

    def __init__(self, until: float) -> None:
        self.mac: bytes | None = None
        self.until = until
        self.tries = 1
        self.waiting: list[bytes] = []


class Neighbours:
    """`send(mac, message)` sends ARP, `pass_on(mac, packet)` an IPv4 packet that waited, `count` counts a reason, and
    `unanswered(ip)` hears of an address that nobody has.

    Work of a call is bounded by `limits.neighbours`.
    """

    def __init__(
        self,
        mac: bytes,
        ip: bytes,
        limits: "Limits",
        send: "Callable[[bytes, Arp], None]",
        pass_on: "Callable[[bytes, bytes], None]",
        count: "Callable[[str], None]",
        unanswered: "Callable[[bytes], None]",
    ) -> None:
        self._mac = mac
        self._ip = ip
        self._limits = limits
        self._send = send
        self._pass_on = pass_on
        self._count = count
        self._unanswered = unanswered
        self.known: dict[bytes, Neighbour] = {}

    def announce(self) -> None:
        """Gratuitously: so that others replace what they knew. RFC 5227, 3."""
        self._send(BROADCAST, Arp(arp.REQUEST, self._mac, self._ip, _NOBODY, self._ip))

    def send(self, ip: bytes, packet: bytes, now: float) -> None:
        """A packet to a neighbour, when it is known where that is."""
        found = self.known.get(ip)
        if found is not None and found.mac is not None:
            if now < found.until:
                self._pass_on(found.mac, packet)
                return
            self._forget(ip)
            found = None
        if found is None:
            found = self._add(ip, now + INTERVAL)
            self._ask(ip)
        if len(found.waiting) >= self._limits.waiting:
            self._count("arp-waiting-full")
            return
        found.waiting.append(packet)

    def receive(self, message: Arp, now: float) -> None:
        """Learn from a request or a reply that the host takes for sound, and answer what asks for us."""
        ours = message.target_ip == self._ip
        probe = message.sender_ip == b"\0\0\0\0"  # RFC 5227, 1.1: who asks has no address yet
        if not probe:
            found = self.known.get(message.sender_ip)
            if found is None and ours:
                found = self._add(message.sender_ip, 0.0)
            if found is not None:
                found.mac = message.sender_mac
                found.until = now + LIFETIME
                waiting, found.waiting = found.waiting, []
                for packet in waiting:
                    self._pass_on(message.sender_mac, packet)
        if ours and message.operation == arp.REQUEST:
            answer = Arp(arp.REPLY, self._mac, self._ip, message.sender_mac, message.sender_ip)
            self._send(message.sender_mac, answer)

    def deadline(self) -> "float | None":
        """When a request is to be repeated."""
        times = [found.until for found in self.known.values() if found.mac is None]
        return min(times) if times else None

    def handle_deadline(self, now: float) -> None:
        """Ask again, or give up."""
        due = [ip for ip, found in self.known.items() if found.mac is None and found.until <= now]
        for ip in due:
            found = self.known[ip]
            if found.tries >= TRIES:
                self._forget(ip)
                self._unanswered(ip)
            else:
                found.tries += 1
                found.until = now + INTERVAL
                self._ask(ip)

    def _ask(self, ip: bytes) -> None:
        self._send(BROADCAST, Arp(arp.REQUEST, self._mac, self._ip, _NOBODY, ip))

    def _add(self, ip: bytes, until: float) -> Neighbour:
        if len(self.known) >= self._limits.neighbours:
            self._count("neighbours-full")
            oldest = min(self.known, key=lambda one: self.known[one].until)
            self._forget(oldest)
        self.known[ip] = Neighbour(until)
        return self.known[ip]

    def _forget(self, ip: bytes) -> None:
        for _ in self.known.pop(ip).waiting:
            self._count("arp-unanswered")
