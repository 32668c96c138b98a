"""The judges judged: roscpp and rospy understand each other's samples, so a difference elsewhere is ours."""

from __future__ import annotations

import pytest

from interop.cases import CASES, Case
from interop.ros1 import Master, Peer, wait_until


@pytest.fixture(scope="module")
def pair(master: Master, roscpp: Peer, rospy: Peer) -> tuple[Peer, Peer]:
    return roscpp, rospy


@pytest.mark.parametrize("case", CASES, ids=str)
@pytest.mark.parametrize("way", ["roscpp to rospy", "rospy to roscpp"])
def test_both_peers_mean_the_same_message(pair: tuple[Peer, Peer], case: Case, way: str, topic: str) -> None:
    sender, receiver = pair if way.startswith("roscpp") else pair[::-1]
    sender.ask(f"advertise {case.type} {topic} 0", f"advertised {topic}")
    receiver.ask(f"subscribe {case.type} {topic} {case.size}", f"subscribed {topic}")
    wait_until(lambda: sender.subscribers(topic) == 1, "the peers connect")
    for i in range(case.count):
        sender.say(f"publish {topic} {i} {case.size}")
    lines = receiver.wait_for(f"got {topic} ", case.count)
    assert lines == [f"got {topic} {i} ok" for i in range(case.count)]
    sender.ask(f"unadvertise {topic}", f"unadvertised {topic}")
    receiver.ask(f"unsubscribe {topic}", f"unsubscribed {topic}")
