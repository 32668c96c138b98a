#!/bin/sh
# The ordinary test command. The tests come last so that the line with their counts ends the output;
# a failure of lint, types or layers is remembered and fails the command after the tests have told theirs.
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
if [ -n "$failed" ]; then
    echo "== FAILED before the tests:$failed" >&2
fi
echo "== pytest"
status=0
if [ $# -gt 0 ]; then
    "$python" -m pytest "$@" </dev/null || status=$?
else
    "$python" tools/run_tests.py || status=$?
fi
[ -z "$failed" ] || exit 1
exit "$status"
