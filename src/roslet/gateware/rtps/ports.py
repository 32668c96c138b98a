"""How the RTPS blocks read and write the two memories, and what they say of a submessage."""

from __future__ import annotations

from amaranth.hdl import Cat, Value
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

SUBMESSAGE = data.StructLayout({"id": 8, "flags": 8, "known": 1, "slot": 8})
"""Beside the body of a submessage: its kind and flags, and which participant it is from, where that is `known`."""


READ_LATENCY = 2


class ReadSignature(wiring.Signature):
    """A read port, seen from who reads: `data` is what lay at `addr` two cycles before (READ_LATENCY): block RAM is slow, so
    what it gives goes to registers first. A read may begin in each cycle.

    Several share a port by turns: who has no use for it keeps `addr` at zero.
    """

    def __init__(self, address_bits: int) -> None:
        super().__init__({"addr": Out(address_bits), "data": In(32)})


class WriteSignature(wiring.Signature):
    """A write port, seen from who writes; shared as above, all at zero while `en` is low."""

    def __init__(self, address_bits: int) -> None:
        super().__init__({"addr": Out(address_bits), "data": Out(32), "en": Out(1)})


def exchanged(word: Value) -> Value:
    """The octets of a word in the other order."""
    return Cat(word.word_select(n, 8) for n in reversed(range(4)))


KEEP = data.StructLayout({"en": 1, "word": 4})
"""The word that passes in this cycle is kept, as that word of the scratch area."""

USER = data.StructLayout({"reader": 8, "representation": 16})
"""Beside a message of the user's: the number of our reader, and the representation identifier, RTPS 2.3, 10.5, as a
number."""

PARTICIPANTS, PUBLICATIONS, SUBSCRIPTIONS = range(3)
DISCOVERY = data.StructLayout({"kind": 2, "known": 1, "slot": 8, "gone": 1, "has_key": 1})
"""Beside a parameter list of discovery: of which writer it is, from whom; `gone`, it is about something that is no more,
whose GUID is in the scratch area where `has_key`."""


class DueSignature(wiring.Signature):
    """Something must be sent for proxy `proxy`, when `en` is high for a cycle; seen from who says so."""

    def __init__(self, proxy_bits: int) -> None:
        super().__init__({"en": Out(1), "proxy": Out(proxy_bits)})
