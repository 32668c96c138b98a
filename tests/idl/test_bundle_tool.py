"""The bundled definitions are what `tools/bundle_definitions.py` makes of the installed packages."""

from __future__ import annotations

import subprocess
import sys

import peers


def test_making_the_bundle_again_changes_nothing() -> None:
    ros1 = ["/usr/share", str(peers.require("ros1-definitions"))]
    peers.require("genpy")
    ros2 = str(peers.require("kilted").parent.parent / "share")
    tool = str(peers.ROOT / "tools/bundle_definitions.py")
    command = [sys.executable, tool, "--check", "--ros1", *ros1]
    command += ["--ros1-python", str(peers.DEBIAN_PYTHON), "--ros2", ros2]
    ran = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert (ran.returncode, ran.stderr) == (0, "")
    kept = sorted(
        line.split(":")[0] for line in ran.stdout.splitlines() if line.endswith("not found, kept as it is")
    )
    # These come from sources, since no peer installs them.
    assert kept == [
        "ros1 actionlib_tutorials",
        "ros1 roscpp_tutorials",
        "ros1 rospy_tutorials",
        "ros1 turtlesim",
        "ros2 composition_interfaces",
        "ros2 example_interfaces",
        "ros2 statistics_msgs",
        "ros2 tf2_msgs",
    ]
