"""10 MiB reliable samples over a cable that loses one frame in a hundred, between us and each peer.

A datagram of 60 KB is 41 frames on such a cable, and a third of them lack one. Linux keeps those 30 s, and takes no further
fragments of anybody once they fill 4 MiB: whatever is repeated, nothing gets through. So what we send to another host fits
a frame; for what Fast DDS sends, its users set what ROS's page on DDS tuning tells (KEPT).
"""

from __future__ import annotations

import pathlib

import pytest

from interop.namespace import Namespace, connect_lossy
from interop.networks import listen, talk

SIZE = 10 << 20
KEPT = "sysctl -qw net.ipv4.ipfrag_high_thresh=134217728 net.ipv4.ipfrag_time=3"


def exchange(folder: pathlib.Path, talker: str, listener: str, *words: str, kept: bool = True) -> None:
    with (
        Namespace(folder, route=False) as here,
        Namespace(folder, route=False) as middle,
        Namespace(folder, route=False) as there,
    ):
        bridge = connect_lossy(here, middle, there, 1.0)
        for host in (here, there) if kept else ():
            host.run(KEPT)
        talk(here, talker, str(SIZE), *words)
        heard = listen(there, listener, str(SIZE))
        lines = heard.finish(60.0)
        bridge.process.terminate()
        told = bridge.finish(10.0)[-1].split()
    assert lines == ["ready"] + [f"heard {SIZE + len('hello 0')}"] * 3
    passed, lost = int(told[1]), int(told[3])
    assert 0.003 < lost / (passed + lost) < 0.03, told


@pytest.mark.parametrize("peer", ["kilted", "cyclone", "roslet"])
def test_what_we_write_arrives_whole(tmp_path: pathlib.Path, peer: str) -> None:
    exchange(tmp_path, "roslet", peer, kept=False)


@pytest.mark.parametrize("peer", ["kilted", "cyclone"])
def test_what_a_peer_writes_arrives_whole(tmp_path: pathlib.Path, peer: str) -> None:
    exchange(tmp_path, peer, "roslet")
