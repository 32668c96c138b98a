"""A compiled design: pins, clocks, time, waveforms, and the cache of what was built."""

from __future__ import annotations

import pathlib
import tempfile

import pytest
from amaranth.hdl import ClockDomain, ClockSignal, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out
from amaranth.sim import Simulator

from roslet.sim import compile as building
from roslet.sim.model import Model
from sim.echo import Echo


class Edges(wiring.Component):
    """Registers of two clocks and both edges, and what follows from them without a clock."""

    def __init__(self) -> None:
        super().__init__(
            {
                "clk": In(1),
                "other": In(1),
                "d": In(8),
                "up": Out(8),
                "crossed": Out(8),
                "down": Out(8),
                "sum": Out(9),
                "level": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.domains.sync = ClockDomain("sync", reset_less=True)
        m.domains.other = ClockDomain("other", reset_less=True)
        m.domains.fall = ClockDomain("fall", reset_less=True, clk_edge="neg")
        m.d.comb += [
            ClockSignal("sync").eq(self.clk),
            ClockSignal("other").eq(self.other),
            ClockSignal("fall").eq(self.other),
        ]
        m.d.sync += self.up.eq(self.up + self.d)
        m.d.other += self.crossed.eq(self.up)
        m.d.fall += self.down.eq(self.up)
        m.d.comb += [self.sum.eq(self.up + self.d), self.level.eq(self.other)]
        return m


class Counter(wiring.Component):
    """Without clock domains of its own: Amaranth gives it `clk` and `rst`."""

    def __init__(self) -> None:
        super().__init__({"step": In(4), "value": Out(100), "low": Out(1)})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        inner = Signal(100, init=1, name="inner")
        m.d.sync += inner.eq(Mux(inner[99], 1, (inner << self.step)[:100]))
        m.d.comb += [self.value.eq(inner), self.low.eq(inner < 100)]
        return m


def test_a_register_takes_what_stood_before_the_edge() -> None:
    with Model(Edges()) as model:
        model.clock("clk", 100e6)
        model.set("d", 3)
        assert model.get("sum") == 3, "what has no clock follows at once"
        model.run(0)
        assert (model.get("up"), model.get("sum")) == (3, 6), "the first edge is at time 0"
        model.run(9e-9)
        assert model.get("up") == 3
        model.run(1e-9)
        assert model.get("up") == 6


def test_clocks_run_at_their_own_period_and_phase() -> None:
    with Model(Edges()) as model:
        model.clock("clk", 100e6)
        model.clock("other", 25e6, phase=0.25, duty=0.5)
        model.set("d", 1)
        seen = []
        for _ in range(12):
            model.run(5e-9)
            seen.append(tuple(model.get(name) for name in ("up", "crossed", "down", "level")))
        # clk rises at 0, 10, 20 ...; other rises at 10, 50 ... and falls at 30, 70 ..., in the same instants.
        assert [up for up, *_ in seen] == [1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7]
        assert [crossed for _, crossed, *_ in seen] == [0, 1, 1, 1, 1, 1, 1, 1, 1, 5, 5, 5]
        assert [level for *_, level in seen] == [0, 1, 1, 1, 1, 0, 0, 0, 0, 1, 1, 1]
        assert [down for *_, down, _ in seen] == [0, 0, 0, 0, 0, 3, 3, 3, 3, 3, 3, 3]
        assert (model.cycles("clk"), model.cycles("other")) == (7, 2)
        assert model.picoseconds == 60_000


def test_it_does_what_the_simulator_of_amaranth_does() -> None:
    steps = [(7 * n) % 16 for n in range(400)]
    expected = []
    reference = Counter()

    async def bench(ctx: object) -> None:
        for step in steps:
            ctx.set(reference.step, step)  # type: ignore[attr-defined]
            await ctx.tick()  # type: ignore[attr-defined]
            expected.append((ctx.get(reference.value), ctx.get(reference.low)))  # type: ignore[attr-defined]

    simulator = Simulator(reference)
    simulator.add_clock(1e-8)
    simulator.add_testbench(bench)
    simulator.run()
    found = []
    with Model(Counter()) as model:
        model.clock("clk", 100e6, phase=0.5)
        for step in steps:
            model.set("step", step)
            model.run_cycles("clk", 1)
            found.append((model.get("value"), model.get("low")))
    assert found == expected


def test_signals_within_are_found_by_their_path() -> None:
    with Model(Echo()) as model:
        assert model.signal("rx unbuffered produce_w_bin").bits == 7
        assert model.get("rx unbuffered produce_w_bin") == 0


def test_wide_signals_and_their_bounds() -> None:
    with Model(Echo()) as model:
        model.clock("clk", 50e6)
        model.set("rst_n", 1)
        value = 0x1F0F_0123_4567_89AB_CDEF
        model.set("wide", value)
        model.run_cycles("clk", 2)
        assert model.get("wide_copy") == value
        with pytest.raises(ValueError, match="wide has 77 bits, which cannot hold"):
            model.set("wide", 1 << 77)
        with pytest.raises(ValueError, match="cannot hold -1"):
            model.set("wide", -1)
        with pytest.raises(ValueError, match="wide_copy is no input"):
            model.set("wide_copy", 1)
        with pytest.raises(KeyError, match="no signal 'nothing'"):
            model.get("nothing")


def test_misuse_of_clocks_is_said() -> None:
    with Model(Echo()) as model:
        with pytest.raises(ValueError, match="no clock was started"):
            model.run(1.0)
        with pytest.raises(ValueError, match="no clock 'clk' was started"):
            model.cycles("clk")
        with pytest.raises(ValueError, match="wide is no input of one bit"):
            model.clock("wide", 1e6)
        for hz, phase, duty in ((0.0, 0.0, 0.5), (1e6, 1.0, 0.5), (1e6, 0.0, 1.0)):
            with pytest.raises(ValueError, match="a clock has a frequency above 0"):
                model.clock("clk", hz, phase, duty)
        with pytest.raises(ValueError, match="too short"):
            model.clock("clk", 1e13)
        model.clock("clk", 1e6)
        with pytest.raises(ValueError, match="clk is a clock already"):
            model.clock("clk", 1e6)


def test_models_of_one_library_know_nothing_of_each_other() -> None:
    with Model(Edges()) as one, Model(Edges()) as other:
        for model, d in ((one, 1), (other, 2)):
            model.clock("clk", 100e6)
            model.set("d", d)
        one.run_cycles("clk", 9)
        other.run_cycles("clk", 4)
        assert (one.get("up"), other.get("up")) == (10, 10)


def test_a_waveform_shows_both_edges_and_what_changed(tmp_path: pathlib.Path) -> None:
    file = tmp_path / "edges.vcd"
    with Model(Edges()) as model:
        model.clock("clk", 100e6)
        model.set("d", 1)
        model.run(12e-9)
        model.vcd(file)
        model.run(20e-9)
        model.close_vcd()
        model.run(20e-9)
        assert model.get("up") == 6
    lines = file.read_text().splitlines()
    assert "$timescale 1 ps $end" in lines
    names = {line.split()[4]: line.split()[3] for line in lines if line.startswith("$var")}
    times = [int(line[1:]) for line in lines if line.startswith("#")]
    assert times == [12_000, 15_000, 20_000, 25_000, 30_000]
    clock = [line for line in lines if line[0] in "01" and line[1:] == names["clk"]]
    assert clock == ["1" + names["clk"], "0" + names["clk"]] * 2 + ["1" + names["clk"]]
    sums = [line for line in lines if line.startswith("b") and line.endswith(" " + names["sum"])]
    assert [int(line[1:].split()[0], 2) for line in sums] == [3, 4, 5]


def test_a_waveform_that_begins_while_the_clock_is_low_has_its_next_edge_up(tmp_path: pathlib.Path) -> None:
    with Model(Edges()) as model:
        model.clock("clk", 100e6)
        model.run(17e-9)
        model.vcd(tmp_path / "low.vcd")
        model.run(10e-9)
    times = [line for line in (tmp_path / "low.vcd").read_text().splitlines() if line.startswith("#")]
    assert times == ["#17000", "#20000", "#25000"]


def test_what_was_built_is_kept_and_what_differs_is_built_anew(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROSLET_CACHE", str(tmp_path))
    first = building.build(Counter())
    assert first.parent.parent == tmp_path / "sim"

    def never(**_: object) -> None:
        raise AssertionError("it was built again")

    with monkeypatch.context() as patched:
        patched.setattr(tempfile, "mkdtemp", never)
        assert building.build(Counter()) == first
        with pytest.raises(AssertionError, match="built again"):
            building.build(Edges())
    assert sorted(one.name for one in (tmp_path / "sim").iterdir()) == [first.parent.name]


def test_a_compiler_that_is_missing_or_refuses_is_told_of_and_leaves_nothing(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROSLET_CACHE", str(tmp_path))
    monkeypatch.setenv("CXX", "no-such-compiler")
    with pytest.raises(building.CompileFailed, match="no-such-compiler is not installed"):
        building.build(Counter())
    liar = tmp_path / "liar"
    liar.write_text(
        '#!/bin/sh\ncase "$1" in -dump*|--version) echo 1;; *) echo "out of order" >&2; exit 1;; esac\n'
    )
    liar.chmod(0o755)
    monkeypatch.setenv("CXX", str(liar))
    with pytest.raises(building.CompileFailed, match="out of order"):
        building.build(Counter())
    assert list((tmp_path / "sim").iterdir()) == []


def test_the_design_does_not_depend_on_where_its_source_lies() -> None:
    text = building.rtlil(Counter())
    assert str(pathlib.Path(__file__).parent) not in text
    assert text == building.rtlil(Counter())


def test_a_clock_that_the_design_looks_at_is_never_skipped() -> None:
    folder = building.build(Edges()).parent
    assert (folder / "clocks.inc").read_text() == 'ROSLET_CLOCK("clk", prev_p_clk)\n'
