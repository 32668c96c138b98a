"""Which of a peer's addresses are used, and who is told of our moves. Addresses are chosen by hand."""

import pytest

from roslet.engine.rtps import events
from roslet.engine.rtps.participant import Participant
from roslet.engine.rtps.reach import MAX_ADDRESSES, addresses_of, near
from roslet.wire.rtps import locator

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

pytestmark = pytest.mark.micropython

OURS = (("10.0.1.1", 24), ("172.17.0.1", 16))
GROUP = locator.udp4("239.255.0.1", 7400)


def at(*hosts: str) -> "tuple[locator.Locator, ...]":
    return tuple([locator.udp4(host, 7411) for host in hosts])


@pytest.mark.parametrize(
    ("hosts", "heard_from", "expected"),
    [
        (["10.9.9.9", "10.0.1.2"], "10.9.9.9", ["10.9.9.9"]),
        (["10.9.9.9", "10.0.1.2"], "10.0.9.1", ["10.0.1.2"]),
        (["127.0.0.1", "10.0.1.2"], "10.0.9.1", ["10.0.1.2"]),
        (["127.0.0.1"], "10.0.1.2", []),
        (["172.17.0.1", "10.0.1.2"], "10.0.9.1", ["10.0.1.2"]),
        (["172.17.0.1", "10.9.9.9"], "10.0.9.1", ["10.9.9.9"]),
        (["10.9.9.9", "10.0.1.1"], "127.0.0.1", ["10.0.1.1"]),
        (["10.9.9.9", "127.0.0.1"], "10.0.1.1", ["127.0.0.1"]),
        (["127.0.0.1"], "0.0.0.0", ["127.0.0.1"]),
        (["10.9.9.9", "10.9.8.9"], "10.0.9.1", ["10.9.9.9", "10.9.8.9"]),
        (["10.9.9.%d" % i for i in range(9)], "10.0.9.1", ["10.9.9.%d" % i for i in range(MAX_ADDRESSES)]),
    ],
)
def test_a_peer_is_sent_to_where_it_can_be_reached(
    hosts: "list[str]", heard_from: str, expected: "list[str]"
) -> None:
    assert addresses_of(at(*hosts), heard_from, OURS) == tuple([(host, 7411) for host in expected])


def test_without_knowledge_of_our_networks_the_first_few_are_used() -> None:
    hosts = ["127.0.0.1", "10.0.0.1", "10.0.0.2", "10.0.0.3", "10.0.0.4"]
    assert addresses_of(at(*hosts), "10.1.1.1") == tuple([(host, 7411) for host in hosts[:4]])


def test_a_prefix_says_what_is_near() -> None:
    assert near("10.0.1.255", OURS)
    assert not near("10.0.2.1", OURS)
    assert near("172.17.255.9", OURS)
    assert near("192.0.2.1", (("198.51.100.1", 0),))


def participant(number: int, host: str, **fields: "Any") -> Participant:
    here = locator.udp4(host, 7410)
    default = locator.udp4(host, 7411)
    prefix = b"\x01\x52" + bytes(9) + bytes([number])
    return Participant(prefix, 0, (here,), (default,), (("239.255.0.1", 7400),), **fields)


def announcements(one: Participant, now: float) -> "list[tuple[bytes, tuple[tuple[str, int], ...]]]":
    """What is due of the writer 000100c2: announcements of the participant itself."""
    one.handle_deadline(now)
    sent = [(b"".join([bytes(part) for part in parts]), to) for parts, to in one.datagrams_to_send(now)]
    return [pair for pair in sent if b"\x00\x01\x00\xc2" in pair[0]]


def meet(one: Participant, other: Participant, host: str, now: float) -> None:
    """`one` hears an announcement of `other` from an address."""
    other.start(now)
    for datagram, _ in announcements(other, now):
        one.receive_datagram(datagram, (host, 7411), now)
    one.datagrams_to_send(now)


def test_who_does_not_hear_the_group_is_told_singly() -> None:
    us = participant(1, "10.0.1.1", networks=OURS)
    meet(us, participant(2, "10.0.1.2", multicast=(GROUP,)), "10.0.1.2", 0.0)
    meet(us, participant(3, "10.0.1.3"), "10.0.1.3", 0.0)
    meet(us, participant(4, "10.0.9.4", multicast=(GROUP,)), "10.0.9.4", 0.0)
    us.start(1.0)
    ((_, to),) = announcements(us, 1.0)
    assert to == (("239.255.0.1", 7400), ("10.0.1.3", 7410), ("10.0.9.4", 7410))


def test_a_move_is_told_to_all_under_a_new_number() -> None:
    us, peer = participant(1, "10.0.1.1", networks=OURS), participant(2, "10.0.1.2", multicast=(GROUP,))
    meet(us, peer, "10.0.1.2", 0.0)
    meet(peer, us, "10.0.1.1", 0.0)
    peer.take_events()
    us.datagrams_to_send(0.0)
    moved = us.spdp.own.replace(metatraffic_unicast=(locator.udp4("10.0.1.7", 7410),))
    us.move(moved, (("239.255.0.1", 7400), ("10.0.5.5", 7410)), (("10.0.1.7", 24),), 10.5)
    sent = announcements(us, 10.5)
    assert [to for _, to in sent] == [(("10.0.1.2", 7410),), (("239.255.0.1", 7400), ("10.0.5.5", 7410))]
    # It is believed once it was silent for half its lease: until then anybody could say so.
    peer.receive_datagram(sent[0][0], ("10.0.1.7", 7411), 10.5)
    (event,) = peer.take_events()
    assert isinstance(event, events.ParticipantDiscovered)
    assert event.data == moved
    assert peer.spdp.remotes[us.guid_prefix].metatraffic == (("10.0.1.7", 7410),)
    # And anew as quickly as at the start.
    assert announcements(us, 10.59) == []
    assert len(announcements(us, 10.61)) == 1


def test_a_peer_that_is_only_heard_from_elsewhere_is_sent_to_there() -> None:
    us = participant(1, "10.0.1.1", networks=(("10.0.1.1", 24), ("10.0.2.1", 24)))
    prefix = b"\x01\x52" + bytes(9) + b"\x02"
    peer = Participant(prefix, 0, at("10.0.1.2", "10.0.2.2"), at("10.0.1.2", "10.0.2.2"), ())
    said = peer.spdp._announcement(0.0)

    def heard(host: str, now: float) -> str:
        us.receive_datagram(b"".join([bytes(part) for part in said]), (host, 7411), now)
        return us.spdp.remotes[prefix].metatraffic[0][0]

    assert heard("10.0.1.2", 0.0) == "10.0.1.2"
    assert heard("10.0.2.2", 0.0) == "10.0.1.2"
    assert heard("10.0.1.2", 3.0) == "10.0.1.2"
    assert heard("10.0.2.2", 3.0) == "10.0.1.2"
    assert heard("10.0.2.2", 6.0) == "10.0.2.2"
