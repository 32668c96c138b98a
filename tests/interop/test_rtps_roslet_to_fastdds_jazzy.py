"""A roslet participant writes, jazzy reads."""

from __future__ import annotations

from interop.rtps import Exchange


class TestExchange(Exchange):
    talker, listener = "roslet", "jazzy"
