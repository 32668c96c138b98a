"""RTPS between two processes over loopback beside raw UDP sockets, in one run and without any peer.

    python benchmarks/rtps.py                    # all of it, some 20 seconds
    python benchmarks/rtps.py --only rtt,64      # one measurement: rtt or rate, and a size

The participants themselves, without a node: reliable, nothing lost, samples to sinks. The floor is a ping-pong of datagrams
in Python. Let it have a network namespace to itself, and two processors.
"""

from __future__ import annotations

import argparse
import socket
import statistics
import subprocess
import sys
import time

from roslet.io.select import Reactor
from roslet.io.udp import Domain
from roslet.wire.rtps import qos
from roslet.wire.rtps.qos import Qos

TYPE = "roslet::benchmark::dds_::Octets_"
RTT = (64, 4096, 65536, 1 << 20)
RATES = (64, 1024, 65536, 1 << 20)
QOS = Qos((qos.RELIABLE, 10**8), history=(qos.KEEP_ALL, 1))
SECONDS = 2.0
PATIENCE = 30.0


def payload(size: int, number: int = 0) -> bytearray:
    """`size` octets with their encapsulation header and a number."""
    data = bytearray(size)
    data[0:8] = b"\0\1\0\0" + number.to_bytes(4, "little")
    return data


class End:
    """A participant with a writer of one topic and a reader of another."""

    def __init__(self, writes: str, reads: str, sink) -> None:  # type: ignore[no-untyped-def]
        self.reactor = Reactor()
        self.domain = Domain(self.reactor, lambda event: None)
        participant = self.domain.participant
        with self.reactor.lock:
            self.writer = participant.create_writer(writes, TYPE, QOS, self.reactor.now())
            self.reader = participant.create_reader(reads, TYPE, QOS, self.reactor.now(), sink=sink)
            self.domain.flush()

    def matched(self) -> bool:
        """Whether both have met their other end."""
        return bool(self.writer.proxies and self.reader.proxies)

    def write(self, data: bytearray) -> None:
        """Send a sample, as soon as there is room for it."""
        size = len(data)
        if self.writer.full(size) and not self.reactor.run_until(
            lambda: not self.writer.full(size), PATIENCE
        ):
            raise TimeoutError(f"no room: {self.domain.participant.counters} {self.domain.errors}")
        with self.reactor.lock:
            now = self.reactor.now()
            self.writer.write(data, now)
            self.domain.send(now)

    def close(self) -> None:
        """Leave."""
        self.domain.close()
        self.reactor.close()


def echo() -> None:
    """The other end: answers every sample of topic `ping`, and counts those of `flow` and says how many came."""
    seen = 0
    last = -1

    def sink(proxy, value, stamp) -> None:  # type: ignore[no-untyped-def]
        nonlocal seen, last
        data = value.payload
        if data[0] == 0:
            end.write(data)
            return
        number = int.from_bytes(data[4:8], "little")
        if number != last + 1:
            raise AssertionError(f"{number} after {last}")
        last = number
        if data[0] == 2:
            last = -1
            end.write(payload(8, number + 1))

    end = End("pong", "ping", sink)
    parent = sys.stdin
    import threading

    gone = threading.Event()

    def wait() -> None:
        parent.read()
        gone.set()

    threading.Thread(target=wait, daemon=True).start()
    end.reactor.run_until(gone.is_set)
    if "-v" in sys.argv:
        print(end.domain.participant.counters, end.domain.errors, file=sys.stderr)
    end.close()


