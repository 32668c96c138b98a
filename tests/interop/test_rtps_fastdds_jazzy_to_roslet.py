"""jazzy writes, a roslet participant reads."""

from __future__ import annotations

from interop.rtps import Exchange


class TestExchange(Exchange):
    talker, listener = "jazzy", "roslet"
