"""Participants find each other: SPDP. RTPS 2.3, 8.5.3.

What a remote participant is to us, and what each event makes of it, is the table TRANSITIONS. Every message of a
participant renews its lease; only its own announcement makes it known.
"""

from roslet.engine.rtps.events import ParticipantDiscovered, ParticipantLost
from roslet.engine.rtps.reach import addresses_of, near
from roslet.engine.rtps.schedule import Alarm
from roslet.errors import ProtocolError
from roslet.wire.rtps import info_dst, info_ts, inline_qos, participant_data
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

    from roslet.engine.rtps.common import Common
    from roslet.engine.rtps.outbox import Address
    from roslet.engine.rtps.reach import Network
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
# What only this machine sends from; 0.0.0.0 is how multicast comes over a loopback without a route.
LOCAL = ("127.0.0.1", "0.0.0.0")
# Seconds: a peer that is heard twice, so long apart, from another of its addresses, and not once from the one in use, has
# moved there.
MOVED = 1.0


class RemoteParticipant:
    """A participant that announced itself. `heard`: when anything last came from it. `alone`: our multicast does not reach
    it, so that announcements go to it by itself."""

    def __init__(
        self, value: "ParticipantData", host: str, now: float, networks: "tuple[Network, ...]" = ()
    ) -> None:
        self.heard = now
        self._elsewhere: tuple[str, float] | None = None
        self.update(value, host, networks)

    def believes(self, host: str, now: float) -> bool:
        """Whether discovery in its name may come from this address: where it was first heard, where it says it is, or this
        machine. One that has been silent for half its lease may have moved."""
        if host in self.hosts:
            return True
        return self.lease is not None and now - self.heard > self.lease / 2

    def update(self, value: "ParticipantData", host: str, networks: "tuple[Network, ...]" = ()) -> None:
        self.data = value
        self.host = host
        self.lease = value.lease / 1e9 if value.lease < INFINITE else None
        self.metatraffic = addresses_of(
            value.metatraffic_unicast or value.metatraffic_multicast, host, networks
        )
        self.default = addresses_of(value.default_unicast or value.default_multicast, host, networks)
        self.hosts = {host}
        self.hosts.update(LOCAL)
        self.hosts.update([address for address, _ in networks])
        locators = value.metatraffic_unicast + value.default_unicast
        self.hosts.update([one.host for one in locators if one.usable])
        self.alone = bool(networks) and not (value.metatraffic_multicast and near(host, networks))

    def moved(self, host: str, now: float) -> bool:
        """An announcement came from `host`: whether the peer is to be reached there from now on."""
        if host == self.host:
            self._elsewhere = None
        elif self._elsewhere is None or self._elsewhere[0] != host:
            self._elsewhere = (host, now)
        elif now - self._elsewhere[1] >= MOVED:
            self._elsewhere = None
            return True
        return False


