"""What a message says about itself: who sent it, for whom, where replies go. RTPS 2.3, 8.3.4, 8.3.7."""

import sys

import pytest

from engine.rtps.network import GROUP, RELIABLE, Network, body, matched, numbers, pair
from roslet.engine.rtps import events
from roslet.wire.rtps import header, locator, message, number_set
from roslet.wire.rtps.ack_nack import AckNack
from roslet.wire.rtps.data import Data
from roslet.wire.rtps.heartbeat import Heartbeat
from roslet.wire.rtps.info_dst import InfoDestination
from roslet.wire.rtps.info_reply import InfoReply
from roslet.wire.rtps.info_src import InfoSource
from roslet.wire.rtps.info_ts import InfoTimestamp

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

pytestmark = pytest.mark.micropython

ELSEWHERE = locator.udp4("10.9.9.9", 1234)
NOBODY = b"\1\2" + bytes(10)
# What loss and repetition make be counted.
USUAL = ("sample-repeated", "heartbeat-repeated", "acknack-repeated", "discovery-from-another-address")


def quiet_pair() -> "Any":
    network = Network()
    one, other, writer, reader = pair(network, RELIABLE, RELIABLE)
    assert matched(network, writer, reader)
    network.run(1)
    one.participant.datagrams_to_send(network.now)
    other.participant.datagrams_to_send(network.now)
    return network, one, other, writer, reader


def feed(host: "Any", network: "Any", prefix: bytes, *parts: "Any") -> "Any":
    """Give a host a datagram; the answers: (kinds of submessages, addresses) of each."""
    datagram = header.own(prefix) + b"".join([bytes(part) for part in parts])
    host.participant.receive_datagram(datagram, ("10.0.0.1", 7410), network.now)
    host.participant.handle_deadline(network.now)
    found = []
    for pieces, addresses in host.participant.datagrams_to_send(network.now):
        values = message.parse(b"".join([bytes(piece) for piece in pieces]))[1]
        found.append(([type(value).__name__ for value in values], addresses))
    return found


def test_an_answer_goes_where_info_reply_says_and_the_next_one_does_not() -> None:
    for form in ("emit", "emit_ip4"):
        network, one, other, writer, reader = quiet_pair()
        prefix = one.participant.guid_prefix
        beat = Heartbeat(reader.entity_id, writer.entity_id, 1, 0, 1000)
        where = getattr(InfoReply((ELSEWHERE,)), form)()
        usual = reader.proxies[writer.data.guid].addresses
        answer = ["InfoDestination", "AckNack"]
        assert feed(other, network, prefix, where, beat.emit()) == [(answer, (("10.9.9.9", 1234),))]
        beat.count += 1
        assert feed(other, network, prefix, beat.emit()) == [(answer, usual)]
        beat.count += 1
        # It holds up to the next INFO_SRC, and not before it was said.
        source = InfoSource(b"\2\3", b"\1\1", prefix).emit()
        assert feed(other, network, prefix, where, source, beat.emit()) == [(answer, usual)]
        beat.count += 1
        assert feed(other, network, prefix, beat.emit(), where) == [(answer, usual)]


def test_repairs_go_where_info_reply_says() -> None:
    network, one, other, writer, reader = quiet_pair()
    writer.write(body(1), network.now)
    one.participant.datagrams_to_send(network.now)
    ask = AckNack(reader.entity_id, writer.entity_id, number_set.of(1, [1]), 1000)
    where = InfoReply((ELSEWHERE,)).emit()
    (repair, beat) = feed(one, network, other.participant.guid_prefix, where, ask.emit())
    assert repair == (["InfoDestination", "InfoTimestamp", "Data"], (("10.9.9.9", 1234),))
    assert beat == (["InfoDestination", "Heartbeat"], (("10.9.9.9", 1234),))


def test_an_info_reply_without_a_usable_locator_changes_nothing() -> None:
    network, one, other, writer, reader = quiet_pair()
    beat = Heartbeat(reader.entity_id, writer.entity_id, 1, 0, 1000)
    where = InfoReply((locator.Locator(16, 1, bytes(16)),)).emit()
    ((_, addresses),) = feed(other, network, one.participant.guid_prefix, where, beat.emit())
    assert addresses == reader.proxies[writer.data.guid].addresses


def test_info_src_names_another_source_whomever_the_message_is_for() -> None:
    network, one, other, writer, reader = quiet_pair()
    source = InfoSource(b"\2\3", b"\1\1", one.participant.guid_prefix).emit()
    sample = Data(reader.entity_id, writer.entity_id, 1, body(5)).emit()
    away = InfoDestination(NOBODY).emit()
    here = InfoDestination(other.participant.guid_prefix).emit()
    feed(other, network, NOBODY, source, away, sample)
    network.run(0.001)
    assert numbers(other) == []
    feed(other, network, NOBODY, sample)
    assert other.participant.counters == {"data-of-unmatched-writer": 1}
    feed(other, network, NOBODY, away, source, here, sample)
    network.run(0.001)
    assert numbers(other) == [5]


