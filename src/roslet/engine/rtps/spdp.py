"""Participants find each other: SPDP. RTPS 2.3, 8.5.3.

What a remote participant is to us, and what each event makes of it, is the table TRANSITIONS. Every message of a
participant renews its lease; only its own announcement makes it known.
"""

from roslet.engine.rtps.events import ParticipantDiscovered, ParticipantLost
from roslet.errors import ProtocolError
from roslet.wire.rtps import header, info_dst, info_ts, inline_qos, participant_data
from roslet.wire.rtps.data import FLAG_D, FLAG_K, Data
from roslet.wire.rtps.guid import (
    ENTITYID_SPDP_BUILTIN_PARTICIPANT_READER,
    ENTITYID_SPDP_BUILTIN_PARTICIPANT_WRITER,
    ENTITYID_UNKNOWN,
)
from roslet.wire.rtps.inline_qos import STATUS_DISPOSED, STATUS_UNREGISTERED
from roslet.wire.rtps.times import INFINITE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from roslet.engine.rtps.limits import Limits
    from roslet.engine.rtps.outbox import Address, Outbox
    from roslet.wire.rtps.locator import Locator
    from roslet.wire.rtps.participant_data import ParticipantData

ABSENT, ALIVE = "ABSENT", "ALIVE"
ANNOUNCED, DEPARTED, EXPIRED = "ANNOUNCED", "DEPARTED", "EXPIRED"

TRANSITIONS = {
    # state, event: next state, what is done
    (ABSENT, ANNOUNCED): (ALIVE, "discover"),
    (ALIVE, ANNOUNCED): (ALIVE, "renew"),
    (ALIVE, DEPARTED): (ABSENT, "forget"),
    (ALIVE, EXPIRED): (ABSENT, "expire"),
    (ABSENT, DEPARTED): (ABSENT, "nothing"),
}

# Announcements at once at start, and the seconds between them: peers that start together find each other although some are
# lost.
QUICK = 5
QUICK_PERIOD = 0.1
# Addresses of one peer that everything is sent to, where none is known to be the right one.
MAX_ADDRESSES = 4
# Only this machine sends from here.
LOOPBACK = "127.0.0.1"


def addresses_of(locators: "tuple[Locator, ...]", heard_from: str) -> "tuple[Address, ...]":
    """Where to send: the address that the peer was heard from if it is among its locators, else the first few usable."""
    usable = [(one.host, one.port) for one in locators if one.usable]
    same = [one for one in usable if one[0] == heard_from]
    return tuple(same[:1] or usable[:MAX_ADDRESSES])


class RemoteParticipant:
    """A participant that announced itself. `heard`: when anything last came from it."""

    def __init__(self, value: "ParticipantData", host: str, now: float) -> None:
        self.heard = now
        self.update(value, host)

    def believes(self, host: str, now: float) -> bool:
        """Whether discovery in its name may come from this address: where it was first heard, where it says it is, or this
        machine. One that has been silent for half its lease may have moved."""
        if host in self.hosts:
            return True
        return self.lease is not None and now - self.heard > self.lease / 2

    def update(self, value: "ParticipantData", host: str) -> None:
        self.data = value
        self.host = host
        self.lease = value.lease / 1e9 if value.lease < INFINITE else None
        locators = value.metatraffic_unicast + value.default_unicast
        self.hosts = {host, LOOPBACK}
        self.hosts.update([one.host for one in locators if one.usable])
        self.metatraffic = addresses_of(value.metatraffic_unicast or value.metatraffic_multicast, host)
        self.default = addresses_of(value.default_unicast or value.default_multicast, host)


