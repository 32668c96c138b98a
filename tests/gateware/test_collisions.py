"""The platform that spoils what is read while it is written does so, and no more."""

from __future__ import annotations

from amaranth.hdl import ClockDomain, ClockSignal, Module
from amaranth.lib import memory, wiring
from amaranth.lib.wiring import In, Out

from gateware.collisions import SpoiledCollisions
from roslet.sim.compile import build
from roslet.sim.model import Model


class Stored(wiring.Component):
    """A memory with a port for each way to read a word while it is written."""

    def __init__(self) -> None:
        super().__init__(
            {
                "clk": In(1),
                "at": In(2),
                "en": In(1),
                "w_at": In(2),
                "w_data": In(8),
                "w_en": In(1),
                "plain": Out(8),
                "clear": Out(8),
                "now": Out(8),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.domains.sync = ClockDomain("sync", reset_less=True)
        m.d.comb += ClockSignal("sync").eq(self.clk)
        m.submodules.words = words = memory.Memory(shape=8, depth=4, init=[1, 2, 3, 4])
        write = words.write_port()
        plain = words.read_port()
        clear = words.read_port(transparent_for=(write,))
        now = words.read_port(domain="comb")
        m.d.comb += [write.addr.eq(self.w_at), write.data.eq(self.w_data), write.en.eq(self.w_en)]
        for port, shown in ((plain, self.plain), (clear, self.clear), (now, self.now)):
            m.d.comb += [port.addr.eq(self.at), shown.eq(port.data)]
        m.d.comb += [plain.en.eq(self.en), clear.en.eq(self.en)]
        return m


def test_only_a_word_that_is_read_while_it_is_written_is_spoiled() -> None:
    with Model(build(Stored(), SpoiledCollisions())) as model:
        model.clock("clk", 100e6)

        def edge(at: int, en: int, w_at: int, w_data: int, w_en: int) -> tuple[int, int, int]:
            for name, value in {"at": at, "en": en, "w_at": w_at, "w_data": w_data, "w_en": w_en}.items():
                model.set(name, value)
            model.run(10e-9)
            return model.get("plain"), model.get("clear"), model.get("now")

        assert edge(1, 1, 1, 9, 0) == (2, 2, 2)
        assert edge(1, 1, 2, 9, 1) == (2, 2, 2)  # another word is written
        assert edge(1, 1, 1, 7, 1) == (0xFF ^ 2, 7, 7)
        assert edge(1, 0, 1, 7, 0) == (0xFF ^ 2, 7, 7)  # what was read stays
        assert edge(1, 1, 1, 7, 0) == (7, 7, 7)
        assert edge(3, 0, 3, 8, 1) == (7, 7, 8)  # nothing is read
        assert edge(3, 1, 0, 0, 0) == (8, 8, 8)