def floor_echo(port: int) -> None:
    """The floor's other end."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.connect(("127.0.0.1", port))
        sock.send(b"here")
        buffer = bytearray(65536)
        view = memoryview(buffer)
        while size := sock.recv_into(buffer):
            sock.send(view[:size])


def floor(size: int, count: int) -> list[float]:
    """Round trips of one datagram between blocking sockets, in microseconds."""
    taken = []
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("127.0.0.1", 0))
        child = start("floor-echo", str(sock.getsockname()[1]))
        sock.connect(sock.recvfrom(100)[1])
        message, buffer = bytes(size), bytearray(65536)
        for _ in range(count):
            begin = time.perf_counter()
            sock.send(message)
            sock.recv_into(buffer)
            taken.append((time.perf_counter() - begin) * 1e6)
        sock.send(b"")
        child.wait()
    return taken


def start(*words: str) -> subprocess.Popen[bytes]:
    """This program in another role."""
    return subprocess.Popen([sys.executable, __file__, "--role", *words], stdin=subprocess.PIPE)


class Measure:
    """This end."""

    def __init__(self, words: list[str]) -> None:
        self.got = 0
        self.answer = b""
        self.ping: bytearray | None = None
        self.taken: list[float] = []
        self.begin = 0.0
        self.child = start("echo", *words)
        self.end = End("ping", "pong", self.sink)
        if not self.end.reactor.run_until(self.end.matched, PATIENCE):
            raise TimeoutError("the other end did not come")
        self.end.reactor.run_until(lambda: False, 0.3)

    def sink(self, proxy, value, stamp) -> None:  # type: ignore[no-untyped-def]
        """An answer; in a ping-pong the next ping goes out at once, as from a node's callback."""
        self.answer = bytes(value.payload[:8])
        self.got += 1
        if self.ping is not None:
            now = time.perf_counter()
            self.taken.append((now - self.begin) * 1e6)
            self.begin = now
            self.end.write(self.ping)

    def rtt(self, size: int) -> list[float]:
        """Round trips, one in flight, in microseconds."""
        self.taken = []
        self.ping = payload(size)
        self.begin = time.perf_counter()
        self.end.write(self.ping)
        self.end.reactor.run_until(lambda: False, SECONDS)
        self.ping = None
        before = self.got
        self.end.reactor.run_until(lambda: self.got > before, 1.0)
        if not self.taken:
            raise TimeoutError(f"{size} octets: {self.end.domain.participant.counters}")
        return self.taken[len(self.taken) // 10 :]

    def rate(self, size: int) -> float:
        """Samples a second that came, in order and none missing."""
        data = payload(size)
        data[0] = 1
        begin = time.perf_counter()
        self.got = 0
        number = 0
        while True:
            last = time.perf_counter() - begin > SECONDS
            data[4:8] = number.to_bytes(4, "little")
            if last:
                data[0] = 2
            number += 1
            self.end.write(data)
            if last:
                break
        if not self.end.reactor.run_until(lambda: self.got, PATIENCE):
            raise TimeoutError(f"{size} octets: {self.end.domain.participant.counters}")
        assert int.from_bytes(self.answer[4:], "little") == number
        return number / (time.perf_counter() - begin)

    def close(self) -> None:
        """End both."""
        assert self.child.stdin
        self.child.stdin.close()
        self.child.wait()
        self.end.close()


def main() -> None:
    """The command."""
    if sys.argv[1:2] == ["--role"]:
        if sys.argv[2] == "echo":
            echo()
        else:
            floor_echo(int(sys.argv[3]))
        return
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default="", help="rtt,SIZE or rate,SIZE")
    parser.add_argument("--verbose", "-v", action="store_true", help="counters, to standard error")
    parser.add_argument("--profile", action="store_true", help="profile this end")
    options = parser.parse_args()
    wanted = [("rtt", size) for size in RTT] + [("rate", size) for size in RATES]
    if options.only:
        kind, _, text = options.only.partition(",")
        wanted = [(kind, int(text))]
    least = statistics.median(floor(64, 20000))
    print(f"floor, 64 octets: {least:.1f} us")
    measure = Measure(["-v"] if options.verbose else [])
    if options.profile:
        import cProfile
        import pstats

        profiler = cProfile.Profile()
        for kind, size in wanted:
            profiler.runcall(getattr(measure, kind), size)
        pstats.Stats(profiler).sort_stats("tottime").print_stats(30)
        measure.close()
        return
    for kind, size in wanted:
        if kind == "rtt":
            taken = sorted(measure.rtt(size))
            median = statistics.median(taken)
            print(
                f"rtt {size}: {median:.1f} us, {median / least:.2f} x floor, p99 {taken[len(taken) * 99 // 100]:.0f} us"
            )
        else:
            rate = measure.rate(size)
            print(f"rate {size}: {rate:.0f}/s, {rate * size / 1e6:.1f} MB/s")
    if options.verbose:
        print(measure.end.domain.participant.counters, measure.end.domain.errors, file=sys.stderr)
    measure.close()


if __name__ == "__main__":
    main()
