"""`roslet`: parse, import the one module that is needed, run it, turn what it raises into a line and an exit code."""

from __future__ import annotations

import argparse
import os
import signal
import sys
from contextlib import suppress
from importlib import import_module
from typing import TYPE_CHECKING, Any

from roslet.cli.options import (
    BROKEN_PIPE,
    EXIT_CODES,
    FAILED,
    INTERRUPTED,
    TERMINATED,
    UNREACHABLE,
    CommandError,
    Formatter,
    sentence,
)
from roslet.errors import CallTimeout, RosletError, Unreachable

if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import FrameType

# Each has a module of its name in this package with `add(parser)`.
COMMANDS = {
    "topic": "list, show, publish and measure topics",
    "node": "list, show, ping and end nodes",
    "service": "list, show and call services",
    "param": "read and write parameters",
    "action": "list, show and use actions",
    "interface": "show message, service and action definitions",
    "gen": "generate code from definitions",
    "gateware": "build and simulate nodes in gates",
    "micropython": "bundle and run nodes for MicroPython",
    "master": "be a ROS 1 master",
    "doctor": "find what keeps nodes from hearing each other",
    "run": "run an unmodified rospy or rclpy program, without ROS",
    "bench": "measure speed against peers and a raw socket",
    "demo": "see it work: master, nodes, rates, round trips, in about 20 seconds",
}


class Terminated(SystemExit):
    """SIGTERM, as an exception, so that nodes are unregistered on the way out."""


def build(chosen: str | None) -> argparse.ArgumentParser:
    """The parser, with the arguments of the chosen command only."""
    parser = argparse.ArgumentParser(
        prog="roslet",
        description="A ROS node where ROS itself cannot go.",
        epilog="`roslet COMMAND --help` and `roslet COMMAND COMMAND --help` have examples.\n\n" + EXIT_CODES,
        formatter_class=Formatter,
    )
    parser.add_argument("--version", action="store_true", help="print the version and exit")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", dest="group")
    for name, summary in COMMANDS.items():
        command = commands.add_parser(
            name,
            help=summary,
            description=sentence(summary),
            formatter_class=Formatter,
        )
        if name == chosen:
            import_module("roslet.cli." + name).add(command)
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; the exit code. What it prints goes to standard output, errors to standard error."""
    given = list(sys.argv[1:] if argv is None else argv)
    for stream in (sys.stdout, sys.stderr):
        # A name or a string may hold what the terminal's encoding lacks: show it escaped rather than fail.
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
    previous = _quit_on_sigterm()
    try:
        code = _run(given)
        sys.stdout.flush()
        return code
    except BrokenPipeError:
        # Python flushes standard output once more at exit; there is nobody to tell then either.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return BROKEN_PIPE
    except KeyboardInterrupt:
        return INTERRUPTED
    except CommandError as error:
        return _failed(str(error), error.code)
    except (Unreachable, CallTimeout) as error:
        return _failed(str(error), UNREACHABLE)
    except RosletError as error:
        return _failed(str(error), FAILED)
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        return _failed(f"{where}{error.strerror or error}", FAILED)
    finally:
        if previous is not None:
            signal.signal(signal.SIGTERM, previous)


def _run(given: list[str]) -> int:
    chosen = next((word for word in given if not word.startswith("-")), None)
    parser = build(chosen)
    arguments = parser.parse_args(given)
    if arguments.version:
        from roslet import __version__

        print(f"roslet {__version__}")
        return 0
    if arguments.group is None:
        parser.print_help()
        return 0
    code: int = arguments.function(arguments)
    return code


def _failed(text: str, code: int) -> int:
    with suppress(OSError):
        sys.stdout.flush()
    print("roslet: " + " ".join(text.split("\n")), file=sys.stderr, flush=True)
    return code


def _quit_on_sigterm() -> Any:
    """Make SIGTERM an exception; the handler to put back, None where this thread may not set one."""

    def terminated(number: int, frame: FrameType | None) -> None:
        interrupts = sys.modules.get(
            "roslet.io.interrupts"
        )  # where there is a node; it is not imported for less
        if interrupts is None or not interrupts.put_off(number, frame):
            raise Terminated(TERMINATED)

    try:
        return signal.signal(signal.SIGTERM, terminated)
    except ValueError:
        return None


if __name__ == "__main__":
    sys.exit(main())
