"""One run of `roslet bench`: what was asked for is measured, shown and written."""

from __future__ import annotations

import contextlib
import datetime
import json
import os
import pathlib
import platform
import statistics
import sys
from typing import TYPE_CHECKING, Any

import roslet
from roslet.cli.bench import PARTS, board, compiled, porting, report, rtt, size, stacks, validity
from roslet.cli.bench.paper import SIZES
from roslet.cli.bench.tables import tables
from roslet.cli.options import USAGE, CommandError
from roslet.cli.output import Live, emit_json, note, table

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterator

QUICK_SIZES, QUICK_COUNT = (1, 1024, 32768), 50
WIDTH = 40


class Progress:
    """A bar on standard error where that is a terminal; elsewhere a line where somebody else's turn begins."""

    def __init__(self, part: str) -> None:
        self.part = part
        self._live = Live(sys.stderr)
        self._name = ""

    def __call__(self, name: str, done: int, whole: int) -> None:
        share = done / max(1, whole)
        filled = round(WIDTH * share)
        if self._live.in_place:
            self._live.show(
                f"{self.part:9}[{'#' * filled}{'.' * (WIDTH - filled)}] {100 * share:3.0f} %  {name}"
            )
        elif name != self._name and name:
            note(f"{self.part}, {100 * share:.0f} %: {name}")
        self._name = name


def evaluate(arguments: argparse.Namespace) -> int:
    """The command; 0 where every message came and was right."""
    parts = [part.strip() for part in arguments.only.split(",") if part.strip()]
    if unknown := set(parts) - set(PARTS):
        raise CommandError(f"no such part: {', '.join(sorted(unknown))}; there are {', '.join(PARTS)}", USAGE)
    sizes, rounds, count = _extent(arguments)
    try:
        own = [stacks.of_user(text) for text in arguments.echo]
    except ValueError as error:
        raise CommandError(str(error), USAGE) from None
    sizes_given = [size.given(_json(path)) for path in arguments.sizes_of]
    _json(arguments.gates)
    found, absent = stacks.peers(arguments.stacks, note)
    ours = [stack for stack in stacks.ours() if stacks.wanted(stack.name, arguments.stacks)]
    result: dict[str, Any] = {"problems": []}
    with (
        _network() as network,
        _boards(arguments.stacks, parts, absent) as (boards, sizes_of_boards, mirrors),
    ):
        everybody = [*stacks.floors(), *ours, *boards, *found, *own]
        result["about"] = _about(absent)
        if "rtt" in parts:
            trips = rtt.measure(everybody, network, rtt.cases(sizes), rounds, count, Progress("rtt"))
            result["rtt"] = _trips(trips, everybody, sizes, rounds, count)
            result["problems"] += _lost(result["rtt"])
        if "validity" in parts:
            result["validity"] = validity.measure(
                [*validity.peers(everybody, note), *mirrors],
                network,
                Progress("validity"),
                validity.QUICK if arguments.quick else (),
            )
            result["problems"] += result["validity"]["problems"]
        if "porting" in parts:
            result["porting"] = porting.measure(network, Progress("porting"))
            result["problems"] += result["porting"]["problems"]
    if "size" in parts:
        memory = result["rtt"]["memory"] if "rtt" in result else {}
        result["size"] = size.measure(memory, sizes_of_boards, *sizes_given)
    if arguments.gates:
        result["gates"] = _json(arguments.gates)["echo"]
    folder = pathlib.Path(arguments.output)
    paths = report.write(result, folder)
    if arguments.json:
        emit_json({**result, "rtt": {**result["rtt"], "samples": None}} if "rtt" in result else result)
    else:
        for one in tables(result):
            print(f"{one.title}:")
            table(one.headings, one.rows, "  ")
            print(f"{one.note}\n" if one.note else "")
        for problem in result["problems"]:
            note(f"problem: {problem}")
        print("written: " + " ".join(map(str, paths)))
    return 1 if result["problems"] else 0


