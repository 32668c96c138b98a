"""A node's parameters. What is expected is what rclpy (Kilted) documents and does, written by hand."""

import array

import pytest

from roslet import errors
from roslet.engine.ros2 import parameters as p
from roslet.engine.ros2.parameters import Descriptor, Parameter, Parameters, type_of
from roslet.errors import InvalidName

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

pytestmark = pytest.mark.micropython


@pytest.mark.parametrize(
    ("value", "kind"),
    [
        (None, p.NOT_SET),
        (True, p.BOOL),
        (1, p.INTEGER),
        (-(1 << 63), p.INTEGER),
        (1.5, p.DOUBLE),
        ("", p.STRING),
        (b"ab", p.BYTE_ARRAY),
        ([b"a", b"b"], p.BYTE_ARRAY),
        ([], p.BYTE_ARRAY),
        ([True], p.BOOL_ARRAY),
        ((1, 2), p.INTEGER_ARRAY),
        ([1.0], p.DOUBLE_ARRAY),
        (["a"], p.STRING_ARRAY),
        (array.array("d", [1.0, 2.0]), p.DOUBLE_ARRAY),
    ],
)
def test_a_value_has_a_type(value: "Any", kind: int) -> None:
    assert type_of(value) == kind
    assert Parameter("a", value).type == kind


@pytest.mark.parametrize("value", [1 << 63, {}, [1, 1.0], [1, True], [None], [[1]], [b"ab"], object()])
def test_other_values_are_refused(value: "Any") -> None:
    with pytest.raises(TypeError):
        type_of(value)


def test_a_parameter_keeps_its_own_copy_and_agrees_with_its_type() -> None:
    given = [1, 2]
    found = Parameter("a", given)
    given.append(3)
    assert found.value == [1, 2]
    assert Parameter("a", [b"x", b"y"]).value == b"xy"
    assert Parameter("a", [], p.STRING_ARRAY) == Parameter("a", (), p.STRING_ARRAY)
    assert Parameter("a", []).value == b""
    for value, kind in ((1, p.DOUBLE), (None, p.BOOL), ([], p.STRING), (True, p.INTEGER)):
        with pytest.raises(TypeError):
            Parameter("a", value, kind)


def test_declaring_gives_value_type_and_override() -> None:
    store = Parameters({"b": 5, "c": "wrong", "e": []})
    assert store.declare("a", 1).value == 1
    assert store.declare("b", 1).value == 5
    assert store.get("b").value == 5
    assert store.declare("b2", ["x"], p.STRING_ARRAY).value == ["x"]
    with pytest.raises(errors.ParameterRefused, match="its type is integer, not string") as raised:
        store.declare("c", 1)
    assert raised.value.wrong_type
    assert not store.has("c")
    assert store.declare("c", 1, ignore_override=True).value == 1
    assert store.declare("e", [1.0]) == Parameter("e", [], p.DOUBLE_ARRAY)
    with pytest.raises(errors.ParameterAlreadyDeclared):
        store.declare("a", 2)
    with pytest.raises(InvalidName):
        store.declare("", 1)
    with pytest.raises(ValueError):
        store.declare("n")
    with pytest.raises(ValueError):
        store.declare("n", None, p.BOOL, Descriptor(dynamic_typing=True))
    with pytest.raises(TypeError):
        store.declare("n", 1, p.BOOL)


def test_a_type_alone_leaves_it_uninitialized_until_it_is_set() -> None:
    store = Parameters()
    store.declare("a", type=p.DOUBLE)
    with pytest.raises(errors.ParameterUninitialized):
        store.get("a")
    assert store.get_or("a", 7) == 7
    assert store.get_type("a") == p.NOT_SET
    assert store.describe("a").type == p.DOUBLE
    assert store.set([Parameter("a", "x"), Parameter("a", 2.0)]) == [
        (False, "a: its type is double, not string"),
        (True, ""),
    ]
    assert store.get("a").value == 2.0


