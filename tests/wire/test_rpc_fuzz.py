"""The fuzz targets of HTTP and XML-RPC run without a fuzzer, and the inputs that once broke them."""

from __future__ import annotations

import subprocess
import sys

import pytest

import peers
from roslet.wire import http


@pytest.mark.parametrize("target", ["fuzz_http", "fuzz_xmlrpc"])
def test_the_fuzz_target_runs_without_a_fuzzer(target: str) -> None:
    command = [sys.executable, str(peers.ROOT / f"fuzz/{target}.py"), "--smoke", "3000"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.stdout == "3000 inputs, no finding\n", done.stderr


def test_the_header_bound_does_not_depend_on_the_cuts() -> None:
    # Found by fuzz_http: the empty line lay beyond the bound, and was seen only in large pieces.
    head = b"POST / HTTP/1.1\r\nA: " + b"b" * 40 + b"\r\n"
    for bound in range(len(head) - 2, len(head) + 4):
        whole, bytewise = http.RequestParser(bound), http.RequestParser(bound)
        complete = whole.feed(head + b"\r\n")
        for at in range(len(head) + 2):
            bytewise.feed((head + b"\r\n")[at : at + 1])
        assert bool(complete) == (bound >= len(head) + 2)
        assert (whole.error is None) == (bytewise.error is None) == bool(complete)


def test_only_the_body_counts_towards_the_bound_of_the_body() -> None:
    # Found by fuzz_http: the header counted too, where both came in one piece and the close ends the body.
    head = b"HTTP/1.0 200 OK\r\nA: " + b"b" * 40 + b"\r\n\r\n"
    parser = http.ResponseParser(max_body=30)
    assert parser.feed(head + b"x" * 30) == []
    assert parser.error is None
    (response,) = parser.end()
    assert response.body == b"x" * 30
    assert parser.feed(head + b"x" * 31) == []
    assert parser.error is not None
    assert parser.error.reason == "body-too-large"
