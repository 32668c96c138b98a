"""Round trips and one-way rates of a roslet node beside raw blocking sockets, in one run and without any peer.

    python benchmarks/round_trip.py                 # every size
    python benchmarks/round_trip.py --sizes 64,1048576 --count 2000

Two processes and two one-way connections, one message in flight. The floor moves the same number of bytes with blocking
sockets in Python: what the language and the kernel cost without any ROS. The two take turns, size by size.
"""

from __future__ import annotations

import argparse
import socket
import statistics
import subprocess
import sys
import time

import roslet
from roslet.master.server import MasterServer

SIZES = (1, 64, 1024, 16384, 262144, 1048576)
WARM_UP = 200
# Seconds that one measurement may take.
PATIENCE = 60.0


def receive(sock: socket.socket, view: memoryview) -> None:
    """Fill `view`."""
    at = 0
    while at < len(view):
        count = sock.recv_into(view[at:])
        if not count:
            raise ConnectionError("the other end has gone")
        at += count


def floor_echo(port: int, size: int) -> None:
    """The floor's other end: what comes on the first connection goes out on the second."""
    pair = [socket.create_connection(("127.0.0.1", port)) for _ in range(2)]
    for sock in pair:
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    view = memoryview(bytearray(size))
    try:
        while True:
            receive(pair[0], view)
            pair[1].sendall(view)
    except ConnectionError:
        return


def floor(size: int, count: int) -> list[float]:
    """Round trips of `size` bytes, in microseconds."""
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        listener.listen(2)
        listener.settimeout(PATIENCE)
        child = start("floor-echo", str(listener.getsockname()[1]), str(size))
        pair = [listener.accept()[0] for _ in range(2)]
    message, view, taken = bytes(size), memoryview(bytearray(size)), []
    for sock in pair:
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    for _ in range(WARM_UP + count):
        begin = time.perf_counter_ns()
        pair[0].sendall(message)
        receive(pair[1], view)
        taken.append((time.perf_counter_ns() - begin) / 1000)
    for sock in pair:
        sock.close()
    child.wait(PATIENCE)
    return taken[WARM_UP:]


def node_echo(network: str) -> None:
    """The node's other end."""
    with roslet.Node("echo", network=network) as node:
        pong = node.publisher("pong", "std_msgs/String")
        node.subscribe("ping", "std_msgs/String", pong.publish)
        node.spin(PATIENCE)


def round_trips(network: str, size: int, count: int) -> list[float]:
    """Round trips of a String whose serialised size is `size` or 5 bytes, in microseconds."""
    taken: list[float] = []
    begin = 0

    with roslet.Node("ping", network=network) as node:
        child = start("node-echo", network)
        ping = node.publisher("ping", "std_msgs/String")
        message = ping.type(data="x" * max(1, size - 4))  # type: ignore[call-arg]

        def answered(_: object) -> None:
            nonlocal begin
            taken.append((time.perf_counter_ns() - begin) / 1000)
            if len(taken) < WARM_UP + count:
                begin = time.perf_counter_ns()
                ping.publish(message)

        pong = node.subscribe("pong", "std_msgs/String", answered)
        if not (ping.wait_for_subscribers(1, PATIENCE) and pong.wait_for_publishers(1, PATIENCE)):
            raise TimeoutError("the echo node did not come")
        begin = time.perf_counter_ns()
        ping.publish(message)
        node.spin_until(lambda: len(taken) >= WARM_UP + count, PATIENCE)
        child.terminate()
        child.wait(PATIENCE)
    return taken[WARM_UP:]


def start(*arguments: str) -> subprocess.Popen[bytes]:
    """This program again, as the other end."""
    return subprocess.Popen([sys.executable, __file__, *arguments])


def percentile(values: list[float], part: float) -> float:
    return sorted(values)[min(len(values) - 1, int(part * len(values)))]


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--sizes", default=",".join(map(str, SIZES)))
    parser.add_argument("--count", type=int, default=1000)
    given = parser.parse_args()
    print("   bytes |  floor us    99 % | roslet us    99 % | ratio")
    with MasterServer(port=0) as master:
        network = master.uri.replace("http", "ros1", 1).rstrip("/")
        for size in map(int, given.sizes.split(",")):
            bare, ours = floor(size, given.count), round_trips(network, size, given.count)
            low, high = statistics.median(bare), statistics.median(ours)
            print(
                f"{size:8} | {low:9.1f} {percentile(bare, 0.99):7.1f} |"
                f" {high:9.1f} {percentile(ours, 0.99):7.1f} | {high / low:5.2f}",
                flush=True,
            )


if __name__ == "__main__":
    if sys.argv[1:2] == ["floor-echo"]:
        floor_echo(int(sys.argv[2]), int(sys.argv[3]))
    elif sys.argv[1:2] == ["node-echo"]:
        node_echo(sys.argv[2])
    else:
        main()
