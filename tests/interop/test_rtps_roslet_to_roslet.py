"""Two roslet participants in processes of their own, on loopbacks with and without a route for multicast."""

from __future__ import annotations

import pathlib

from interop import rtps
from interop.namespace import Namespace


class TestExchange(rtps.Exchange):
    talker, listener = "roslet", "roslet"


def test_no_route_for_multicast_is_no_obstacle(tmp_path: pathlib.Path) -> None:
    with Namespace(tmp_path, route=False) as namespace:
        namespace.start(*rtps.command("roslet", "talker", 3), name="talker")
        heard = namespace.start(*rtps.command("roslet", "listener", 3), name="listener").finish()
    assert heard == ["ready", "heard hello 0", "heard hello 1", "heard hello 2"]
