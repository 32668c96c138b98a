"""A pseudo-terminal: a serial line that another program opens by its path. Unix."""

from __future__ import annotations

import os

from roslet.sim.link import Link

ROOM = 256
"""Octets read in one go: what is not read yet makes who writes wait, as the line does."""


class Pty(Link):
    """A serial line whose other end is `path`, for pyserial, `ros2://?slip=PATH`, or whoever opens devices.

    It carries octets, in pieces of any size. `dropped` counts octets that nobody took: the kernel keeps some thousand for
    whoever opens the other end later.
    """

    def __init__(self) -> None:
        import tty

        self._fd, self._other = os.openpty()
        tty.setraw(self._other)
        os.set_blocking(self._fd, False)
        self.path = os.ttyname(self._other)
        self.dropped = 0

    def send(self, frame: bytes, now: float) -> None:
        try:
            taken = os.write(self._fd, frame)
        except BlockingIOError:
            taken = 0
        self.dropped += len(frame) - taken

    def receive(self, now: float) -> list[bytes]:
        try:
            return [os.read(self._fd, ROOM)]
        except BlockingIOError:
            return []

    def fileno(self) -> int | None:
        return self._fd

    def close(self) -> None:
        for fd in (self._fd, self._other):
            if fd >= 0:
                os.close(fd)
        self._fd = self._other = -1
