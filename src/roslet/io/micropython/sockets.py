"""Sockets as MicroPython has them: addresses as the port wants them, groups, what a peer's address is.

The Unix port takes and gives addresses as bytes (`struct sockaddr_in`), boards as (host, port); it has no `getsockname`, so
ports are chosen here. Boards differ in how our own address is found, and in how many sockets there are.
"""

import errno
import os
import socket
from struct import unpack_from

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_socket: "Any" = socket
# Linux, as MicroPython names only some of them.
_IPPROTO_IP, _IPPROTO_TCP, _TCP_NODELAY, _SO_REUSEPORT = 0, 6, 1, 15
_IP_MULTICAST_IF, _IP_MULTICAST_TTL, _IP_MULTICAST_LOOP, _IP_MULTICAST_ALL = 32, 33, 34, 49
# Where ports are chosen from, and how often another is tried.
FIRST_PORT, LAST_PORT = 20000, 32767
TRIES = 100
# Addresses that are remembered in the port's form, and hosts.
MAX_KNOWN = 64
# Bytes that are read of a datagram at first: most have less.
FIRST = 512
LOOPBACK = "127.0.0.1"

_peek: int = getattr(_socket, "MSG_PEEK", 0)
_known: "dict[tuple[str, int], Any]" = {}
_hosts: "dict[bytes, str]" = {}


def address(host: str, port: int) -> "Any":
    """What `connect`, `bind` and `sendto` take. A host that is no number is looked up, which blocks. Raises OSError."""
    return address_of((host, port))


def address_of(pair: "tuple[str, int]") -> "Any":
    """The same of both as a pair."""
    found = _known.get(pair)
    if found is None:
        if len(_known) >= MAX_KNOWN:
            _known.clear()
        found = _known[pair] = _socket.getaddrinfo(pair[0], pair[1], _socket.AF_INET)[0][-1]
    return found


def host(raw: "Any") -> str:
    """The host of an address that `recvfrom` or `accept` gave. Hosts are few and remembered; each connection has another
    port."""
    if isinstance(raw, tuple):
        return raw[0]  # type: ignore[no-any-return]
    number = bytes(raw[4:8])
    found = _hosts.get(number)
    if found is None:
        if len(_hosts) >= MAX_KNOWN:
            _hosts.clear()
        a, b, c, d = number
        found = _hosts[number] = "%d.%d.%d.%d" % (a, b, c, d)
    return found


def octets(host: str) -> bytes:
    """The four octets of an IPv4 address. Raises ValueError."""
    found = bytes([int(part) for part in host.split(".")])
    if len(found) != 4:
        raise ValueError(host)
    return found


def _random_port() -> int:
    return FIRST_PORT + unpack_from("<H", os.urandom(2), 0)[0] % (LAST_PORT - FIRST_PORT + 1)  # type: ignore[no-any-return]


def listen(backlog: int = 4) -> "tuple[Any, int]":
    """A listening socket on a port of chance, and the port. Raises OSError."""
    for _ in range(TRIES):
        sock = _socket.socket()
        port = _random_port()
        try:
            sock.bind(address("0.0.0.0", port))
            sock.listen(backlog)
            sock.setblocking(False)
            return sock, port
        except OSError:
            sock.close()
        finally:
            _known.pop(("0.0.0.0", port), None)
    raise OSError(errno.EADDRINUSE)


def connect(host: str, port: int) -> "Any":
    """A socket that is being connected. Raises OSError."""
    where = address(host, port)
    sock = _socket.socket()
    try:
        sock.setblocking(False)
        tune(sock)
        sock.connect(where)
    except OSError as error:
        if error.errno != errno.EINPROGRESS:
            sock.close()
            raise
    return sock


def tune(sock: "Any") -> None:
    """Send small messages at once, where the port can be told so."""
    _try_option(sock, _IPPROTO_TCP, _TCP_NODELAY, 1)


def _try_option(sock: "Any", level: int, option: int, value: "Any") -> bool:
    try:
        sock.setsockopt(level, option, value)
    except OSError:
        return False
    return True


def datagrams(port: int, shared: bool = False) -> "Any":
    """A UDP socket on a port of every interface; `shared` with others that share it. Raises OSError."""
    sock = _socket.socket(_socket.AF_INET, _socket.SOCK_DGRAM)
    try:
        sock.setblocking(False)
        if shared:
            sock.setsockopt(_socket.SOL_SOCKET, _socket.SO_REUSEADDR, 1)
            _try_option(sock, _socket.SOL_SOCKET, _SO_REUSEPORT, 1)
            _try_option(sock, _IPPROTO_IP, _IP_MULTICAST_ALL, 0)
        sock.bind(address("0.0.0.0", port))
    except OSError:
        sock.close()
        raise
    return sock


def receive(sock: "Any", most: int) -> "tuple[bytes, Any]":
    """A datagram, of which the rest beyond `most` is lost, and where it came from. Raises OSError; MemoryError, and then
    the datagram still waits.

    MicroPython allots room for the longest before it looks, in one piece, which a heap that is nearly full may not have.
    Where it can look first, it begins with little, and of a datagram for which there is no memory the beginning is taken:
    it has whole submessages, and the rest will be asked for again.
    """
    room = FIRST if _peek else most
    found: Any = None
    try:
        while room < most:
            found = sock.recvfrom(room, _peek)
            if len(found[0]) < room:
                break
            room *= 2
        else:
            return sock.recvfrom(most)  # type: ignore[no-any-return]
    except MemoryError:
        if found is None:
            raise
    sock.recv(1)  # the rest of it goes as well
    return found  # type: ignore[no-any-return]


def join(sock: "Any", group: str, interface: str) -> bool:
    """Join a group on the interface with this address; whether that worked."""
    return _try_option(sock, _IPPROTO_IP, _socket.IP_ADD_MEMBERSHIP, octets(group) + octets(interface))


def group_sender(interface: str) -> "Any":
    """A UDP socket whose datagrams to groups leave by the interface with this address. Raises OSError."""
    sock = _socket.socket(_socket.AF_INET, _socket.SOCK_DGRAM)
    sock.setblocking(False)
    # Boards have one interface, and may know none of these.
    _try_option(sock, _IPPROTO_IP, _IP_MULTICAST_IF, octets(interface))
    _try_option(sock, _IPPROTO_IP, _IP_MULTICAST_TTL, 1)
    _try_option(sock, _IPPROTO_IP, _IP_MULTICAST_LOOP, 1)
    return sock


def own_addresses() -> "list[str]":
    """IPv4 addresses of this machine but for loopback's: of the board's station interface, or as Linux tells them."""
    try:
        import network  # type: ignore[import-not-found, unused-ignore]  # boards
    except ImportError:
        return _linux_addresses()
    station: Any = network.WLAN(network.STA_IF)
    return [station.ifconfig()[0]] if station.isconnected() else []


def _linux_addresses() -> "list[str]":
    found: list[str] = []
    last = ""
    try:
        with open("/proc/net/fib_trie") as lines:
            for line in lines:
                if "|--" in line:
                    last = line.split("|--")[1].strip()
                elif "/32 host LOCAL" in line and not last.startswith("127.") and last not in found:
                    found.append(last)
    except OSError:
        pass
    return found
