"""`roslet gateware`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from roslet.cli import gateware_sim
from roslet.cli.options import Group

if TYPE_CHECKING:
    import argparse


def add(parser: argparse.ArgumentParser) -> None:
    """Declare the commands."""
    gateware_sim.add(Group(parser))
