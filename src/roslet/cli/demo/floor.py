"""The floor for a round trip in Python on this machine: two TCP connections, blocking sockets, nothing else.

Run as a program it is the other end: it accepts two connections and sends on the second what comes on the first. It
imports only the standard library, so that it may be run by its path.
"""

from __future__ import annotations

import socket
import subprocess
import sys
import time

# A Coordinate as TCPROS carries it: a length of four bytes, three float32 and a time.
SIZE = 4 + 3 * 4 + 8
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
    """Round trips of `size` bytes in seconds, made at `rate` a second for `seconds`, with a process of our own.

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
                return _exchange(there, back, size, seconds, rate)
        finally:
            try:
                other.wait(2.0)
            except subprocess.TimeoutExpired:
                other.kill()
                other.wait()


def _exchange(
    there: socket.socket, back: socket.socket, size: int, seconds: float, rate: float
) -> list[float]:
    trips = []
    message = bytes(size)
    due = time.perf_counter()
    end = due + seconds
    while due < end:
        pause = due - time.perf_counter()
        if pause > 0:
            time.sleep(pause)
        begin = time.perf_counter()
        there.sendall(message)
        if len(receive(back, size)) < size:
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


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]))
