"""XML-RPC documents as ROS peers write them, and every way in which a document is refused."""

import pytest

from roslet.errors import Fault, InvalidMessage, ProtocolError
from roslet.wire import xmlrpc

pytestmark = pytest.mark.micropython

# As xmlrpcpp (roscpp) writes a call: no white space.
ROSCPP_CALL = (
    b'<?xml version="1.0"?>\r\n<methodCall><methodName>registerPublisher</methodName>\r\n'
    b"<params><param><value>/talker</value></param><param><value>/chatter</value></param>"
    b"<param><value><array><data><value><i4>-3</i4></value><value><double>0.5</double></value>"
    b"<value><boolean>1</boolean></value></data></array></value></param></params></methodCall>\r\n"
)
# As Python's xmlrpc.client (rospy) writes one.
ROSPY_CALL = b"""<?xml version='1.0'?>
<methodCall>
<methodName>setParam</methodName>
<params>
<param>
<value><string>/node</string></value>
</param>
<param>
<value><struct>
<member>
<name>a&lt;b</name>
<value><int>5</int></value>
</member>
<member>
<name>list</name>
<value><array><data>
<value><nil/></value>
<value><string></string></value>
<value><base64>
AAEC
</base64></value>
</data></array></value>
</member>
</struct></value>
</param>
</params>
</methodCall>
"""


def call(inner: bytes) -> bytes:
    return (
        b"<methodCall><methodName>m</methodName><params><param>" + inner + b"</param></params></methodCall>"
    )


def value_of(inner: bytes) -> object:
    return xmlrpc.parse_call(call(inner))[1][0]


def test_a_call_of_roscpp_is_read() -> None:
    assert xmlrpc.parse_call(ROSCPP_CALL) == (
        "registerPublisher",
        ["/talker", "/chatter", [-3, 0.5, True]],
    )


def test_a_call_of_rospy_is_read() -> None:
    assert xmlrpc.parse_call(ROSPY_CALL) == (
        "setParam",
        ["/node", {"a<b": 5, "list": [None, "", b"\x00\x01\x02"]}],
    )


@pytest.mark.parametrize(
    ("inner", "value"),
    [
        (b"<value>text</value>", "text"),
        (b"<value></value>", ""),
        (b"<value/>", ""),
        (b"<value> spaces kept </value>", " spaces kept "),
        (b"<value><string> a\tb\n</string></value>", " a\tb\n"),
        (b"<value><string/></value>", ""),
        (b"<value>\n  <string>x</string>\n</value>", "x"),
        (b"<value><string>a>b</string></value>", "a>b"),
        (b"<value><string>&lt;&gt;&amp;&apos;&quot;&#65;&#x42;&#xe9;</string></value>", "<>&'\"AB\xe9"),
        (b"<value><string>\xc3\xa9</string></value>", "\xe9"),
        (b"<value><i4> +7 </i4></value>", 7),
        (b"<value><int>-2147483648</int></value>", -2147483648),
        (b"<value><i8>9223372036854775807</i8></value>", 9223372036854775807),
        (b"<value><double>-1e-3</double></value>", -0.001),
        (b"<value><double> 3 </double></value>", 3.0),
        (b"<value><boolean>0</boolean></value>", False),
        (b"<value><nil/></value>", None),
        (b"<value><ex:nil/></value>", None),
        (b"<value><nil></nil></value>", None),
        (b"<value><base64/></value>", b""),
        (b"<value><array><data/></array></value>", []),
        (b"<value><array> <data> </data> </array></value>", []),
        (b"<value><struct/></value>", {}),
        (b"<value><struct></struct></value>", {}),
        (b"<value><struct><member><name/><value>x</value></member></struct></value>", {"": "x"}),
        (b"<value><array><data><value/><value>a</value><value/></data></array></value>", ["", "a", ""]),
        (b"<value><array ><data kind='x'><value>a</value></data></array></value>", ["a"]),
        (b"<value><dateTime.iso8601>19980717T14:08:55</dateTime.iso8601></value>", "19980717T14:08:55"),
    ],
)
def test_every_spelling_of_a_value_is_read(inner: bytes, value: object) -> None:
    got = value_of(inner)
    if isinstance(got, xmlrpc.DateTime):
        got = got.value
    assert got == value
    assert type(got) is type(value)


def test_a_carriage_return_arrives_as_a_line_feed() -> None:
    assert value_of(b"<value>a\r\nb\rc</value>") == "a\nb\nc"


def test_a_byte_order_mark_white_space_and_a_declaration_may_stand_first() -> None:
    document = b'\xef\xbb\xbf \n<?xml version="1.0" encoding="UTF-8"?>\n' + call(b"<value>x</value>")
    assert xmlrpc.parse_call(document) == ("m", ["x"])


