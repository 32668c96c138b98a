"""Our store of parameters and that of rclpy's Node give the same results to the same operations."""

from __future__ import annotations

import json
import pathlib
from typing import Any

import pytest

import peers
from interop.namespace import Namespace
from roslet import errors
from roslet.engine.ros2.parameters import Descriptor, Parameter, Parameters
from roslet.errors import InvalidName

RANGED = {"integer_range": [0, 10, 3]}
FLOATING = {"floating_point_range": [0.0, 1.0, 0.1]}
VALUES: list[Any] = [None, True, 3, 2.5, "text", [True], [1, 2], [1.5], ["a", "b"]]

OPERATIONS: list[list[Any]] = [
    *[["declare", f"kind{number}", value, 0, {}] for number, value in enumerate(VALUES)],
    *[["set", [[f"kind{number}", value] for value in VALUES]] for number in range(1, len(VALUES))],
    *[["get", f"kind{number}"] for number in range(len(VALUES))],
    ["declare", "kind1", False, 0, {}],
    ["declare", "typed", None, 3, {}],
    ["get", "typed"],
    ["describe", "typed"],
    ["set", [["typed", 1], ["typed", 1.0], ["typed", None]]],
    ["get", "typed"],
    ["declare", "any", None, 0, {"dynamic_typing": True}],
    ["get", "any"],
    ["set", [["any", 1], ["any", "x"]]],
    ["describe", "any"],
    ["declare", "both", None, 1, {"dynamic_typing": True}],
    ["set", [["any", None]]],
    ["get", "any"],
    ["declare", "fixed", 1, 0, {"read_only": True, "description": "d", "additional_constraints": "c"}],
    ["set", [["fixed", 2]]],
    ["undeclare", "fixed"],
    ["describe", "fixed"],
    ["declare", "ranged", 3, 0, RANGED],
    ["set", [["ranged", value] for value in (-1, 0, 1, 3, 9, 10, 11)]],
    ["declare", "outside", 4, 0, RANGED],
    ["declare", "floating", 0.5, 0, FLOATING],
    ["set", [["floating", value] for value in (-0.1, 0.0, 0.05, 0.3, 1.0, 1.0000001, 1.1)]],
    ["declare", "over", 1, 0, {}],
    ["declare", "wrongly", 1, 0, {}],
    ["get", "over"],
    ["get", "absent"],
    ["undeclare", "absent"],
    ["describe", "absent"],
    ["set", [["absent", 1]]],
    ["get", "absent"],
    ["atomically", [["kind2", 7], ["kind3", "wrong"]]],
    ["get", "kind2"],
    ["atomically", [["kind2", 7], ["kind3", 7.5]]],
    ["get", "kind2"],
    ["undeclare", "kind2"],
    ["get", "kind2"],
    *[["declare", name, 1, 0, {}] for name in ("a.b.c", "a.d", "ab.c", "z.y.x.w", "")],
    *[
        ["list", prefixes, depth]
        for prefixes in ([], ["a"], ["a", "z.y"], ["a.d"], ["q"])
        for depth in (0, 1, 2)
    ],
    ["list", [], -1],
]
OVERRIDES: dict[str, Any] = {"over": 5, "wrongly": "text", "never": 1}
ERRORS = {
    errors.ParameterNotDeclared: "ParameterNotDeclaredException",
    errors.ParameterUninitialized: "ParameterUninitializedException",
    errors.ParameterAlreadyDeclared: "ParameterAlreadyDeclaredException",
    errors.ParameterReadOnly: "ParameterImmutableException",
    InvalidName: "InvalidParameterException",
    ValueError: "ValueError",
    TypeError: "TypeError",
}


def plain(parameter: Parameter) -> list[Any]:
    return [parameter.type, parameter.value]


def run(store: Parameters, operation: list[Any]) -> Any:
    what, *rest = operation
    if what == "declare":
        name, value, kind, fields = rest
        fields = {("constraints" if key == "additional_constraints" else key): fields[key] for key in fields}
        return plain(store.declare(name, value, kind, Descriptor(name, **fields)))
    if what == "set":
        return [one[0] for one in store.set([Parameter(*pair) for pair in rest[0]])]
    if what == "atomically":
        return store.set_atomically([Parameter(*pair) for pair in rest[0]])[0]
    if what == "get":
        return plain(store.get(rest[0]))
    if what == "undeclare":
        return store.undeclare(rest[0])
    if what == "list":
        return [sorted(found) for found in store.list_parameters(*rest)]
    found = store.describe(rest[0])
    return [found.type, found.description, found.constraints, found.read_only, found.dynamic_typing]


def ours(store: Parameters, operation: list[Any]) -> Any:
    try:
        return run(store, operation)
    except errors.ParameterRefused as error:
        return "InvalidParameterTypeException" if error.wrong_type else "InvalidParameterValueException"
    except tuple(ERRORS) as error:
        return ERRORS[type(error)]


@pytest.mark.parametrize("peer", ["kilted", "jazzy"])
@pytest.mark.parametrize("undeclared", [False, True])
def test_each_operation_gives_what_it_gives_in_rclpy(
    tmp_path: pathlib.Path, undeclared: bool, peer: str
) -> None:
    given = {"overrides": OVERRIDES, "undeclared": undeclared, "operations": OPERATIONS}
    (tmp_path / "given").write_text(json.dumps(given))
    program = str(peers.ROOT / "tests/interop/peers/rclpy_parameters.py")
    with Namespace(tmp_path) as namespace:
        command = f"exec {peers.require(peer)} {program} < {tmp_path / 'given'}"
        theirs = json.loads("\n".join(namespace.start("sh", "-c", command, name="parameters").finish(60)))
    store = Parameters(OVERRIDES, undeclared)
    different = []
    for operation, their in zip(OPERATIONS, theirs, strict=True):
        mine = ours(store, operation)
        if mine != their:
            different.append(f"{operation}: ours {mine}, theirs {their}")
    assert not different, "\n".join(different)