class Spdp:
    """Announces us, and keeps the table of who is there. `discovered` and `lost` are called before the events go out;
    `answered` says whether a participant has ever shown that it knows us."""

    def __init__(
        self,
        own: "ParticipantData",
        outbox: "Outbox",
        addresses: "tuple[Address, ...]",
        period: float,
        limits: "Limits",
        epoch: int,
        deliver: "Callable[[Any], None]",
        discovered: "Callable[[RemoteParticipant, float], None]",
        lost: "Callable[[RemoteParticipant], None]",
        answered: "Callable[[bytes], bool]",
        count: "Callable[[str], None]",
    ) -> None:
        self.remotes: dict[bytes, RemoteParticipant] = {}
        self.own = own
        self._outbox = outbox
        self._addresses = addresses
        self._period = period
        self._limits = limits
        self._epoch = epoch
        self._deliver = deliver
        self._discovered = discovered
        self._lost = lost
        self._answered = answered
        self._count = count
        self._header = header.own(own.guid_prefix)
        self._payload = own.emit()
        self._sequence = 1
        self._quick = QUICK
        self._announce_at: float | None = None
        self._expire_at: float | None = None

    # -- announcing

    def start(self, now: float) -> None:
        """From now on announcements go out."""
        self._announce_at = now

    def change(self, own: "ParticipantData", now: float) -> None:
        """Announce other data, under the next sequence number: peers take the same number for a repeat."""
        self.own = own
        self._payload = own.emit()
        self._sequence += 1
        self._announce_at = now

    def _announcement(self, now: float, prefix: bytes = b"") -> "tuple[bytes, ...]":
        stamp = info_ts.InfoTimestamp(self._epoch + int(now * 1000000000)).emit()
        to = bytes(info_dst.InfoDestination(prefix).emit()) if prefix else b""
        reader_id = ENTITYID_SPDP_BUILTIN_PARTICIPANT_READER if prefix else ENTITYID_UNKNOWN
        value = Data(reader_id, ENTITYID_SPDP_BUILTIN_PARTICIPANT_WRITER, self._sequence, self._payload)
        return self._header, to, bytes(stamp), value.emit()

    def depart(self, now: float) -> None:
        """Tell everybody that we are gone."""
        self._announce_at = None
        key = inline_qos.InlineQos(self.own.guid, STATUS_DISPOSED | STATUS_UNREGISTERED).emit()
        value = Data(
            ENTITYID_UNKNOWN,
            ENTITYID_SPDP_BUILTIN_PARTICIPANT_WRITER,
            self._sequence + 1,
            participant_data.ParticipantData(self.own.guid).emit_key(),
            key,
            FLAG_K,
        )
        message = (self._header, value.emit())
        self._outbox.send(message, self._addresses)
        for remote in self.remotes.values():
            self._outbox.send(message, remote.metatraffic)

    # -- hearing

    def handle_data(self, value: Data, prefix: bytes, host: str, now: float) -> None:
        """A DATA of some participant's announcer. Raises ProtocolError."""
        if value.flags & FLAG_D:
            found = participant_data.parse(value.payload)
            if found.guid_prefix != prefix:
                raise ProtocolError("participant-of-another-prefix")
            self._announced(found, host, now)
            return
        said = inline_qos.parse(value.inline_qos, value.little)
        guid = said.key_hash
        if not guid and value.flags & FLAG_K:
            guid = participant_data.parse(value.payload).guid
        if said.status & (STATUS_DISPOSED | STATUS_UNREGISTERED) and guid[:12] == prefix:
            self._step(prefix, DEPARTED)

    def _announced(self, found: "ParticipantData", host: str, now: float) -> None:
        own = self.own
        domain = found.domain_id
        if (domain is not None and domain != own.domain_id) or found.domain_tag != own.domain_tag:
            self._count("participant-of-another-domain")
            return
        prefix = found.guid_prefix
        remote = self.remotes.get(prefix)
        if TRANSITIONS[(ALIVE if remote is not None else ABSENT, ANNOUNCED)][1] == "discover":
            if len(self.remotes) >= self._limits.participants:
                self._count("participants-full")
                return
            remote = self.remotes[prefix] = RemoteParticipant(found, host, now)
            # The newcomer hears of us at once, whatever multicast does.
            self._outbox.send(self._announcement(now, prefix), remote.metatraffic)
            self._discovered(remote, now)
            self._deliver(ParticipantDiscovered(found))
        elif remote is not None:
            remote.heard = now
            if found != remote.data or host not in remote.hosts:
                remote.update(found, host)
                self._discovered(remote, now)
                self._deliver(ParticipantDiscovered(found))
            if not self._answered(prefix):
                # Our greeting was lost, or it lost us; its next chance would be our next announcement.
                self._outbox.send(self._announcement(now, prefix), remote.metatraffic)
        self._expire_at = min(self._expire_at or now, now)

    def _step(self, prefix: bytes, event: str) -> None:
        action = TRANSITIONS[(ALIVE if prefix in self.remotes else ABSENT, event)][1]
        if action in ("forget", "expire"):
            remote = self.remotes.pop(prefix)
            self._lost(remote)
            self._deliver(ParticipantLost(remote.data, action == "expire"))

    # -- time

    def deadline(self) -> "float | None":
        """When `handle_deadline` has something to do."""
        if self._announce_at is None or self._expire_at is None:
            return self._announce_at if self._expire_at is None else self._expire_at
        return min(self._announce_at, self._expire_at)

    def handle_deadline(self, now: float) -> None:
        """Announce, and let leases expire."""
        if self._announce_at is not None and now >= self._announce_at:
            self._outbox.send(self._announcement(now), self._addresses)
            self._quick = max(0, self._quick - 1)
            self._announce_at = now + (QUICK_PERIOD if self._quick else self._period)
        if self._expire_at is not None and now >= self._expire_at:
            soonest: float | None = None
            for prefix, remote in list(self.remotes.items()):
                if remote.lease is None:
                    continue
                at = remote.heard + remote.lease
                if now >= at:
                    self._step(prefix, EXPIRED)
                elif soonest is None or at < soonest:
                    soonest = at
            self._expire_at = soonest
