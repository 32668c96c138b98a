"""Every reason that the RTPS engine and its wire formats count is explained, and nothing else is."""

from __future__ import annotations

import reason_words
from roslet.engine.rtps.reasons import REASONS


def test_every_reason_is_explained_and_every_explanation_is_used() -> None:
    reason_words.check(REASONS, "engine/rtps", "wire/rtps")
