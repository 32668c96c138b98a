"""Frames as streams of octets: what every block takes and gives.

A frame is any number of octets, none as well, and then an *end*, an item of its own that carries no octet. An end may be
`bad`: then all that was taken of the frame must be forgotten, whoever keeps some of it. So a block need not hold a frame
back until a checksum behind it is known.

The rules of Amaranth's streams hold: `valid` does not wait for `ready`, and what is valid stays, unchanged, until it is
taken.
"""

from __future__ import annotations

from typing import Any

from amaranth.hdl import ShapeLike
from amaranth.lib import data, stream
from amaranth.lib.wiring import Out, Signature

OCTET = data.StructLayout({"data": 8, "end": 1, "bad": 1})
"""An item. `bad` is low where `end` is; `data` means nothing at an end."""


class FrameSignature(Signature):
    """Frames and what is known of them: `stream` of OCTET, and `meta`.

    `meta` says something of the frame that is passing: it is steady from when the frame's first item is valid until its end
    has been taken, and means nothing between frames. Without a layout of it there is no `meta`.
    """

    def __init__(self, meta: ShapeLike | None = None) -> None:
        self.layout = meta
        members: dict[str, Any] = {"stream": Out(stream.Signature(OCTET))}
        if meta is not None:
            members["meta"] = Out(meta)
        super().__init__(members)
