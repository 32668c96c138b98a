"""`roslet bench`: the evaluation of the mROS paper, sections 5.3 to 5.6, on this machine.

`stacks` finds who is compared, `rtt validity size porting` measure, `tables plots report` show, `evaluate` is the command.
`programs/` is what other interpreters and compilers run. Figures of the paper are in `paper`, marked as such.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from roslet.cli.options import finish

if TYPE_CHECKING:
    import argparse

PARTS = ("rtt", "validity", "porting", "size")


def add(parser: argparse.ArgumentParser) -> None:
    """Declare the command."""
    finish(
        parser,
        run,
        "roslet bench --quick\nroslet bench --only rtt --stacks roslet,roscpp --rounds 5\n"
        'roslet bench --only rtt --echo "my board=ros1:python3 start_board.py"',
        "json",
    )
    parser.description = (
        "Evaluate as the mROS paper does: round trips, validity, program size and porting cost.\n\n"
        "roslet is measured beside raw sockets and the peers that are installed: roscpp, rospy, rclpy,\n"
        "cyclonedds. All take their turn in every round. Nothing leaves this host. Leaves a page with plots\n"
        "(`pip install 'roslet[plots]'`), JSON and CSV in a folder. Exit code 0 where every message came\n"
        "and was right."
    )
    parser.add_argument(
        "--quick", action="store_true", help="3 sizes, 50 messages, 1 round: a look, no measurement"
    )
    parser.add_argument("--only", default=",".join(PARTS), metavar="PARTS", help=f"of {', '.join(PARTS)}")
    parser.add_argument(
        "--stacks", default="", metavar="WORDS", help="only those with one of these words in their name"
    )
    parser.add_argument(
        "--sizes", metavar="BYTES", help="of strings, powers of two (default 1 to 32768, all of them)"
    )
    parser.add_argument("--rounds", type=int, metavar="N", help="how often each has its turn (default 3)")
    parser.add_argument(
        "--count", type=int, metavar="N", help="messages of each size in a round (default 200)"
    )
    parser.add_argument(
        "--echo", action="append", default=[], metavar="NAME=ros1|ros2:COMMAND",
        help="an echo node of your own, started so, pinged by roslet (see docs/evaluation.md)",
    )  # fmt: skip
    parser.add_argument(
        "--gates", metavar="FILE", help="what `python benchmarks/gates.py --only echo --json` printed"
    )
    parser.add_argument(
        "--sizes-of",
        action="append",
        default=[],
        metavar="FILE",
        help="what `roslet gateware build --json` printed, or other sizes as JSON (see docs/evaluation.md)",
    )
    parser.add_argument(
        "--output", metavar="DIR", default="roslet-bench", help="where the report goes (default roslet-bench)"
    )


def run(arguments: argparse.Namespace) -> int:
    """`roslet bench`."""
    from roslet.cli.bench.evaluate import evaluate

    return evaluate(arguments)
