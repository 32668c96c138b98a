"""The send queue against the plainest model of it: a list of bytes objects."""

import random

import pytest

from roslet.engine.ros1.queue import SendQueue

pytestmark = pytest.mark.micropython


def drain(queue: SendQueue, step: int = 1 << 30) -> bytes:
    out = b""
    while len(queue):
        data = b"".join([bytes(part) for part in queue.peek()])[:step]
        queue.sent(len(data))
        out += data
    return out


def test_frames_go_out_in_their_order_however_they_are_cut() -> None:
    for step in (1, 2, 3, 5, 7, 100):
        queue = SendQueue(0)
        for index in range(300):
            queue.push(b"frame %d;" % index)
        assert drain(queue, step) == b"".join([b"frame %d;" % index for index in range(300)])
        assert queue.bytes == 0 and queue.high_water == 300 and queue.dropped == 0


def test_a_full_queue_drops_its_oldest_frame_and_counts_it() -> None:
    queue = SendQueue(3)
    assert [queue.push(b"%d" % index) for index in range(5)] == [0, 0, 0, 1, 1]
    assert queue.dropped == 2 and len(queue) == 3 and queue.high_water == 3
    assert drain(queue) == b"234"


def test_a_frame_that_has_begun_is_never_dropped() -> None:
    queue = SendQueue(2)
    queue.push(b"abcd")
    queue.sent(1)
    for index in range(4):
        queue.push(b"%d" % index)
    assert drain(queue) == b"bcd23"
    assert queue.dropped == 2


def test_the_rest_of_a_frame_stands_first_and_does_not_count() -> None:
    queue = SendQueue(1)
    queue.push_rest(b"rest")
    assert not queue.full
    assert queue.push(b"1") == 0
    assert queue.full
    assert queue.push(b"2") == 1
    assert drain(queue, 3) == b"rest2"


def test_a_rest_behind_other_frames_is_refused() -> None:
    queue = SendQueue(1)
    queue.push(b"a")
    with pytest.raises(ValueError, match="behind other frames"):
        queue.push_rest(b"b")
    assert drain(queue) == b"a"


def test_without_depth_bytes_are_the_bound() -> None:
    queue = SendQueue(0, max_bytes=10)
    queue.push(b"12345")
    assert not queue.full
    queue.push(b"67890")
    assert queue.full and queue.bytes == 10
    queue.sent(4)
    assert queue.bytes == 10  # a frame counts whole until its last byte has gone
    queue.sent(1)
    assert queue.bytes == 5 and not queue.full


def test_clear_says_how_many_frames_were_given_up() -> None:
    queue = SendQueue(0)
    queue.push(b"ab")
    queue.push(b"cd")
    queue.sent(1)
    assert queue.clear() == 2
    assert len(queue) == 0 and queue.bytes == 0
    queue.push(b"x")
    assert drain(queue) == b"x"


def test_at_most_64_buffers_go_out_at_once() -> None:
    queue = SendQueue(0)
    for _ in range(100):
        queue.push(b"x")
    assert len(queue.peek()) == 64


class Model:
    """The same, naively."""

    def __init__(self, depth: int) -> None:
        self.depth = depth
        self.frames: list[bytes] = []
        self.begun = False
        self.dropped = 0
        self.out = b""

    def push(self, frame: bytes) -> None:
        if self.depth and len(self.frames) - (1 if self.begun else 0) >= self.depth:
            del self.frames[1 if self.begun else 0]
            self.dropped += 1
        self.frames.append(frame)

    def push_rest(self, rest: bytes) -> None:
        self.frames.append(rest)
        self.begun = True

    def sent(self, count: int) -> None:
        while count:
            head = self.frames[0]
            if count < len(head):
                self.out += head[:count]
                self.frames[0] = head[count:]
                self.begun = True
                return
            self.out += head
            count -= len(head)
            del self.frames[0]
            self.begun = False


@pytest.mark.parametrize("seed", range(20))
def test_random_use_agrees_with_the_model(seed: int) -> None:
    random.seed(seed)
    depth = random.randrange(5)
    queue, model, out, serial = SendQueue(depth), Model(depth), b"", 0
    for _ in range(1000):
        action = random.randrange(4)
        if action < 2:
            serial += 1
            data = b"<%d>" % serial
            if not len(queue) and random.randrange(2):
                queue.push_rest(data)
                model.push_rest(data)
            else:
                queue.push(data)
                model.push(data)
        elif len(queue):
            ready = b"".join([bytes(part) for part in queue.peek()])
            count = random.randrange(len(ready) + 1)
            out += ready[:count]
            queue.sent(count)
            model.sent(count)
        assert len(queue) == len(model.frames)
        assert queue.dropped == model.dropped
        assert out == model.out
    assert out + drain(queue) == model.out + b"".join(model.frames)
