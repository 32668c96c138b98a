"""A peer whose machine vanishes without a word: the cable is pulled in a network namespace."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Iterator

import pytest

import roslet
from node.test_services import _environment
from nodes import wait_until
from roslet.io import select
from roslet.master.server import MasterServer

SPACE = f"roslet{os.getpid()}"
HERE, THERE = "10.213.7.1", "10.213.7.2"


def ip(*arguments: str) -> None:
    subprocess.run(["ip", *arguments], check=True, capture_output=True)


@pytest.fixture
def cable() -> Iterator[None]:
    """A namespace joined to ours by a cable."""
    if os.geteuid() != 0:
        pytest.skip("making a network namespace needs root")
    near, far = f"rl{os.getpid() % 100000}a", f"rl{os.getpid() % 100000}b"
    try:
        ip("netns", "add", SPACE)
        ip("link", "add", near, "type", "veth", "peer", "name", far, "netns", SPACE)
        ip("addr", "add", HERE + "/24", "dev", near)
        ip("link", "set", near, "up")
        ip("netns", "exec", SPACE, "ip", "addr", "add", THERE + "/24", "dev", far)
        ip("netns", "exec", SPACE, "ip", "link", "set", far, "up")
        ip("netns", "exec", SPACE, "ip", "link", "set", "lo", "up")
        yield None
    finally:
        subprocess.run(["ip", "netns", "del", SPACE], check=False, capture_output=True)
        subprocess.run(["ip", "link", "del", near], check=False, capture_output=True)


def test_a_vanished_publisher_and_a_vanished_subscriber_are_noticed(
    cable: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, seconds in (("KEEPIDLE", 1), ("KEEPINTVL", 1), ("KEEPCNT", 2), ("UNACKED", 3)):
        monkeypatch.setattr(select, name, seconds)  # in life it takes half a minute
    program = f"""
import roslet
node = roslet.Node('far', network='ros1://{HERE}:PORT', environment={{'ROS_IP': '{THERE}'}})
talk = node.publisher('from_far', 'std_msgs/String')
node.subscribe('to_far', 'std_msgs/String', lambda m: None)
node.timer(0.1, lambda: talk.publish(data='alive'))
print('ready', flush=True)
node.spin()
"""
    with MasterServer(HERE, 0) as master:
        near = roslet.Node("near", network=f"ros1://{HERE}:{master.port}", environment={"ROS_IP": HERE})
        near.log.quiet = True
        command = [
            "ip",
            "netns",
            "exec",
            SPACE,
            sys.executable,
            "-c",
            program.replace("PORT", str(master.port)),
        ]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, env=_environment())
        try:
            assert process.stdout is not None and process.stdout.readline() == b"ready\n"
            publisher = near.publisher("to_far", "std_msgs/String")
            got: list[str] = []
            subscription = near.subscribe(
                "from_far", "std_msgs/String", lambda message: got.append(message.data)
            )
            wait_until(lambda: publisher.subscriber_count == 1 and len(got) > 2, "they talk")
            ip("netns", "exec", SPACE, "ip", "link", "set", "lo", "down")
            subprocess.run(
                [
                    "ip",
                    "netns",
                    "exec",
                    SPACE,
                    "ip",
                    "link",
                    "set",
                    "dev",
                    f"rl{os.getpid() % 100000}b",
                    "down",
                ],
                check=True,
            )
            begin = time.monotonic()
            near.timer(0.1, lambda: publisher.publish(data="are you there"))
            wait_until(lambda: subscription.publisher_count == 0, "the silent publisher is given up", 15)
            wait_until(lambda: publisher.subscriber_count == 0, "the silent subscriber is given up", 15)
            assert time.monotonic() - begin < 9
            assert near.counters["publisher-lost"] == 1
            assert near.call_master("getPid") > 0
        finally:
            process.kill()
            process.wait()
            near.close()
