"""What discovery of many ROS 2 nodes costs, simulated: the table and the plot of docs/ros2-scaling.md.

    python benchmarks/discovery.py                        # 2, 10 and 100 nodes
    python benchmarks/discovery.py --nodes 2,10,100,300   # some minutes
    python benchmarks/discovery.py --plot docs/ros2-scaling.svg   # the plot, too; needs roslet[plots]

Packets, bytes and seconds are exact and the same everywhere: time is virtual. CPU and memory are this machine's.
"""

from __future__ import annotations

import argparse
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tests"))

from engine.rtps import discovery
from engine.rtps.discovery import Cost

HEAD = """\
| nodes | packets | MB | CPU of a node, s | memory of a node, KiB | afterwards, packets/s | afterwards, KB/s |
|---:|---:|---:|---:|---:|---:|---:|"""


def line(cost: Cost) -> str:
    """A row of the table."""
    return (
        f"| {cost.nodes} | {cost.packets:,} | {cost.bytes / 1e6:.3g} | {cost.cpu:.2g} "
        f"| {cost.held / 1024:,.0f} | {cost.steady_packets:.3g} | {cost.steady_bytes / 1000:.2g} |"
    )


def plot(costs: list[Cost], path: str) -> None:
    """Packets and memory over nodes, on logarithmic scales."""
    import matplotlib  # type: ignore[import-not-found,unused-ignore]

    matplotlib.use("svg")
    matplotlib.rcParams["svg.hashsalt"] = "roslet"
    matplotlib.rcParams["svg.fonttype"] = "none"
    from matplotlib import pyplot

    figure, (left, right) = pyplot.subplots(1, 2, figsize=(8, 3))
    nodes = [cost.nodes for cost in costs]
    left.loglog(nodes, [cost.packets for cost in costs], "o-", label="until all know all")
    left.loglog(nodes, [60 * cost.steady_packets for cost in costs], "s--", label="a minute afterwards")
    left.set_ylabel("packets, all nodes")
    left.legend()
    right.loglog(nodes, [cost.held / 1024 for cost in costs], "o-", label="memory, KiB")
    right.loglog(nodes, [1000 * cost.cpu for cost in costs], "s--", label="CPU of discovery, ms")
    right.set_ylabel("one node")
    right.legend()
    for axes in (left, right):
        axes.set_xlabel("nodes")
        axes.grid(True, alpha=0.3)
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--nodes", default="2,10,100")
    parser.add_argument("--plot", metavar="SVG")
    options = parser.parse_args()
    print(HEAD)
    costs = []
    for nodes in options.nodes.split(","):
        costs.append(discovery.measure(int(nodes)))
        print(line(costs[-1]), flush=True)
    if options.plot:
        plot(costs, options.plot)


if __name__ == "__main__":
    main()
