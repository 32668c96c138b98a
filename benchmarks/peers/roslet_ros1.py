"""roslet on a ROS 1 network, for the side-by-side measurements of ROS stacks; the master is the other ROS 1 adapters'."""

import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from roslet_common import PYTHON, build, make_peer, version  # noqa: F401 - the harness calls them

NAME = "roslet-ros1"
TYPES = ("String", "Image", "PointStamped", "Coordinate")
WHAT = ("rtt", "tput", "start", "ser")
VARIANTS: dict[str, dict[str, str]] = {"tcp": {}}
TPUT = {64: 100000, 1048576: 1000}


def command(role, variant):
    return [PYTHON, os.path.abspath(__file__), role]


def services(variant):
    import ros1_common

    return ros1_common.master()


def env(variant):
    import ros1_common
    from adapters import ROOT

    return {**ros1_common.env(), "PEERS_ROOT": ROOT}


if __name__ == "__main__":
    from peerlib import child_main

    child_main(lambda args: make_peer(args, "ros1", "ros1://"))
