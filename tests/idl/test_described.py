"""A definition made of a type description is the type again: its hash, and so its layout, are the same."""

from __future__ import annotations

import copy

import pytest

from roslet.errors import DefinitionError
from roslet.idl import ROS2, Registry
from roslet.idl.described import MAX_TYPES, definition_text
from roslet.idl.rihs import type_description, type_hash

BUNDLED = Registry(ROS2, {})


def test_every_bundled_message_survives_its_description() -> None:
    names = BUNDLED.names("msg")
    assert len(names) > 150
    for name in names:
        text = definition_text(type_description(BUNDLED, name))
        again = Registry(ROS2, {})
        again.load_full_text(name, text)
        assert type_hash(again, name) == type_hash(BUNDLED, name), f"{name}:\n{text}"


def test_a_description_is_spelled_as_a_definition() -> None:
    text = definition_text(type_description(BUNDLED, "geometry_msgs/msg/PointStamped"))
    assert text.splitlines()[:4] == [
        "std_msgs/Header header",
        "geometry_msgs/Point point",
        "=" * 80,
        "MSG: builtin_interfaces/msg/Time",
    ]


@pytest.mark.parametrize("number", [0, 12, 14, 19, 48, 60, 146 + 48, 255])
def test_a_type_id_without_spelling_is_refused(number: int) -> None:
    description = type_description(BUNDLED, "std_msgs/msg/Int8")
    description["type_description"]["fields"][0]["type"]["type_id"] = number
    with pytest.raises(DefinitionError, match=f"type id {number}"):
        definition_text(description)


@pytest.mark.parametrize("place", ["name", "nested_type_name", "type_name"])
def test_a_name_of_several_lines_adds_no_lines_to_the_definition(place: str) -> None:
    description = copy.deepcopy(type_description(BUNDLED, "std_msgs/msg/Header"))
    field = description["type_description"]["fields"][0]
    target = {
        "name": field,
        "nested_type_name": field["type"],
        "type_name": description["referenced_type_descriptions"][0],
    }[place]
    target[place] += "\nint8 smuggled"
    with pytest.raises(DefinitionError, match="is no name"):
        definition_text(description)


def test_a_description_of_too_many_types_is_refused() -> None:
    description = type_description(BUNDLED, "std_msgs/msg/Header")
    description["referenced_type_descriptions"] *= MAX_TYPES + 1
    with pytest.raises(DefinitionError, match="1001 types"):
        definition_text(description)
