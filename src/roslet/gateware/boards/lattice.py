"""Lattice's ECP5 and iCE40: Yosys, nextpnr, and what they say of size and speed. Pins are wherever nextpnr likes."""

from __future__ import annotations

import json
import pathlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from roslet.gateware import toolchain

ROUNDS = 5


def mapping(levels: int) -> str:
    """ABC's script, as Yosys takes it: mapped to the fewest LUTs, whatever comes of the clock, and from there ROUNDS times
    again, with no more than `levels` LUTs in a row."""
    first = ["strash", "ifraig", "scorr", "dc2", "if,-a", "mfs2,-a", "lutpack,-S,1"]
    again = ["strash", "dch,-f", f"if,-D,{levels},-F,5,-A,5", f"mfs2,-a,-L,{levels}", "lutpack,-S,1"]
    return ";".join(first + ROUNDS * again)


@dataclass(frozen=True)
class Chip:
    """A device in a package, how it is synthesized for, and what its cells count as."""

    title: str
    synthesis: str
    levels: int  # LUTs in a row, between flip-flops, that are short enough
    mapped: str  # what Yosys does after ABC
    placer: str
    device: tuple[str, ...]
    constraints: str  # the ending of the file's name; the option of nextpnr's as well
    frequency: str  # a line of it that gives a clock, {port}, its frequency, {mhz}
    luts: Mapping[str, Mapping[str, int]]
    """Of what a LUT4 is used for: the cells that take some, and how many."""
    flip_flops: str  # what the names of such cells begin with
    block_rams: str
    default_mhz: float


ECP5 = Chip(
    title="ECP5 LFE5U-25F, speed grade 6, CABGA381",
    synthesis="synth_ecp5 -nowidelut",  # with wide multiplexers in LUT pairs the whole takes a tenth more
    levels=7,
    mapped="clean",
    placer="nextpnr-ecp5",
    device=("--25k", "--speed", "6", "--package", "CABGA381", "--lpf-allow-unconstrained"),
    constraints="lpf",
    frequency='FREQUENCY PORT "{port}" {mhz:g} MHZ;',
    luts={
        "logic": {"LUT4": 1},
        "carry": {"CCU2C": 2},
        "ram": {"TRELLIS_DPR16X4": 6},  # 4 that hold bits, 2 that address them
    },
    flip_flops="TRELLIS_FF",
    block_rams="DP16KD",
    default_mhz=100.0,
)

ICE40 = Chip(
    title="iCE40 HX8K, CT256",
    synthesis="synth_ice40 -device hx",
    levels=10,
    mapped="ice40_wrapcarry -unwrap; techmap -map +/ice40/ff_map.v; clean; opt_lut -tech ice40",
    placer="nextpnr-ice40",
    device=("--hx8k", "--package", "ct256", "--pcf-allow-unconstrained"),
    constraints="pcf",
    frequency="set_frequency {port} {mhz:g}",
    luts={"logic": {"SB_LUT4": 1}},  # carries lie beside their LUTs
    flip_flops="SB_DFF",
    block_rams="SB_RAM40_4K",
    default_mhz=25.0,
)


def build(
    chip: Chip,
    top: Any,
    name: str,
    folder: pathlib.Path,
    goals: Mapping[str, float],
    seed: int = 1,
    seeds: int = 1,
) -> dict[str, Any]:
    """Synthesize, place and route `top` in `folder`; `goals` are MHz of the inputs that are clocks.

    It is placed from `seed` and the numbers after it, `seeds` of them at most, until all clocks are as fast as they should
    be; what is left in `folder` and reported is the best.

    Returns the figures: `luts` with `total` and what for, `flip_flops`, `block_rams`, `clocks` (see `toolchain.clocks`),
    `met`, whether all are as fast as they should be, and `seed`. Raises ToolMissing, ToolFailed; what does not fit is one of
    these.
    """
    toolchain.command(chip.placer)  # before the minutes that lie ahead
    netlist = f"{name}.json"
    synthesis = f"{chip.synthesis} -top {name}"
    script = (
        toolchain.write_rtlil(top, name, folder, free=True),
        f"{synthesis} -run :map_luts",
        f"abc -lut 4 -script +{mapping(chip.levels)}",
        chip.mapped,
        f"{synthesis} -run map_cells: -json {netlist}",
    )
    toolchain.run("yosys", ["-q", "-p", "; ".join(script)], folder)
    cells = toolchain.cells(folder / netlist, name)
    constraints = f"{name}.{chip.constraints}"
    lines = [chip.frequency.format(port=port, mhz=mhz) for port, mhz in goals.items()]
    (folder / constraints).write_text("\n".join([*lines, ""]), encoding="utf-8")
    option, ending = {"lpf": ("--textcfg", "config"), "pcf": ("--asc", "asc")}[chip.constraints]
    best: dict[str, Any] = {}
    for number in range(seed, seed + seeds):
        tried, report = folder / f"{name}.tried.{ending}", folder / f"{name}.tried.json"
        arguments = [*chip.device, "--json", netlist, f"--{chip.constraints}", constraints]
        arguments += [option, tried.name, "--report", report.name, "--seed", str(number)]
        toolchain.run(chip.placer, [*arguments, "--timing-allow-fail", "-q"], folder)
        found = {**figures(chip, cells, json.loads(report.read_text(encoding="utf-8"))), "seed": number}
        if not best or _slack(found) > _slack(best):
            best = found
            tried.replace(folder / f"{name}.{ending}")
            report.replace(folder / f"{name}.report.json")
        if best["met"]:
            break
    for left in (tried, report):
        left.unlink(missing_ok=True)
    return best


def _slack(found: Mapping[str, Any]) -> float:
    """By which part of its goal the slowest clock is faster."""
    return min((clock["fmax"] / clock["goal"] for clock in found["clocks"].values()), default=1.0) - 1


def figures(chip: Chip, cells: Mapping[str, int], report: dict[str, Any]) -> dict[str, Any]:
    """What `build` returns, from the numbers of cells and nextpnr's report."""

    def count(begins: str) -> int:
        return sum(number for kind, number in cells.items() if kind.startswith(begins))

    luts = {
        use: sum(each * cells.get(kind, 0) for kind, each in kinds.items())
        for use, kinds in chip.luts.items()
    }
    clocks = toolchain.clocks(report)
    return {
        "device": chip.title,
        "luts": {"total": sum(luts.values()), **luts},
        "flip_flops": count(chip.flip_flops),
        "block_rams": count(chip.block_rams),
        "clocks": clocks,
        "met": all(clock["fmax"] >= clock["goal"] for clock in clocks.values()),
    }
