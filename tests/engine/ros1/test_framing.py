"""The frame receiver: every cut gives the same frames, and what is held is bounded."""

from struct import pack

import pytest

from roslet.engine.ros1 import framing
from roslet.engine.ros1.framing import FrameReceiver, Paused
from roslet.errors import ProtocolError

pytestmark = pytest.mark.micropython

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def frame(body: bytes) -> bytes:
    return pack("<I", len(body)) + body


class Collector:
    """Takes frames, copies them, and may keep views."""

    def __init__(self, **options: "Any") -> None:
        self.bodies: list[bytes] = []
        self.views: list[memoryview] = []
        self.keep = False
        self.receiver = FrameReceiver(self.deliver, **options)

    def deliver(self, view: memoryview, start: int, end: int) -> None:
        self.bodies.append(bytes(view[start:end]))
        if self.keep:
            self.views.append(view[start:end])


BODIES = [b"", b"a", b"", b"hello", bytes(range(256)), b"x" * 59, b"y" * 60, b"z" * 61, b"big" * 100, b"end"]
STREAM = b"".join([frame(body) for body in BODIES])


@pytest.mark.parametrize("step", [1, 2, 3, 4, 5, 7, 16, 63, 64, 65, 100, 10000])
def test_a_stream_gives_the_same_frames_however_it_is_cut(step: int) -> None:
    collector = Collector(chunk=64)  # so that some frames fit the chunk, some just so, some not
    for at in range(0, len(STREAM), step):
        collector.receiver.feed(STREAM[at : at + step])
    assert collector.bodies == BODIES
    assert collector.receiver.pending == 0


def test_a_tail_waits_for_its_rest() -> None:
    collector = Collector()
    collector.receiver.feed(frame(b"whole") + b"\x05\x00\x00\x00ha")
    assert collector.bodies == [b"whole"]
    assert collector.receiver.pending == 6
    collector.receiver.feed(b"lf!")
    assert collector.bodies == [b"whole", b"half!"]


def test_a_prefix_stands_before_each_length() -> None:
    seen = []

    def deliver(view: memoryview, start: int, end: int) -> None:
        seen.append((view[start - 5], bytes(view[start:end])))

    receiver = FrameReceiver(deliver, prefix=1, chunk=64)
    stream = b"\x01" + frame(b"yes") + b"\x00" + frame(b"n" * 100) + b"\x01" + frame(b"")
    for at in range(len(stream)):
        receiver.feed(stream[at : at + 1])
    assert seen == [(1, b"yes"), (0, b"n" * 100), (1, b"")]


@pytest.mark.parametrize("maximum", [0, 9, 10, 63, 64, 1000])
def test_a_frame_may_be_as_long_as_the_bound_and_no_longer(maximum: int) -> None:
    collector = Collector(maximum=maximum, chunk=64)
    collector.receiver.feed(frame(bytes(maximum)))
    assert collector.bodies == [bytes(maximum)]
    for whole in (True, False):
        collector = Collector(maximum=maximum, chunk=64)
        stream = frame(bytes(maximum + 1))
        with pytest.raises(
            ProtocolError, match="frame-too-large: %d bytes; at most %d" % (maximum + 1, maximum)
        ):
            collector.receiver.feed(stream if whole else stream[:4])
            collector.receiver.feed(b"\0")  # where the frame is longer than the chunk its head is enough
        assert collector.bodies == []


def test_a_length_that_lies_costs_no_more_than_the_first_allocation() -> None:
    collector = Collector()
    collector.receiver.feed(pack("<I", 200 << 20) + bytes(framing.CHUNK))
    large = collector.receiver._large
    assert large is not None and len(large) <= framing.FIRST_LARGE
    assert collector.receiver.pending == framing.CHUNK + 4


