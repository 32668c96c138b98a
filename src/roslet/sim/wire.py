"""One Ethernet in simulated time: gateware, software hosts and TAP devices on the same hub; or one serial line.

Time of the wire is in seconds; a compiled design's own time is mapped to it by a stated factor. With factor 250 a design
whose clock was started with 50 MHz lives through 200,000 cycles in a second of the wire: what it counts in cycles and what
its peers count in seconds agree where it was told that it has 200 kHz.
"""

from __future__ import annotations

import select
import time
from collections.abc import Callable
from typing import TYPE_CHECKING

from roslet.sim.link import Damaged, Hub, Link
from roslet.sim.mii import Mii, fcs
from roslet.sim.model import PICOSECONDS
from roslet.sim.uart import Uart

if TYPE_CHECKING:
    import pathlib

    from roslet.engine.net.host import Host
    from roslet.engine.net.slip_host import SlipHost
    from roslet.sim.capture import Capture
    from roslet.sim.model import Model

# Seconds of a design's own time between two looks at its pins: about one frame of the smallest size at 100 Mbit/s.
QUANTUM = 1e-5
# Frames that wait to go into a design's pins: a second of the largest ones at 100 Mbit/s.
MAX_WAITING = 8192
# Octets that wait to go into a design's serial pin: what is more waits in the link.
MAX_OCTETS = 256
# Seconds of the wall clock after which `until` is looked at, though nothing has happened on the wire.
LOOK = 0.02
# Faults of a frame that no receiver minds.
_MINOR = {"gap-short", "preamble-short"}


class Station:
    """Something that lives on a wire."""

    link: Link

    def advance(self, now: float) -> None:
        """Live until `now`."""

    def exchange(self, now: float) -> None:
        """Take what the link has, and give it what is to be sent."""
        raise NotImplementedError

    def deadline(self) -> float | None:
        """When it must be looked at, apart from what the link has."""
        return None

    def coming(self) -> float | None:
        """When its link has something for it."""
        return self.link.deadline()

    def filenos(self) -> list[int]:
        """What to wait for, where something comes from outside."""
        number = self.link.fileno()
        return [] if number is None else [number]

    def close(self) -> None:
        """Give back the link."""
        self.link.close()


class HostStation(Station):
    """A software host."""

    def __init__(self, host: Host | SlipHost, link: Link) -> None:
        self.host = host
        self.link = link
        self.damaged = 0

    def exchange(self, now: float) -> None:
        for frame in self.link.receive(now):
            if isinstance(frame, Damaged):
                self.damaged += 1  # as an Ethernet controller drops it
            else:
                self.host.receive_frame(frame, now)
        at = self.host.deadline()
        if at is not None and at <= now:
            self.host.handle_deadline(now)
        for frame in self.host.frames_to_send(now):
            self.link.send(frame, now)

    def deadline(self) -> float | None:
        return self.host.deadline()


class SlipStation(HostStation):
    """A software host at one end of a serial line; the link carries octets."""

    def __init__(self, host: SlipHost, link: Link) -> None:
        super().__init__(host, link)
        self._slip = host

    def exchange(self, now: float) -> None:
        for octets in self.link.receive(now):
            self._slip.receive_data(octets, now)
        self._slip.handle_deadline(now)
        if octets := self._slip.data_to_send(now):
            self.link.send(octets, now)


class DesignStation(Station):
    """A design with its pins on a link. `factor`: seconds of the wire in a second of the design. `faults` counts what was
    wrong with what it sent, by name."""

    def __init__(self, model: Model, link: Link, factor: float) -> None:
        self.model = model
        self.link = link
        self.factor = factor
        self.faults: dict[str, int] = {}
        self._start = 0.0

    def start(self, now: float) -> None:
        """Its present is `now`."""
        self._start = now - self.model.now * self.factor

    def advance(self, now: float) -> None:
        until = round((now - self._start) / self.factor * PICOSECONDS)
        if until > self.model.picoseconds:
            self.model.run_until(until)


class GatewareStation(DesignStation):
    """A design at its MII pins. `faults` are those of `mii.FAULTS`; of such frames only the ones that a receiver does not
    mind get further. `dropped` counts frames that came faster than its pins take them."""

    def __init__(self, model: Model, mii: Mii, link: Link, factor: float) -> None:
        super().__init__(model, link, factor)
        self.mii = mii
        self.dropped = 0

    def exchange(self, now: float) -> None:
        for frame in self.link.receive(now):
            if self.mii.waiting >= MAX_WAITING:
                self.dropped += 1
            elif isinstance(frame, Damaged):
                self.mii.send(frame, check=bytes(octet ^ 0xFF for octet in fcs(frame)), pad=False)
            else:
                self.mii.send(frame)
        for sent in self.mii.receive():
            for fault in sent.faults:
                self.faults[fault] = self.faults.get(fault, 0) + 1
            if _MINOR.issuperset(sent.faults):
                self.link.send(sent.frame, self._start + sent.end * self.factor)