class Spdp:
    """Announces us, and keeps the table of who is there. `discovered` and `lost` are called before the events go out;
    `answered` says whether a participant has ever shown that it knows us."""

    def __init__(
        self,
        own: "ParticipantData",
        common: "Common",
        addresses: "tuple[Address, ...]",
        period: float,
        discovered: "Callable[[RemoteParticipant, float], None]",
        lost: "Callable[[RemoteParticipant, float], None]",
        answered: "Callable[[bytes], bool]",
        networks: "tuple[Network, ...]" = (),
    ) -> None:
        self.remotes: dict[bytes, RemoteParticipant] = {}
        self.own = own
        self._outbox = common.outbox
        self._addresses = addresses
        self._networks = networks
        self._period = period
        self._limits = common.limits
        self._epoch = common.epoch
        self._deliver = common.deliver
        self._discovered = discovered
        self._lost = lost
        self._answered = answered
        self._count = common.count
        self._header = common.header
        self._payload = own.emit()
        self._sequence = 1
        self._quick = QUICK
        self._announcing = Alarm(common.schedule, self._announce)
        self._expiring = Alarm(common.schedule, self._expire)

    # -- announcing

    def start(self, now: float) -> None:
        """From now on announcements go out."""
        self._announcing.set(now)

    def change(self, own: "ParticipantData", now: float) -> None:
        """Announce other data, under the next sequence number: peers take the same number for a repeat."""
        self.own = own
        self._payload = own.emit()
        self._sequence += 1
        self._announcing.set(now)

    def move(
        self,
        own: "ParticipantData",
        addresses: "tuple[Address, ...]",
        networks: "tuple[Network, ...]",
        now: float,
    ) -> None:
        """Our interfaces, or whom we announce to, have changed: everybody is told, as often as at the start, and each peer's
        addresses are chosen anew."""
        self._addresses = addresses
        self._networks = networks
        self._quick = QUICK
        if own != self.own:
            self.change(own, now)
        else:
            self._announcing.set(now)
        for remote in list(self.remotes.values()):
            remote.update(remote.data, remote.host, networks)
            self._outbox.send(self._announcement(now, remote.data.guid_prefix), remote.metatraffic)
            self._discovered(remote, now)

    def _announcement(self, now: float, prefix: bytes = b"") -> "tuple[bytes, ...]":
        stamp = info_ts.InfoTimestamp(self._epoch + int(now * 1000000000)).emit()
        to = bytes(info_dst.InfoDestination(prefix).emit()) if prefix else b""
        reader_id = ENTITYID_SPDP_BUILTIN_PARTICIPANT_READER if prefix else ENTITYID_UNKNOWN
        value = Data(reader_id, ENTITYID_SPDP_BUILTIN_PARTICIPANT_WRITER, self._sequence, self._payload)
        return self._header, to, bytes(stamp), value.emit()

    def depart(self, now: float) -> None:
        """Tell everybody that we are gone."""
        self._announcing.cancel()
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
            self._step(prefix, DEPARTED, now)

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
            remote = self.remotes[prefix] = RemoteParticipant(found, host, now, self._networks)
            # The newcomer hears of us at once, whatever multicast does.
            self._outbox.send(self._announcement(now, prefix), remote.metatraffic)
            self._discovered(remote, now)
            self._deliver(ParticipantDiscovered(found))
        elif remote is not None:
            remote.heard = now
            moved = remote.moved(host, now)
            if found != remote.data or host not in remote.hosts:
                remote.update(found, host, self._networks)
                self._discovered(remote, now)
                self._deliver(ParticipantDiscovered(found))
            elif moved:
                remote.update(found, host, self._networks)
                self._discovered(remote, now)
            if not self._answered(prefix):
                # Our greeting was lost, or it lost us; its next chance would be our next announcement.
                self._outbox.send(self._announcement(now, prefix), remote.metatraffic)
        if remote is not None and remote.lease is not None:
            self._expiring.set(remote.heard + remote.lease)

    def _step(self, prefix: bytes, event: str, now: float) -> None:
        action = TRANSITIONS[(ALIVE if prefix in self.remotes else ABSENT, event)][1]
        if action in ("forget", "expire"):
            remote = self.remotes.pop(prefix)
            self._lost(remote, now)
            self._deliver(ParticipantLost(remote.data, action == "expire"))

    def relearn(self, now: float) -> None:
        """Forget all participants and take them for new: what they announced of themselves is asked for again."""
        for remote in list(self.remotes.values()):
            self._step(remote.data.guid_prefix, EXPIRED, now)
            self._announced(remote.data, remote.host, now)

    # -- time

    def _announce(self, now: float) -> None:
        alone = [one.metatraffic for one in self.remotes.values() if one.alone]
        singly = [one[0] for one in alone if one and one[0] not in self._addresses]
        self._outbox.send(self._announcement(now), self._addresses + tuple(singly))
        self._quick = max(0, self._quick - 1)
        self._announcing.set(now + (QUICK_PERIOD if self._quick else self._period))

    def _expire(self, now: float) -> None:
        """Let leases expire. As whatever is heard renews one, the earliest end is looked for only when one was near."""
        soonest: float | None = None
        for prefix, remote in list(self.remotes.items()):
            if remote.lease is None:
                continue
            at = remote.heard + remote.lease
            if now >= at:
                self._step(prefix, EXPIRED, now)
            elif soonest is None or at < soonest:
                soonest = at
        if soonest is not None:
            self._expiring.set(soonest)
