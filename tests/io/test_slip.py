"""Nodes at the two ends of a pseudo-terminal: what a serial line is, as far as a program sees."""

from __future__ import annotations

import errno
import os
import threading
import time
import tty
from collections.abc import Callable, Iterator
from contextlib import suppress

import pytest
from scapy.layers.inet import ICMP, IP
from scapy.packet import Raw

import roslet
from roslet.engine.rtps import events
from roslet.errors import Unreachable
from roslet.io import slip
from roslet.io.select import READ, WRITE, Reactor
from roslet.io.slip import SlipDomain
from roslet.names import Ros2Network, SerialLine
from roslet.wire.net.slip import Decoder, emit
from roslet.wire.rtps.qos import Qos

PATIENCE = 10.0


class Cable:
    """Two pseudo-terminals and a thread that carries octets between them, so that each end has a path of its own."""

    def __init__(self) -> None:
        self.masters: list[int] = []
        self.slaves: list[int] = []
        for _ in range(2):
            master, slave = os.openpty()
            tty.setraw(slave)
            os.set_blocking(master, False)
            self.masters.append(master)
            self.slaves.append(slave)
        self.paths = [os.ttyname(slave) for slave in self.slaves]
        self.octets = 0
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._carry)
        self._thread.start()

    def _carry(self) -> None:
        while not self._over.wait(0.0005):
            for here, there in (self.masters, reversed(self.masters)):
                data = b""
                with suppress(BlockingIOError):
                    data = os.read(here, 4096)
                self.octets += len(data)
                while data and not self._over.is_set():
                    try:
                        data = data[os.write(there, data) :]
                    except BlockingIOError:
                        time.sleep(0.001)

    def noise(self, end: int, data: bytes) -> None:
        """Octets that come out at an end, from nobody."""
        os.write(self.masters[end], data)

    def close(self) -> None:
        self._over.set()
        self._thread.join()
        for fd in (*self.masters, *self.slaves):
            os.close(fd)


@pytest.fixture
def cable() -> Iterator[Cable]:
    found = Cable()
    yield found
    found.close()


def url(cable: Cable, end: int) -> str:
    return f"ros2://42?slip={cable.paths[end]}&baud=1000000&address=10.0.0.{end + 1}/24"


def wait(predicate: Callable[[], object]) -> bool:
    end = time.monotonic() + PATIENCE
    while not predicate() and time.monotonic() < end:
        time.sleep(0.01)
    return bool(predicate())


def test_two_nodes_exchange_strings_both_ways_through_noise(cable: Cable) -> None:
    with (
        roslet.Node("one", network=url(cable, 0)) as one,
        roslet.Node("other", network=url(cable, 1)) as other,
    ):
        assert one.network == url(cable, 0)
        heard: dict[str, list[str]] = {"one": [], "other": []}
        one.subscribe("to_one", "std_msgs/msg/String", lambda message: heard["one"].append(message.data))
        other.subscribe(
            "to_other", "std_msgs/msg/String", lambda message: heard["other"].append(message.data)
        )
        to_one = other.publisher("to_one", "std_msgs/msg/String")
        to_other = one.publisher("to_other", "std_msgs/msg/String")
        assert to_one.wait_for_subscribers(1, PATIENCE) and to_other.wait_for_subscribers(1, PATIENCE)
        texts = ["hello", "\xdb\xc0" * 10, "x" * 20_000]
        for text in texts:
            cable.noise(0, os.urandom(500))
            to_one.publish(data=text)
            to_other.publish(data=text)
        one.reactor.run_until(lambda: heard["one"] == texts and heard["other"] == texts, PATIENCE)
        assert heard == {"one": texts, "other": texts}
        assert one.nodes() == ["/one", "/other"]
        assert "slip-escape" in one.counters


def test_a_node_says_goodbye_over_the_line(cable: Cable) -> None:
    with roslet.Node("stays", network=url(cable, 0)) as stays:
        with roslet.Node("goes", network=url(cable, 1)):
            assert wait(lambda: stays.nodes() == ["/goes", "/stays"])
        assert wait(lambda: stays.nodes() == ["/stays"])


def test_a_line_that_is_not_there_or_is_in_use_is_told(cable: Cable) -> None:
    with pytest.raises(Unreachable, match="no serial line /nowhere of 115200 bit/s"):
        roslet.Node("one", network="ros2://?slip=/nowhere&address=10.0.0.1/24")
    with roslet.Node("one", network=url(cable, 0)), pytest.raises(Unreachable, match="no serial line"):
        roslet.Node("two", network=url(cable, 0).replace("//42", "//43"))


