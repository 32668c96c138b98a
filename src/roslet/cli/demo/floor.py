"""The floor for a round trip in Python on this machine: two TCP connections, or datagrams; blocking sockets, nothing else.

Run as a program it is the other end, and sends back what comes: on the second of two connections what comes on the first,
or each datagram. It imports only the standard library, so that it may be run by its path.
"""

from __future__ import annotations

import socket
import subprocess
import sys
import time

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable

# A Coordinate as TCPROS carries it: a length of four bytes, three float32 and a time.
SIZE = 4 + 3 * 4 + 8
# The same as RTPS carries it: header 20, INFO_TS 12, DATA 24, encapsulation 4, three float32 and a time.
DATAGRAM = 20 + 12 + 24 + 4 + 3 * 4 + 8
# Seconds for the other process to be there.
PATIENCE = 10.0


def receive(sock: socket.socket, size: int) -> bytes:
    """Exactly `size` bytes; fewer only where the connection ended."""
    data = sock.recv(size)
    while data and len(data) < size:
        more = sock.recv(size - len(data))
        if not more:
            break
        data += more
    return data


def measure(seconds: float, rate: float, size: int = SIZE) -> list[float]:
    """Round trips over TCP of `size` bytes in seconds, made at `rate` a second for `seconds`, with a process of our own.

    The pace matters: a processor that was idle for a while answers more slowly than one that never is.
    """
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        listener.listen(2)
        listener.settimeout(PATIENCE)
        port = str(listener.getsockname()[1])
        other = subprocess.Popen([sys.executable, __file__, port, str(size)], stdin=subprocess.DEVNULL)
        try:
            with listener.accept()[0] as there, listener.accept()[0] as back:
                for sock in (there, back):
                    sock.settimeout(PATIENCE)
                    sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                return _paced(lambda: _there_and_back(there, back, size), seconds, rate)
        finally:
            _end(other)


def measure_datagrams(seconds: float, rate: float, size: int = DATAGRAM) -> list[float]:
    """The same with datagrams."""
    with socket.socket(type=socket.SOCK_DGRAM) as ours:
        ours.bind(("127.0.0.1", 0))
        ours.settimeout(PATIENCE)
        port = str(ours.getsockname()[1])
        other = subprocess.Popen(
            [sys.executable, __file__, port, str(size), "datagrams"], stdin=subprocess.DEVNULL
        )
        try:
            ours.connect(ours.recvfrom(size)[1])
            return _paced(lambda: _there_and_back(ours, ours, size), seconds, rate)
        finally:
            ours.send(b"")
            _end(other)


def _end(process: subprocess.Popen[bytes]) -> None:
    try:
        process.wait(2.0)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def _there_and_back(there: socket.socket, back: socket.socket, size: int) -> bool:
    there.sendall(bytes(size))
    return len(receive(back, size)) == size


def _paced(exchange: Callable[[], bool], seconds: float, rate: float) -> list[float]:
    trips = []
    due = time.perf_counter()
    end = due + seconds
    while due < end:
        pause = due - time.perf_counter()
        if pause > 0:
            time.sleep(pause)
        begin = time.perf_counter()
        if not exchange():
            break
        trips.append(time.perf_counter() - begin)
        due += 1 / rate
    return trips


def main(port: int, size: int) -> None:
    """The other end."""
    with (
        socket.create_connection(("127.0.0.1", port), PATIENCE) as there,
        socket.create_connection(("127.0.0.1", port), PATIENCE) as back,
    ):
        for sock in (there, back):
            sock.settimeout(None)
            sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        while True:
            data = receive(there, size)
            if len(data) < size:
                return
            back.sendall(data)


def main_datagrams(port: int, size: int) -> None:
    """The other end for datagrams; an empty one ends it, or silence."""
    with socket.socket(type=socket.SOCK_DGRAM) as sock:
        sock.connect(("127.0.0.1", port))
        sock.settimeout(PATIENCE)
        sock.send(b"here")
        while data := sock.recv(size):
            sock.send(data)


if __name__ == "__main__":
    (main_datagrams if "datagrams" in sys.argv else main)(int(sys.argv[1]), int(sys.argv[2]))
