"""Where things lie in the two memories: nothing at the place of another, whatever the widths of the numbers that say
where."""

from __future__ import annotations

from typing import Any

import pytest
from amaranth.hdl import Const, Module, Signal, Value
from amaranth.sim import Simulator

from roslet.gateware.rtps import tables
from roslet.gateware.rtps.tables import Local, OwnMap, PeerMap


def evaluate(values: list[Value]) -> list[int]:
    """What expressions of constants are."""
    m, outputs = Module(), [Signal(32) for _ in values]
    m.d.comb += [out.eq(value) for out, value in zip(outputs, values, strict=True)]
    found: list[int] = []

    async def process(ctx: Any) -> None:
        await ctx.delay(1e-9)
        found.extend(ctx.get(out) for out in outputs)

    simulator = Simulator(m)
    simulator.add_testbench(process)
    simulator.run()
    return found


def numbers(count: int, words: int) -> list[tuple[int, int]]:
    return [(n, word) for n in range(count) for word in range(words)]


@pytest.mark.parametrize(("participants", "endpoints"), [(1, 1), (2, 1), (1, 5), (3, 2)])
def test_every_word_has_a_place_of_its_own(participants: int, endpoints: int) -> None:
    peers = PeerMap(participants, endpoints)

    def narrow(number: int) -> Value:
        """As few bits as it needs, none for zero."""
        return Const(number, number.bit_length())

    places: list[Value] = []
    for wide in (False, True):
        index: Any = (lambda n: Const(n, 8)) if wide else narrow
        places += [peers.participant(index(n), index(word)) for n, word in numbers(participants, 16)]
        places += [
            peers.builtin(index(n), index(kind), index(word))
            for n, word in numbers(participants, 8)
            for kind in range(4)
        ]
        places += [peers.endpoint(index(n), index(word)) for n, word in numbers(endpoints, 8)]
        places += [peers.scratch(index(word)) for word in range(16)]
    got = evaluate(places)
    half = len(got) // 2
    assert got[:half] == got[half:]
    assert len(set(got[:half])) == half
    assert max(got) < peers.depth <= 1 << peers.address_bits


def test_our_own_words_have_places_of_their_own() -> None:
    writers = [Local("a", "A", words=5, depth=2), Local("bb", "B" * 30, words=1)]
    own = OwnMap(writers, [Local("c" * 9, "C")])
    texts = [(reader, is_type, n) for reader in (False, True) for is_type in (False, True) for n in range(2)]
    words = [(*text, word) for text in texts for word in range(1 << own.text_bits)]
    got = evaluate(
        [
            own.text(Const(r, 1), Const(t, 1), Const(n, n), Const(word, word.bit_length()))
            for r, t, n, word in words
        ]
    )
    assert got == [own.text_address(r, t, n) + word for r, t, n, word in words]
    places = [
        *got,
        *(own.own(word) for word in range(tables.OWN_WORDS)),
        *evaluate(
            [own.writer(Const(n, n), word, b) for b in range(2) for n in range(2) for word in range(4)]
        ),
        *(
            at
            for n, one in enumerate(writers)
            for at in range(own.samples[n], own.samples[n] + own.stride(one) * one.depth)
        ),
    ]
    assert len(set(places)) == len(places)
    assert max(places) < own.depth


@pytest.mark.parametrize("count", [0, 129])
def test_a_table_for_nobody_or_for_too_many_is_refused(count: int) -> None:
    with pytest.raises(ValueError, match=f"1 to 128 participants, not {count}"):
        PeerMap(count, 1)
    with pytest.raises(ValueError, match=f"1 to 128 endpoints, not {count}"):
        PeerMap(1, count)


@pytest.mark.parametrize("depth", [0, 3, 1 << 16])
def test_a_history_of_no_power_of_two_is_refused(depth: int) -> None:
    with pytest.raises(ValueError, match=f"power of two of messages, at most 32768, not {depth}"):
        Local("t", "T", depth=depth)