def _extent(arguments: argparse.Namespace) -> tuple[tuple[int, ...], int, int]:
    """Sizes, rounds and messages."""
    sizes: tuple[int, ...] = QUICK_SIZES if arguments.quick else SIZES
    if arguments.sizes is not None:
        try:
            sizes = tuple(int(size) for size in arguments.sizes.split(",") if size)
        except ValueError:
            raise CommandError(f"not sizes: {arguments.sizes}", USAGE) from None
    if wrong := set(sizes) - set(SIZES):
        raise CommandError(f"sizes are powers of two up to {SIZES[-1]}, not {min(wrong)}", USAGE)
    rounds = arguments.rounds or (1 if arguments.quick else 3)
    count = arguments.count or (QUICK_COUNT if arguments.quick else rtt.COUNT)
    if rounds < 1 or count < 1:
        raise CommandError("rounds and messages are at least 1", USAGE)
    return sizes, rounds, count


def _json(path: str | None) -> dict[str, Any]:
    """What a file says that another command wrote; nothing where there is no file."""
    if path is None:
        return {}
    try:
        found = json.loads(pathlib.Path(path).read_text("utf-8"))
    except (OSError, ValueError) as error:
        raise CommandError(f"{path}: {error}") from None
    if not isinstance(found, dict):
        raise CommandError(f"{path}: not a JSON object")
    return found


def _network() -> Any:
    """A master of ours, and a ROS 2 domain that hardly anybody else's nodes are in."""

    @contextlib.contextmanager
    def opened() -> Any:
        from roslet.master.server import MasterServer

        with MasterServer("127.0.0.1", 0) as master:
            yield stacks.Network(master.uri, 1 + os.getpid() % 100)

    return opened()


@contextlib.contextmanager
def _boards(
    only: str, parts: list[str], absent: dict[str, str]
) -> Iterator[tuple[list[stacks.Stack], dict[str, Any], list[stacks.Stack]]]:
    """Of board.py, for the parts that have a use for them: nodes, their sizes, mirrors. Where they cannot be made,
    `absent` is told why."""
    found: list[stacks.Stack] = []
    mirrors: list[stacks.Stack] = []
    sizes: dict[str, Any] = {}
    with contextlib.ExitStack() as opened:
        try:
            if "rtt" in parts or "size" in parts:
                found, sizes = opened.enter_context(board.boards(only))
            if "validity" in parts:
                mirrors = opened.enter_context(board.mirrors(only))
        except compiled.Absent as error:
            absent["MicroPython"] = str(error)
        yield found, sizes, mirrors


def _about(absent: dict[str, str]) -> dict[str, str]:
    about = {
        "measured": datetime.datetime.now().astimezone().isoformat(timespec="minutes"),
        "roslet": roslet.__version__,
        "Python": platform.python_version(),
        "system": f"{platform.system()} {platform.release()}, {_processor()}, {os.cpu_count()} processors",
        "load average at the start": f"{os.getloadavg()[0]:.1f}",
    }
    if absent:
        about["not installed"] = "; ".join(f"{name} ({why})" for name, why in absent.items())
    return about


def _processor() -> str:
    with contextlib.suppress(OSError), open("/proc/cpuinfo", encoding="utf-8") as file:
        for line in file:
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.machine()


def _trips(
    trips: rtt.Trips, everybody: list[stacks.Stack], sizes: tuple[int, ...], rounds: int, count: int
) -> dict[str, Any]:
    figures = trips.figures()
    ratios: dict[str, dict[str, float]] = {}
    for stack in everybody:
        base, ours = figures.get(stack.floor, {}), figures.get(stack.name, {})
        if stack.dialect:
            ratios[stack.name] = {
                case: one["median"] / base[case]["median"] for case, one in ours.items() if case in base
            }
    return {
        "cases": rtt.cases(sizes),
        "rounds": rounds,
        "count": count,
        "stacks": {
            stack.name: stack.dialect or ("floor ros1" if stack.floor == stacks.TCP else "floor ros2")
            for stack in everybody
        },
        "figures": figures,
        "ratios": ratios,
        "memory": trips.memory,
        "load": trips.load,
        "others": statistics.fmean(trips.busy) if trips.busy else 0.0,
        "processors": os.cpu_count(),
        "failed": trips.problems,
        "samples": {
            name: {case: one.rounds for case, one in cases.items()} for name, cases in trips.measured.items()
        },
    }


def _lost(found: dict[str, Any]) -> list[str]:
    lost = [
        f"{name}, {case}: {one['lost']} messages lost"
        for name, cases in found["figures"].items()
        for case, one in cases.items()
        if one["lost"]
    ]
    return [*found["failed"], *lost]
