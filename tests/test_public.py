"""The public API: what `roslet` exports is exact, sorted and described."""

from __future__ import annotations

import ast
import importlib
import inspect
import pathlib
from typing import Any

import pytest

import roslet
from roslet import errors

SOURCE = pathlib.Path(roslet.__file__).parent

PUBLIC = [
    "CallTimeout",
    "Client",
    "DefinitionError",
    "Duration",
    "Fault",
    "HandshakeRefused",
    "InvalidMessage",
    "InvalidName",
    "MalformedMessage",
    "Node",
    "NodeClosed",
    "ParameterAlreadyDeclared",
    "ParameterNotDeclared",
    "ParameterNotSet",
    "ParameterReadOnly",
    "ParameterRefused",
    "ParameterUninitialized",
    "ProtocolError",
    "Publisher",
    "QoS",
    "Rate",
    "RawMessage",
    "RecursiveType",
    "RemoteError",
    "RosletError",
    "Service",
    "ServiceFailed",
    "Subscription",
    "Time",
    "Timer",
    "UnknownType",
    "Unreachable",
    "Unsupported",
    "load",
]

# The rooms whose public names are an API as well.
ROOMS = ("roslet.node", "roslet.idl", "roslet.layout", "roslet.gen.runtime")


def test_all_is_exact_and_sorted() -> None:
    assert roslet.__all__ == sorted(roslet.__all__) == PUBLIC


@pytest.mark.parametrize("name", PUBLIC)
def test_a_public_name_is_there_and_has_a_docstring(name: str) -> None:
    value = getattr(roslet, name)
    assert inspect.getdoc(value), f"roslet.{name} has no docstring"


def test_every_exception_is_public() -> None:
    tree = [kind for kind in vars(errors).values() if inspect.isclass(kind)]
    assert sorted(kind.__name__ for kind in tree) == sorted(
        name
        for name in PUBLIC
        if isinstance(getattr(roslet, name), type) and issubclass(getattr(roslet, name), Exception)
    )


def test_dir_lists_what_is_not_imported_yet() -> None:
    assert set(PUBLIC) <= set(dir(roslet))


def test_a_name_that_is_not_public_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="module 'roslet' has no attribute 'nothing'"):
        _ = roslet.nothing


@pytest.mark.parametrize("room", ROOMS)
def test_the_names_of_a_room_are_there_once(room: str) -> None:
    module = importlib.import_module(room)
    assert len(module.__all__) == len(set(module.__all__))
    assert [name for name in module.__all__ if not hasattr(module, name)] == []


def undocumented(kind: Any) -> list[str]:
    """The public methods and properties of a class that have no docstring."""
    found = []
    for name, value in vars(kind).items():
        described = isinstance(value, (property, staticmethod, classmethod)) or inspect.isfunction(value)
        if described and not name.startswith("_") and not inspect.getdoc(getattr(kind, name)):
            found.append(f"{kind.__name__}.{name}")
    return found


CLASSES = [getattr(roslet, name) for name in PUBLIC if inspect.isclass(getattr(roslet, name))]


@pytest.mark.parametrize("kind", CLASSES, ids=lambda kind: kind.__name__)
def test_every_public_method_has_a_docstring(kind: type) -> None:
    assert [
        name for base in kind.__mro__ if base.__module__.startswith("roslet") for name in undocumented(base)
    ] == []


def test_every_module_says_what_it_is() -> None:
    silent = []
    counted = (
        SOURCE / "cli/bench/programs/porting"
    )  # programs whose lines are compared: they hold nothing else
    for path in sorted(set(SOURCE.rglob("*.py")) - set(counted.glob("*.py"))):
        if ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) is None:
            silent.append(path.relative_to(SOURCE).as_posix())
    assert silent == []
