"""Where the garbage of a node on MicroPython comes from: octets of heap that each line allots for one message echoed.

    python benchmarks/garbage.py ros2 --lines 40

The echo node is bundled as for a board, but as text, with a probe behind each statement; roslet on CPython pings it. A
probe asks `micropython.mem_current`: octets that were asked for and not given back. The heap gives blocks, of 32 octets
on the 64-bit interpreter, so what the heap loses is more: `tests/interop/test_micropython_memory.py` measures that, without
probes. Frames of functions, which are given back when they return, are not counted. The probes make the node slow: what
goes by time, such as heartbeats, comes more often for a message than it otherwise does.
"""

from __future__ import annotations

import argparse
import ast
import os
import pathlib
import subprocess
import sys
import tempfile
from typing import Any, Literal

from roslet.bundle import link
from roslet.bundle.build import build
from roslet.master.server import MasterServer

ROOT = pathlib.Path(__file__).resolve().parent.parent
DEFINITIONS = ROOT / "examples/msgs/mros_comm_measure"
PINGER = ROOT / "tests/interop/peers/roslet_pinger.py"
HEAP = "8m"
WARM_UP, MESSAGES = 200, 500
PROGRAM = f"""
import gc
import roslet

Coordinate = roslet.load("msgs").mros_comm_measure.msg.Coordinate
node = roslet.Node("echo", network="NETWORK")
pong = node.publisher("pong", Coordinate, qos=10)
count = 0

def back(message):
    global count
    pong.publish(message)
    count += 1
    if count == {WARM_UP}:
        gc.collect()
        gc.disable()
        roslet.probe_clear()
    elif count == {WARM_UP + MESSAGES}:
        roslet.probe_print()

node.subscribe("ping", Coordinate, back, qos=10)
print("ready")
node.spin()
"""
PROBES = """
from micropython import mem_current as probe_now
probe_sums = [0] * {count}
probe_last = [0]
def probe(at):
    probe_sums[at] += probe_now() - probe_last[0]
    probe_last[0] = probe_now()
def probe_enter():
    found = probe_now() - probe_last[0]
    probe_last[0] = probe_now()
    return found
def probe_leave(frame):
    probe_last[0] -= frame
def probe_clear():
    for at in range(len(probe_sums)):
        probe_sums[at] = 0
    probe_last[0] = probe_now()
def probe_print():
    for at in range(len(probe_sums)):
        if probe_sums[at]:
            print("probe", at, probe_sums[at])
    print("end")
"""


class Instrument(ast.NodeTransformer):
    """Puts a probe behind each statement of each function. `places[n]` says where probe n is."""

    def __init__(self) -> None:
        self.places: list[str] = []
        self._inside: list[str] = []

    def _probe(self, what: str) -> ast.stmt:
        self.places.append(".".join(self._inside) + ": " + what)
        return ast.parse(f"probe({len(self.places) - 1})").body[0]

    def visit_ClassDef(self, node: ast.ClassDef) -> ast.AST:
        self._inside.append(node.name)
        self.generic_visit(node)
        self._inside.pop()
        return node

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        self._inside.append(node.name)
        if not any(isinstance(one, ast.Yield | ast.YieldFrom) for one in ast.walk(node)):
            begin = ast.parse("probe_frame = probe_enter()").body[0]
            node.body = [begin, *self._body(node.body), ast.parse("probe_leave(probe_frame)").body[0]]
        self._inside.pop()
        return node

    def _body(self, body: list[ast.stmt]) -> list[ast.stmt]:
        found: list[ast.stmt] = []
        for one in body:
            said = ast.unparse(one).splitlines()[0]
            if isinstance(one, ast.FunctionDef):
                found += [self._visited(one), self._probe(said)]
            elif isinstance(one, ast.Return) and one.value is not None:
                made = ast.parse("probe_value = 0").body[0]
                assert isinstance(made, ast.Assign)
                made.value = one.value
                found += [
                    made,
                    self._probe(said),
                    *ast.parse("probe_leave(probe_frame)\nreturn probe_value").body,
                ]
            elif isinstance(one, ast.Return):
                found += [*ast.parse("probe_leave(probe_frame)").body, one]
            elif isinstance(one, ast.Raise | ast.Break | ast.Continue | ast.Global | ast.Nonlocal):
                found.append(one)
            elif isinstance(one, ast.If | ast.For | ast.While | ast.With):
                one.body = [self._probe(said), *self._body(one.body)]
                if not isinstance(one, ast.With) and one.orelse:
                    one.orelse = self._body(one.orelse)
                found += [one, self._probe("after " + said)]
            elif isinstance(one, ast.Try):
                one.body = self._body(one.body)
                for handler in one.handlers:
                    handler.body = [self._probe("except"), *self._body(handler.body)]
                one.orelse, one.finalbody = self._body(one.orelse), self._body(one.finalbody)
                found.append(one)
            else:
                found += [one, self._probe(said)]
        return found

    def _visited(self, node: ast.FunctionDef) -> ast.stmt:
        found = self.visit_FunctionDef(node)
        assert isinstance(found, ast.stmt)
        return found