def test_what_was_not_declared_is_refused_or_declared_as_it_comes() -> None:
    store = Parameters()
    store.declare("a", 1)
    for ask in (store.get, store.get_type, store.describe, store.undeclare):
        with pytest.raises(errors.ParameterNotDeclared):
            ask("x")
    with pytest.raises(errors.ParameterNotDeclared, match="x, y"):
        store.set_atomically([Parameter("a", 2), Parameter("x", 1), Parameter("y", 1)])
    assert store.get("a").value == 1
    store.allow_undeclared = True
    assert store.get("x") == Parameter("x")
    assert store.get_type("x") == p.NOT_SET
    assert store.describe("x") == Descriptor("x")
    assert store.set_atomically([Parameter("x", 1)]) == (True, "")
    assert store.set_atomically([Parameter("x", "other type")]) == (True, "")
    assert store.describe("x") == Descriptor("x", p.STRING, dynamic_typing=True)
    assert store.set_atomically([Parameter("x")]) == (True, "")
    assert not store.has("x")
    assert store.set_atomically([Parameter("a")]) == (
        False,
        "a: it has a fixed type and cannot be undeclared",
    )


def test_undeclared_parameters_are_bounded() -> None:
    store = Parameters(allow_undeclared=True)
    for number in range(p.MAX_UNDECLARED):
        store.set([Parameter("p%d" % number, 1)])
    assert store.set([Parameter("more", 1)])[0][0] is False
    assert store.set([Parameter("p1", 2)]) == [(True, "")]


def test_read_only_parameters_stay() -> None:
    store = Parameters()
    store.declare("a", 1, descriptor=Descriptor(read_only=True, description="d", constraints="c"))
    assert store.set([Parameter("a", 2)]) == [(False, "a: it is read-only")]
    with pytest.raises(errors.ParameterReadOnly):
        store.undeclare("a")
    with pytest.raises(errors.ParameterReadOnly):
        store.set_descriptor("a", Descriptor())
    assert store.describe("a") == Descriptor("a", p.INTEGER, "d", "c", True)
    store.declare("b", 1)
    store.undeclare("b")
    assert store.names() == ["a"]


@pytest.mark.parametrize(
    ("value", "right"),
    [(0, True), (3, True), (10, True), (9, True), (11, False), (-1, False), (4, False), (1 << 62, False)],
)
def test_integers_stay_in_their_range_and_on_its_steps(value: int, right: bool) -> None:
    for ends in ((0, 10), (10, 0)):
        store = Parameters()
        store.declare("a", 0, descriptor=Descriptor(integer_range=(ends[0], ends[1], 3)))
        assert store.set([Parameter("a", value)])[0][0] is right


@pytest.mark.parametrize(
    ("value", "right"),
    [
        (0.0, True),
        (0.3, True),
        (0.1 + 0.2, True),
        (1.0000001, True),
        (0.25, False),
        (1.01, False),
        (-0.1, False),
        (float("nan"), False),
        (float("inf"), False),
    ],
)
def test_doubles_stay_in_their_range_and_near_its_steps(value: float, right: bool) -> None:
    store = Parameters()
    store.declare("a", 0.5, descriptor=Descriptor(floating_point_range=(0.0, 1.0, 0.1)))
    assert store.set([Parameter("a", value)])[0][0] is right


def test_a_range_without_ends_and_a_step_without_size_are_no_trouble() -> None:
    store = Parameters()
    infinite = float("inf")
    store.declare("a", 0.0, descriptor=Descriptor(floating_point_range=(-infinite, infinite, 1.0)))
    store.declare("b", 0.0, descriptor=Descriptor(floating_point_range=(0.0, 1e30, 1e-30)))
    assert (
        store.set([Parameter("a", 0.5), Parameter("b", 1e29), Parameter("a", infinite)]) == [(True, "")] * 3
    )


def test_all_are_set_or_none() -> None:
    store = Parameters()
    store.declare("a", 1)
    store.declare("b", "x")
    assert store.set_atomically([Parameter("a", 2), Parameter("b", 3)]) == (
        False,
        "b: its type is string, not integer",
    )
    assert store.get("a").value == 1
    assert store.set_atomically([Parameter("a", 2), Parameter("b", "y")]) == (True, "")
    assert (store.get("a").value, store.get("b").value) == (2, "y")


