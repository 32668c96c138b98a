"""A serial line around an RTPS participant: IP packets by SLIP, with a software host in place of the kernel's."""

from __future__ import annotations

import os
import select
from time import monotonic

from roslet.engine.net.limits import Limits
from roslet.engine.net.slip_host import SlipHost
from roslet.errors import Unreachable
from roslet.io.domain import GROUP, ParticipantShell
from roslet.io.resolver import literal
from roslet.io.select import GONE, READ, WRITE
from roslet.names import OFF, SUBNET, SYSTEM_DEFAULT, Ros2Network, SerialLine
from roslet.wire.rtps import locator

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from typing import Any

    from roslet.engine.rtps.outbox import Address
    from roslet.io.select import Reactor, Timer

# Packets that wait for the line: the fragments of the largest datagram are 45. At 1 Mbit/s these take two seconds, and what
# waits longer is better sent again by who knows what is still wanted.
MAX_PACKETS = 128
# Participant ids that are announced to where a peer is given without a port: fewer than over UDP, as every announcement
# takes time of the line from the rest.
UNICAST_IDS = 2
# Octets read in one go; the kernel holds no more of a serial line.
ROOM = 4096
# Reads before others get their turn.
BATCH = 16
# Seconds until a line that has gone is looked for again.
AGAIN = 1.0
# Seconds that closing gives the line to take the last words.
LAST_WORDS = 0.25


def open_serial(line: SerialLine) -> int:
    """A descriptor of the device, 8N1 without flow control, for nobody else to open. Raises Unreachable."""
    try:
        import termios

        import serial
    except ImportError:
        raise Unreachable("a serial line needs pyserial: pip install 'roslet[serial]'") from None
    try:
        port = serial.Serial(line.device, line.baud, timeout=0, exclusive=True)
    except (OSError, ValueError, serial.SerialException) as error:
        raise Unreachable(f"no serial line {line.device} of {line.baud} bit/s: {error}") from error
    # The port object closes its own; ours keeps the settings and the lock, which belong to what was opened.
    fd = os.dup(port.fileno())
    port.close()
    # Otherwise nothing to read looks like the end of it.
    settings = termios.tcgetattr(fd)
    settings[6][termios.VMIN] = 1
    termios.tcsetattr(fd, termios.TCSANOW, settings)
    return fd


