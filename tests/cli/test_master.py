"""`roslet master`: where it listens, and the rosout node that it can be."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable

import pytest

import roslet


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@pytest.mark.parametrize("given", ["environment", "option"])
def test_the_port_is_that_of_the_environment_unless_it_is_given(given: str) -> None:
    port, other = free_port(), free_port()
    environment = dict(
        os.environ, ROS_MASTER_URI=f"http://localhost:{port if given == 'environment' else other}"
    )
    options = [] if given == "environment" else ["--port", str(port)]
    process = subprocess.Popen(
        [sys.executable, "-m", "roslet", "master", *options],
        env=environment,
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stdout is not None
        assert process.stdout.readline() == f"ROS_MASTER_URI=http://127.0.0.1:{port}/\n"
        process.send_signal(signal.SIGINT)
        assert process.wait(10) == 0
    finally:
        process.kill()
        process.communicate()


def test_a_master_uri_without_a_port_is_refused() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "roslet", "master"],
        env=dict(os.environ, ROS_MASTER_URI="nonsense"),
        capture_output=True,
        text=True,
        timeout=20,
        check=False,
    )
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr == "roslet: 'nonsense' is no URI\n"


def test_with_rosout_all_logs_are_gathered_and_nothing_is_left_at_the_end(
    start: Callable[..., subprocess.Popen[str]],
) -> None:
    process = start("master", "--host", "127.0.0.1", "--port", "0", "--rosout")
    assert process.stdout is not None
    network = "ros1" + process.stdout.readline().strip().removeprefix("ROS_MASTER_URI=http")
    heard: list[tuple[str, str]] = []
    with roslet.Node("viewer", network=network) as viewer, roslet.Node("robot", network=network) as robot:
        robot.log.quiet = True
        viewer.subscribe(
            "/rosout_agg", "rosgraph_msgs/Log", lambda log: heard.append((log.name, log.msg)), qos=100
        )
        assert set(viewer.nodes()) == {"/rosout", "/viewer", "/robot"}
        end = time.monotonic() + 10
        while ("/robot", "hot") not in heard and time.monotonic() < end:
            robot.log.error("hot")  # again: the connections are made meanwhile
            viewer.spin(0.1)
        assert ("/robot", "hot") in heard
    begin = time.monotonic()
    process.send_signal(signal.SIGINT)
    assert (process.wait(5), process.stderr.read() if process.stderr else "") == (0, "")
    assert time.monotonic() - begin < 2
