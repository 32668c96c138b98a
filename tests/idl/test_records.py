"""The records' value semantics and what importing the room costs."""

from __future__ import annotations

import copy
import pickle
import subprocess
import sys

import pytest

import peers
import roslet.idl
from roslet.idl import Array, Constant, Field, FieldType, Message, Service, TypeName, parse

INT8 = FieldType("int8", None, "int8")
NAME = TypeName("pkg", "msg", "Thing")


def test_type_names_are_equal_hashed_and_ordered_by_package_kind_and_name() -> None:
    names = [
        TypeName("b", "msg", "A"),
        TypeName("a", "srv", "A"),
        TypeName("a", "msg", "B"),
        TypeName("a", "msg", "A"),
    ]
    assert sorted(names) == names[::-1]
    assert max(names) >= names[0] > names[1] >= min(names) <= names[3]
    assert TypeName("a", "msg", "A") == names[3]
    assert len({*names, TypeName("a", "msg", "A")}) == 4
    assert names[3] != ("a", "msg", "A")


def test_where_a_thing_stands_is_no_part_of_what_it_is() -> None:
    assert Field("x", INT8, 3, line=1) == Field("x", INT8, 3, line=2)
    assert hash(Field("x", INT8, 3, line=1)) == hash(Field("x", INT8, 3, line=2))
    assert Field("x", INT8) != Field("x", INT8, 3)
    assert Constant("X", INT8, 3, "3", line=1) == Constant("X", INT8, 3, "3", line=2)
    assert hash(Constant("X", INT8, 3, "3", line=1)) == hash(Constant("X", INT8, 3, "3", line=2))
    assert Constant("X", INT8, 3, "3") != Constant("X", INT8, 3, "+3")
    one, other = parse("int8 x\n", NAME, "ros1", "a"), parse("# c\nint8 x\n", NAME, "ros1", "b")
    assert one == other
    assert hash(one) == hash(other)
    assert one != parse("int8 x\n", NAME, "ros2", "a")
    assert one != parse("int8 y\n", NAME, "ros1", "a")


def test_records_show_replace_copy_and_pickle() -> None:
    message = parse("int8[<=3] x [1]\nstring S=a\n", NAME, "ros2", "f")
    assert isinstance(message, Message)
    assert repr(Array("fixed", 3)) == "Array(kind='fixed', size=3)"
    assert message.replace(dialect="ros1") != message
    for same in (copy.deepcopy(message), pickle.loads(pickle.dumps(message)), message.replace()):
        assert same == message
        assert (same.text, same.file) == (message.text, "f")
    with pytest.raises(TypeError, match="Field has no field size"):
        message.fields[0].replace(size=3)


@pytest.mark.parametrize(
    ("record", "text"),
    [
        (INT8, "int8"),
        (FieldType("string", None, "string", 5, Array("unbounded")), "string<=5[]"),
        (FieldType("uint8", None, "char", None, Array("fixed", 0)), "char[0]"),
        (FieldType(None, NAME, "pkg/Thing", None, Array("bounded", 3)), "pkg/Thing[<=3]"),
    ],
)
def test_a_field_type_prints_as_a_definition_spells_it(record: FieldType, text: str) -> None:
    assert str(record) == text


def test_the_parts_of_a_service_are_messages_of_its_file() -> None:
    service = parse("---\n", TypeName("pkg", "srv", "Ask"), "ros2", "f")
    assert isinstance(service, Service)
    assert (service.text, service.file, service.response.file) == ("---\n", "f", "f")


def test_the_public_names_are_exact_and_sorted() -> None:
    public = roslet.idl.__all__
    assert public == sorted(public, key=lambda name: (not name.isupper(), name[0].islower(), name))
    assert all(hasattr(roslet.idl, name) for name in public)


def test_importing_the_room_imports_nothing_costly() -> None:
    script = (
        "import sys; sys.path.insert(0, sys.argv[1]); import roslet.idl.records, roslet.idl; "
        "print(*sorted({'dataclasses', 'inspect', 're', 'json', 'hashlib', 'pathlib', 'enum'} & set(sys.modules)))"
    )
    command = [sys.executable, "-I", "-S", "-c", script, str(peers.ROOT / "src")]
    ran = subprocess.run(command, capture_output=True, text=True, check=True)
    assert ran.stdout == "\n"
