"""One of many words that stand at ports."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from operator import or_

from amaranth.hdl import Module, Mux, Signal, Value

WORD = 32


def gather(m: Module, words: Sequence[Value], index: Value) -> Value:
    """`words[index]`, of 32 bits at most each, in the next cycle; zero behind the last one.

    Each word has flip-flops that are reset while it is not meant, and what all of them have is or-ed: a third of a LUT for
    a bit, where a multiplexer takes two thirds. `index` must come early in a cycle, and what is returned late.
    """
    kept = [Signal(WORD, name=f"kept{n}") for n in range(len(words))]
    for n, (register, word) in enumerate(zip(kept, words, strict=True)):
        m.d.sync += register.eq(Mux(index == n, word, 0))
    return reduce(or_, kept)
