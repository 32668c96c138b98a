"""Box plots like the paper's Figures 16 and 17, with matplotlib (the extra `plots`)."""

from __future__ import annotations

import importlib.util
import io
from typing import Any

from roslet.cli.bench import paper
from roslet.cli.bench.rtt import quantile

COLOURS = ("#999999", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
QUOTED = "mROS, the paper's"
HEADROOM = 8


def available() -> bool:
    """Whether matplotlib is installed."""
    return importlib.util.find_spec("matplotlib") is not None


def _pyplot() -> Any:
    import matplotlib  # type: ignore[import-not-found,unused-ignore]

    matplotlib.use("svg")
    matplotlib.rcParams["svg.hashsalt"] = "roslet"
    matplotlib.rcParams["svg.fonttype"] = "none"
    from matplotlib import pyplot

    return pyplot


def box(values: list[float]) -> dict[str, Any]:
    """Median, quartiles, and whiskers at 1 % and 99 %."""
    ordered = sorted(values)
    parts = {"whislo": 0.01, "q1": 0.25, "med": 0.5, "q3": 0.75, "whishi": 0.99}
    return {**{name: quantile(ordered, part) for name, part in parts.items()}, "fliers": []}


def _draw(
    axes: Any, boxes: list[dict[str, Any]], places: list[float], width: float, colour: str, across: bool
) -> None:
    found = axes.bxp(
        boxes, positions=places, widths=width, showfliers=False, patch_artist=True, vert=not across
    )
    for patch in found["boxes"]:
        patch.set(facecolor=colour, edgecolor=colour, linewidth=0.5)
    for name in ("whiskers", "caps"):
        for line in found[name]:
            line.set(color=colour, linewidth=0.7)
    for line in found["medians"]:
        line.set(color="white", linewidth=0.9)


def _samples(result: dict[str, Any], name: str, case: str) -> list[float]:
    rounds = result["rtt"]["samples"].get(name, {}).get(case, [])
    return [value for one in rounds for value in one]


def _svg(pyplot: Any, figure: Any) -> str:
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None})
    pyplot.close(figure)
    return text.getvalue()


def strings(result: dict[str, Any]) -> str:
    """Figure 16: round trips of strings over their size, one panel for each network."""
    pyplot = _pyplot()
    found = result["rtt"]
    sizes = [case for case in found["cases"] if case != paper.COORDINATE]
    figure, panels = pyplot.subplots(2, 1, figsize=(11, 8), sharex=True)
    for axes, dialect in zip(panels, ("ros1", "ros2"), strict=True):
        names = [name for name, one in found["stacks"].items() if one in (dialect, f"floor {dialect}")]
        width = 0.8 / max(1, len(names))
        for at, name in enumerate(names):
            shown = [(place, _samples(result, name, case)) for place, case in enumerate(sizes)]
            shown = [(place, values) for place, values in shown if values]
            if not shown:
                continue
            places = [place + (at - (len(names) - 1) / 2) * width for place, _ in shown]
            colour = COLOURS[at % len(COLOURS)]
            _draw(axes, [box(values) for _, values in shown], places, 0.8 * width, colour, False)
            axes.plot([], [], color=colour, linewidth=6, label=name)
        quoted = [paper.MEANS[QUOTED].get(case) for case in sizes]
        axes.plot(range(len(sizes)), quoted, "x", color="#777777", label=f"{QUOTED}, mean ({paper.MARK})")
        axes.set_yscale("log")
        low, high = axes.get_ylim()
        axes.set_ylim(low, HEADROOM * high)  # for the legend
        axes.set_ylabel("round trip, us")
        axes.set_title({"ros1": "ROS 1", "ros2": "ROS 2"}[dialect])
        axes.grid(True, axis="y", alpha=0.3)
        axes.legend(fontsize="small", ncols=3, loc="upper left")
    panels[-1].set_xticks(range(len(sizes)), [f"{int(case):,}" for case in sizes])
    panels[-1].set_xlabel("letters in the string that comes back (whiskers: 1 % and 99 %)")
    figure.tight_layout()
    return _svg(pyplot, figure)


def coordinate(result: dict[str, Any]) -> str:
    """Figure 17: round trips of a Coordinate."""
    pyplot = _pyplot()
    found = result["rtt"]
    names = [name for name in found["stacks"] if _samples(result, name, paper.COORDINATE)]
    figure, axes = pyplot.subplots(figsize=(8, 0.9 + 0.42 * (len(names) + 1)))
    for at, name in enumerate(names):
        colour = COLOURS[0 if name.startswith("floor") else 1 if name.startswith("roslet") else 2]
        _draw(axes, [box(_samples(result, name, paper.COORDINATE))], [-at], 0.6, colour, True)
    axes.plot([paper.MEANS[QUOTED][paper.COORDINATE]], [-len(names)], "x", color="#777777")
    axes.set_yticks([-at for at in range(len(names) + 1)], [*names, f"{QUOTED}, mean\n({paper.MARK})"])
    axes.set_xscale("log")
    axes.set_xlabel("round trip of a Coordinate, us (whiskers: 1 % and 99 %)")
    axes.grid(True, axis="x", alpha=0.3)
    figure.tight_layout()
    return _svg(pyplot, figure)
