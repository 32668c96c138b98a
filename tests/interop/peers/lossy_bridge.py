"""A bridge between two interfaces that loses frames. lossy_bridge.py ONE OTHER PERCENT

A seeded die decides, so that the pattern is the same in each run. Prints `ready`; on SIGTERM `passed N lost N overrun N`:
frames passed on, lost on purpose, and lost because this program was too slow.
"""

import random
import select
import signal
import socket
import struct
import sys

ETH_P_ALL = 3
SOL_PACKET, PACKET_STATISTICS, PACKET_VNET_HDR = 263, 6, 15
SO_RCVBUFFORCE = 33


def open_end(name):
    end = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, 0)
    # With the header of virtio a frame whose checksum the sender left to its card stays one: nothing is to be computed.
    end.setsockopt(SOL_PACKET, PACKET_VNET_HDR, 1)
    end.setsockopt(socket.SOL_SOCKET, SO_RCVBUFFORCE, 64 << 20)
    end.bind((name, ETH_P_ALL))
    end.setblocking(False)
    return end


def main():
    ends = [open_end(name) for name in sys.argv[1:3]]
    other = {ends[0].fileno(): (ends[0], ends[1]), ends[1].fileno(): (ends[1], ends[0])}
    loss = float(sys.argv[3]) / 100
    die = random.Random(1)
    passed = lost = 0
    stopped = []
    signal.signal(signal.SIGTERM, lambda *_: stopped.append(True))
    poller = select.epoll()
    for end in ends:
        poller.register(end, select.EPOLLIN)
    print("ready", flush=True)
    while not stopped:
        for number, _ in poller.poll(0.2):
            here, there = other[number]
            for _ in range(64):
                try:
                    frame, source = here.recvfrom(131072)
                except BlockingIOError:
                    break
                if source[2] == socket.PACKET_OUTGOING:
                    continue
                if die.random() < loss:
                    lost += 1
                    continue
                try:
                    there.send(frame)
                    passed += 1
                except OSError as error:
                    print("send", error, len(frame), file=sys.stderr)
    overrun = sum(struct.unpack("II", end.getsockopt(SOL_PACKET, PACKET_STATISTICS, 8))[1] for end in ends)
    print("passed", passed, "lost", lost, "overrun", overrun, flush=True)


main()
