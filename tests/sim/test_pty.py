"""A pseudo-terminal as a link, opened from the other side as a program opens a serial line."""

from __future__ import annotations

import os
import time

import serial

from roslet.sim.pty import Pty


def received(pty: Pty, size: int) -> bytes:
    found, end = b"", time.monotonic() + 5.0
    while len(found) < size and time.monotonic() < end:
        found += b"".join(pty.receive(0.0))
    return found


def test_octets_go_both_ways_unchanged() -> None:
    pty, every = Pty(), bytes(range(256))
    with serial.Serial(pty.path, 115200, timeout=5.0, exclusive=True) as port:
        pty.send(every, 0.0)
        assert port.read(256) == every
        port.write(every)
        assert received(pty, 256) == every
        assert pty.receive(0.0) == []
    pty.close()


def test_what_nobody_takes_is_counted_and_who_opens_it_again_is_heard() -> None:
    pty = Pty()
    for _ in range(100):
        pty.send(bytes(1000), 0.0)
    assert 0 < pty.dropped < 100_000
    for _ in range(2):
        with serial.Serial(pty.path, 9600, timeout=5.0) as port:
            port.write(b"again")
            assert received(pty, 5) == b"again"
    pty.close()


def test_closing_gives_back_the_descriptors_and_may_be_done_twice() -> None:
    before = len(os.listdir("/proc/self/fd"))
    pty = Pty()
    assert os.path.exists(pty.path)
    pty.close()
    pty.close()
    assert len(os.listdir("/proc/self/fd")) == before
