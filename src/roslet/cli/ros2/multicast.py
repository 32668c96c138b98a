"""Does multicast work here? With sockets of its own, beside those of a participant."""

from __future__ import annotations

import os
import socket
import struct
import sys
import time
from typing import TYPE_CHECKING

from roslet.io.domain import GROUP
from roslet.wire.rtps import locator

if TYPE_CHECKING:
    from types import TracebackType

    from roslet.io.interfaces import Interface

# Seconds for a datagram to come back to its own host.
WAIT = 0.5
_MAGIC = b"RTPS"
_HEADER_SIZE = 20
_IP_MULTICAST_ALL = 49  # linux/in.h


def _name(number: int, address: str) -> bytes:
    """How an ip_mreq or ip_mreqn names an interface."""
    return socket.inet_aton(address) + (struct.pack("=i", number) if number else b"")


def hears_itself(number: int, address: str) -> str:
    """What keeps a datagram to the group, sent by an interface, from coming back by it; "" where nothing does.

    It goes to a port of its own, so that no participant sees it.
    """
    word = os.urandom(16)
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ear,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as mouth,
    ):
        try:
            ear.bind(("", 0))
            if sys.platform == "linux":
                # Otherwise Linux hands over what comes by other interfaces, which other sockets have joined.
                ear.setsockopt(socket.IPPROTO_IP, _IP_MULTICAST_ALL, 0)
            ear.setsockopt(
                socket.IPPROTO_IP,
                socket.IP_ADD_MEMBERSHIP,
                socket.inet_aton(GROUP) + _name(number, address),
            )
        except OSError as error:
            return f"cannot join {GROUP}: {error.strerror}"
        try:
            name = _name(number, address)
            mouth.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, bytes(4) + name if number else name)
            mouth.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_LOOP, 1)
            mouth.sendto(word, (GROUP, ear.getsockname()[1]))
        except OSError as error:
            return f"cannot send to {GROUP}: {error.strerror}"
        end = time.monotonic() + WAIT
        while True:
            ear.settimeout(max(0.001, end - time.monotonic()))
            try:
                if ear.recv(64) == word:
                    return ""
            except OSError:
                pass
            if time.monotonic() >= end:
                return f"what it sends to {GROUP} does not come back"


def has_route() -> bool:
    """Whether the system knows an interface for the group where a program names none."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect((GROUP, 9))
        except OSError:
            return False
    return True


class Listener:
    """Hears what comes to a domain's group, beside the participants of this host; a context manager."""

    def __init__(self, domain: int, interfaces: list[Interface]) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM | socket.SOCK_NONBLOCK)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        if hasattr(socket, "SO_REUSEPORT"):
            self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
        try:
            self._socket.bind(("", locator.metatraffic_multicast_port(domain)))
            for one in interfaces:
                if one.multicast:
                    self._join(one)
        except OSError:
            self._socket.close()  # somebody does not share the port; then nobody is heard

    def _join(self, one: Interface) -> None:
        try:
            self._socket.setsockopt(
                socket.IPPROTO_IP,
                socket.IP_ADD_MEMBERSHIP,
                socket.inet_aton(GROUP) + _name(one.number, one.address),
            )
        except OSError:
            return  # `hears_itself` says so

    def heard(self) -> set[bytes]:
        """GUID prefixes of the participants whose messages have come since the start, as far as the kernel kept them."""
        found: set[bytes] = set()
        while True:
            try:
                data = self._socket.recv(65536)
            except OSError:
                return found
            if len(data) >= _HEADER_SIZE and data[:4] == _MAGIC:
                found.add(data[8:_HEADER_SIZE])

    def __enter__(self) -> Listener:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._socket.close()