def test_a_large_buffer_at_most_doubles_with_what_arrives() -> None:
    size = 10 << 20
    collector = Collector()
    collector.receiver.feed(pack("<I", size))
    sent = 0
    while sent < size:
        count = min(1 << 20, size - sent)
        collector.receiver.feed(bytes(count))
        sent += count
        large = collector.receiver._large
        if large is not None:
            assert len(large) <= max(framing.FIRST_LARGE, 2 * sent)
    assert len(collector.bodies) == 1 and len(collector.bodies[0]) == size


@pytest.mark.cpython
def test_a_large_buffer_is_used_again_only_when_no_view_is_alive() -> None:
    buffers = []
    collector = Collector()

    def deliver(view: memoryview, start: int, end: int) -> None:
        buffers.append(id(view.obj))
        if collector.keep:
            collector.views.append(view)

    collector.receiver.deliver = deliver
    large = frame(bytes(100_000))
    collector.receiver.feed(large)
    collector.receiver.feed(large)
    assert buffers[0] == buffers[1]
    collector.keep = True
    collector.receiver.feed(large)
    assert collector.receiver._spare is None
    collector.receiver.feed(large)
    first, second = collector.views
    assert first.obj is not second.obj
    collector.views.clear()


def test_a_buffer_that_is_lent_serves_every_large_frame() -> None:
    collector = Collector()
    collector.receiver.lends = True
    seen = []
    large = frame(bytes(100_000))
    for _ in range(3):
        collector.receiver.feed(large)
        seen.append(collector.receiver._spare)
    assert seen[0] is not None and seen[0] is seen[1] is seen[2]


@pytest.mark.cpython
def test_a_kept_view_of_a_large_frame_never_changes() -> None:
    collector = Collector()
    collector.keep = True
    for value in range(5):
        collector.receiver.feed(frame(bytes([value]) * 100_000))
    assert [view[0] for view in collector.views] == [0, 1, 2, 3, 4]
    assert all(bytes(view) == bytes([value]) * 100_000 for value, view in enumerate(collector.views))


def test_with_copies_a_kept_view_of_a_small_frame_never_changes() -> None:
    collector = Collector(copies=True, chunk=64)
    collector.keep = True
    for value in range(100):
        collector.receiver.feed(frame(bytes([value]) * 20))
    assert [bytes(view) for view in collector.views] == [bytes([value]) * 20 for value in range(100)]


def test_room_is_never_empty() -> None:
    collector = Collector(chunk=32)
    for at in range(len(STREAM)):
        room = collector.receiver.writable()
        assert len(room) > 0
        room[0] = STREAM[at]
        collector.receiver.received(1)
    assert collector.bodies == BODIES


class TroubleError(Exception):
    pass


def test_what_deliver_raises_comes_out_and_the_rest_follows() -> None:
    collector = Collector(chunk=64)
    plain = collector.deliver

    def deliver(view: memoryview, start: int, end: int) -> None:
        plain(view, start, end)
        if bytes(view[start:end]) == b"bad":
            raise TroubleError

    collector.receiver.deliver = deliver
    stream = frame(b"one") + frame(b"bad") + frame(b"two") + frame(b"three")
    stream += b"\x40\x00\x00\x00" + bytes(64 - len(stream) - 4)  # the chunk is full to its last byte
    room = collector.receiver.writable()
    room[: len(stream)] = stream
    with pytest.raises(TroubleError):
        collector.receiver.received(len(stream))
    assert collector.bodies == [b"one", b"bad"]
    assert len(collector.receiver.writable()) > 0
    collector.receiver.received(0)
    assert collector.bodies == [b"one", b"bad", b"two", b"three"]


def test_a_pause_leaves_the_rest_for_later() -> None:
    collector = Collector(chunk=64)
    plain = collector.deliver

    def deliver(view: memoryview, start: int, end: int) -> None:
        plain(view, start, end)
        raise Paused

    collector.receiver.deliver = deliver
    with pytest.raises(Paused):
        collector.receiver.feed(frame(b"1") + frame(b"2"))
    with pytest.raises(Paused):
        collector.receiver.received(0)
    collector.receiver.received(0)
    assert collector.bodies == [b"1", b"2"]
