"""`roslet bench`: the measurements are not part of the package; this finds and runs them."""

from __future__ import annotations

import argparse
import os
import pathlib

from roslet.cli.options import CommandError, finish


def add(parser: argparse.ArgumentParser) -> None:
    """Declare the command."""
    finish(parser, run, "roslet bench\nroslet bench --only floor-py,roslet-ros1 --what rtt")
    parser.description = (
        "Measure speed against peers and a raw-socket floor.\n\nThe measurements need peers and a checkout of roslet; "
        "this runs `tools/bench.sh` there, as\n`make bench` does, and hands it the arguments. "
        "`roslet demo` times a round trip without any of that."
    )
    parser.add_argument(
        "arguments", nargs=argparse.REMAINDER, metavar="...", help="arguments of tools/bench.sh"
    )


def script() -> pathlib.Path:
    """tools/bench.sh of the checkout that this roslet runs from. Raises CommandError where it is installed."""
    found = pathlib.Path(__file__).resolve().parents[3] / "tools" / "bench.sh"
    if not found.is_file():
        raise CommandError(
            "the measurements come with a checkout of roslet: run `make bench` there, or `roslet demo`"
        )
    return found


def run(arguments: argparse.Namespace) -> int:
    """`roslet bench`."""
    program = str(script())
    os.execv("/bin/sh", ["sh", program, *arguments.arguments])
