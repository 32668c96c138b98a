"""Multicast groups of a host, and what routers and switches hear of them. RFC 2236 (IGMPv2), as a host."""

from roslet.wire.net import igmp
from roslet.wire.net.igmp import ALL_HOSTS, ALL_ROUTERS, Igmp

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable

# 8.10 and 8.1: seconds between the reports of a new member, and how many there are.
UNSOLICITED_REPORT_INTERVAL = 10.0
ROBUSTNESS = 2
# 4: what a query of IGMPv1, which says nothing, stands for. Tenths of a second.
V1_MAX_RESPONSE = 100


class Group:
    """Joined `users` times. `at`: when it is reported, None where it is not; `reports` of a new member that are left;
    `last`: whether we were the last to report it."""

    __slots__ = ("at", "last", "reports", "users")

    def __init__(self) -> None:
        self.users = 1
        self.at: float | None = None
        self.reports = 0
        self.last = False


class Groups:
    """`send(destination, message)` sends IGMP; `chance()` is a number from 0 to below 1. 224.0.0.1 is always joined and
    never reported (6)."""

    def __init__(self, send: "Callable[[bytes, Igmp], None]", chance: "Callable[[], float]") -> None:
        self._send = send
        self._chance = chance
        self.joined: dict[bytes, Group] = {}

    def has(self, group: bytes) -> bool:
        return group == ALL_HOSTS or group in self.joined

    def join(self, group: bytes, now: float) -> None:
        """For one more endpoint."""
        if group == ALL_HOSTS:
            return
        found = self.joined.get(group)
        if found is not None:
            found.users += 1
            return
        found = self.joined[group] = Group()
        found.reports = ROBUSTNESS
        self._report(group, found, now)

    def leave(self, group: bytes) -> None:
        """For one endpoint less."""
        found = self.joined.get(group)
        if found is None:
            return
        found.users -= 1
        if not found.users:
            del self.joined[group]
            if found.last:
                self._send(ALL_ROUTERS, Igmp(igmp.LEAVE, 0, group))

    def receive(self, message: Igmp, now: float) -> bool:
        """Whether the message is one that concerns a host."""
        if message.kind == igmp.QUERY:
            longest = (message.max_response or V1_MAX_RESPONSE) / 10
            for group, found in self.joined.items():
                if message.group == group or message.group == b"\0\0\0\0":
                    at = now + longest * self._chance()
                    if found.at is None or at < found.at or found.at > now + longest:
                        found.at = at
            return True
        if message.kind == igmp.REPORT or message.kind == igmp.REPORT_V1:
            heard = self.joined.get(message.group)
            if heard is not None:
                # 3: somebody else has said it.
                heard.at = None
                heard.reports = 0
                heard.last = False
            return True
        return message.kind == igmp.LEAVE

    def _report(self, group: bytes, found: Group, now: float) -> None:
        self._send(group, Igmp(igmp.REPORT, 0, group))
        found.last = True
        found.reports = max(found.reports - 1, 0)
        found.at = now + UNSOLICITED_REPORT_INTERVAL * self._chance() if found.reports else None

    def deadline(self) -> "float | None":
        """When the next report is due."""
        times = [found.at for found in self.joined.values() if found.at is not None]
        return min(times) if times else None

    def handle_deadline(self, now: float) -> None:
        """Report what is due."""
        for group, found in self.joined.items():
            if found.at is not None and found.at <= now:
                self._report(group, found, now)
