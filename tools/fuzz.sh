#!/bin/sh
# Every target of fuzz/ for SECONDS (default 30), one after another. A finding ends it; its input is kept in build/fuzz.
set -eu
cd "$(dirname "$0")/.."

root=$PWD
python=$root/.venv/bin/python
if ! "$python" -c 'import atheris' 2>/dev/null; then
    if command -v uv >/dev/null 2>&1; then
        uv pip install -qq --python "$python" --editable '.[fuzz]'
    else
        "$python" -m pip install -qq --editable '.[fuzz]'
    fi
fi
mkdir -p build/fuzz
for target in fuzz/fuzz_*.py; do
    name=$(basename "$target" .py)
    echo "== $name"
    mkdir -p "build/fuzz/$name"
    "$python" "$target" -max_total_time="${1:-30}" -artifact_prefix="build/fuzz/$name-" "build/fuzz/$name" \
        >"build/fuzz/$name.log" 2>&1 || {
        tail -n 40 "build/fuzz/$name.log" >&2
        exit 1
    }
    tail -n 1 "build/fuzz/$name.log"
done
