"""Runs core test modules under MicroPython: `micropython run.py FOLDER FILE...`.

FOLDER holds a stand-in for the few parts of pytest that core tests use. One JSON line a test goes to
standard output: {"file", "test", "outcome": "passed" | "failed" | "skipped", "text"}.
"""

import json
import sys

import uio as io  # the built-in one: a folder of the path, such as tests/io, would hide `io`


def report(path, name, outcome, text=""):
    print(json.dumps({"file": path, "test": name, "outcome": outcome, "text": text}))


def traceback_of(error):
    stream = io.StringIO()
    sys.print_exception(error, stream)
    return stream.getvalue()


def run_one(path, name, function, pytest):
    """Runs every case of one test; parametrised cases are all run, the failures are told together."""
    if pytest.is_marked(function, "cpython"):
        report(path, name, "skipped", "needs CPython")
        return
    failures = []
    for arguments in pytest.cases(function):
        try:
            pytest.plain(function)(**arguments)
        except Exception as error:
            failures.append("case " + repr(arguments) + "\n" + traceback_of(error))
    if failures:
        report(path, name, "failed", "\n".join(failures[:5]))
    else:
        report(path, name, "passed")


def run_file(path, pytest):
    scope = {"__name__": "test_module", "__file__": path}
    with open(path) as stream:
        source = stream.read()
    try:
        exec(compile(source, path, "exec"), scope)
    except Exception as error:
        report(path, "", "failed", traceback_of(error))
        return
    for name in sorted(scope):
        if name.startswith("test_"):
            run_one(path, name, scope[name], pytest)


def main():
    sys.path.insert(0, sys.argv[1])
    import pytest  # the stand-in in FOLDER

    for path in sys.argv[2:]:
        run_file(path, pytest)


main()
