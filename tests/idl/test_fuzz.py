"""The parser on texts that nobody would write: it answers with records or a DefinitionError, and soon."""

from __future__ import annotations

import subprocess
import sys
import time

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import peers
from roslet.errors import DefinitionError
from roslet.idl import Constant, Dialect, Field, Interface, Kind, Message, Service, TypeName, parse

# The pieces that definitions are made of, so that random texts get past the first word.
PIECES = [
    *("int8", "uint64", "float32", "bool", "string", "wstring", "byte", "char", "time", "Header", "pkg/Name"),
    *(
        "[]",
        "[3]",
        "[<=3]",
        "<=5",
        "[",
        "]",
        "<",
        "=",
        "==",
        " ",
        "  ",
        "\t",
        "\n",
        "\r\n",
        "#",
        "---\n",
        "---",
    ),
    *(
        "x",
        "y",
        "X",
        "_",
        "1",
        "-1",
        "0x1F",
        "1e400",
        "nan",
        "true",
        "'",
        '"',
        "\\",
        "\\x4",
        ",",
        "/",
        "é",
        "\0",
    ),
    *("\u2028", "\x0c", "\ud800", "9" * 30),
]
TEXTS = st.one_of(
    st.text(max_size=200),
    st.lists(st.sampled_from(PIECES), max_size=40).map("".join),
    st.text(max_size=20).map("int8 ".__add__),
)
DIALECTS: list[Dialect] = ["ros1", "ros2"]
KINDS: list[Kind] = ["msg", "srv", "action"]


def parts(interface: Interface) -> list[Message]:
    if isinstance(interface, Message):
        return [interface]
    if isinstance(interface, Service):
        return [interface.request, interface.response]
    return [interface.goal, interface.result, interface.feedback]


@settings(max_examples=1500, deadline=None)
@given(TEXTS, st.sampled_from(DIALECTS), st.sampled_from(KINDS))
def test_any_text_is_read_or_refused_with_a_place_inside_it(text: str, dialect: Dialect, kind: Kind) -> None:
    lines = text.split("\n")
    try:
        interface = parse(text, TypeName("pkg", kind, "Thing"), dialect)
    except DefinitionError as error:
        assert 1 <= error.line <= len(lines)
        assert 1 <= error.column <= len(lines[error.line - 1]) + 1
        return
    for part in parts(interface):
        entries: list[Field | Constant] = [*part.fields, *part.constants]
        for entry in entries:
            assert entry.name in lines[entry.line - 1]
            assert lines[entry.line - 1].split()[0].startswith(entry.type.spelled)


@given(st.text(max_size=20), st.text(max_size=20), st.sampled_from(DIALECTS))
def test_any_name_is_taken_or_refused(package: str, name: str, dialect: Dialect) -> None:
    try:
        assert parse("", TypeName(package, "msg", name), dialect).name == TypeName(package, "msg", name)
    except DefinitionError as error:
        assert "names are made of" in error.message


LARGE = 200_000


@pytest.mark.parametrize(
    "text",
    [
        "x" * LARGE,
        "int8 " + "x" * LARGE,
        "int8 X=" + "9" * LARGE,
        "float64 X=" + "9" * LARGE,
        "bool X=" + "9" * LARGE,
        "uint8 X=0x" + "f" * LARGE,
        "int8[" + "9" * LARGE + "] x",
        "int8" + "[" * LARGE + " x",
        "string<=" + "1" * LARGE + " x",
        "string x '" + "\\'" * (LARGE // 2) + "'",
        "string x " + "\\" * LARGE,
        "string[] x [" + "'a'," * (LARGE // 4) + "]",
        "string[] x [" + "," * LARGE + "]",
        "string[] x [" + "a " * LARGE + "]",
        "int8[] x [" + "1," * LARGE + "]",
        "a/" * LARGE + "b x",
        "#" * LARGE,
        "\n" * LARGE,
        " " * LARGE + "int8 x",
        "int8" + " " * LARGE + "x",
        "---\n" * LARGE,
        "".join([f"int8 x{number}\n" for number in range(LARGE // 10)]),
        "".join([f"int8 X{number}={number % 100}\n" for number in range(LARGE // 10)]),
    ],
    ids=lambda text: text[:16].replace("\n", "~"),
)
@pytest.mark.parametrize("dialect", DIALECTS)
def test_large_texts_take_linear_time(text: str, dialect: Dialect) -> None:
    start = time.process_time()
    for kind in KINDS:
        try:
            assert parse(text, TypeName("pkg", kind, "Thing"), dialect).dialect == dialect
        except DefinitionError as error:
            assert len(str(error)) < 400
    # Linear readers need 0.05 to 2 s for these, several times as long beside other work; quadratic ones minutes.
    assert time.process_time() - start < 20


def test_the_fuzz_target_runs_without_a_fuzzer() -> None:
    command = [sys.executable, str(peers.ROOT / "fuzz/fuzz_idl.py"), "--smoke", "2000"]
    ran = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert (ran.returncode, ran.stderr) == (0, "")
    assert ran.stdout.startswith("2000 inputs")
