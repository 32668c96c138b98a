"""`roslet master`: where it listens."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys

import pytest


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
