#!/bin/sh
# Runs the benchmarks against every peer that is here; arguments go to the harness.
set -eu
cd "$(dirname "$0")/.."
if [ -f benchmarks/run.py ]; then
    exec .venv/bin/python benchmarks/run.py "$@"
fi
echo "bench.sh: benchmarks/run.py is missing" >&2
exit 1