def measure(dialect: Literal["ros1", "ros2"], folder: pathlib.Path) -> dict[str, float]:
    """Octets of each place for a message."""
    network = "ros1://" if dialect == "ros1" else f"ros2://{1 + os.getpid() % 100}?range=localhost"
    (folder / "program.py").write_text(PROGRAM.replace("NETWORK", network))
    unshortened: Any = link
    unshortened.shorten = lambda pieces, program, public: ({}, {})  # names as they are in the source
    build(
        folder / "program.py",
        folder / "out",
        dialect,
        definitions=[DEFINITIONS],
        rosout=False,
        compiled=False,
        by_module=False,
    )
    library = folder / "out/lib/roslet.py"
    tree = ast.parse(library.read_text())
    instrument = Instrument()
    instrument.visit(tree)
    probes = PROBES.replace("{count}", str(len(instrument.places)))
    library.write_text(probes + ast.unparse(ast.fix_missing_locations(tree)) + "\n")
    with MasterServer("127.0.0.1", 0) as master:
        variables = {
            **os.environ,
            "ROS_MASTER_URI": master.uri,
            "ROS_IP": "127.0.0.1",
            "PYTHONPATH": str(ROOT / "src"),
            "MICROPYPATH": f"{library.parent}:.frozen",
        }
        run = "import sys; from micropython_unix import run_main; sys.exit(run_main(['micropython', *sys.argv[1:]]))"
        words = [sys.executable, "-c", run, "-X", f"heapsize={HEAP}", "-c", "import main"]
        sums: dict[str, float] = {}
        with subprocess.Popen(words, env=variables, stdout=subprocess.PIPE, text=True) as board:
            assert board.stdout is not None
            pinger = [
                sys.executable,
                str(PINGER),
                network,
                str(WARM_UP + MESSAGES),
                "pinger",
                str(DEFINITIONS),
            ]
            peer: subprocess.Popen[bytes] | None = None
            for line in board.stdout:
                if line.startswith("ready"):
                    peer = subprocess.Popen(pinger, env=variables, stdout=subprocess.DEVNULL)
                elif line.startswith("probe"):
                    _, at, octets = line.split()
                    place = instrument.places[int(at)]
                    sums[place] = sums.get(place, 0.0) + int(octets) / MESSAGES
                elif line.startswith("end"):
                    break
            board.kill()
            if peer is not None:
                peer.wait(30.0)
    return sums


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("dialect", choices=["ros1", "ros2"])
    parser.add_argument("--lines", type=int, default=30)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        sums = measure(arguments.dialect, pathlib.Path(folder))
    print(f"{sum(sums.values()):9.0f}  octets a message, all of it")
    for place, octets in sorted(sums.items(), key=lambda one: -abs(one[1]))[: arguments.lines]:
        print(f"{octets:9.1f}  {place}")


if __name__ == "__main__":
    main()