def test_the_common_datagram_and_its_like_mean_the_same() -> None:
    """INFO_TS and DATA in little endian go a way of their own; in other forms and orders, the general one."""
    network, one, other, writer, reader = quiet_pair()
    prefix = one.participant.guid_prefix
    stamp = InfoTimestamp(1500000000000000000)
    beats = 1000
    number = 0
    for little in (True, False):
        for reader_id in (reader.entity_id, bytes(4)):
            for tail in ("", "beat"):
                for length in ("said", "zero"):
                    number += 1
                    beats += 1
                    sample = Data(reader_id, writer.entity_id, number, body(number), little=little).emit()
                    if length == "zero" and not tail:
                        sample = sample[:2] + bytes(2) + sample[4:]
                    beat = Heartbeat(reader_id, writer.entity_id, 1, number, beats).emit() if tail else b""
                    answers = feed(other, network, prefix, stamp.emit(little), sample, beat)
                    assert len(answers) == (1 if tail else 0)
    network.run(0.001)
    assert numbers(other) == list(range(1, number + 1))
    assert {event.time for event in other.of(events.SampleReceived)} == {stamp.time}
    assert other.participant.counters == {}


def test_a_common_datagram_that_is_not_right_is_counted_as_any() -> None:
    network, one, other, writer, reader = quiet_pair()
    prefix = one.participant.guid_prefix
    stamp = InfoTimestamp(0).emit()
    sample = bytes(Data(reader.entity_id, writer.entity_id, 1, body(1)).emit())
    stranger = bytes(Data(reader.entity_id, b"\0\0\x77\3", 1, body(1)).emit())
    cases = [
        (sample[:2] + b"\xff\x7f" + sample[4:], "submessage-too-long"),
        (sample[:2] + b"\x08\0" + sample[4:12] + bytes(len(sample) - 12), "data-truncated"),
        (sample[:16] + b"\xff\xff\xff\xff\1\0\0\0" + sample[24:], "data-invalid"),
        (sample[:16] + bytes(8) + sample[24:], "data-invalid"),
        (sample[:6] + b"\x0c\0" + sample[8:], "data-invalid"),
        (stranger, "data-of-unmatched-writer"),
    ]
    for broken, reason in cases:
        other.participant.counters.clear()
        feed(other, network, prefix, stamp, broken)
        assert other.participant.counters == {reason: 1}, reason
    network.run(0.001)
    assert numbers(other) == []


def test_readers_that_share_a_multicast_locator_are_reached_by_one_datagram() -> None:
    network = Network(3, 0.1)
    one = network.host()
    writer = one.participant.create_writer("t", "T", RELIABLE, 0.0)
    group = (locator.udp4(GROUP[0], GROUP[1]),)
    hosts = [network.host() for _ in range(3)]
    readers = [
        host.participant.create_reader("t", "T", RELIABLE, 0.0, multicast=group if index < 2 else ())
        for index, host in enumerate(hosts)
    ]
    assert network.run(20, lambda: len(writer.proxies) == 3 and all(reader.proxies for reader in readers))
    assert writer.addresses == (GROUP, (hosts[2].address, 7411))
    for number in range(20):
        writer.write(body(number), network.now)
    assert network.run(20, lambda: writer.acknowledged(20))
    assert [numbers(host) for host in hosts] == [list(range(20))] * 3
    hosts[0].participant.delete_reader(readers[0], network.now)
    assert network.run(20, lambda: len(writer.proxies) == 2)
    # One reader alone is as well reached by unicast.
    assert set(writer.addresses) == {(hosts[1].address, 7411), (hosts[2].address, 7411)}


def test_shells_that_use_their_memory_again_carry_the_same_samples() -> None:
    """One receives into one buffer without asking where from, the other sends small samples at once and keeps them where
    acknowledged ones were, on MicroPython; under loss, so that what was kept is sent again."""
    network = Network(7, loss=0.1, twice=0.05, late=0.1)
    one, other, writer, reader = pair(network, RELIABLE, RELIABLE)
    assert matched(network, writer, reader)
    room = memoryview(bytearray(1500))
    got: list[bytes] = []
    at_once: list[int] = []

    def receive(datagram: bytes, source: "Any", now: float) -> None:
        room[: len(datagram)] = datagram
        other.participant.receive_again(room, len(datagram), now)

    def send(front: "Any", rest: "Any", addresses: "Any") -> None:
        at_once.append(len(rest))
        for address in addresses:
            network._send(one, bytes(front) + bytes(rest), address)

    other.participant.receive_datagram = receive
    one.participant.outbox.at_once = send
    reader.sink = lambda proxy, value, time: got.append(bytes(value.payload))
    buffer = bytearray(12)
    for number in range(400):
        buffer[:] = body(number)
        writer.write(memoryview(buffer), network.now)
        buffer[:] = bytes(12)
        network.run(0.002)
    assert network.run(5.0, lambda: writer.acknowledged(400))
    assert got == [body(number) for number in range(400)]
    assert bool(at_once) == (sys.implementation.name == "micropython")
    left = [reason for reason in other.participant.counters if reason not in USUAL]
    assert left == [], other.participant.counters


def test_discovery_from_nobody_knows_where_is_not_believed() -> None:
    network, _one, other, _, _ = quiet_pair()
    network.keep = True
    assert network.run(10.0, lambda: bool(network.seen))
    room = memoryview(bytearray(1500))
    announcement = next(datagram for datagram in network.seen if b"\x00\x01\x00\xc2" in datagram)
    room[: len(announcement)] = announcement
    before = dict(other.participant.counters)
    other.participant.receive_again(room, len(announcement), network.now)
    assert before.get("discovery-from-another-address", 0) == 0
    assert other.participant.counters["discovery-from-another-address"] == 1
