#!/bin/sh
# Makes .venv with the project (editable) and its extra `dev`. A second run with the same pyproject.toml is instant.
set -eu
cd "$(dirname "$0")/.."

python=${PYTHON:-python3}
"$python" -c 'import sys; sys.exit(sys.version_info < (3, 10))' || {
    echo "venv.sh: $python is older than Python 3.10; name another with PYTHON=..." >&2
    exit 1
}
want=$("$python" - <<'P'
import hashlib, pathlib, sys
print(sys.version_info[:2], hashlib.sha256(pathlib.Path("pyproject.toml").read_bytes()).hexdigest())
P
)
stamp=.venv/roslet-stamp
[ "$(cat "$stamp" 2>/dev/null || true)" != "$want" ] || exit 0

echo "venv.sh: making .venv"
if command -v uv >/dev/null 2>&1; then
    [ -x .venv/bin/python ] || uv venv --quiet --python "$python" .venv
    uv pip install -qq --python .venv/bin/python --editable '.[dev]'
else
    [ -x .venv/bin/python ] || "$python" -m venv .venv
    .venv/bin/python -m pip install -qq --editable '.[dev]'
fi
echo "$want" >"$stamp"
