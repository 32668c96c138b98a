"""Two roslet participants in processes of their own, on loopbacks with and without a route for multicast."""

from __future__ import annotations

import pathlib

import pytest

from interop import rtps
from interop.namespace import Namespace


@pytest.mark.parametrize("words", [(), ("transient_local",)])
def test_every_sample_arrives_in_order(tmp_path: pathlib.Path, words: tuple[str, ...]) -> None:
    rtps.check_text(tmp_path, "roslet", "roslet", *words)


def test_large_samples_arrive_whole(tmp_path: pathlib.Path) -> None:
    rtps.check_large(tmp_path, "roslet", "roslet", 10 << 20)


def test_no_route_for_multicast_is_no_obstacle(tmp_path: pathlib.Path) -> None:
    with Namespace(tmp_path, route=False) as namespace:
        namespace.start(*rtps.command("roslet", "talker", 3), name="talker")
        heard = namespace.start(*rtps.command("roslet", "listener", 3), name="listener").finish()
    assert heard == ["ready", "heard hello 0", "heard hello 1", "heard hello 2"]
