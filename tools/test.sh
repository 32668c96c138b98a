#!/bin/sh
# The ordinary test command. A failure of lint, types or layers is remembered, and fails the command and is named after
# the tests have told their counts: the end of the output says all there is to mend.
# Arguments go to pytest; without any, every test is run.
set -eu
cd "$(dirname "$0")/.."

tools/debian.sh
tools/venv.sh
tools/peers.sh

python=.venv/bin/python
failed=
check() {
    name=$1
    shift
    echo "== $name"
    "$@" || failed="$failed $name"
}
check "ruff" "$python" -m ruff check
check "format" "$python" -m ruff format --check
check "mypy" "$python" -m mypy
check "layers" .venv/bin/lint-imports
echo "== pytest"
status=0
if [ $# -gt 0 ]; then
    "$python" -m pytest "$@" </dev/null || status=$?
else
    "$python" tools/run_tests.py || status=$?
fi
if [ -n "$failed" ]; then
    echo "== FAILED before the tests:$failed"
    exit 1
fi
exit "$status"
