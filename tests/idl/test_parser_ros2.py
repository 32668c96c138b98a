"""The ROS 2 dialect, by cases written from the interface pages of its documentation and REP-2012's events."""

from __future__ import annotations

import pytest

from roslet.errors import DefinitionError
from roslet.idl import Action, Array, Field, FieldType, Message, Service, TypeName, parse

NAME = TypeName("pkg", "msg", "Thing")


def message(text: str) -> Message:
    parsed = parse(text, NAME, "ros2")
    assert isinstance(parsed, Message)
    return parsed


def only_field(text: str) -> Field:
    (field,) = message(text).fields
    return field


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("time t", "Time"),
        ("duration t", "Duration"),
        ("time[] t", "Time"),
        ("time[3] t", "Time"),
        ("duration[<=3] t", "Duration"),
    ],
)
def test_the_times_of_ros_1_are_those_of_builtin_interfaces(text: str, name: str) -> None:
    theirs = only_field("builtin_interfaces/" + name + text.split()[0].removeprefix(name.lower()) + " t")
    ours = only_field(text)
    assert ours.type.message == TypeName("builtin_interfaces", "msg", name) == theirs.type.message
    assert (ours.type.primitive, ours.type.array) == (None, theirs.type.array)


def test_a_constant_is_no_time() -> None:
    with pytest.raises(DefinitionError, match="a constant is a number, a bool or a string, not of type time"):
        message("time T=1")


def test_a_bare_header_is_that_of_std_msgs_where_the_package_has_none() -> None:
    own, standard = TypeName("pkg", "msg", "Header"), TypeName("std_msgs", "msg", "Header")
    assert only_field("Header header").type.message == own
    for text, expected in (("Header header", standard), ("Header[] header", own), ("other/Header h", None)):
        parsed = parse(text, NAME, "ros2", own_header=False)
        assert isinstance(parsed, Message)
        assert parsed.fields[0].type.message == (expected or TypeName("other", "msg", "Header"))


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
        ("wstring", "wstring"),
        ("char", "uint8"),
        ("byte", "uint8"),
    ],
)
def test_every_primitive_is_known_in_every_kind_of_array(spelled: str, primitive: str) -> None:
    for brackets, array in [
        ("", None),
        ("[]", Array("unbounded")),
        ("[7]", Array("fixed", 7)),
        ("[<=7]", Array("bounded", 7)),
    ]:
        assert only_field(f"{spelled}{brackets} x").type == FieldType(primitive, None, spelled, None, array)


def test_strings_may_be_bounded_also_in_arrays() -> None:
    assert only_field("string<=5 x").type == FieldType("string", None, "string", 5)
    expected = FieldType("wstring", None, "wstring", 5, Array("bounded", 10))
    assert only_field("wstring<=5[<=10] x").type == expected
    assert str(expected) == "wstring<=5[<=10]"


def test_nested_names_are_of_the_own_package_unless_one_is_given() -> None:
    assert only_field("Header h").type.message == TypeName("pkg", "msg", "Header")
    assert only_field("std_msgs/Header[<=2] h").type == FieldType(
        None, TypeName("std_msgs", "msg", "Header"), "std_msgs/Header", None, Array("bounded", 2)
    )


def test_comments_blank_lines_and_odd_white_space_mean_nothing() -> None:
    text = "# @verbatim (language=)\n  \t# x\n\n\tint32  \tx  7 # seven\r\n\nstring s 'a' # 'b'\n# end"
    assert message(text).fields == (
        Field("x", FieldType("int32", None, "int32"), 7),
        Field("s", FieldType("string", None, "string"), "a"),
    )


@pytest.mark.parametrize(
    ("line", "value"),
    [
        ("bool x true", True),
        ("bool x FALSE", False),
        ("bool x 1", True),
        ("int8 x -128", -128),
        ("uint8 x 0xFF", 255),
        ("int64 x -0b11", -3),
        ("uint16 x 0o17", 15),
        ("char x 65", 65),
        ("byte x 255", 255),
        ("float32 x 1e-3", 0.001),
        ("float64 x -inf", float("-inf")),
        ("string x plain words", "plain words"),
        ('string x "  kept  "', "  kept  "),
        ("string x 'it\\'s'", "it's"),
        ('string x "say \\"a\\""', 'say "a"'),
        ('string x "a=b"', "a=b"),
        ("string x don't", "don't"),
        ('string x ""', ""),
        ('string x "\\t\\x41\\u00e9\\101\\\\"', "\tAéA\\"),
        ("string x a\\qb\\", "a\\qb\\"),
        ("wstring x 'größe'", "größe"),
        ("string<=3 x abc", "abc"),
        ("int32[] x []", ()),
        ("int32[] x [ 1,2 , 0x3 ]", (1, 2, 3)),
        ("int32[2] x [1, 2]", (1, 2)),
        ("float64[<=3] x [1, 2.5]", (1.0, 2.5)),
        ("bool[2] x [true, 0]", (True, False)),
        ('string[] x ["a, b", \'c\', d e , "f\\"g"]', ("a, b", "c", "d e", 'f"g')),
        ("string<=2[<=2] x ['ab', c]", ("ab", "c")),
        ("string[] x ['a',]", ("a",)),
    ],
)
def test_a_default_is_read_as_the_fields_type_says(line: str, value: object) -> None:
    field = only_field(line)
    assert field.default == value
    assert type(field.default) is type(value)


