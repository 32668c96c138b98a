"""What is left of modules that are bundled, and that it does what the whole would."""

from __future__ import annotations

import types
from typing import Any

import pytest

from roslet.bundle.link import Linker
from roslet.bundle.shake import Shaker

ONE = '''
"""A docstring that takes room."""
from __future__ import annotations
from roslet.two import WIDTH, _twice as double, Base
from roslet import two

TYPE_CHECKING = False
if TYPE_CHECKING:
    import nothing_at_all

DEPTH = 2 * WIDTH
unused: "dict[str, int]" = {}
emit = "emit of one"


def _helper(value: "int") -> "int":
    "Also a docstring."
    return double(value) + DEPTH


class Thing(Base):
    __slots__ = ("_secret",)

    def __init__(self, secret):
        self._secret = secret
        self._never_read = secret

    def tell(self):
        return "%s %d" % (self._secret, _helper(3))

    def shared(self):
        return [emit for _ in range(1)][0] + two.emit()

    def never_called(self):
        return 1 / 0


def found_by_text(thing):
    return getattr(thing, "by_text")()


def never():
    from roslet.three import nothing
    return nothing
'''
TWO = """
WIDTH = 3
if CPYTHON:
    raise ImportError("not on a board")


def _twice(value):
    return 2 * value


def emit():
    emit_here = "of two"
    return " and " + emit_here


class Base:
    _kind = "base"

    def by_text(self):
        return self._kind + self._secret

    def _secret_of_base(self):
        return 0
"""
THREE = "nothing = 1\n"
PROGRAM = """
import roslet
thing = roslet.Thing("s")
RESULTS.append(thing.tell())
RESULTS.append(thing.shared())
RESULTS.append(roslet.found_by_text(thing))
"""
TEXTS = {
    "roslet": "from roslet.one import Thing, found_by_text\n",
    "roslet.one": ONE,
    "roslet.two": TWO,
    "roslet.three": THREE,
}


def linked(program: str = PROGRAM, **settings: Any) -> Linker:
    shaker = Shaker(program, TEXTS, folds={"CPYTHON": False}, roots=["roslet"], **settings)
    return Linker(shaker.trees(), shaker.program, ["Thing", "found_by_text"], ["roslet"])


def run(linker: Linker, monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """What the program says, with the linked module in the place of roslet."""
    import ast
    import sys

    module = types.ModuleType("roslet")
    exec(compile(linker.text(), "linked", "exec"), module.__dict__)
    results: list[Any] = []
    monkeypatch.setitem(sys.modules, "roslet", module)
    exec(compile(ast.unparse(linker.program), "program", "exec"), {"RESULTS": results})
    return results


def test_the_program_does_what_it_did(monkeypatch: pytest.MonkeyPatch) -> None:
    assert run(linked(), monkeypatch) == ["s 12", "emit of one and of two", "bases"]


@pytest.mark.parametrize(
    "gone",
    [
        "docstring",
        "never_called",
        "def never",
        "nothing_at_all",
        "unused",
        "__slots__",
        "_never_read",
        "_secret",
        "_kind",
        "WIDTH",
        "DEPTH",
        "CPYTHON",
        "__future__",
        '"int"',
    ],
)
def test_what_nobody_reaches_is_gone(gone: str) -> None:
    assert gone not in linked().text()


def test_public_names_stay() -> None:
    text = linked().text()
    assert "class Thing(" in text and "def found_by_text(" in text and "def by_text(" in text


def test_an_excluded_module_is_an_import_error_where_it_is_needed() -> None:
    program = "import roslet\n\ndef late():\n    from roslet.three import nothing\n    return nothing\n"
    shaker = Shaker(program, TEXTS, excluded=["roslet.three"], roots=["roslet"])
    assert not shaker.reaches("roslet.three")
    scope: dict[str, Any] = {}
    import ast

    exec(compile(ast.unparse(shaker.program).replace("import roslet\n", ""), "program", "exec"), scope)
    with pytest.raises(ImportError, match=r"roslet\.three is not in this bundle"):
        scope["late"]()


def test_a_bound_has_the_value_that_was_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    linker = linked(bounds={"roslet.two": {"WIDTH": 10}})
    assert run(linker, monkeypatch)[0] == "s 26"
