"""The Linux kernel on the wire: a TAP device in a namespace of the test's own, in the time of the wall clock."""

from __future__ import annotations

import os
import pathlib
import sys
import textwrap
from collections.abc import Iterator

import pytest

import peers
from interop.namespace import Namespace, Program
from roslet.engine.net.events import EchoReplied
from roslet.engine.net.host import Host
from roslet.errors import Unreachable
from roslet.sim.tap import Tap
from roslet.sim.wire import Wire
from sim.echo import plugged

pytestmark = pytest.mark.skipif(os.geteuid() != 0, reason="only root makes TAP devices")

LINUX, OURS = "10.9.0.1", "10.9.0.2"
SECONDS = 20.0


@pytest.fixture
def linux(tmp_path: pathlib.Path) -> Iterator[tuple[Namespace, Wire]]:
    """A namespace whose interface `tap` is on a wire that keeps to the wall clock."""
    with Namespace(tmp_path) as namespace:
        wire = Wire(factor=100.0, pace=1.0)
        wire.tap(Tap("tap", namespace.pid))
        namespace.run(f"sysctl -qw net.ipv6.conf.tap.disable_ipv6=1; ip address add {LINUX}/24 dev tap")
        namespace.run("ip link set dev tap up")
        yield namespace, wire
        wire.close()


def ended(wire: Wire, program: Program) -> str:
    """What a program printed; the wire runs until it has ended, which it must do well."""
    assert wire.run(SECONDS, until=lambda: program.process.poll() is not None), program.lines()
    return "\n".join(program.finish(1.0))


@pytest.mark.parametrize("size", [0, 56, 1472, 1473, 8000, 65507])
def test_linux_pings_a_software_host(linux: tuple[Namespace, Wire], size: int) -> None:
    ping = str(peers.require("ping"))
    namespace, wire = linux
    wire.host(Host("02:00:00:00:00:02", f"{OURS}/24"))
    program = namespace.start(ping, "-c", "5", "-i", "0.02", "-W", "5", "-s", str(size), OURS, LC_ALL="C")
    assert "5 received, 0% packet loss" in ended(wire, program)


def test_arping_finds_a_software_host(linux: tuple[Namespace, Wire]) -> None:
    arping = str(peers.require("arping"))
    namespace, wire = linux
    wire.host(Host("02:00:00:00:00:02", f"{OURS}/24"))
    program = namespace.start(arping, "-I", "tap", "-c", "2", "-f", OURS, LC_ALL="C")
    assert "[02:00:00:00:00:02]" in ended(wire, program)


def test_a_software_host_pings_linux_with_fragments(linux: tuple[Namespace, Wire]) -> None:
    _, wire = linux
    host = wire.host(Host("02:00:00:00:00:02", f"{OURS}/24")).host
    for size in (0, 1472, 1473, 65507):
        host.ping(LINUX, wire.now, bytes(size))
        replies: list[EchoReplied] = []

        def replied(replies: list[EchoReplied] = replies) -> bool:
            event = host.next_event()
            if isinstance(event, EchoReplied):
                replies.append(event)
            return bool(replies)

        assert wire.run(SECONDS, until=replied)
        assert replies[0].data == bytes(size)


def test_datagrams_of_all_sizes_go_to_linux_and_back(linux: tuple[Namespace, Wire]) -> None:
    namespace, wire = linux
    host = wire.host(Host("02:00:00:00:00:02", f"{OURS}/24")).host
    endpoint = host.open(7000)
    program = textwrap.dedent(f"""
        import socket
        sizes = (0, 1, 1472, 1473, 9000, 65507)
        end = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        end.bind(("{LINUX}", 7001))
        end.settimeout(10)
        for size in sizes:
            data = bytes(n & 255 for n in range(size))
            end.sendto(data, ("{OURS}", 7000))
            assert end.recvfrom(65535) == (data[::-1], ("{OURS}", 7000)), size
        print("all")
    """)
    started = namespace.start(sys.executable, "-c", program)

    def serve() -> bool:
        while (found := endpoint.receive()) is not None:
            endpoint.send(found[0][::-1], found[1], wire.now)
        return started.process.poll() is not None

    assert wire.run(SECONDS, until=serve)
    assert started.finish(1.0) == ["all"]
    assert host.counters.keys() <= {"ethernet-not-for-us", "udp-port-closed"}


def test_linux_hears_the_igmp_of_a_software_host_and_sends_to_its_group(
    linux: tuple[Namespace, Wire],
) -> None:
    namespace, wire = linux
    host = wire.host(Host("02:00:00:00:00:02", f"{OURS}/24")).host
    endpoint = host.open(7000)
    endpoint.join("239.255.0.1", wire.now)
    program = textwrap.dedent(f"""
        import socket
        end = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        end.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton("{LINUX}"))
        end.sendto(b"hello", ("239.255.0.1", 7000))
    """)
    started = namespace.start(sys.executable, "-c", program)
    assert wire.run(SECONDS, until=lambda: started.process.poll() is not None)
    started.finish(1.0)
    wire.run(0.05)
    found = endpoint.receive()
    assert found is not None and found[0] == b"hello" and found[1][0] == LINUX


def test_a_frame_of_linux_goes_through_gateware_and_back(linux: tuple[Namespace, Wire]) -> None:
    namespace, wire = linux
    model, mii = plugged()
    with model:
        gates = wire.gateware(model, mii)
        program = textwrap.dedent("""
            import socket
            end = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(0x88B5))
            end.bind(("tap", 0x88B5))
            end.settimeout(10)
            for size in (60, 61, 500, 1514):
                frame = (bytes(6 * [255]) + bytes((2, 0, 0, 0, 0, 9)) + b"\\x88\\xb5").ljust(size, b"x")
                end.send(frame)
                while True:
                    got, source = end.recvfrom(2048)
                    if source[2] != socket.PACKET_OUTGOING:
                        break
                assert got == frame, (size, got)
            print("all")
        """)
        assert ended(wire, namespace.start(sys.executable, "-c", program)) == "all"
        assert gates.faults == {}
        assert model.now < wire.now


def test_a_device_that_cannot_be_made_says_why() -> None:
    with pytest.raises(ValueError, match="an interface's name has 1 to 15 octets"):
        Tap("x" * 16)
    with pytest.raises(Unreachable, match="no namespace of process"):
        Tap("tap", 2**22 + 1)


def test_frames_to_an_interface_that_is_not_up_are_counted(tmp_path: pathlib.Path) -> None:
    with Namespace(tmp_path) as namespace:
        tap = Tap("down", namespace.pid)
        tap.send(bytes(60), 0.0)
        assert tap.dropped == 1 and tap.receive(0.0) == []
        tap.close()
        tap.close()
