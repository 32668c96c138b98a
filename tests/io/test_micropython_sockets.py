"""Datagrams of a node on MicroPython whose heap is in pieces: each is read as far as there is memory, and goes."""

from __future__ import annotations

import types
from typing import Any

import pytest

from roslet.io.micropython import sockets
from roslet.io.micropython.udp import Domain

SOURCE = ("10.0.0.7", 7411)


class Starved:
    """A UDP socket with datagrams that wait, in a heap that has no piece of more than `room` octets."""

    def __init__(self, room: int, *waiting: bytes) -> None:
        self.room = room
        self.waiting = list(waiting)

    def recvfrom(self, most: int, flags: int = 0) -> tuple[bytes, tuple[str, int]]:
        if most > self.room:
            raise MemoryError
        data = self.waiting[0] if flags else self.waiting.pop(0)
        return data[:most], SOURCE

    def recv(self, most: int) -> bytes:
        return self.recvfrom(most)[0]


@pytest.mark.parametrize(("size", "had"), [(300, 300), (900, 900), (1400, 1024), (9000, 1024)])
def test_of_a_datagram_as_much_is_read_as_there_is_memory_for(size: int, had: int) -> None:
    sock = Starved(1100, bytes(size), b"next")
    assert sockets.receive(sock, 16384) == (bytes(had), SOURCE)
    assert sock.waiting == [b"next"]


def test_of_the_longest_datagram_the_beginning_is_read_where_there_is_no_memory_for_all() -> None:
    sock = Starved(8192, bytes(14720), b"next")
    assert sockets.receive(sock, 16384) == (bytes(8192), SOURCE)
    assert sock.waiting == [b"next"]


@pytest.mark.parametrize("samples", [False, True])
def test_a_datagram_without_memory_does_not_stay_before_the_next(samples: bool) -> None:
    """It did, and what was behind it was never read: peers were taken to be gone when their leases had run out."""
    sock = Starved(100, bytes(300), bytes(300))
    counters: dict[str, int] = {}
    domain: Any = Domain.__new__(Domain)
    domain.__dict__.update(
        participant=types.SimpleNamespace(counters=counters),
        loop=types.SimpleNamespace(now=lambda: 0.0),
        _closed=False,
        _datagram=16384,
        _reading=False,
        _bounded=True,
        _with_source=1.0,
        _room=memoryview(bytearray(512)),
        _user=sock,
    )
    for _ in range(2):
        domain._read_samples(1) if samples else domain._read(sock)
    assert sock.waiting == []
    assert counters == {"no-memory-for-datagram": 2}
