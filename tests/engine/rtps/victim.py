"""A participant that is driven by hand, with datagrams of `hand`. Runs on MicroPython."""

from engine.rtps import hand
from engine.rtps.hand import PREFIX, PUBLICATIONS_WRITER, READER, SOURCE, SUBSCRIPTIONS_WRITER, WRITER
from roslet.engine.rtps import events
from roslet.engine.rtps.participant import Participant
from roslet.wire.rtps import locator, qos
from roslet.wire.rtps.qos import Qos

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

RELIABLE = Qos((qos.RELIABLE, 100000000), history=(qos.KEEP_LAST, 10))
LATCHED = Qos((qos.RELIABLE, 100000000), qos.TRANSIENT_LOCAL, (qos.KEEP_LAST, 10))
BODY = b"\0\1\0\0body"
OWN = b"\x01\x52" + bytes(10)


class Victim:
    """A participant, driven by hand. `meet` makes it know the peer of `hand` with a writer of topic t."""

    def __init__(self, **fields: "Any") -> None:
        meta, user = locator.udp4("10.0.0.1", 7410), locator.udp4("10.0.0.1", 7411)
        self.participant = Participant(OWN, 0, (meta,), (user,), (("239.255.0.1", 7400),), **fields)
        self.now = 0.0
        self.events: list[Any] = []
        self.participant.start(0.0)
        self.turn()

    @property
    def counters(self) -> "dict[str, int]":
        return self.participant.counters

    def turn(self) -> "list[tuple[bytes, tuple[Any, ...]]]":
        """What a runtime does after each datagram; returns what was sent."""
        self.participant.handle_deadline(self.now)
        sent = [
            (b"".join([bytes(part) for part in parts]), addresses)
            for parts, addresses in self.participant.datagrams_to_send(self.now)
        ]
        self.events += self.participant.take_events()
        return sent

    def take(self, *datagrams: bytes, source: "tuple[str, int]" = SOURCE) -> None:
        for datagram in datagrams:
            self.participant.receive_datagram(datagram, source, self.now)
            self.turn()

    def of(self, kind: type) -> "list[Any]":
        return [event for event in self.events if isinstance(event, kind)]

    def samples(self) -> "list[tuple[int, bytes]]":
        return [(one.sequence, bytes(one.payload)) for one in self.of(events.SampleReceived)]

    def meet(self, e: str = "<") -> None:
        self.take(hand.spdp(e=e), sedp(hand.endpoint(PREFIX + WRITER, "t", "T", e), e=e))


def sedp(said: bytes, sequence: int = 1, writer: bytes = PUBLICATIONS_WRITER, e: str = "<") -> bytes:
    """An announcement of an endpoint, and the heartbeat that goes with it."""
    return hand.message(
        hand.data(writer, sequence, said, e=e), hand.heartbeat(writer, 1, sequence, sequence, e=e)
    )


def met(e: str = "<", **fields: "Any") -> "tuple[Victim, Any]":
    """A victim with a reliable reader of t that has matched the peer's writer and knows where it begins."""
    victim = Victim(**fields)
    reader = victim.participant.create_reader("t", "T", RELIABLE, 0.0)
    victim.meet(e)
    victim.take(hand.message(hand.heartbeat(WRITER, 1, 0, 1, e=e)))
    assert len(victim.of(events.EndpointMatched)) == 1
    assert victim.counters == {}
    return victim, reader


def offered(**fields: "Any") -> "tuple[Victim, Any]":
    """A victim with a transient-local writer of t that has matched the peer's reader."""
    victim = Victim(**fields)
    writer = victim.participant.create_writer("t", "T", LATCHED, 0.0)
    victim.take(hand.spdp(), sedp(hand.endpoint(PREFIX + READER), 1, SUBSCRIPTIONS_WRITER))
    assert list(writer.proxies) == [PREFIX + READER]
    assert victim.counters == {}
    return victim, writer
