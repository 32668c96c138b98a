"""How reliable topics fare on bad networks: tables that are kept. ROSLET_UPDATE=1 writes them anew."""

from __future__ import annotations

import itertools
import os
import pathlib

import pytest

from engine.rtps.network import Host, Network
from roslet.engine.rtps import events
from roslet.wire.rtps import qos
from roslet.wire.rtps.qos import Qos

SNAPSHOT = pathlib.Path(__file__).with_name("lossy_networks.txt")
RELIABLE = Qos((qos.RELIABLE, 10**8), history=(qos.KEEP_ALL, 1))
LATCHED = Qos((qos.RELIABLE, 10**8), qos.TRANSIENT_LOCAL, (qos.KEEP_ALL, 1))
LOSSES = (0.0, 0.05, 0.1, 0.2, 0.3)
SEEDS = (11, 12, 13)
SAMPLES = 200
LARGE, LARGE_SIZE, FRAGMENT = 4, 300000, 8000
KEPT = 100

STEADY = """\
{samples} samples of 100 octets, one a millisecond, reliable, keep all; delay 0.2 ms; reordered: up to 20 ms late.
partition: nothing passes for 2 s while the samples are written. Times are virtual, from the network's start, and from
the last sample (or the end of the partition) to the arrival of all; the worst of three seeds.

 loss  doubled  reordered  partition | matched after s  recovered after s  datagrams a sample
"""
LARGE_SAMPLES = """
{samples} samples of {size} octets in fragments of {fragment}, written at once.

 loss  doubled  reordered  partition | all there after s  datagrams a fragment
"""
LATE = """
A reader that joins when {samples} samples of 100 octets are kept for it (transient local).

 loss  doubled  reordered  partition | all there after s  datagrams a sample
"""


def body(number: int, size: int) -> bytes:
    return number.to_bytes(4, "big") + bytes([number & 255]) * (size - 4)


def received(host: Host) -> list[bytes]:
    return [event.payload for event in host.of(events.SampleReceived)]


def check_all_arrived(host: Host, count: int, size: int) -> None:
    """Once, in order, unharmed, and none is said to be lost."""
    assert received(host) == [body(number, size) for number in range(count)]
    assert host.of(events.SamplesLost) == []


class Weather:
    """How bad a network is. A partition begins with the first sample and lasts 2 s."""

    def __init__(self, loss: float, twice: float, late: float, partition: bool) -> None:
        self.loss, self.twice, self.late, self.partition = loss, twice, late, partition

    def network(self, seed: int) -> Network:
        return Network(seed, self.loss, self.twice, self.late)

    def cells(self) -> str:
        parted = "yes" if self.partition else "no"
        return f"{self.loss:5.0%}  {self.twice:7.0%}  {self.late:9.0%}  {parted:>9} |"


def heal_after(network: Network, begin: float) -> float:
    """Let a partition end 2 s after `begin`; when it ended."""
    network.run(max(0.0, begin + 2.0 - network.now))
    network.apart.clear()
    return network.now


def steady(weather: Weather, seed: int) -> tuple[float, float, float]:
    network = weather.network(seed)
    one, other = network.host(), network.host()
    writer = one.participant.create_writer("t", "T", RELIABLE, 0.0)
    reader = other.participant.create_reader("t", "T", RELIABLE, 0.0)
    assert network.run(30, lambda: bool(writer.proxies and reader.proxies))
    met = network.now
    network.run(1.0)
    before, begin = network.sent, network.now
    if weather.partition:
        network.apart.add(other.address)
    for number in range(SAMPLES):
        writer.write(body(number, 100), network.now)
        network.run(0.001)
    end = heal_after(network, begin) if weather.partition else network.now
    assert network.run(60, lambda: len(other.of(events.SampleReceived)) == SAMPLES)
    recovered = network.now - end
    assert network.run(60, lambda: writer.acknowledged(SAMPLES))
    check_all_arrived(other, SAMPLES, 100)
    return met, recovered, (network.sent - before) / SAMPLES


def large(weather: Weather, seed: int) -> tuple[float, float]:
    network = weather.network(seed)
    one, other = network.host(fragment_size=FRAGMENT), network.host()
    writer = one.participant.create_writer("t", "T", RELIABLE, 0.0)
    reader = other.participant.create_reader("t", "T", RELIABLE, 0.0)
    assert network.run(30, lambda: bool(writer.proxies and reader.proxies))
    network.run(1.0)
    before, begin = network.sent, network.now
    if weather.partition:
        network.apart.add(other.address)
    for number in range(LARGE):
        writer.write(body(number, LARGE_SIZE), network.now)
    end = heal_after(network, begin) if weather.partition else begin
    assert network.run(60, lambda: len(other.of(events.SampleReceived)) == LARGE)
    took = network.now - end
    assert network.run(60, lambda: writer.acknowledged(LARGE))
    check_all_arrived(other, LARGE, LARGE_SIZE)
    assert other.participant._common.assembling.left == other.participant.limits.assembly_bytes
    fragments = LARGE * -(-LARGE_SIZE // FRAGMENT)
    return took, (network.sent - before) / fragments


def late_joiner(weather: Weather, seed: int) -> tuple[float, float]:
    network = weather.network(seed)
    one = network.host()
    writer = one.participant.create_writer("t", "T", LATCHED, 0.0)
    for number in range(KEPT):
        writer.write(body(number, 100), network.now)
    network.run(1.0)
    before, begin = network.sent, network.now
    other = network.host()
    if weather.partition:
        network.apart.add(other.address)
    other.participant.create_reader("t", "T", LATCHED, network.now)
    end = heal_after(network, begin) if weather.partition else begin
    assert network.run(60, lambda: len(other.of(events.SampleReceived)) == KEPT)
    took = network.now - end
    assert network.run(60, lambda: bool(writer.proxies) and writer.acknowledged(KEPT))
    check_all_arrived(other, KEPT, 100)
    return took, (network.sent - before) / KEPT


def weathers(losses: tuple[float, ...] = LOSSES) -> list[Weather]:
    return [
        Weather(*one) for one in itertools.product(losses, (0.0, 0.2), (0.0, 0.3), (False, True))
    ]  # every combination


def tables() -> str:
    text = STEADY.format(samples=SAMPLES)
    for weather in weathers():
        runs = [steady(weather, seed) for seed in SEEDS]
        met, recovered, cost = (max(column) for column in zip(*runs, strict=True))
        text += f"{weather.cells()} {met:15.3f}  {recovered:17.3f}  {cost:18.2f}\n"
    text += LARGE_SAMPLES.format(samples=LARGE, size=LARGE_SIZE, fragment=FRAGMENT)
    for weather in weathers():
        took, cost = (max(column) for column in zip(*[large(weather, seed) for seed in SEEDS], strict=True))
        text += f"{weather.cells()} {took:17.3f}  {cost:20.2f}\n"
    text += LATE.format(samples=KEPT)
    for weather in weathers():
        runs_late = [late_joiner(weather, seed) for seed in SEEDS]
        took, cost = (max(column) for column in zip(*runs_late, strict=True))
        text += f"{weather.cells()} {took:17.3f}  {cost:18.2f}\n"
    return text


@pytest.mark.timeout(300)
def test_the_tables_are_as_they_were() -> None:
    text = tables()
    if os.environ.get("ROSLET_UPDATE"):
        SNAPSHOT.write_text(text)
    assert text == SNAPSHOT.read_text(), "a table has changed; look at it, and keep it with ROSLET_UPDATE=1"