class SerialStation(DesignStation):
    """A design at its serial pins; the link carries octets. The only fault is `framing`, an octet without a stop bit."""

    def __init__(self, model: Model, uart: Uart, link: Link, factor: float) -> None:
        super().__init__(model, link, factor)
        self.uart = uart

    def exchange(self, now: float) -> None:
        if self.uart.waiting < MAX_OCTETS:
            for octets in self.link.receive(now):
                self.uart.send(octets)
        if octets := self.uart.receive():
            self.link.send(octets, now)
        if self.uart.framing:
            self.faults["framing"] = self.uart.framing

    def coming(self) -> float | None:
        return super().coming() if self.uart.waiting < MAX_OCTETS else None

    def filenos(self) -> list[int]:
        return super().filenos() if self.uart.waiting < MAX_OCTETS else []


class Bridge(Station):
    """Two links as one, such as a hub's port and a TAP device."""

    def __init__(self, link: Link, other: Link) -> None:
        self.link = link
        self.other = other

    def exchange(self, now: float) -> None:
        for frame in self.link.receive(now):
            self.other.send(frame, now)
        for frame in self.other.receive(now):
            self.link.send(frame, now)

    def deadline(self) -> float | None:
        return self.other.deadline()

    def filenos(self) -> list[int]:
        other = self.other.fileno()
        return super().filenos() + ([] if other is None else [other])

    def close(self) -> None:
        super().close()
        self.other.close()


class Wire:
    """A hub and what is on it.

    factor   seconds of the wire in a second of a design's own time
    pace     seconds of the wire in a second of the wall clock, at most; None: as fast as it goes. Where the simulation is
             slower than that, `lag` says by how many seconds of the wall clock it is behind.
    quantum  seconds of a design's own time between two looks at its pins: a frame may arrive as much later

    With `pace` the wire waits, without work, for its time or a frame from outside, whichever is first.
    """

    def __init__(self, factor: float = 1.0, pace: float | None = None, quantum: float = QUANTUM) -> None:
        if factor <= 0 or quantum <= 0 or (pace is not None and pace <= 0):
            raise ValueError("factor, pace and quantum are above 0")
        self.factor = factor
        self.pace = pace
        self.hub = Hub()
        self.now = 0.0
        self.lag = 0.0
        self.stations: list[Station] = []
        self._step = quantum * factor
        self._gates = False

    # -- what is on it

    def add(self, station: Station) -> None:
        """One more station."""
        self.stations.append(station)

    def design(self, station: DesignStation) -> None:
        """One more that is a design, whose clocks must have been started."""
        station.start(self.now)
        self.add(station)
        self._gates = True

    def host(self, host: Host, link: Link | None = None) -> HostStation:
        """A software host, on a port of its own unless another link is given; it says that it is there."""
        station = HostStation(host, link or self.hub.port())
        host.start(self.now)
        self.add(station)
        return station

    def gateware(
        self, model: Model, mii: Mii, link: Link | None = None, kind: type[GatewareStation] | None = None
    ) -> GatewareStation:
        """A design, likewise, as a station of `kind`. Its clocks must have been started."""
        station = (kind or GatewareStation)(model, mii, link or self.hub.port(), self.factor)
        self.design(station)
        return station

    def serial(self, model: Model, uart: Uart, link: Link | None = None) -> SerialStation:
        """A design at one end of a serial line, likewise: a hub with two ports is such a line."""
        station = SerialStation(model, uart, link or self.hub.port(), self.factor)
        self.design(station)
        return station

    def tap(self, tap: Link, link: Link | None = None) -> Bridge:
        """A TAP device, or any link to somewhere else, likewise."""
        station = Bridge(link or self.hub.port(), tap)
        self.add(station)
        return station

    def capture(self, path: str | pathlib.Path) -> Capture:
        """Write what passes the hub to a file from now on."""
        from roslet.sim.capture import Capture

        made = Capture(path)
        self.hub.listeners.append(made.write)
        return made

    # -- time

    def run(self, seconds: float, until: Callable[[], bool] | None = None) -> bool:
        """Let time of the wire pass; until `until()` holds, which is looked at after each step, and may
        use what is on the wire. Whether it came to hold."""
        end = self.now + seconds
        began, origin = time.monotonic(), self.now
        self._exchange()
        while not (until is not None and until()):
            target = self._next(end)
            if self.pace is not None:
                allowed = origin + (time.monotonic() - began) * self.pace
                if target > allowed:
                    wait = (target - allowed) / self.pace
                    self._wait(wait if until is None else min(wait, LOOK))
                    allowed = origin + (time.monotonic() - began) * self.pace
                    target = max(min(target, allowed), self.now)
                self.lag = max(0.0, (allowed - target) / self.pace)
            elif self.now >= end:
                return False
            for station in self.stations:
                station.advance(target)
            self.now = target
            self._exchange()
            if self.now >= end:
                return until is not None and until()
        return True

    def _exchange(self) -> None:
        for station in self.stations:
            station.exchange(self.now)

    def _next(self, end: float) -> float:
        """The next time at which anything can happen."""
        target = min(end, self.now + self._step) if self._gates else end
        for station in self.stations:
            for at in (station.deadline(), station.coming()):
                if at is not None and at < target:
                    target = at
        return max(target, self.now)

    def _wait(self, seconds: float) -> None:
        """For so long, or until something comes from outside."""
        numbers = [number for station in self.stations for number in station.filenos()]
        if numbers:
            select.select(numbers, [], [], seconds)
        else:
            time.sleep(seconds)

    def close(self) -> None:
        """Give back the links. Closing twice is allowed."""
        for station in self.stations:
            station.close()
        self.stations.clear()
