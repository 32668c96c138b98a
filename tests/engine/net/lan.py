"""Hosts on one cable in virtual time, with seeded loss, duplication and delay. Runs on MicroPython."""

from roslet.engine.net.host import Host

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

MAX_STEPS = 100000


class Lan:
    """Every frame reaches all others, after `delay` seconds; `loss` and `twice` are probabilities."""

    def __init__(
        self, *hosts: Host, seed: int = 1, loss: float = 0.0, twice: float = 0.0, delay: float = 0.0001
    ) -> None:
        self.hosts = list(hosts)
        self.now = 0.0
        self.seen: list[bytes] = []
        self.events: dict[str, list[Any]] = {host.address: [] for host in hosts}
        self._loss = loss
        self._twice = twice
        self._delay = delay
        self._state = seed * 2654435761 % (1 << 32)
        self._flying: list[tuple[float, Host, bytes]] = []

    def _roll(self) -> float:
        self._state = (self._state * 1664525 + 1013904223) % (1 << 32)
        return self._state / (1 << 32)

    def _collect(self) -> None:
        for host in self.hosts:
            for frame in host.frames_to_send(self.now):
                self.seen.append(frame)
                for other in self.hosts:
                    if other is host or self._roll() < self._loss:
                        continue
                    for _ in range(2 if self._roll() < self._twice else 1):
                        late = self._delay * (1 + (self._roll() if self._twice else 0))
                        self._flying.append((self.now + late, other, frame))

    def run(self, seconds: float) -> None:
        """Let virtual time pass."""
        end = self.now + seconds
        for _ in range(MAX_STEPS):
            self._collect()
            times = [at for at in [host.deadline() for host in self.hosts] if at is not None]
            times += [at for at, _, _ in self._flying]
            soonest = min(times) if times else end
            if soonest > end:
                break
            self.now = max(self.now, soonest)
            here = [one for one in self._flying if one[0] <= self.now]
            self._flying = [one for one in self._flying if one[0] > self.now]
            for _, host, frame in here:
                host.receive_frame(frame, self.now)
            for host in self.hosts:
                host.handle_deadline(self.now)
            for host in self.hosts:
                event = host.next_event()
                while event is not None:
                    self.events[host.address].append(event)
                    event = host.next_event()
            if not times:
                break
        self.now = end
        self._collect()
