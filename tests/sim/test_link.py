"""Hubs, faults, traces and captures, without anybody at their ends."""

from __future__ import annotations

import pathlib
import struct
import subprocess

import pytest

import peers
from roslet.sim.capture import Capture
from roslet.sim.link import MAX_WAITING, Damaged, Faults, Hub, Link, describe, trace

MACS = bytes((2, 0, 0, 0, 0, 2)), bytes((2, 0, 0, 0, 0, 1))


def frame(number: int, size: int = 60) -> bytes:
    return b"".join(MACS) + b"\x88\xb5" + number.to_bytes(4, "big") + bytes(size - 18)


def a_cable() -> tuple[Link, Link]:
    hub = Hub(delay=0.0)
    return hub.port(), hub.port()


def test_a_hub_gives_a_frame_to_all_others_after_its_delay() -> None:
    hub = Hub(delay=0.5)
    ports = [hub.port() for _ in range(3)]
    ports[0].send(frame(1), 1.0)
    assert [port.deadline() for port in ports] == [None, 1.5, 1.5]
    assert [port.receive(1.4) for port in ports] == [[], [], []]
    assert [port.receive(1.5) for port in ports] == [[], [frame(1)], [frame(1)]]
    assert [port.receive(9.0) for port in ports] == [[], [], []]


def test_a_hub_holds_no_more_than_its_bound_for_a_port() -> None:
    hub = Hub()
    one, other = hub.port(), hub.port()
    for number in range(MAX_WAITING + 3):
        one.send(frame(number), 0.0)
    assert hub.dropped == 3
    assert len(other.receive(1.0)) == MAX_WAITING


def through(**rates: float) -> tuple[Faults, list[bytes]]:
    """What is left of 2,000 frames, half of which went each way."""
    one, other = a_cable()
    bad = Faults(one, seed=4, **rates)
    got = []
    for number in range(2000):
        now = number / 1000
        if number & 1:
            bad.send(frame(number), now)
        else:
            other.send(frame(number), now)
        got += bad.receive(now) + other.receive(now)
    got += bad.receive(1e9) + other.receive(1e9)
    return bad, got


def test_a_good_cable_changes_nothing() -> None:
    _, got = through()
    assert got == [frame(number) for number in range(2000)]


def test_loss_takes_about_as_many_frames_as_it_says() -> None:
    bad, got = through(loss=0.1)
    assert 150 < bad.counts["loss"] < 250 and len(got) == 2000 - bad.counts["loss"]
    assert set(got) <= {frame(number) for number in range(2000)}


def test_bit_errors_turn_one_bit_and_show_in_the_fcs() -> None:
    bad, got = through(bit_error=0.1)
    wrong = [one for one in got if isinstance(one, Damaged)]
    assert len(got) == 2000 and len(wrong) == bad.counts["bit_error"] > 150
    for number, one in enumerate(got):
        turned = int.from_bytes(one, "big") ^ int.from_bytes(frame(number), "big")
        assert turned.bit_count() == isinstance(one, Damaged)


def test_truncated_frames_are_a_beginning() -> None:
    bad, got = through(truncate=0.1)
    wrong = [(number, one) for number, one in enumerate(got) if isinstance(one, Damaged)]
    assert len(wrong) == bad.counts["truncate"] > 150
    assert all(0 < len(one) < 60 and frame(number).startswith(one) for number, one in wrong)


def test_duplicates_come_twice_and_late_frames_late() -> None:
    bad, got = through(duplicate=0.1)
    assert len(got) == 2000 + bad.counts["duplicate"] and bad.counts["duplicate"] > 150
    bad, got = through(reorder=0.2, late=0.01)
    expected = [frame(number) for number in range(2000)]
    assert got != expected and sorted(got) == sorted(expected)
    assert 300 < bad.counts["reorder"] < 500


def test_a_seed_repeats_a_run() -> None:
    rates = {"loss": 0.1, "bit_error": 0.1, "duplicate": 0.1, "reorder": 0.1, "truncate": 0.1}
    assert through(**rates)[1] == through(**rates)[1]


def test_a_late_frame_has_a_deadline() -> None:
    one, other = a_cable()
    bad = Faults(one, seed=1, reorder=1.0)
    assert bad.deadline() is None
    bad.send(frame(1), 0.0)
    at = bad.deadline()
    assert at is not None and 0 < at < 1e-3 and other.receive(1.0) == []
    assert bad.receive(at) == [] and other.receive(at) == [frame(1)]


def test_probabilities_are_checked() -> None:
    with pytest.raises(ValueError, match="loss is a probability, from 0 to 1, not"):
        Faults(Hub().port(), loss=1.5)


def test_a_trace_says_what_passes() -> None:
    said: list[str] = []
    one, other = a_cable()
    traced = trace(one, "node", said.append)
    asks = (
        b"\xff" * 6
        + MACS[1]
        + b"\x08\x06\0\1\x08\0\6\4\0\1"
        + MACS[1]
        + b"\xc0\xa8\1\2"
        + bytes(6)
        + b"\xc0\xa8\1\n"
    )
    traced.send(asks, 0.25)
    other.send(Damaged(frame(1)), 0.5)
    traced.receive(0.5)
    assert said == [
        "    0.250000 node -> 02:00:00:00:00:01 > ff:ff:ff:ff:ff:ff ARP 192.168.1.2: who has 192.168.1.10",
        "    0.500000 node <- 02:00:00:00:00:01 > 02:00:00:00:00:02 type 0x88b5, 60 octets damaged",
    ]
    assert describe(b"\1") == "1 octets (ethernet-truncated)"


def test_a_capture_has_nanoseconds_and_is_read_by_tshark(tmp_path: pathlib.Path) -> None:
    file = tmp_path / "wire.pcap"
    one, other = a_cable()
    with Capture(file, start=1_700_000_000) as capture:
        link = capture.around(one)
        link.send(frame(1), 0.000000001)
        other.send(frame(2, 1514), 2.5)
        link.receive(2.5)
        link.send(Damaged(frame(3)), 3.0)
    assert (capture.frames, capture.damaged) == (2, 1)
    data = file.read_bytes()
    assert data[:4] == b"\x4d\x3c\xb2\xa1"
    assert struct.unpack_from("<IIII", data, 24) == (1_700_000_000, 1, 60, 60)
    program = str(peers.require("tshark"))
    fields = ["-T", "fields", "-e", "frame.time_epoch", "-e", "frame.len", "-e", "eth.type"]
    done = subprocess.run(
        [program, "-r", str(file), *fields], capture_output=True, text=True, timeout=60, check=True
    )
    assert [line.split() for line in done.stdout.splitlines()] == [
        ["1700000000.000000001", "60", "0x88b5"],
        ["1700000002.500000000", "1514", "0x88b5"],
    ]
