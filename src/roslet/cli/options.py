"""What the commands share: how they are declared, their common options, their exit codes, their errors."""

from __future__ import annotations

import argparse
import os
from typing import TYPE_CHECKING, Any

from roslet.errors import RosletError

if TYPE_CHECKING:
    from collections.abc import Callable

    Arguments = argparse.Namespace
    Function = Callable[[argparse.Namespace], int]

OK = 0
FAILED = 1
USAGE = 2
UNREACHABLE = 3
INTERRUPTED = 130  # 128 + SIGINT, as shells report it
TERMINATED = 143  # 128 + SIGTERM
BROKEN_PIPE = 141  # 128 + SIGPIPE

EXIT_CODES = """exit codes:
  0    done
  1    failed: refused, not found, wrong or incomplete
  2    wrong usage
  3    nobody reachable: the master, a node or a service does not answer
  130  interrupted (Ctrl-C); 143 terminated; 141 nobody reads the output
"""


# Help of the lists' --all.
ALL = "hidden ones too: on ROS 2 names with a part that begins with _"


class CommandError(RosletError):
    """The command cannot do what was asked; the text is for people. `code` is the exit code."""

    def __init__(self, text: str, code: int = FAILED) -> None:
        super().__init__(text)
        self.code = code


class Formatter(argparse.RawDescriptionHelpFormatter):
    """Help with examples as written, and room for the names of commands."""

    def __init__(self, prog: str) -> None:
        super().__init__(prog, max_help_position=30)

    def add_argument(self, action: argparse.Action) -> None:
        super().add_argument(action)
        if action.nargs == argparse.PARSER:
            # argparse forgets that the names of commands are indented once more, and breaks the longest line.
            self._action_max_length += 2


class Parser(argparse.ArgumentParser):
    """The parser of one command: options may stand before, between and behind the other arguments."""

    _within = False

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """As ArgumentParser's, which takes what follows an option for superfluous where a list of values may be empty."""
        if self._within:
            return super().parse_known_args(args, namespace)
        self._within = True
        try:
            return self.parse_known_intermixed_args(args, namespace)
        finally:
            self._within = False


class Group:
    """One group of commands under construction: `roslet GROUP COMMAND`."""

    def __init__(self, parser: argparse.ArgumentParser) -> None:
        self._parser = parser
        self._commands = parser.add_subparsers(
            title="commands", metavar="COMMAND", dest="command", required=True, parser_class=Parser
        )

    def command(
        self, name: str, function: Function, summary: str, example: str, common: str = ""
    ) -> argparse.ArgumentParser:
        """Declare a command; `common` names the options it shares with others (see `finish`)."""
        parser = self._commands.add_parser(
            name,
            help=summary,
            description=sentence(summary),
            formatter_class=Formatter,
        )
        return finish(parser, function, example, common)

    def listing(self, function: Function, what: str, example: str) -> argparse.ArgumentParser:
        """Declare the command `list` of what there is in the graph: below a namespace, with names only where wanted."""
        parser = self.command("list", function, f"list {what}", example, "network json")
        parser.add_argument(
            "namespace", nargs="?", default="/", metavar="NAMESPACE", help="those below it only"
        )
        parser.add_argument("-q", "--names", action="store_true", help="names only, one a line")
        return parser


def sentence(summary: str) -> str:
    """A summary as a sentence."""
    return summary[:1].upper() + summary[1:] + "."


def finish(
    parser: argparse.ArgumentParser, function: Function, example: str, common: str = ""
) -> argparse.ArgumentParser:
    """Give a parser its function, its example and, of the words in `common`, the options: network, types, json."""
    parser.set_defaults(function=function)
    indented = "\n".join("  " + line for line in example.strip().splitlines())
    parser.epilog = f"examples:\n{indented}\n\n`roslet --help` lists the exit codes."
    options = common.split()
    if "network" in options:
        parser.add_argument(
            "--network",
            metavar="URL",
            default=default_network(),
            help="ros2://DOMAIN or ros1://host:port; default: $ROSLET_NETWORK, else ros1:// where $ROS_MASTER_URI is set, "
            "else ros2://",
        )
    if "types" in options:
        parser.add_argument(
            "--types",
            metavar="DIR",
            action="append",
            default=[],
            help="load definitions from a package or workspace; may be repeated",
        )
    if "json" in options:
        parser.add_argument("--json", action="store_true", help="print JSON")
    return parser


def default_network() -> str:
    """The network of a command that is told none: what $ROSLET_NETWORK says; else ROS 1 where $ROS_MASTER_URI is set, as in
    the shells of those who use it; else ROS 2."""
    said = os.environ.get("ROSLET_NETWORK", "")
    return said or ("ros1://" if os.environ.get("ROS_MASTER_URI") else "ros2://")


def positive(text: str) -> float:
    """An argument type: a number above zero."""
    value = float(text)
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"{text} is not above zero")
    return value


def count(text: str) -> int:
    """An argument type: an integer of at least one."""
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"{text} is not at least 1")
    return value


def full_name(name: str) -> str:
    """A graph name as given on the command line: relative ones are in $ROS_NAMESPACE. Raises InvalidName."""
    from roslet.names import join, resolve

    namespace = "/" + os.environ.get("ROS_NAMESPACE", "").strip("/")
    return resolve(name, join(namespace, "roslet"))


def below(namespace: str) -> str:
    """What the names below a namespace, as given on the command line, begin with. Raises InvalidName."""
    return full_name(namespace).rstrip("/") + "/"


def load_types(arguments: Any) -> None:
    """Load what --types names, for every type that this process asks for from now on."""
    if arguments.types:
        from roslet.gen.runtime import load

        for path in arguments.types:
            load(path)
