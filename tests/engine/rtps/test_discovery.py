"""What discovery of many nodes costs: a table that is kept (ROSLET_UPDATE=1 writes it anew), and how it grows."""

from __future__ import annotations

import os
import pathlib

import pytest

from docs.pages import table_rows
from engine.rtps import discovery

SNAPSHOT = pathlib.Path(__file__).with_name("discovery.txt")
PAGE = "docs/ros2-scaling.md"
HEADER = """\
Nodes of 6 endpoints that start at once; until all know all, with endpoints and graph samples, acknowledged; delay 0.2 ms.

 nodes  loss | packets   bytes  virtual s  packets a pair | packets/s afterwards
"""


def row(nodes: int, loss: float) -> tuple[str, discovery.Cost]:
    cost = discovery.measure(nodes, loss)
    pairs = nodes * (nodes - 1)
    cells = f"{nodes:6d} {loss:5.0%} | {cost.packets:7d} {cost.bytes:8d} {cost.seconds:9.3f}"
    return f"{cells}  {cost.packets / pairs:14.1f} | {cost.steady_packets:20.2f}\n", cost


def test_the_table_is_as_it_was() -> None:
    text = HEADER
    for loss in (0.0, 0.1):
        for nodes in (2, 10, 30):
            line, cost = row(nodes, loss)
            text += line
            if not loss:
                assert cost.counters == {}
    if os.environ.get("ROSLET_UPDATE"):
        SNAPSHOT.write_text(text)
    assert text == SNAPSHOT.read_text(), "the table has changed; look at it, and keep it with ROSLET_UPDATE=1"


@pytest.mark.timeout(240)
def test_a_hundred_nodes_meet_at_a_cost_that_grows_with_their_pairs() -> None:
    few, many = discovery.measure(10, steady=6.0), discovery.measure(100, steady=6.0)
    assert many.counters == {}
    # Packets and bytes are for each pair, announcements and memory for each node.
    assert many.packets / (100 * 99) <= few.packets / (10 * 9) * 1.05
    assert many.bytes / (100 * 99) <= few.bytes / (10 * 9) * 1.05
    assert many.steady_packets / 100 <= few.steady_packets / 10 * 1.05
    assert many.held / 100 <= few.held / 10 * 1.1


def test_nodes_that_start_one_after_the_other_meet_at_the_same_cost() -> None:
    at_once, in_turn = discovery.measure(20, steady=1.0), discovery.measure(20, spread=2.0, steady=1.0)
    assert in_turn.counters == {}
    assert in_turn.packets <= at_once.packets * 1.1


def test_the_table_of_the_documentation_is_that_of_the_engine() -> None:
    rows = {cells[0]: cells for cells in table_rows(PAGE, "## What it costs") if cells[0].isdigit()}
    assert set(rows) == {"2", "10", "100", "300"}
    for nodes in (2, 10):
        cost = discovery.measure(nodes, steady=6.0)
        packets, size = int(rows[str(nodes)][1].replace(",", "")), float(rows[str(nodes)][2])
        assert cost.packets == pytest.approx(packets, rel=0.1), "run benchmarks/discovery.py"
        assert cost.bytes / 1e6 == pytest.approx(size, rel=0.1), "run benchmarks/discovery.py"