@pytest.mark.parametrize(
    ("line", "value", "text"),
    [
        ("int32 X=-5", -5, "-5"),
        ("int32 X = 0x10 # sixteen", 16, "0x10"),
        ("uint8 LONG_NAME_2=255", 255, "255"),
        ("byte X=255", 255, "255"),
        ("bool X=true", True, "true"),
        ("float32 X=3.5", 3.5, "3.5"),
        ("string X=plain words", "plain words", "plain words"),
        ('string X="quoted" # comment', "quoted", '"quoted"'),
        ("string X=a # no part of it", "a", "a"),
        ("wstring X='ü'", "ü", "'ü'"),
        ("string X=a=b", "a=b", "a=b"),
    ],
)
def test_a_constant_has_a_value_and_keeps_its_text(line: str, value: object, text: str) -> None:
    (constant,) = message(line).constants
    assert (constant.value, constant.text) == (value, text)
    assert type(constant.value) is type(value)


@pytest.mark.parametrize(
    ("text", "line", "column", "sentence"),
    [
        ("int32", 1, 6, "expected a name after the type int32"),
        ("int32 X", 1, 7, "X is no field name: field names are made of lower-case letters"),
        ("int32 a__b", 1, 7, "a__b is no field name"),
        ("int32 a_", 1, 7, "a_ is no field name"),
        ("int32 x=1", 1, 7, "x is no constant name: constant names are made of capitals"),
        ("int32 A__B=1", 1, 7, "A__B is no constant name"),
        ("int32 x 1\n\nint32 x", 3, 7, "x is defined twice, first in line 1"),
        ("string<=0 x", 1, 9, "a size is at least 1 and at most 4294967295"),
        ("string<5 x", 1, 7, "a bound is written string<=N"),
        ("string<= x", 1, 9, "expected a size in decimal digits, not "),
        ("int8<=5 x", 1, 5, "only string and wstring have a bound, not int8"),
        ("int8[0] x", 1, 6, "a size is at least 1"),
        ("int8[<3] x", 1, 6, "a bound is written [<=N]"),
        ("int8[<=] x", 1, 8, "expected a size in decimal digits, not "),
        ("int8[>=3] x", 1, 6, "expected a size in decimal digits, not >=3"),
        ("int8[][] x", 1, 5, "int8[][]: arrays have one dimension"),
        (
            "lower x",
            1,
            1,
            "lower is no type: type names are made of letters and digits and begin with a capital",
        ),
        ("Snake_Case x", 1, 1, "Snake_Case is no type"),
        ("Pkg/Name x", 1, 1, "Pkg/Name is no type name: package names are made of lower-case"),
        ("std_msgs/msg/String x", 1, 1, "std_msgs/msg/String is no type name: expected package/Name"),
        ("pkg/name x", 1, 5, "pkg/name is no type"),
        ("uint8 x 256", 1, 9, "default of x: '256' does not fit uint8: 0 to 255"),
        ("uint8 x 1.0", 1, 9, "default of x: '1.0' is no integer"),
        ("bool x yes", 1, 8, "default of x: 'yes' is no bool: true, false, 1 or 0"),
        ("Other x 5", 1, 9, "default of x: a field of type Other cannot have a default value"),
        ("int32[] x 5", 1, 11, "default of x: the default of an array is written [a, b, ...]"),
        ("int32[] x [1", 1, 11, "default of x: the default of an array is written [a, b, ...]"),
        ("int32[] x [1,,2]", 1, 11, "default of x: element 1: '' is no integer"),
        ("int32[2] x [1]", 1, 12, "default of x: 1 values for an array of exactly 2"),
        ("int32[<=1] x [1, 2]", 1, 14, "default of x: 2 values for an array of at most 1"),
        ("string<=2 x abc", 1, 13, "default of x: 3 characters, string holds at most 2"),
        ('string x "a"b"', 1, 10, 'default of x: a " inside "..." needs a backslash before it'),
        ("string[] x ['a]", 1, 12, "default of x: element 0: the quote is not closed"),
        ("string[] x ['a' b]", 1, 12, "default of x: element 0: expected a comma after the closing quote"),
        ("string[] x [a,,b]", 1, 12, "default of x: element 1 is empty"),
        ("string x \\x4", 1, 10, "default of x: '\\\\x4' is no character"),
        ("string x \\ud800", 1, 10, "default of x: '\\\\ud800' is no character"),
        ("string<=5 X=a", 1, 1, "a constant is a number, a bool or a string, not of type string<=5"),
        ("uint8 X=", 1, 9, "constant X: '' is no integer"),
    ],
)
def test_an_error_says_line_column_and_what_is_wrong(
    text: str, line: int, column: int, sentence: str
) -> None:
    with pytest.raises(DefinitionError) as caught:
        parse(text, NAME, "ros2", "Thing.msg")
    error = caught.value
    assert error.message.startswith(sentence)
    assert (error.file, error.line, error.column) == ("Thing.msg", line, column)