def test_latin_1_is_read_where_declared() -> None:
    document = b'<?xml version="1.0" encoding="ISO-8859-1"?>' + call(b"<value>\xe9</value>")
    assert xmlrpc.parse_call(document) == ("m", ["\xe9"])


def test_a_call_may_have_no_parameters() -> None:
    for inner in (b"<params></params>", b"<params/>", b""):
        document = b"<methodCall><methodName> m </methodName>" + inner + b"</methodCall>"
        assert xmlrpc.parse_call(document) == ("m", [])


@pytest.mark.parametrize(
    ("inner", "reason"),
    [
        (b"<value><int>x</int></value>", "bad-int"),
        (b"<value><int></int></value>", "bad-int"),
        (b"<value><int>1_0</int></value>", "bad-int"),
        (b"<value><i4>99999999999999999999</i4></value>", "bad-int"),
        (b"<value><i8>9223372036854775808</i8></value>", "bad-int"),
        (b"<value><boolean>true</boolean></value>", "bad-boolean"),
        (b"<value><double>1,5</double></value>", "bad-double"),
        (b"<value><double>1_0</double></value>", "bad-double"),
        (b"<value><double></double></value>", "bad-double"),
        (b"<value><base64>A</base64></value>", "bad-base64"),
        (b"<value><nil>x</nil></value>", "unexpected-text"),
        (b"<value>x<int>1</int></value>", "unexpected-text"),
        (b"<value><int>1</int>x</value>", "unexpected-text"),
        (b"<value><array>x<data></data></array></value>", "unexpected-text"),
        (b"x<value>1</value>", "unexpected-text"),
        (b"<value><complex>1</complex></value>", "unexpected-tag"),
        (b"<value><int>1</i4></value>", "unexpected-tag"),
        (b"<value><int>1</int></wrong>", "unexpected-tag"),
        (b"<value><struct><name>a</name></struct></value>", "unexpected-tag"),
        (b"<value><struct><member><value>a</value></member></struct></value>", "unexpected-tag"),
        (b"<value><int>1</int></value><value>2</value>", "unexpected-tag"),
        (b"<wert>1</wert>", "unexpected-tag"),
        (b"<value>&unknown;</value>", "bad-entity"),
        (b"<value>&</value>", "bad-entity"),
        (b"<value>& lt;</value>", "bad-entity"),
        (b"<value>&#0;</value>", "bad-entity"),
        (b"<value>&#xD800;</value>", "bad-entity"),
        (b"<value>&#x110000;</value>", "bad-entity"),
        (b"<value>&#99999999999999999999;</value>", "bad-entity"),
        (b"<value>\x00</value>", "control-character"),
        (b"<value>\x1b[0m</value>", "control-character"),
        (b"<value>\xff</value>", "bad-encoding"),
        (b"<value><![CDATA[x]]></value>", "forbidden-markup"),
        (b"<value><!-- x --></value>", "forbidden-markup"),
        (b"<value><?php x ?></value>", "forbidden-markup"),
        (b"<value><int>1</int></value", "truncated"),
    ],
)
def test_a_bad_document_is_refused_under_its_reason(inner: bytes, reason: str) -> None:
    document = (
        call(inner) if reason != "truncated" else call(inner)[: -len(b"</param></params></methodCall>")]
    )
    with pytest.raises(ProtocolError) as raised:
        xmlrpc.parse_call(document)
    assert raised.value.reason == reason


def test_an_entity_bomb_is_refused_before_it_is_looked_at() -> None:
    bomb = (
        b'<?xml version="1.0"?><!DOCTYPE lolz [<!ENTITY lol "lol"><!ENTITY lol2 "&lol;&lol;&lol;">]>'
        b"<methodCall><methodName>&lol2;</methodName></methodCall>"
    )
    with pytest.raises(ProtocolError) as raised:
        xmlrpc.parse_call(bomb)
    assert raised.value.reason == "forbidden-markup"


def test_nesting_is_bounded_both_ways_by_the_same_depth() -> None:
    value: object = 1
    for _ in range(xmlrpc.MAX_DEPTH):
        value = [value]
    assert xmlrpc.parse_call(xmlrpc.emit_call("m", [value])) == ("m", [value])
    with pytest.raises(InvalidMessage):
        xmlrpc.emit_call("m", [[value]])
    deeper = b"<value><array><data>" * 100_000
    with pytest.raises(ProtocolError) as raised:
        value_of(deeper)
    assert raised.value.reason == "too-deep"
    structs = b"<value><struct><member><name>a</name>" * 1000
    with pytest.raises(ProtocolError) as raised:
        value_of(structs)
    assert raised.value.reason == "too-deep"


def test_a_recursive_value_is_refused_when_sent() -> None:
    value: list[object] = []
    value.append(value)
    with pytest.raises(InvalidMessage):
        xmlrpc.emit_response(value)


