"""The floor in `roslet bench`: blocking sockets in Python that move as many bytes; `floor_node.py ROLE OPTIONS`.

TCP over two connections, one each way, with a length of four octets and a string's of four before the letters, as TCPROS has
it; or datagrams, with the 60 octets of RTPS, DATA and its encapsulation, and a string's length and end.
"""

import contextlib
import json
import os
import socket
import sys
import threading
import time

ROS1_HEADER, ROS1_COORDINATE = 4 + 4, 4 + 12 + 8
ROS2_HEADER, ROS2_COORDINATE = 60 + 4 + 1, 60 + 12 + 8
PATIENCE = 30.0
CONTROL = 64


def sizes(case, tcp):
    """Octets there and back."""
    if case == "coordinate":
        both = ROS1_COORDINATE if tcp else ROS2_COORDINATE
        return both, both
    header = ROS1_HEADER if tcp else ROS2_HEADER
    return header + 1, header + int(case)


def fill(sock, view):
    at = 0
    while at < len(view):
        count = sock.recv_into(view[at:])
        if not count:
            raise ConnectionError
        at += count


def quick(*socks):
    for sock in socks:
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)


def ping(cases, count, warm_up):
    tcp = os.environ["BENCH_FLOOR"] == "tcp"
    address = ("127.0.0.1", int(os.environ["BENCH_PORT"]))
    if tcp:
        there, back = socket.create_connection(address), socket.create_connection(address)
        quick(there, back)
    else:
        there = back = socket.socket(type=socket.SOCK_DGRAM)
        there.connect(address)
    for case in cases:
        go, come = sizes(case, tcp)
        message, view, taken = bytes(go), memoryview(bytearray(come)), []
        there.sendall(json.dumps([go, come, warm_up + count]).encode().ljust(CONTROL))
        fill(back, memoryview(bytearray(1)))
        for _ in range(warm_up + count):
            begin = time.perf_counter_ns()
            there.sendall(message)
            fill(back, view)
            taken.append((time.perf_counter_ns() - begin) / 1000)
        print(json.dumps({"case": case, "us": taken[warm_up:], "lost": 0}), flush=True)
    print(json.dumps({"done": True}), flush=True)
    threading.Event().wait()


def echo():
    """Tells its port; serves one who pings."""
    tcp = os.environ["BENCH_FLOOR"] == "tcp"
    with socket.socket(type=socket.SOCK_STREAM if tcp else socket.SOCK_DGRAM) as bound:
        bound.settimeout(PATIENCE)
        bound.bind(("127.0.0.1", 0))
        if tcp:
            bound.listen(2)
        print(json.dumps({"ready": True, "port": bound.getsockname()[1]}), flush=True)
        if tcp:
            there, back = bound.accept()[0], bound.accept()[0]
            quick(there, back)
        else:
            bound.connect(bound.recvfrom(1, socket.MSG_PEEK)[1])
            there = back = bound
        for sock in (there, back):
            sock.settimeout(None)
        while True:
            control = memoryview(bytearray(CONTROL))
            fill(there, control)
            go, come, count = json.loads(bytes(control))
            answer, view = bytes(come), memoryview(bytearray(go))
            back.sendall(b"!")
            for _ in range(count):
                fill(there, view)
                back.sendall(answer)


if __name__ == "__main__":
    threading.Thread(target=lambda: (sys.stdin.read(), os._exit(0)), daemon=True).start()
    with contextlib.suppress(ConnectionError, TimeoutError):
        {"ping": ping, "echo": echo}[sys.argv[1]](**json.loads(sys.argv[2]))
