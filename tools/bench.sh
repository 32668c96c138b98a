#!/bin/sh
# Runs the benchmarks: round trips on both networks beside raw sockets, and serialisation beside the peers that are there. Where
# $ROSLET_HARNESS names a side-by-side harness of ROS stacks (a folder with a run.py that takes adapters from
# $PEERS_ADAPTERS), it is run as well, with our adapter in benchmarks/peers; then arguments go to it.
set -eu
cd "$(dirname "$0")/.."
cache=${ROSLET_PEERS:-$HOME/.cache/roslet/peers}
python=.venv/bin/python
if [ -z "${ROSLET_HARNESS:-}" ]; then
    "$python" benchmarks/round_trip.py "$@"
    [ $# = 0 ] || exit 0
    "$python" benchmarks/rtps.py
    "$python" benchmarks/serialization.py
    exit
fi
export PEERS_ADAPTERS="$PWD/benchmarks/peers"
export PEERS_KILTED_PYTHON="${PEERS_KILTED_PYTHON:-$cache/kilted/bin/python}"
export PEERS_PIP_PYTHON="${PEERS_PIP_PYTHON:-$cache/cyclone/bin/python}"
export PEERS_PLAIN_PYTHON="${PEERS_PLAIN_PYTHON:-$PWD/.venv/bin/python}"
if [ $# = 0 ]; then
    set -- --only floor-py,ros1-roscpp,ros1-rospy,roslet-ros1,ros2-rclpy,dds-cyclone-py,roslet-ros2 --what rtt,tput,start,ser --rounds 1
fi
exec "$python" "$ROSLET_HARNESS/run.py" "$@"
