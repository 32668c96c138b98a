"""The ROS 1 dialect, by cases written from http://wiki.ros.org/msg, /srv and actionlib's documentation."""

from __future__ import annotations

import pytest

from roslet.errors import DefinitionError
from roslet.idl import Action, Array, Field, FieldType, Message, Service, TypeName, parse

NAME = TypeName("pkg", "msg", "Thing")


def message(text: str) -> Message:
    parsed = parse(text, NAME, "ros1")
    assert isinstance(parsed, Message)
    return parsed


def only_type(text: str) -> FieldType:
    (field,) = message(text).fields
    return field.type


@pytest.mark.parametrize(
    ("spelled", "primitive"),
    [
        ("bool", "bool"),
        ("int8", "int8"),
        ("uint8", "uint8"),
        ("int16", "int16"),
        ("uint16", "uint16"),
        ("int32", "int32"),
        ("uint32", "uint32"),
        ("int64", "int64"),
        ("uint64", "uint64"),
        ("float32", "float32"),
        ("float64", "float64"),
        ("string", "string"),
        ("time", "time"),
        ("duration", "duration"),
        ("char", "uint8"),
        ("byte", "int8"),
    ],
)
def test_every_primitive_is_known_and_char_is_unsigned_and_byte_signed(spelled: str, primitive: str) -> None:
    assert only_type(f"{spelled} x") == FieldType(primitive, None, spelled)
    assert only_type(f"{spelled}[] x") == FieldType(primitive, None, spelled, None, Array("unbounded"))
    assert only_type(f"{spelled}[7] x") == FieldType(primitive, None, spelled, None, Array("fixed", 7))


def test_wstring_is_a_nested_type_as_ros1_has_no_such_primitive() -> None:
    assert only_type("wstring x").message == TypeName("pkg", "msg", "wstring")


def test_a_bare_header_means_that_of_std_msgs_and_an_array_the_packages_own() -> None:
    assert only_type("Header header").message == TypeName("std_msgs", "msg", "Header")
    assert only_type("std_msgs/Header h").message == TypeName("std_msgs", "msg", "Header")
    assert only_type("Header[] headers").message == TypeName("pkg", "msg", "Header")


def test_nested_names_are_of_the_own_package_unless_one_is_given() -> None:
    assert only_type("Other[3] x") == FieldType(
        None, TypeName("pkg", "msg", "Other"), "Other", None, Array("fixed", 3)
    )
    assert only_type("geometry_msgs/Pose x").message == TypeName("geometry_msgs", "msg", "Pose")
    assert only_type("tfMessage x").message == TypeName("pkg", "msg", "tfMessage")


def test_comments_blank_lines_and_odd_white_space_mean_nothing() -> None:
    text = "# a comment\n\n   \t# another\n  int32\t \tx   # of x\n\nint32 y# of y\r\n#int32 z\n"
    assert message(text).fields == (
        Field("x", FieldType("int32", None, "int32")),
        Field("y", FieldType("int32", None, "int32")),
    )


def test_annotations_in_comments_are_ignored() -> None:
    assert len(message("# @unit(m)\n@\nint32 x # @default(value=5)\n".replace("@\n", "#@\n")).fields) == 1


def test_fields_and_constants_know_their_lines() -> None:
    parsed = message("# one\nint32 x\n\nint32 A=5\nint32 y\n")
    assert [field.line for field in parsed.fields] == [2, 5]
    assert [constant.line for constant in parsed.constants] == [4]


@pytest.mark.parametrize(
    ("line", "value", "text"),
    [
        ("int8 X=-128", -128, "-128"),
        ("byte X=-1", -1, "-1"),
        ("char X=255", 255, "255"),
        ("uint64 X = 18446744073709551615", 18446744073709551615, "18446744073709551615"),
        ("int32 X= +5 # five", 5, "+5"),
        ("float32 X=-1.5e3", -1500.0, "-1.5e3"),
        ("float64 X=1", 1.0, "1"),
        ("bool X=True", True, "True"),
        ("bool X=0", False, "0"),
        ("bool X=2", True, "2"),
    ],
)
def test_a_constant_keeps_its_value_and_its_text(line: str, value: object, text: str) -> None:
    (constant,) = message(line).constants
    assert (constant.name, constant.value, constant.text) == ("X", value, text)
    assert type(constant.value) is type(value)


