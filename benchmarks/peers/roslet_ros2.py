"""roslet on a ROS 2 network, for the side-by-side measurements of ROS stacks: RTPS over UDP, reliable, depth 10; throughput
with KEEP_ALL on both sides, so that the publisher waits."""

import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from roslet_common import PYTHON, build, make_peer, version  # noqa: F401 - the harness calls them

NAME = "roslet-ros2"
TYPES = ("String", "Image", "PointStamped", "Coordinate")
WHAT = ("rtt", "tput", "start", "ser")
VARIANTS: dict[str, dict[str, str]] = {"udp": {}}
TPUT = {64: 50000, 1048576: 500}


def command(role, variant):
    return [PYTHON, os.path.abspath(__file__), role]


def env(variant):
    from adapters import ROOT

    return {"PEERS_ROOT": ROOT, "ROS_DOMAIN_ID": "78"}


if __name__ == "__main__":
    from peerlib import child_main

    child_main(lambda args: make_peer(args, "ros2", "ros2://"))