@pytest.mark.parametrize("document", [ROSCPP_CALL, ROSPY_CALL])
def test_a_document_cut_anywhere_is_refused(document: bytes) -> None:
    document = document.strip()
    for length in range(len(document)):
        with pytest.raises(ProtocolError) as raised:
            xmlrpc.parse_call(document[:length])
        if length > len(b"<?xml") and document[length - 6 : length] == b"value>":
            assert raised.value.reason == "truncated"


def test_no_parameter_is_set_to_an_integer_that_rosmaster_could_not_give_back() -> None:
    for value in (2**31, -(2**31) - 1, [2**40], {"a": {"b": [1, 2**31]}}):
        with pytest.raises(InvalidMessage, match="more than 32 bits") as raised:
            xmlrpc.emit_call("setParam", ["/n", "/p", value])
        assert raised.value.path == "params[2]"
        assert b"<i8>" in xmlrpc.emit_call("other", ["/n", "/p", value])
    for allowed in (2**31 - 1, -(2**31), 1e300, "<value><i8>2147483648</i8></value>"):
        assert xmlrpc.parse_call(xmlrpc.emit_call("setParam", ["/n", "/p", allowed]))[1][2] == allowed


def test_an_error_tells_the_byte_where_it_was_found() -> None:
    with pytest.raises(ProtocolError) as raised:
        xmlrpc.parse_call(call(b"<value><int>x</int></value>"))
    offset = call(b"<value><int>x</int></value>").find(b"<int>")
    assert "at byte %d:" % offset in str(raised.value)


@pytest.mark.parametrize(
    ("value", "path"),
    [
        ([0, {"a": [2**63]}], "params[0][1].a[0]"),
        ({1: 2}, "params[0]"),
        ([1, [object()]], "params[0][1][0]"),
    ],
)
def test_a_value_that_cannot_be_sent_raises_with_its_path(value: object, path: str) -> None:
    with pytest.raises(InvalidMessage) as raised:
        xmlrpc.emit_call("m", [value])
    assert raised.value.path == path


def test_text_that_xml_cannot_carry_raises_when_sent() -> None:
    with pytest.raises(InvalidMessage, match="0x1b"):
        xmlrpc.emit_response("\x1b[0m")


def test_a_fault_is_raised_as_one_and_carries_any_text() -> None:
    with pytest.raises(Fault) as raised:
        xmlrpc.parse_response(xmlrpc.emit_fault(-7, "bad \x00 <thing>\n"))
    assert raised.value.code == -7
    assert raised.value.message == "bad ? <thing>\n"


@pytest.mark.parametrize(
    "inner",
    [
        b"<value>x</value>",
        b"<value><struct><member><name>faultCode</name><value>1</value></member></struct></value>",
    ],
)
def test_a_fault_without_code_and_text_is_no_response(inner: bytes) -> None:
    with pytest.raises(ProtocolError) as raised:
        xmlrpc.parse_response(b"<methodResponse><fault>" + inner + b"</fault></methodResponse>")
    assert raised.value.reason == "bad-document"


def test_values_come_back_as_they_were_sent() -> None:
    value = {
        "bool": True,
        "ints": [0, -1, 2147483647, -2147483648, 1 << 40],
        "float": [0.1, -1e300, 5e-324, 0.0],
        "text": ["", " ", "<&>\"'", "\xe9\u20ac\U0001f600", "line\nfeed\ttab"],
        "bytes": b"\x00\xff" * 50,
        "none": None,
        "": {"nested": [[], {}, [[]]]},
    }
    assert xmlrpc.parse_response(xmlrpc.emit_response(value)) == value
    assert xmlrpc.parse_call(xmlrpc.emit_call("a<b", [value, 1])) == ("a<b", [value, 1])
    assert xmlrpc.parse_response(memoryview(xmlrpc.emit_response(value))) == value


def test_tuples_and_bytearrays_go_as_lists_and_bytes() -> None:
    assert xmlrpc.parse_response(xmlrpc.emit_response((1, bytearray(b"x")))) == [1, b"x"]


def test_infinities_survive() -> None:
    assert xmlrpc.parse_response(xmlrpc.emit_response([float("inf"), float("-inf")])) == [
        float("inf"),
        float("-inf"),
    ]


def test_more_tags_than_the_bound_are_refused() -> None:
    document = b"<" * (xmlrpc.MAX_TAGS + 1)
    with pytest.raises(ProtocolError) as raised:
        xmlrpc.parse_call(document)
    assert raised.value.reason == "too-many-tags"


@pytest.mark.cpython
def test_a_document_beyond_the_bound_is_refused() -> None:
    with pytest.raises(ProtocolError) as raised:
        xmlrpc.parse_call(b" " * (xmlrpc.MAX_DOCUMENT + 1))
    assert raised.value.reason == "too-large"


@pytest.mark.cpython
def test_a_lone_surrogate_raises_when_sent() -> None:
    with pytest.raises(InvalidMessage, match="surrogate"):
        xmlrpc.emit_response("\ud800")
