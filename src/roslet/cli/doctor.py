"""`roslet doctor`: what keeps nodes from hearing each other, and what to do about it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from roslet.cli.graph import is_ros1
from roslet.cli.options import FAILED, OK, finish, positive
from roslet.cli.output import emit_json

if TYPE_CHECKING:
    import argparse

FINE, INFO, WARNING, PROBLEM = "ok", "info", "warning", "problem"


class Finding:
    """What was looked at, `level`, what was found there, and what to do about it ("" where nothing is)."""

    def __init__(self, about: str, level: str, text: str, remedy: str = "") -> None:
        self.about = about
        self.level = level
        self.text = text
        self.remedy = remedy

    def data(self) -> dict[str, str]:
        """As JSON data."""
        return {"about": self.about, "level": self.level, "text": self.text, "remedy": self.remedy}


def add(parser: argparse.ArgumentParser) -> None:
    """Declare the command."""
    finish(
        parser,
        run,
        "roslet doctor\nroslet doctor --network ros2://42 --for 10\nroslet doctor --network ros1://robot:11311\n"
        "roslet doctor --json | jq '.[] | select(.level == \"problem\")'",
        "network json",
    )
    parser.description = (
        "Find what keeps nodes from hearing each other: the environment, interfaces, ports, multicast, who is there, and\n"
        "what in the graph does not go together. Each finding comes with its remedy. The exit code is 1 where there is a\n"
        "problem; warnings alone are 0."
    )
    parser.add_argument(
        "--for",
        dest="seconds",
        type=positive,
        default=3.5,
        metavar="SECONDS",
        help="how long to listen on ROS 2 (default 3.5: most participants announce themselves every 3 s)",
    )


def run(arguments: argparse.Namespace) -> int:
    """`roslet doctor`."""
    if is_ros1(arguments.network):
        from roslet.cli.ros1.doctor import examine as examine_ros1

        found = examine_ros1(arguments.network)
    else:
        from roslet.cli.ros2.doctor import examine as examine_ros2

        found = examine_ros2(arguments.network, arguments.seconds)
    if arguments.json:
        emit_json([one.data() for one in found])
    else:
        print_findings(found)
    return FAILED if any(one.level == PROBLEM for one in found) else OK


def print_findings(found: list[Finding]) -> None:
    """A line each, the remedy below, and how many there were of what is not right."""
    levels = max(len(one.level) for one in found)
    abouts = max(len(one.about) for one in found)
    for one in found:
        print(f"{one.level.ljust(levels)}  {one.about.ljust(abouts)}  {one.text}")
        if one.remedy:
            print(f"{' ' * (levels + 2 + abouts)}  -> {one.remedy}")
    counts = {level: len([one for one in found if one.level == level]) for level in (PROBLEM, WARNING)}
    words = [f"{count} {level}{'' if count == 1 else 's'}" for level, count in counts.items()]
    print(f"\n{', '.join(words)}")
