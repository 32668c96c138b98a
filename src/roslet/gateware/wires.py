"""Ports of a block that are ports of what it is in, too."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from amaranth.hdl import Module
from amaranth.lib.wiring import Out, connect, flipped


def expose(
    m: Module, inside: Any, outside: Any, names: Iterable[str] | None = None, prefix: str = ""
) -> None:
    """Connect ports of the block `inside`, those in `names` or all, with those of `outside` that have their names behind
    `prefix`: the same ports, in the same directions, of which `outside` is the one that others see."""
    for name in inside.signature.members if names is None else names:
        member = inside.signature.members[name]
        ours, theirs = getattr(inside, name), getattr(outside, prefix + name)
        if not member.is_signature:
            m.d.comb += theirs.eq(ours) if member.flow == Out else ours.eq(theirs)
        elif member.flow == Out:
            connect(m, ours, flipped(theirs))
        else:
            connect(m, flipped(theirs), ours)