@pytest.mark.parametrize(
    ("line", "value"),
    [
        ("string X=plain", "plain"),
        ("string X=  two words \t", "two words"),
        ("string X=a # is no comment", "a # is no comment"),
        ('string X="quotes stay"', '"quotes stay"'),
        ("string X==", "="),
        ("string X=", ""),
        ("string X=größe \\n", "größe \\n"),
    ],
)
def test_a_string_constant_is_the_rest_of_the_line_stripped(line: str, value: str) -> None:
    (constant,) = message(line).constants
    assert constant.value == constant.text == value


def test_a_hash_before_the_equals_sign_makes_no_constant() -> None:
    parsed = message("string x # y=z")
    assert [field.name for field in parsed.fields] == ["x"]
    assert parsed.constants == ()


def test_a_fixed_array_may_be_empty() -> None:
    assert only_type("int8[0] x").array == Array("fixed", 0)


@pytest.mark.parametrize(
    ("text", "line", "column", "sentence"),
    [
        ("int32", 1, 6, "expected a name after the type int32"),
        ("\n  int32   # x", 2, 8, "expected a name after the type int32"),
        ("int32 x 5", 1, 9, "expected the end of the line after x: ROS 1 fields have no default values"),
        ("int32 1x", 1, 7, "1x is no field name: field names are made of letters, digits and underscores "),
        ("int32 _x", 1, 7, "_x is no field name"),
        ("int32 x\nint32 y\nfloat32 x", 3, 9, "x is defined twice, first in line 1"),
        ("int32 X=1\nint32 X", 2, 7, "X is defined twice, first in line 1"),
        ("int32 X=0x10", 1, 9, "constant X: '0x10' is no decimal integer"),
        ("int32 X=", 1, 9, "constant X: '' is no decimal integer"),
        ("  int8 X = 128", 1, 12, "constant X: '128' does not fit int8: -128 to 127"),
        ("byte X=128", 1, 8, "constant X: '128' does not fit byte: -128 to 127"),
        ("float32 X=1e39", 1, 11, "constant X: '1e39' does not fit float32"),
        ("float64 X=a", 1, 11, "constant X: 'a' is no number"),
        ("bool X=true", 1, 8, "constant X: 'true' is no bool: True, False or an integer"),
        ("time X=1", 1, 1, "a constant is a number, a bool or a string, not of type time"),
        ("int8[2] X=1", 1, 1, "a constant is a number, a bool or a string, not of type int8[2]"),
        ("Other X=1", 1, 1, "a constant is a number, a bool or a string, not of type Other"),
        ("int32 =1", 1, 7, "=1 is no constant name: the name is missing"),
        ("int32 A B=1", 1, 9, "expected the end of the line after A"),
        ("int32[ x", 1, 6, "int32[: brackets do not match"),
        ("int32] x", 1, 1, "int32]: brackets do not match"),
        ("int32[a] x", 1, 7, "expected a size in decimal digits, not a"),
        ("int32[-1] x", 1, 7, "expected a size in decimal digits, not -1"),
        ("int32[03] x", 1, 7, "a size has no leading zeros"),
        ("int32[4294967296] x", 1, 7, "a size is at least 0 and at most 4294967295"),
        ("int32[2][3] x", 1, 6, "int32[2][3]: arrays have one dimension"),
        ("int32[<=3] x", 1, 7, "ROS 1 has no bounded arrays"),
        ("string<=3 x", 1, 7, "ROS 1 has no bounded strings"),
        ("a/b/C x", 1, 1, "a/b/C is no type name: expected package/Name"),
        ("/C x", 1, 1, "/C is no type name: the package is missing"),
        ("a/ x", 1, 3, "a/ is no type: the name is missing"),
        ("sp€cial x", 1, 1, "sp€cial is no type: type names are made of letters, digits and underscores"),
        ("---", 1, 1, "lines --- belong to .srv and .action files"),
    ],
)
def test_an_error_says_line_column_and_what_is_wrong(
    text: str, line: int, column: int, sentence: str
) -> None:
    with pytest.raises(DefinitionError) as caught:
        parse(text, NAME, "ros1", "Thing.msg")
    error = caught.value
    assert (error.file, error.line, error.column) == ("Thing.msg", line, column)
    assert error.message.startswith(sentence)
    assert str(error).startswith(f"Thing.msg:{line}:{column}: ")


