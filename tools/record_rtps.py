"""Records real peers on the loopback of a network namespace of its own: the .pcap files under tests/captures/rtps.

    python tools/record_rtps.py OUTPUT.pcap SECONDS COMMAND [-- COMMAND]...      as root

The commands are started one after the other, half a second apart, and recorded until all have ended or SECONDS have
passed. Only UDP is kept, each datagram once.
"""

from __future__ import annotations

import ctypes
import os
import pathlib
import select
import socket
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tests"))

import pcap

CLONE_NEWNET = 0x40000000
PACKET_OUTGOING = 4


def own_loopback() -> None:
    """This process, and its children, get a network of their own with a loopback that carries multicast."""
    library = ctypes.CDLL(None, use_errno=True)
    if library.unshare(CLONE_NEWNET) != 0:
        raise OSError(ctypes.get_errno(), "unshare")
    subprocess.run(["ip", "link", "set", "lo", "up", "multicast", "on"], check=True)
    subprocess.run(["ip", "route", "add", "239.0.0.0/8", "dev", "lo"], check=True)


def main() -> None:
    """The command."""
    output, seconds = pathlib.Path(sys.argv[1]), float(sys.argv[2])
    commands: list[list[str]] = [[]]
    for word in sys.argv[3:]:
        if word == "--":
            commands.append([])
        else:
            commands[-1].append(word)
    own_loopback()
    tap = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(0x0003))
    tap.bind(("lo", 0))
    tap.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 16 << 20)
    environment = dict(os.environ, FASTDDS_BUILTIN_TRANSPORTS="UDPv4", ROS_DOMAIN_ID="0")
    frames: list[tuple[float, bytes]] = []
    children: list[subprocess.Popen[bytes]] = []
    begin = time.monotonic()
    while time.monotonic() - begin < seconds:
        if len(children) < len(commands) and time.monotonic() - begin > 0.5 * len(children):
            children.append(subprocess.Popen(commands[len(children)], env=environment))
        if len(children) == len(commands) and all(child.poll() is not None for child in children):
            seconds = min(seconds, time.monotonic() - begin + 0.2)
        if select.select([tap], [], [], 0.05)[0]:
            frame, address = tap.recvfrom(65536 + 64)
            if address[2] != PACKET_OUTGOING and frame[23:24] == b"\x11":
                frames.append((time.time(), frame))
    for child in children:
        child.terminate()
        child.wait(10)
    pcap.write_frames(output, frames)
    print(f"{output}: {len(frames)} datagrams")


if __name__ == "__main__":
    main()
