"""The send queue under hypothesis: what goes out is whole frames in order, less exactly those that were counted."""

from __future__ import annotations

import re

from hypothesis import given, settings
from hypothesis import strategies as st

from roslet.engine.ros1.queue import SendQueue


@settings(max_examples=300, deadline=None)
@given(
    depth=st.integers(0, 4),
    steps=st.lists(st.one_of(st.just("push"), st.integers(1, 40)), max_size=60),
)
def test_what_went_in_comes_out_whole_and_in_order_or_is_counted(depth: int, steps: list[str | int]) -> None:
    queue = SendQueue(depth)
    pushed = 0
    dropped = 0
    out = b""
    for step in steps:
        if step == "push":
            dropped += queue.push(b"<%d>" % pushed)
            pushed += 1
        elif len(queue):
            ready = b"".join(bytes(part) for part in queue.peek())[: int(step)]
            out += ready
            queue.sent(len(ready))
    out += b"".join(bytes(part) for part in queue.peek())
    numbers = [int(number) for number in re.findall(rb"<(\d+)>", out)]
    assert b"".join(b"<%d>" % number for number in numbers) == out
    assert numbers == sorted(set(numbers))
    assert len(numbers) + dropped == pushed
    assert dropped == queue.dropped
