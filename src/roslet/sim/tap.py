"""A TAP device: the kernel's end of a cable whose other end is here. Linux, as root."""

from __future__ import annotations

import ctypes
import errno
import os
import struct
import threading

from roslet.errors import Unreachable
from roslet.sim.link import Damaged, Link

# linux/if_tun.h, linux/sched.h, linux/if.h
_TUNSETIFF = 0x400454CA
_IFF_TAP, _IFF_NO_PI = 0x0002, 0x1000
_CLONE_NEWNET = 0x40000000
_MAX_NAME = 15
# Frames read in one go before others get their turn.
BATCH = 64
MAX_FRAME = 65536


class Tap(Link):
    """The interface `name`, made for as long as the link lives; giving it an address and setting it up is the caller's. It
    appears in the network namespace of the process `namespace`, or in our own. `dropped` counts frames that the kernel did
    not take, as those to an interface that is not up. Raises Unreachable, saying why."""

    def __init__(self, name: str, namespace: int | None = None) -> None:
        if not 0 < len(name.encode()) <= _MAX_NAME:
            raise ValueError(f"an interface's name has 1 to {_MAX_NAME} octets, unlike {name!r}")
        self.name = name
        self.dropped = 0
        self._fd = -1
        if namespace is None:
            self._open()
        else:
            self._open_in(namespace)

    def _open(self) -> None:
        import fcntl

        try:
            fd = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
        except OSError as error:
            raise Unreachable(f"no TAP device: {error}") from None
        try:
            fcntl.ioctl(fd, _TUNSETIFF, struct.pack("16sH22x", self.name.encode(), _IFF_TAP | _IFF_NO_PI))
        except OSError as error:
            os.close(fd)
            raise Unreachable(f"no TAP device {self.name}: {error}") from None
        self._fd = fd

    def _open_in(self, namespace: int) -> None:
        """In a thread of its own: a namespace is entered by a thread, and this one never comes back."""
        failed: list[Exception] = []

        def enter() -> None:
            try:
                where = os.open(f"/proc/{namespace}/ns/net", os.O_RDONLY)
                try:
                    libc = ctypes.CDLL(None, use_errno=True)
                    if libc.setns(where, _CLONE_NEWNET):
                        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
                finally:
                    os.close(where)
                self._open()
            except OSError as error:
                failed.append(Unreachable(f"no namespace of process {namespace}: {error}"))
            except Unreachable as error:
                failed.append(error)

        thread = threading.Thread(target=enter)
        thread.start()
        thread.join()
        if failed:
            raise failed[0]

    def send(self, frame: bytes, now: float) -> None:
        if isinstance(frame, Damaged):
            self.dropped += 1
            return
        try:
            os.write(self._fd, frame)
        except OSError:
            self.dropped += 1

    def receive(self, now: float) -> list[bytes]:
        found = []
        for _ in range(BATCH):
            try:
                found.append(os.read(self._fd, MAX_FRAME))
            except BlockingIOError:
                break
            except OSError as error:
                # EIO: the interface is not up.
                if error.errno != errno.EIO:
                    raise
                break
        return found

    def fileno(self) -> int | None:
        return self._fd

    def close(self) -> None:
        if self._fd >= 0:
            os.close(self._fd)
            self._fd = -1