def test_a_long_word_is_not_quoted_whole() -> None:
    with pytest.raises(DefinitionError) as caught:
        message("x" * 10_000 + " y")
    assert len(str(caught.value)) < 300


def test_a_service_has_a_request_a_response_and_an_event() -> None:
    parsed = parse("int64 a\n---\nint64 sum 3\n", TypeName("pkg", "srv", "Ask"), "ros2")
    assert isinstance(parsed, Service)
    assert parsed.request.name == TypeName("pkg", "srv", "Ask_Request")
    assert parsed.response.name == TypeName("pkg", "srv", "Ask_Response")
    assert parsed.response.fields == (Field("sum", FieldType("int64", None, "int64"), 3),)
    assert parsed.response.fields[0].line == 3
    assert parsed.event is not None
    assert parsed.event.name == TypeName("pkg", "srv", "Ask_Event")
    one = Array("bounded", 1)
    assert [(field.name, field.type.message, field.type.array) for field in parsed.event.fields] == [
        ("info", TypeName("service_msgs", "msg", "ServiceEventInfo"), None),
        ("request", TypeName("pkg", "srv", "Ask_Request"), one),
        ("response", TypeName("pkg", "srv", "Ask_Response"), one),
    ]


@pytest.mark.parametrize(
    ("text", "place", "sentence"),
    [
        ("int8 a\nint8 b\n", "2:1", "a line --- is missing: a service has a request and a response"),
        ("---\nint8 a\n---\n", "3:1", "one line --- too many: a service has a request and a response"),
        ("----\n", "1:1", "the separator is a line that holds ---"),
        ("", "1:1", "a line --- is missing"),
    ],
)
def test_a_service_needs_exactly_one_separator(text: str, place: str, sentence: str) -> None:
    with pytest.raises(DefinitionError, match=f"f:{place}: {sentence}"):
        parse(text, TypeName("pkg", "srv", "Ask"), "ros2", "f")


def test_an_action_derives_two_services_and_a_feedback_message() -> None:
    parsed = parse("int32 order\n---\nint32[] r\n---\nint32[] f\n", TypeName("pkg", "action", "Do"), "ros2")
    assert isinstance(parsed, Action)
    assert [one.name.name for one in (parsed.goal, parsed.result, parsed.feedback)] == [
        "Do_Goal",
        "Do_Result",
        "Do_Feedback",
    ]
    assert [one.name.name for one in parsed.messages] == [
        "Do_Goal",
        "Do_Result",
        "Do_Feedback",
        "Do_FeedbackMessage",
    ]
    send_goal, get_result = parsed.services

    def fields(message: Message) -> list[tuple[str, str]]:
        return [(field.name, str(field.type.message or field.type)) for field in message.fields]

    assert send_goal.name == TypeName("pkg", "action", "Do_SendGoal")
    assert fields(send_goal.request) == [
        ("goal_id", "unique_identifier_msgs/msg/UUID"),
        ("goal", "pkg/action/Do_Goal"),
    ]
    assert fields(send_goal.response) == [("accepted", "bool"), ("stamp", "builtin_interfaces/msg/Time")]
    assert get_result.name == TypeName("pkg", "action", "Do_GetResult")
    assert fields(get_result.request) == [("goal_id", "unique_identifier_msgs/msg/UUID")]
    assert fields(get_result.response) == [("status", "int8"), ("result", "pkg/action/Do_Result")]
    assert fields(parsed.messages[3]) == [
        ("goal_id", "unique_identifier_msgs/msg/UUID"),
        ("feedback", "pkg/action/Do_Feedback"),
    ]
    assert send_goal.event is not None
    assert send_goal.event.name == TypeName("pkg", "action", "Do_SendGoal_Event")