def test_a_wrong_name_of_the_interface_itself_is_refused() -> None:
    with pytest.raises(DefinitionError, match=r"pkg/msg/a-b: type names are made of letters"):
        parse("", TypeName("pkg", "msg", "a-b"), "ros1")
    with pytest.raises(DefinitionError, match=r"1/msg/A: package names are made of letters"):
        parse("", TypeName("1", "msg", "A"), "ros1")


SERVICE = TypeName("pkg", "srv", "Ask")


def service(text: str) -> Service:
    parsed = parse(text, SERVICE, "ros1")
    assert isinstance(parsed, Service)
    return parsed


def test_a_service_has_a_request_and_a_response_with_the_texts_that_genmsg_cuts() -> None:
    parsed = service("int64 a\nint64 A=3\n---\nint64 sum\n")
    assert parsed.request.name == TypeName("pkg", "srv", "AskRequest")
    assert parsed.response.name == TypeName("pkg", "srv", "AskResponse")
    assert [field.name for field in parsed.request.fields] == ["a"]
    assert [constant.name for constant in parsed.request.constants] == ["A"]
    assert [(field.name, field.line) for field in parsed.response.fields] == [("sum", 4)]
    assert parsed.event is None
    assert (parsed.request.text, parsed.response.text) == ("int64 a\nint64 A=3\n", "int64 sum\n\n")


def test_a_service_may_have_empty_parts_and_may_lack_the_separator() -> None:
    assert service("---\n").request.fields == ()
    assert service("---").response.text == ""
    parsed = service("int8 x")
    assert [field.name for field in parsed.request.fields] == ["x"]
    assert parsed.response.fields == ()


def test_later_separators_of_a_service_are_skipped_and_the_response_goes_on() -> None:
    parsed = service("--- \nint8 x\n----\nint8 y\n")
    assert [field.name for field in parsed.response.fields] == ["x", "y"]
    with pytest.raises(DefinitionError, match=r":4:1: x is defined twice, first in line 2"):
        service("---\nint8 x\n---\nint8 x\n")


def test_an_indented_separator_is_an_error() -> None:
    with pytest.raises(DefinitionError, match=r":2:2: the separator is a line that holds ---"):
        service("int8 x\n ---\n")


def test_an_action_has_the_seven_messages_of_actionlib() -> None:
    parsed = parse("int32 goal_\n---\nint32 r\n---\nint32 f\n", TypeName("pkg", "action", "Do"), "ros1")
    assert isinstance(parsed, Action)
    assert [field.name for field in parsed.goal.fields] == ["goal_"]
    found = {
        one.name.name: [(str(field.type.message or field.type), field.name) for field in one.fields]
        for one in parsed.messages
    }
    assert found == {
        "DoAction": [
            ("pkg/msg/DoActionGoal", "action_goal"),
            ("pkg/msg/DoActionResult", "action_result"),
            ("pkg/msg/DoActionFeedback", "action_feedback"),
        ],
        "DoActionGoal": [
            ("std_msgs/msg/Header", "header"),
            ("actionlib_msgs/msg/GoalID", "goal_id"),
            ("pkg/msg/DoGoal", "goal"),
        ],
        "DoActionResult": [
            ("std_msgs/msg/Header", "header"),
            ("actionlib_msgs/msg/GoalStatus", "status"),
            ("pkg/msg/DoResult", "result"),
        ],
        "DoActionFeedback": [
            ("std_msgs/msg/Header", "header"),
            ("actionlib_msgs/msg/GoalStatus", "status"),
            ("pkg/msg/DoFeedback", "feedback"),
        ],
        "DoGoal": [("int32", "goal_")],
        "DoResult": [("int32", "r")],
        "DoFeedback": [("int32", "f")],
    }
    assert {one.name.kind for one in parsed.messages} == {"msg"}
    assert parsed.services == ()


@pytest.mark.parametrize(
    ("text", "place", "sentence"),
    [
        ("int8 a\n", "1:1", "a line --- is missing"),
        ("int8 a\n---\nint8 b\n", "3:1", "a line --- is missing"),
        ("---\n---\n---\n", "3:1", "one line --- too many"),
    ],
)
def test_an_action_needs_exactly_two_separators(text: str, place: str, sentence: str) -> None:
    with pytest.raises(DefinitionError, match=f"f:{place}: {sentence}"):
        parse(text, TypeName("pkg", "action", "Do"), "ros1", "f")
