"""A roslet participant writes, jazzy reads."""

from __future__ import annotations

import pathlib

import pytest

from interop import rtps


@pytest.mark.parametrize("words", [(), ("transient_local",)])
def test_every_sample_arrives_in_order(tmp_path: pathlib.Path, words: tuple[str, ...]) -> None:
    rtps.check_text(tmp_path, "roslet", "jazzy", *words)


@pytest.mark.parametrize("size", [100_000, 10 << 20])
def test_large_samples_arrive_whole(tmp_path: pathlib.Path, size: int) -> None:
    rtps.check_large(tmp_path, "roslet", "jazzy", size)


def test_best_effort_samples_arrive_in_order(tmp_path: pathlib.Path) -> None:
    rtps.check_best_effort(tmp_path, "roslet", "jazzy")
