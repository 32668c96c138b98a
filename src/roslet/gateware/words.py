"""Messages as streams of 32-bit words: what the RTPS blocks take and give, four octets a cycle.

A message is any number of words and then an *end*, an item of its own that carries no data, as with frames of octets
(`stream`). The first octet of a word is in its lowest bits. RTPS and CDR align to four octets, so a word never holds parts
of two numbers of 32 bits.
"""

from __future__ import annotations

from typing import Any

from amaranth.hdl import ShapeLike
from amaranth.lib import data, stream
from amaranth.lib.wiring import Out, Signature

WORD = data.StructLayout({"data": 32, "end": 1, "bad": 1, "padding": 2})
"""An item. At an end `padding` counts the octets of the last word that are not of the message, and `bad` says that all of it
must be forgotten; both are zero elsewhere. `data` means nothing at an end."""


class MessageSignature(Signature):
    """Messages and what is known of them: `stream` of WORD, and `meta`, steady as that of `FrameSignature`."""

    def __init__(self, meta: ShapeLike | None = None) -> None:
        self.layout = meta
        members: dict[str, Any] = {"stream": Out(stream.Signature(WORD))}
        if meta is not None:
            members["meta"] = Out(meta)
        super().__init__(members)
