"""A writer that offers less than a reader requests: no sample, and the policy is named at our end."""

from __future__ import annotations

import pathlib

import pytest

from interop import rtps
from interop.namespace import Namespace


@pytest.mark.parametrize("peer", ["kilted", "cyclone"])
def test_a_best_effort_writer_does_not_serve_a_reliable_reader(tmp_path: pathlib.Path, peer: str) -> None:
    with Namespace(tmp_path) as namespace:
        namespace.start(*rtps.command(peer, "talker", 3, "best_effort"), name="talker")
        reader = namespace.start(*rtps.command("roslet", "listener", 1), name="listener")
        reader.wait_for("incompatible reliability")
        assert not [line for line in reader.lines() if line.startswith("heard")]


@pytest.mark.parametrize("peer", ["kilted", "cyclone"])
def test_a_volatile_writer_does_not_serve_a_transient_local_reader(tmp_path: pathlib.Path, peer: str) -> None:
    with Namespace(tmp_path) as namespace:
        namespace.start(*rtps.command(peer, "listener", 3, "transient_local"), name="listener")
        writer = namespace.start(*rtps.command("roslet", "talker", 1), name="talker")
        writer.wait_for("incompatible durability")
