"""Layouts worked out by hand, and sizes against what messages really take."""

from __future__ import annotations

import random
from typing import Any

import pytest

from random_values import STYLES, Values, fill
from roslet.gen import runtime
from roslet.idl import Registry, parse
from roslet.idl.records import Message, TypeName
from roslet.layout import CDR, ROS1, Numbers, Octets, Run, Sequence, Slot, Text, layout
from roslet.layout.flatten import join


def message(text: str, dialect: Any = "ros2") -> Message:
    parsed = parse(text, TypeName("pkg", "msg", "Thing"), dialect)
    assert isinstance(parsed, Message)
    return parsed


def laid_out(text: str, encoding: Any = CDR) -> Any:
    dialect: Any = "ros1" if encoding == ROS1 else "ros2"
    return layout(message(text, dialect), Registry(dialect, None).message, encoding)


def test_fixed_fields_are_one_run_with_padding_inside() -> None:
    made = laid_out("uint8 a\nfloat64 b\nbool c\nuint16 d\n")
    slots = (
        Slot(0, "uint8", ("a",)),
        Slot(8, "float64", ("b",)),
        Slot(16, "bool", ("c",)),
        Slot(18, "uint16", ("d",)),
    )
    assert made.operations == (Run(1, 20, slots),)
    assert (made.minimum, made.maximum, made.fixed) == (20, 20, 20)


def test_ros1_has_no_padding() -> None:
    made = laid_out("uint8 a\nfloat64 b\n", ROS1)
    assert made.operations == (Run(1, 9, (Slot(0, "uint8", ("a",)), Slot(1, "float64", ("b",)))),)


def test_nested_messages_and_fixed_arrays_join_the_run() -> None:
    made = laid_out("geometry_msgs/Point p\nfloat32[3] v\nuint8[2] w\n")
    (run,) = made.operations
    assert run.size == 24 + 12 + 2
    assert [slot.path for slot in run.slots] == [("p", "x"), ("p", "y"), ("p", "z"), ("v",), ("w",)]
    assert made.structs == ((("p",), TypeName("geometry_msgs", "msg", "Point")),)


def test_a_run_carries_the_length_of_the_string_behind_it() -> None:
    made = laid_out("uint16 a\nstring s\n")
    count = Slot(4, "uint32", ("s",), None, "count")
    assert made.operations == (Run(1, 8, (Slot(0, "uint16", ("a",)), count)), Text(("s",), None, False, 1))


def test_after_a_string_alignment_is_done_at_run_time_and_then_known() -> None:
    made = laid_out("string s\nuint32 a\nuint16 b\nuint32 c\nfloat64 d\nuint8 e\nfloat64 f\n")
    runs = [operation for operation in made.operations if isinstance(operation, Run)]
    assert [(run.align, run.size) for run in runs] == [(1, 4), (4, 12), (8, 24)]
    assert [slot.offset for slot in runs[2].slots] == [0, 8, 16]


def test_ros1_strings_break_runs_without_alignment() -> None:
    made = laid_out("string s\nfloat64 a\n", ROS1)
    assert [type(operation) for operation in made.operations] == [Run, Text, Run]
    assert made.operations[2].align == 1


def test_an_empty_ros2_message_is_a_dummy_byte_and_an_empty_ros1_message_nothing() -> None:
    assert laid_out("").operations == (Run(1, 1, (Slot(0, "uint8", (), None, "dummy"),)),)
    assert laid_out("", ROS1).operations == ()


def test_numbers_know_their_padding_where_the_position_is_known() -> None:
    made = laid_out("float64[] a\n")
    assert made.operations[1] == Numbers(("a",), "float64", None, 1, 4)
    behind = laid_out("string s\nfloat64[] a\n")
    assert behind.operations[3] == Numbers(("a",), "float64", None, 8, 0)


def test_after_numbers_that_may_be_absent_only_the_common_alignment_is_known() -> None:
    made = laid_out("float64[] a\nuint32 b\nfloat64 c\n")
    runs = [operation for operation in made.operations if isinstance(operation, Run)]
    assert [run.align for run in runs] == [1, 1, 8]


