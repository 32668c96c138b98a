"""The tables of FEATURES.md and docs/cli.md name what the code has, all of it and nothing else."""

from __future__ import annotations

import argparse
import importlib
import re
import subprocess
import sys
from typing import Any

from docs.pages import ROOT, code, table_rows
from roslet.cli.main import COMMANDS
from roslet.engine.ros1.engine import Engine
from roslet.master.core import API
from roslet.names import parse_network

FEATURES = "FEATURES.md"


def names(heading: str, first: str) -> list[str]:
    """What stands in backquotes in the first cells of the table whose heading's first cell is `first`."""
    found: list[str] = []
    inside = False
    for row in table_rows(FEATURES, heading):
        if row[0] == first or (row[-1].startswith("[`roslet master`]") and first == "master"):
            inside = True
        elif inside and (row[0].startswith(("Slave", "XML-RPC")) or not row[0]):
            break
        elif inside and row[1].startswith("there"):
            found += code(row[0])
    return found


def test_the_master_and_slave_apis_are_listed_whole() -> None:
    master = names("## Master, Slave and Parameter API", "Master and Parameter API")
    assert sorted(set(master) - {"/run_id", "system.multicall", "system.listMethods"}) == sorted(API)
    slave = names("## Master, Slave and Parameter API", "Slave API")
    engine = Engine("/me", parse_network("ros1://localhost")[1], "localhost")
    assert sorted(set(slave) - {"system.multicall", "system.listMethods"}) == sorted(engine.slave.methods)


def test_the_public_names_of_rospy_are_listed_whole() -> None:
    listed: set[str] = set()
    for row in table_rows(FEATURES, "## rospy"):
        if row[1].startswith("there"):
            listed.update(name for name in code(row[0]) if re.fullmatch(r"\w+", name))
    logs = {name for name in listed if name.startswith("log") and name != "logout"}
    listed |= {name + form for name in logs for form in ("_throttle", "_throttle_identical", "_once")}
    listed -= {"_throttle", "_throttle_identical", "_once", "numpy_msg"}
    script = "import roslet.compat.rospy as r; print(*r.__all__, 'Header'); r.Header; r.numpy_msg"
    script = script.replace("r.numpy_msg", "from roslet.compat.rospy.numpy_msg import numpy_msg")
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, timeout=30, check=False
    )
    assert done.returncode == 0, done.stderr
    assert listed == set(done.stdout.split())


def test_the_modules_of_rclpy_are_listed_whole() -> None:
    listed = {
        name
        for row in table_rows(FEATURES, "## rclpy")
        if row[1].startswith("there")
        for name in re.findall(r"`rclpy\.(\w+)`", row[0])
    }
    folder = ROOT / "src" / "roslet" / "compat" / "rclpy"
    assert listed == {path.stem for path in folder.iterdir() if not path.stem.startswith("_")} - {"impl"}


def commands() -> set[str]:
    """Every command that there is: `topic echo`, `master`."""
    found = set()
    for name in COMMANDS:
        parser: Any = argparse.ArgumentParser()
        importlib.import_module("roslet.cli." + name).add(parser)
        inner = [action for action in parser._actions if isinstance(action, argparse._SubParsersAction)]
        found |= {f"{name} {command}" for command in inner[0].choices} if inner else {name}
    return found


def test_every_command_is_documented_and_no_other() -> None:
    text = (ROOT / "docs" / "cli.md").read_text(encoding="utf-8")
    headings = set(re.findall(r"^## (\w+)$", text, re.MULTILINE))
    assert headings == set(COMMANDS)
    used = set()
    for command in commands():
        group, _, name = command.partition(" ")
        section = re.split(rf"^## {group}$", text, flags=re.MULTILINE)[1].split("\n## ")[0]
        if not name or re.search(rf"roslet {command}\b|`{name}|`{command}\b", section):
            used.add(command)
    assert used == commands()
