#!/bin/sh
# Runs the benchmarks: benchmarks/run.py, or the side-by-side harness of ROS stacks with our adapters in
# benchmarks/peers. The harness is a folder with a run.py, named by $ROSLET_HARNESS. Arguments go to what is run.
set -eu
cd "$(dirname "$0")/.."
cache=${ROSLET_PEERS:-$HOME/.cache/roslet/peers}
if [ -f benchmarks/run.py ]; then
    exec .venv/bin/python benchmarks/run.py "$@"
fi
harness=${ROSLET_HARNESS:-../shared/peers}
if [ ! -f "$harness/run.py" ]; then
    echo "bench.sh: no harness at $harness; name it with ROSLET_HARNESS" >&2
    exit 1
fi
export PEERS_ADAPTERS="$PWD/benchmarks/peers"
export PEERS_KILTED_PYTHON="${PEERS_KILTED_PYTHON:-$cache/kilted/bin/python}"
export PEERS_PLAIN_PYTHON="${PEERS_PLAIN_PYTHON:-$PWD/.venv/bin/python}"
if [ $# = 0 ]; then
    set -- --only floor-py,ros1-roscpp,ros1-rospy,roslet-ros1 --what rtt,tput,start,ser --rounds 1
fi
exec .venv/bin/python "$harness/run.py" "$@"