def test_bytes_leave_nothing_known() -> None:
    made = laid_out("uint8[<=5] a\nuint16 b\n")
    assert made.operations[1:] == (Octets(("a",), 5), Run(2, 2, (Slot(0, "uint16", ("b",)),)))
    assert (made.minimum, made.maximum) == (6, 12)


def test_a_sequence_keeps_what_holds_before_and_after_its_body() -> None:
    made = laid_out("geometry_msgs/Point32[] points\nuint32 a\n")
    sequence = made.operations[1]
    assert isinstance(sequence, Sequence)
    assert sequence.element.fixed == 12
    (run,) = sequence.element.operations
    assert isinstance(run, Run) and run.align == 1
    assert made.operations[2].align == 1


def test_a_sequence_of_strings_aligns_in_every_round() -> None:
    made = laid_out("string[<=2] names\n")
    sequence = made.operations[1]
    assert sequence.element.operations[0].align == 4
    assert (sequence.kind, sequence.size) == ("bounded", 2)


def test_a_ros1_time_is_two_integers_and_a_struct() -> None:
    made = laid_out("time t\nduration d\n", ROS1)
    assert [slot.primitive for slot in made.operations[0].slots] == ["uint32", "uint32", "int32", "int32"]
    assert made.structs == ((("t",), "time"), (("d",), "duration"))


@pytest.mark.parametrize(
    ("text", "minimum", "maximum"),
    [
        ("string<=3 s\nfloat64 a\n", 16, 16),
        ("string<=4 s\nfloat64 a\n", 16, 24),
        ("string s\n", 5, None),
        ("wstring<=3 s\n", 4, 16),
        ("float64[<=2] a\nuint8 b\n", 5, 25),
        ("string<=2[<=3] s\nuint8 b\n", 5, 4 + 7 + 1 + 7 + 1 + 7 + 1),
        ("geometry_msgs/Point[3] p\n", 72, 72),
        ("string[2] s\n", 5 + 3 + 5, None),
        ("uint8 a\ngeometry_msgs/Point[<=1000000] p\n", 8, 8 + 24_000_000),
    ],
)
def test_sizes_are_exact(text: str, minimum: int, maximum: int | None) -> None:
    made = laid_out(text)
    assert (made.minimum, made.maximum) == (minimum, maximum)


def test_join_is_the_weakest_common_knowledge() -> None:
    assert join((8, 4), (8, 0)) == (4, 0)
    assert join((8, 4), (4, 0)) == (4, 0)
    assert join((8, 5), (8, 5)) == (8, 5)
    assert join((8, 5), (8, 4)) == (1, 0)


@pytest.mark.parametrize("dialect", ["ros1", "ros2"])
def test_every_bundled_message_is_within_its_sizes(dialect: Any) -> None:
    registry = runtime.registry(dialect)
    seen = 0
    for name in registry.names("msg"):
        kind = runtime.message_class(dialect, name)
        for seed, style in enumerate(STYLES):
            value = Values(registry.message, seed, style).message(registry.message(name))
            size = fill(kind, value).serialized_size()
            assert kind._minimum_size <= size, (name, seed, style)
            assert kind._maximum_size is None or size <= kind._maximum_size, (name, seed, style)
            if style == "empty":
                assert size == kind._minimum_size, name
            if kind._fixed_size is not None:
                assert size == kind._fixed_size, name
            seen += 1
    assert seen > 500


def test_random_definitions_have_the_sizes_of_their_longest_messages() -> None:
    from definitions import classes

    chooser = random.Random(2)
    parts = [
        "uint8",
        "uint16",
        "uint32",
        "float64",
        "string<=5",
        "float32[<=3]",
        "uint8[<=3]",
        "string<=2[<=2]",
    ]
    for _ in range(60):
        fields = [f"{chooser.choice(parts)} f{at}\n" for at in range(chooser.randint(1, 7))]
        with classes("ros2", {"pkg/Thing": "".join(fields)}) as (kind,):
            registry = runtime.registry("ros2")
            value = Values(registry.message, 0, "maximal").message(registry.message("pkg/Thing"))
            assert fill(kind, value).serialized_size() == kind._maximum_size, fields
