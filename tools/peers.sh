#!/bin/sh
# Makes the real peers that the tests judge against, in a cache outside the tree:
#   kilted/ jazzy/ cyclone/  virtual environments with the ROS 2 and DDS wheels
#   ros1-definitions/        definition files of Debian packages that are too heavy to install for them
#   ros1/                    our message packages through gencpp and genpy, and the roscpp peer compiled against them
# Each part carries a stamp of what it was made from, so a second run is instant. What cannot be made here
# (no wheel for this Python, no roscpp) is said loudly and left out; the tests decide whether that is a failure.
set -eu
cd "$(dirname "$0")/.."
cache=${ROSLET_PEERS:-$HOME/.cache/roslet/peers}
mkdir -p "$cache"

if command -v flock >/dev/null 2>&1 && [ -z "${ROSLET_PEERS_LOCKED:-}" ]; then
    ROSLET_PEERS_LOCKED=1 exec flock "$cache/.lock" "$0" "$@"
fi

wheels() { # NAME REQUIREMENT...
    name=$1
    shift
    want="$(python3 -c 'import sys; print(sys.version_info[:2])') $*"
    [ "$(cat "$cache/$name/roslet-stamp" 2>/dev/null || true)" != "$want" ] || return 0
    echo "peers.sh: making $name"
    rm -rf "${cache:?}/$name"
    if python3 -m venv "$cache/$name" && "$cache/$name/bin/python" -m pip install -qq "$@"; then
        echo "$want" >"$cache/$name/roslet-stamp"
    else
        echo "peers.sh: $name CANNOT BE MADE HERE" >&2
        rm -rf "${cache:?}/$name"
    fi
}

wheels kilted ros-rclpy==9.1.2 ros-rmw-fastrtps-cpp==9.3.3 ros-common-interfaces==5.5.1 ros-test-msgs==2.3.0
wheels jazzy ros-jazzy-rclpy==7.1.6 ros-jazzy-rmw-fastrtps-cpp==8.4.3 ros-jazzy-common-interfaces==5.3.6 ros-test-msgs==2.0.3
wheels cyclone cyclonedds==11.0.1

want=$(sha256sum <tools/ros1_definitions.sh | cut -d' ' -f1)
if [ "$(cat "$cache/ros1-definitions/roslet-stamp" 2>/dev/null || true)" != "$want" ]; then
    echo "peers.sh: making ros1-definitions"
    rm -rf "$cache/ros1-definitions"
    if tools/ros1_definitions.sh "$cache/ros1-definitions"; then
        echo "$want" >"$cache/ros1-definitions/roslet-stamp"
    else
        echo "peers.sh: ros1-definitions CANNOT BE MADE HERE" >&2
        rm -rf "$cache/ros1-definitions"
    fi
fi

want=$(cat tools/peers.sh tools/ros1_peers.sh $(find tests/interop/peers -type f -not -name '*.py' | LC_ALL=C sort) | sha256sum | cut -d' ' -f1)
want="$want $(dpkg-query -W -f='${Version}' libroscpp-dev 2>/dev/null || echo none)"
if [ "$(cat "$cache/ros1/roslet-stamp" 2>/dev/null || true)" != "$want" ]; then
    echo "peers.sh: making ros1"
    rm -rf "$cache/ros1"
    if tools/ros1_peers.sh "$cache/ros1"; then
        echo "$want" >"$cache/ros1/roslet-stamp"
    else
        echo "peers.sh: ros1 CANNOT BE MADE HERE" >&2
        rm -rf "$cache/ros1"
    fi
fi