class SlipDomain(ParticipantShell):
    """One participant of a domain, and a host of its own at our end of a serial line.

    `network.line` says which; a descriptor `fd` of something already open, such as a pseudo-terminal in raw mode, is used in
    its place, and closed at last. The participant has the id 0: there is no other on our address. With the ranges SUBNET and
    SYSTEM_DEFAULT the group is joined and announced to; peers must be addresses.

    A device that goes is looked for again, and the line goes on when it is there. Raises Unreachable.
    """

    def __init__(
        self,
        reactor: Reactor,
        on_event: Callable[[Any], None],
        network: Ros2Network,
        warn: Callable[[str], None] | None = None,
        fd: int | None = None,
        **fields: Any,
    ) -> None:
        super().__init__(reactor, on_event, network, warn)
        if network.line is None:
            raise ValueError("the network has no serial line")
        self.line = network.line
        self._given = fd is not None
        self._fd = open_serial(self.line) if fd is None else fd
        os.set_blocking(self._fd, False)
        self._rest = b""  # of the octets that the line is to take next
        self._events = 0  # what the reactor looks for; 0 while it does not know the line
        self._again: Timer | None = None
        seed = int.from_bytes(os.urandom(4), "big")
        self.host = SlipHost(self.line.address, seed, limits=Limits(frames=MAX_PACKETS))
        meta_port = locator.metatraffic_unicast_port(self.domain_id, 0)
        user_port = locator.user_unicast_port(self.domain_id, 0)
        group = (GROUP, locator.metatraffic_multicast_port(self.domain_id))
        self._user = self.host.open(user_port)
        self._endpoints = [self.host.open(meta_port), self._user, self.host.open(group[1])]
        announce_to: list[Address] = []
        grouped = network.range in (SUBNET, SYSTEM_DEFAULT)
        if grouped:
            self._endpoints[2].join(GROUP, 0.0)
            announce_to.append(group)
        announce_to += self._peers()
        address, _, bits = self.line.address.partition("/")
        self.participant = self._make(
            (locator.udp4(address, meta_port),),
            (locator.udp4(address, user_port),),
            (locator.udp4(*group),) if grouped else (),
            tuple(announce_to),
            ((address, int(bits)),),
            fields,
        )
        self.host.counters = self.participant.counters
        self._begin()
        with reactor.lock:
            self.participant.start(reactor.now())
            self.flush()

    def _peers(self) -> list[Address]:
        found: list[Address] = []
        for host, port in self.network.peers if self.network.range != OFF else ():
            if not literal(host):
                self._warn(f"nobody on a serial line knows the name {host}; give the peer's address")
            elif port is None:
                found += self._ports_from(host, range(UNICAST_IDS))
            else:
                found.append((host, port))
        return found

    # -- the loop

    def _begin(self) -> None:
        self._events = READ
        self.reactor.register(self._fd, self._ready, READ)

    def _ready(self, events: int) -> None:
        if self._closed:  # by another thread, when the loop had looked already
            return
        if events & (READ | GONE):
            self._read()
        if not self._closed:
            if events & WRITE:
                self._push()
            self.flush()

    def _read(self) -> None:
        for _ in range(BATCH):
            try:
                data = os.read(self._fd, ROOM)
            except BlockingIOError:
                return
            except OSError as error:
                self._failed("receive", error)
                data = b""
            if not data:
                self._lost()
                return
            self.host.receive_data(data, monotonic())
            self._take()
            if self._closed:
                return

    def _take(self) -> None:
        """What the host has for the participant."""
        now = monotonic()
        participant = self.participant
        for endpoint in self._endpoints:
            while True:
                found = endpoint.receive()
                if found is None:
                    break
                participant.receive_datagram(found[0], found[1], now)
                if participant.pending_events:
                    self._tell()
                if self._closed:
                    return

    def _send(self, parts: Any, addresses: Sequence[Address]) -> None:
        now = monotonic()
        data = parts[0] if len(parts) == 1 else b"".join(parts)
        for address in addresses:
            self._user.send(data, address, now)
        self._push()

    def _push(self) -> None:
        """Give the line what it takes, and have the reactor look when it takes more."""
        if not self._events:
            return
        try:
            while True:
                if not self._rest:
                    self._rest = self.host.data_to_send(monotonic())
                if not self._rest:
                    break
                self._rest = self._rest[os.write(self._fd, self._rest) :]
        except BlockingIOError:
            pass
        except OSError as error:
            self._failed("send", error)
            self._lost()
            return
        wanted = READ | (WRITE if self._rest else 0)
        if wanted != self._events:
            self._events = wanted
            self.reactor.modify(self._fd, wanted)

    def flush(self) -> None:
        """As in `ParticipantShell`; and what the participant has sent to itself comes in the loop's next turn."""
        if self._closed:
            return
        self.host.handle_deadline(monotonic())
        super().flush()
        if any(endpoint.pending for endpoint in self._endpoints):
            self.reactor.call_soon(self._take_own)

    def _take_own(self) -> None:
        if not self._closed:
            self._take()
            self.flush()

    def _deadline(self) -> float | None:
        # What waits for the line needs no timer: the line says when it takes it.
        times = [at for at in (self.participant.deadline(), self.host.deadline()) if at]
        return min(times) if times else None

    # -- coming and going

    def _lost(self) -> None:
        """The device has gone, or nobody has the other end of the pseudo-terminal open."""
        self._warn(f"the serial line {self.line.device} has gone; looking for it every {AGAIN:.0f} s")
        self._events = 0
        self._rest = b""
        self.reactor.unregister(self._fd)
        if not self._given:
            os.close(self._fd)
            self._fd = -1
        self._again = self.reactor.call_at(self.reactor.now() + AGAIN, self._look)

    def _look(self) -> None:
        self._again = None
        if self._closed:
            return
        try:
            if not self._given:
                self._fd = open_serial(self.line)
                os.set_blocking(self._fd, False)
            elif select.select([self._fd], [], [], 0)[0] and not self._readable():
                raise Unreachable("still nobody at the other end")
        except Unreachable:
            self._again = self.reactor.call_at(self.reactor.now() + AGAIN, self._look)
            return
        self._begin()
        self.flush()

    def _readable(self) -> bool:
        try:
            data = os.read(self._fd, ROOM)
        except BlockingIOError:
            return True
        except OSError:
            return False
        self.host.receive_data(data, monotonic())
        return bool(data)

    def close(self) -> None:
        """Depart, and close the line."""
        with self.reactor.lock:
            if self._closed:
                return
            now = self.reactor.now()
            self.participant.close(now)
            for parts, addresses in self.participant.datagrams_to_send(now):
                self._send(parts, addresses)
            end = monotonic() + LAST_WORDS
            while self._events & WRITE and monotonic() < end:
                select.select([], [self._fd], [], max(0.0, end - monotonic()))
                self._push()
            self._closed = True
            for timer in (self._timer, self._again):
                if timer is not None:
                    timer.cancel()
            if self._events:
                self.reactor.unregister(self._fd)
            self._shut()

    def _shut(self) -> None:
        if self._fd >= 0:
            os.close(self._fd)
            self._fd = -1

    def abandon(self) -> None:
        """In a forked child: close the parent's descriptor, and touch nothing else."""
        self._closed = True
        self._shut()