def test_without_pyserial_the_sentence_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "serial", None)
    with pytest.raises(Unreachable, match=r"pip install 'roslet\[serial\]'"):
        slip.open_serial(SerialLine("/dev/null", 9600, "10.0.0.1/24"))


class End:
    """A participant at one end of a pseudo-terminal, without a node; the other end is the test's."""

    def __init__(self) -> None:
        self.master, slave = os.openpty()
        tty.setraw(slave)
        os.set_blocking(self.master, False)
        self.reactor = Reactor()
        self.events: list[object] = []
        self.warnings: list[str] = []
        network = Ros2Network(42, line=SerialLine("pty", 115200, "10.0.0.1/24"))
        self.domain = SlipDomain(
            self.reactor, self.events.append, network, self.warnings.append, fd=slave, match_own=True
        )
        self.packets: list[bytes] = []
        self._decoder = Decoder(1500, self.packets.append)  # type: ignore[arg-type]

    def read(self) -> list[bytes]:
        """The packets that came since."""
        found: list[bytes] = []
        with suppress(BlockingIOError):
            while True:
                found += self._decoder.receive_data(os.read(self.master, 65536))
        return found

    def close(self) -> None:
        self.domain.close()
        with suppress(OSError):
            os.close(self.master)


@pytest.fixture
def end() -> Iterator[End]:
    found = End()
    yield found
    found.close()


def test_pings_are_answered_after_ten_thousand_octets_of_anything(end: End) -> None:
    for hostile in (os.urandom(10_000), b"\xdb" * 10_000, b"x" * 10_000, b"\xc0" * 10_000):
        for at in range(0, len(hostile), 1000):
            os.write(end.master, hostile[at : at + 1000])
            time.sleep(0.005)
        end.read()
        os.write(end.master, emit(bytes(IP(src="10.0.0.2", dst="10.0.0.1") / ICMP(seq=5) / Raw(b"data"))))
        replies: list[bytes] = []

        def answered(replies: list[bytes] = replies) -> bool:
            replies += [packet for packet in end.read() if IP(packet).proto == 1]
            return bool(replies)

        assert wait(answered)
        assert (IP(replies[0])[ICMP].type, IP(replies[0])[ICMP].seq) == (0, 5)
    assert {"slip-escape", "slip-too-long"} <= set(end.domain.participant.counters)


def test_the_participant_announces_itself_to_the_group_and_hears_itself(end: End) -> None:
    packets: list[bytes] = []

    def announced() -> bool:
        packets.extend(end.read())
        return any(IP(packet).dst == "239.255.0.1" for packet in packets)

    assert wait(announced)
    qos = Qos()
    with end.reactor.lock:
        writer = end.domain.participant.create_writer("rt/a", "A", qos, end.reactor.now())
        end.domain.participant.create_reader("rt/a", "A", qos, end.reactor.now())
        end.domain.flush()
    assert wait(lambda: any(isinstance(event, events.EndpointMatched) for event in end.events))
    with end.reactor.lock:
        writer.write(b"\0\1\0\0hello", end.reactor.now())
        end.domain.flush()
    assert wait(lambda: any(isinstance(event, events.SampleReceived) for event in end.events))


def test_what_the_loop_saw_before_another_thread_closed_the_line_is_nothing(end: End) -> None:
    end.domain.close()
    end.domain._ready(READ | WRITE)
    assert end.warnings == []


def test_a_line_that_nobody_reads_holds_a_bounded_backlog(end: End) -> None:
    with end.reactor.lock:
        for _ in range(1000):
            end.domain._send((bytes(1000),), [("10.0.0.2", 7410)])
    assert end.domain.participant.counters["frames-full"] > 100
    assert len(end.domain._rest) <= slip.MAX_PACKETS * 1100
    busy = time.process_time()
    time.sleep(0.3)
    assert time.process_time() - busy < 0.15, "the loop sleeps while the line takes nothing"


def test_a_line_that_goes_is_told_once_and_found_again(cable: Cable, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(slip, "AGAIN", 0.05)
    failing = [True]
    really = os.read

    def read(fd: int, size: int) -> bytes:
        if failing and fd == node._network.shell.domain._fd:  # type: ignore[attr-defined]
            failing.clear()
            raise OSError(errno.EIO, "gone")
        return really(fd, size)

    warnings: list[str] = []
    with roslet.Node("one", network=url(cable, 0)) as node:
        node._network.shell.domain._warn = warnings.append  # type: ignore[attr-defined]
        monkeypatch.setattr(os, "read", read)
        with roslet.Node("other", network=url(cable, 1)):
            assert wait(lambda: node.nodes() == ["/one", "/other"])
        assert len(warnings) == 1 and "has gone" in warnings[0]
