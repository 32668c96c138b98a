"""How a reliable topic fares on bad networks: a table that is kept. ROSLET_UPDATE=1 writes it anew."""

from __future__ import annotations

import os
import pathlib

from engine.rtps.network import Host, Network
from roslet.engine.rtps import events
from roslet.wire.rtps import qos
from roslet.wire.rtps.qos import Qos

SNAPSHOT = pathlib.Path(__file__).with_name("lossy_networks.txt")
RELIABLE = Qos((qos.RELIABLE, 10**8), history=(qos.KEEP_ALL, 1))
SAMPLES = 300
HEADER = """\
300 samples of 100 octets, one a millisecond, reliable, keep all; delay 0.2 ms; reordered: up to 20 ms late.
partition: nothing passes for 2 s while the samples are written. All of them arrived, once and in order.

 loss  doubled  reordered  partition | matched after s  recovered after s  datagrams a sample
"""


def row(loss: float, twice: float, late: float, partition: bool) -> str:
    network = Network(11, loss, twice, late)
    one, other = network.host(), network.host()
    writer = one.participant.create_writer("t", "T", RELIABLE, 0.0)
    reader = other.participant.create_reader("t", "T", RELIABLE, 0.0)
    assert network.run(30, lambda: bool(writer.proxies and reader.proxies))
    met = network.now
    network.run(1.0)
    before = network.sent
    if partition:
        network.apart.add(other.address)
    for number in range(SAMPLES):
        writer.write(number.to_bytes(4, "big") + bytes(96), network.now)
        network.run(0.001)
    if partition:
        network.run(2.0 - SAMPLES * 0.001)
        network.apart.clear()
    end = network.now
    assert network.run(60, lambda: len(received(other)) == SAMPLES)
    recovered = network.now - end
    assert network.run(60, lambda: writer.acknowledged(SAMPLES))
    assert received(other) == list(range(SAMPLES))
    cells = f"{loss:5.0%}  {twice:7.0%}  {late:9.0%}  {'yes' if partition else 'no':>9} |"
    return f"{cells} {met:15.3f}  {recovered:17.3f}  {(network.sent - before) / SAMPLES:18.2f}\n"


def received(host: Host) -> list[int]:
    return [int.from_bytes(event.payload[:4], "big") for event in host.of(events.SampleReceived)]


def test_the_table_is_as_it_was() -> None:
    table = HEADER
    for loss in (0.0, 0.05, 0.1, 0.2, 0.3):
        for twice, late, partition in (
            (0.0, 0.0, False),
            (0.2, 0.0, False),
            (0.0, 0.3, False),
            (0.2, 0.3, True),
        ):
            table += row(loss, twice, late, partition)
    if os.environ.get("ROSLET_UPDATE"):
        SNAPSHOT.write_text(table)
    assert table == SNAPSHOT.read_text(), (
        "the table has changed; look at it, and keep it with ROSLET_UPDATE=1"
    )