def test_callbacks_choose_refuse_and_hear() -> None:
    told: list[Any] = []
    store = Parameters(on_change=lambda change: told.append(change))
    store.declare("a", 1)
    assert told.pop() == p.Change([Parameter("a", 1)], [], [])
    store.add_on_set(lambda given: (given[0].value != 13, "unlucky"))
    store.add_on_set(lambda given: (given[0].value != 0, ""))
    store.add_post_set(lambda given: told.append([one.value for one in given]))
    assert store.set([Parameter("a", 13), Parameter("a", 0), Parameter("a", 2)]) == [
        (False, "unlucky"),
        (False, "a callback of the node refused it"),
        (True, ""),
    ]
    assert told == [p.Change([], [Parameter("a", 2)], []), [2]]
    told.clear()

    def twice(given: "list[Parameter]") -> "list[Parameter]":
        return given + [Parameter("b", 2 * given[0].value)]  # noqa: RUF005 - as MicroPython compiles it

    store.declare("b", 1)
    told.clear()
    store.add_pre_set(twice)
    assert store.set_atomically([Parameter("a", 5)]) == (True, "")
    assert (store.get("a").value, store.get("b").value) == (5, 10)
    assert told[-1] == [5, 10]
    store.remove_pre_set(twice)

    def nothing(given: "list[Parameter]") -> "list[Parameter]":
        return []

    store.add_pre_set(nothing)
    assert store.set_atomically([Parameter("a", 5)])[0] is False
    store.remove_pre_set(nothing)
    with pytest.raises(ValueError):
        store.remove_on_set(lambda given: (True, ""))
    with pytest.raises(errors.ParameterRefused, match="c: unlucky"):
        store.declare("c", 13)
    assert not store.has("c")


def test_a_deletion_is_told() -> None:
    told: list[Any] = []
    store = Parameters(on_change=told.append)
    store.declare("a", 1, descriptor=Descriptor(dynamic_typing=True))
    store.set([Parameter("a")])
    assert told[-1] == p.Change([], [], [Parameter("a")])


def test_names_are_listed_by_prefix_and_depth() -> None:
    store = Parameters()
    for name in ("use_sim_time", "a.b.c", "a.d", "ab.c", "z.y.x.w"):
        store.declare(name, 1)
    assert store.list_parameters() == (
        ["use_sim_time", "a.b.c", "a.d", "ab.c", "z.y.x.w"],
        ["a.b", "a", "ab", "z.y.x"],
    )
    assert store.list_parameters(depth=1) == (["use_sim_time"], [])
    assert store.list_parameters(depth=2)[0] == ["use_sim_time", "a.d", "ab.c"]
    assert store.list_parameters(["a"]) == (["a.b.c", "a.d"], ["a.b", "a"])
    assert store.list_parameters(["a"], 1) == (["a.d"], ["a"])
    assert store.list_parameters(["a.d", "z.y"], 1)[0] == ["a.d"]
    assert store.list_parameters(["a.d", "z.y"], 2)[0] == ["a.d", "z.y.x.w"]
    with pytest.raises(ValueError):
        store.list_parameters([], -1)


def test_a_new_descriptor_keeps_the_value_or_takes_another() -> None:
    store = Parameters()
    store.declare("a", 5)
    assert store.set_descriptor("a", Descriptor(integer_range=(0, 10, 1))).value == 5
    with pytest.raises(errors.ParameterRefused, match="5 is out of range: from 0 to 3"):
        store.set_descriptor("a", Descriptor(integer_range=(0, 3, 1)))
    assert store.set_descriptor("a", Descriptor(integer_range=(0, 3, 1)), 2).value == 2
    assert store.describe("a").integer_range == (0, 3, 1)
    assert store.set([Parameter("a", 4)])[0][0] is False
