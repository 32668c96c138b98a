"""Bulk goes within a window that acknowledgements open, losses narrow, and time opens where nobody acknowledges."""

import pytest

from engine.rtps.network import RELIABLE, Network, body, matched, numbers
from roslet.engine.rtps.outbox import MAX_MARKS, MAX_WINDOW, PACE, WHOLE, WINDOW, Flow, Outbox
from roslet.wire.rtps import data_frag, heartbeat_frag, message, qos

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import Any

pytestmark = pytest.mark.micropython

PLACE = (("10.0.0.1", 1),)
PART = 65000
KEEP_ALL = RELIABLE.replace(history=(qos.KEEP_ALL, 1))


def sample(sequence: int, count: int) -> "Iterator[Any]":
    for number in range(1, count + 1):
        yield (bytes(PART),), PLACE, (sequence, WHOLE) if number == count else None


def sent(outbox: "Any", now: float) -> int:
    return len(outbox.take(now))


def test_what_exceeds_the_window_waits_for_time() -> None:
    outbox = Outbox()
    flow = Flow(outbox)
    flow.add(sample(1, 20))
    assert sent(outbox, 1.0) == 4  # as many as begin within the window
    assert sent(outbox, 1.0) == 0
    at = outbox.deadline()
    assert at is not None
    assert 0 < at - 1.0 < 4 * PART / PACE
    assert sent(outbox, at) > 0
    assert sent(outbox, 1.0 + 4 * PART / PACE) <= 4


def test_an_acknowledgement_makes_room_at_once() -> None:
    outbox = Outbox()
    flow = Flow(outbox)
    for sequence in range(1, 9):
        flow.add(sample(sequence, 1))
    assert sent(outbox, 1.0) == 4
    assert sent(outbox, 1.001) == 0
    flow.acknowledged(2)
    assert outbox.deadline() == 0.0
    assert sent(outbox, 1.001) == 2
    flow.acknowledged(6)
    assert sent(outbox, 1.001) == 2
    assert outbox.deadline() is None


def test_repairs_go_before_what_waits() -> None:
    outbox = Outbox()
    flow = Flow(outbox)
    flow.add(sample(1, 8))
    assert sent(outbox, 1.0) == 4
    flow.add(iter([((b"repair",), PLACE, None)]), True)
    assert outbox.take(1.1)[0] == ((b"repair",), PLACE)


def test_the_window_grows_with_use_and_shrinks_with_loss() -> None:
    outbox = Outbox()
    flow = Flow(outbox)
    flow.widen()
    assert flow.window == WINDOW  # nothing was under way: that it arrived says nothing
    now = 1.0
    for sequence in range(1, 60):
        flow.add(sample(sequence, 60))
        while outbox.deadline() is not None:
            now += 0.01
            outbox.take(now)
        flow.acknowledged(sequence)
        flow.widen()
    assert flow.window == MAX_WINDOW
    flow.narrow()
    assert flow.window == MAX_WINDOW // 2
    for _ in range(10):
        flow.narrow()
    assert flow.window == WINDOW


def test_what_is_never_acknowledged_is_forgotten() -> None:
    outbox = Outbox()
    flow = Flow(outbox)
    now = 0.0
    for sequence in range(1, 3 * MAX_MARKS):
        flow.add(iter([((b"x",), PLACE, (sequence, WHOLE))]))
        now += 1.0
        outbox.take(now)
    assert len(flow._marks) == MAX_MARKS
    assert flow.last_sent == (3 * MAX_MARKS - 1, WHOLE)


def test_a_reader_of_roslet_tells_how_far_a_large_sample_has_come() -> None:
    network = Network()
    one, other = network.host(fragment_size=10000), network.host()
    writer = one.participant.create_writer("t", "T", KEEP_ALL, 0.0)
    reader = other.participant.create_reader("t", "T", KEEP_ALL, 0.0)
    assert matched(network, writer, reader)
    assert writer.tells
    network.run(1)
    network.keep = True
    begin = network.now
    writer.write(body(1, 2000000), network.now)
    assert network.run(5, lambda: writer.acknowledged(1))
    # By the pace of time alone it would take 10 ms; each window takes one round trip of 0.4 ms.
    assert network.now - begin < 0.006
    values = [value for datagram in network.seen for value in message.parse(datagram)[1]]
    assert len([value for value in values if isinstance(value, data_frag.DataFrag)]) == 200
    assert len([value for value in values if isinstance(value, heartbeat_frag.HeartbeatFrag)]) > 20
    assert other.participant.counters == one.participant.counters == {}


def test_a_reader_of_another_vendor_is_paced_by_time_and_hears_nothing_strange() -> None:
    network = Network()
    one, other = network.host(fragment_size=10000), network.host()
    foreign: Any = other.participant.spdp.own.replace(vendor_id=b"\1\x10")
    other.participant.spdp.change(foreign, 0.0)
    writer = one.participant.create_writer("t", "T", KEEP_ALL, 0.0)
    reader = other.participant.create_reader("t", "T", KEEP_ALL, 0.0)
    assert matched(network, writer, reader)
    network.run(1)
    assert not writer.tells
    network.keep = True
    writer.write(body(1, 2000000), network.now)
    assert network.run(5, lambda: writer.acknowledged(1))
    assert numbers(other) == [1]
    values = [value for datagram in network.seen for value in message.parse(datagram)[1]]
    assert len([value for value in values if isinstance(value, heartbeat_frag.HeartbeatFrag)]) == 1


def test_lost_fragments_are_asked_for_while_the_rest_is_on_its_way() -> None:
    for seed in (1, 2, 3):
        network = Network(seed)
        one, other = network.host(fragment_size=10000), network.host()
        writer = one.participant.create_writer("t", "T", KEEP_ALL, 0.0)
        reader = other.participant.create_reader("t", "T", KEEP_ALL, 0.0)
        assert matched(network, writer, reader)
        network.run(1)
        network.loss = 0.05
        for number in range(5):
            writer.write(body(number, 1000000), network.now)
        assert network.run(10, lambda writer=writer: writer.acknowledged(5))
        assert numbers(other) == list(range(5))
        assert other.participant._common.assembling.left == other.participant.limits.assembly_bytes
        assert not writer._repairs.busy
        assert writer._repairs._mending == set()


def test_a_writer_that_may_wait_is_full_before_small_samples_overrun_its_readers() -> None:
    network = Network()
    one, other = network.host(), network.host()
    writer = one.participant.create_writer("t", "T", KEEP_ALL, 0.0)
    reader = other.participant.create_reader("t", "T", KEEP_ALL, 0.0)
    assert matched(network, writer, reader)
    network.run(1)
    written = 0
    while not writer.full(64):
        writer.write(body(written, 64), network.now)
        written += 1
    assert 100 < written < 300  # what a buffer of 208 KiB takes
    for _ in range(8):
        assert network.run(1, lambda: not writer.full(64))
        network.run(0.1)
        while not writer.full(64):
            writer.write(body(written, 64), network.now)
            written += 1
    network.run(1)
    assert written > 3000
    assert numbers(other) == list(range(written))
