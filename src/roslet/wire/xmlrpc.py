"""XML-RPC calls and responses, the remote procedure calls of ROS 1 (xmlrpc.com/spec, with the extensions i8
and nil).

Runs on MicroPython. Emitting checks what it is given and raises `InvalidMessage` with a value path. Parsing
makes one linear pass without recursion, holds no more than the document and its values, and raises
`ProtocolError` with the byte offset and one of these reasons:

    too-large  too-many-tags  too-deep  truncated  bad-encoding  control-character  forbidden-markup
    bad-entity  unexpected-tag  unexpected-text  bad-int  bad-boolean  bad-double  bad-base64  bad-document

There are no entities but the five of XML and character references; a document type, a comment, a CDATA
section or a processing instruction is refused, for no ROS peer sends one. Element attributes are skipped
(Apache's XML-RPC declares a namespace on the root). A carriage return is sent bare, as roscpp and rospy send
it, and arrives as a line feed, as XML prescribes: xmlrpcpp would not read a character reference.

| Python                | XML-RPC                                                    |
|-----------------------|------------------------------------------------------------|
| bool                  | boolean                                                    |
| int                   | i4 where it fits, else i8; read from int, i4, i8           |
| float                 | double                                                     |
| str                   | string; read also from a value without a type              |
| bytes, bytearray      | base64                                                     |
| list, tuple           | array                                                      |
| dict (keys are str)   | struct                                                     |
| DateTime              | dateTime.iso8601                                           |
| None                  | nil                                                        |
"""

import binascii

from roslet.errors import Fault, InvalidMessage, ProtocolError
from roslet.wire.xmltext import escape, find_control, printable, to_utf8, unescape

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any, TypeAlias

    Buffer: TypeAlias = bytes | bytearray | memoryview

MAX_DEPTH = 64
"""Arrays and structs inside each other; ROS parameter trees are some five deep. Both ways, so that what was
received can be sent again.
"""

MAX_DOCUMENT = 16 * 1024 * 1024
"""Bytes of one document; the same bound as `http.MAX_BODY`."""

MAX_TAGS = 2_000_000
"""Tags of one document. A tag costs some 60 bytes while parsing, so this bounds the memory; it allows half a
million numbers in one parameter.
"""


class DateTime:
    """An ISO 8601 time as XML-RPC writes it, such as `19980717T14:08:55`; kept as text, for ROS gives it no
    meaning.
    """

    __slots__ = ("value",)

    def __init__(self, value: str) -> None:
        self.value = value

    def __eq__(self, other: object) -> bool:
        return isinstance(other, DateTime) and other.value == self.value

    def __hash__(self) -> int:
        return hash(self.value)

    def __repr__(self) -> str:
        return "DateTime(%r)" % self.value


# -- emitting

_I8 = "<value><i8>"
_CALL = '<?xml version="1.0"?>\n<methodCall><methodName>%s</methodName><params>'
_RESPONSE = '<?xml version="1.0"?>\n<methodResponse><params><param>'
_FAULT = '<?xml version="1.0"?>\n<methodResponse><fault>'

_SPACES = (b" ", b"\t", b"\r", b"\n")


def emit_call(method: str, params: "list[Any] | tuple[Any, ...]") -> bytes:
    """The document that calls `method`. Raises InvalidMessage for a value that cannot be sent.

    No parameter is set to an integer of more than 32 bits: rosmaster would take it, and fail from then on whoever asks for
    it or for a namespace that it is in; roscpp could not read it.
    """
    out = [_CALL % escape(method)]
    index = 0
    try:
        for value in params:
            out.append("<param>")
            begin = len(out)
            _emit(value, out, 0)
            if method == "setParam":
                _check_narrow(out[begin:])
            out.append("</param>")
            index += 1
    except InvalidMessage as error:
        raise _within("params[%d]" % index, error) from None
    out.append("</params></methodCall>")
    return _encode(out)


def _check_narrow(pieces: "list[str]") -> None:
    for piece in pieces:
        if piece.startswith(_I8):
            number = piece[len(_I8) : piece.find("</")]
            raise InvalidMessage("a parameter cannot be %s, an integer of more than 32 bits" % number)


def emit_response(value: "Any") -> bytes:
    """The document that answers with `value`. Raises InvalidMessage for a value that cannot be sent."""
    out = [_RESPONSE]
    try:
        _emit(value, out, 0)
    except InvalidMessage as error:
        raise _within("value", error) from None
    out.append("</param></params></methodResponse>")
    return _encode(out)


def emit_fault(code: int, message: str) -> bytes:
    """The document that answers with a fault. Characters that XML cannot carry become question marks."""
    out = [_FAULT]
    _emit({"faultCode": code, "faultString": printable(message)}, out, 0)
    out.append("</fault></methodResponse>")
    return _encode(out)


def _encode(out: "list[str]") -> bytes:
    try:
        data = "".join(out).encode()
    except UnicodeError:
        raise InvalidMessage("text with a lone surrogate cannot be sent as XML") from None
    control = find_control(data)
    if control >= 0:
        raise InvalidMessage("text with the control character 0x%02x cannot be sent as XML" % control)
    return data


def _within(step: str, error: InvalidMessage) -> InvalidMessage:
    return InvalidMessage(error.message, step + error.path)


def _emit(value: "Any", out: "list[str]", depth: int) -> None:
    """Append one value. Recursive, and bounded by MAX_DEPTH."""
    kind = type(value)
    if kind is str:
        out.append("<value><string>%s</string></value>" % escape(value))
    elif kind is bool:
        out.append("<value><boolean>1</boolean></value>" if value else "<value><boolean>0</boolean></value>")
    elif kind is int:
        if -0x80000000 <= value <= 0x7FFFFFFF:
            out.append("<value><i4>%d</i4></value>" % value)
        elif -0x8000000000000000 <= value <= 0x7FFFFFFFFFFFFFFF:
            out.append(_I8 + "%d</i8></value>" % value)
        else:
            raise InvalidMessage("an integer of more than 64 bits cannot be sent")
    elif kind is float:
        out.append("<value><double>%r</double></value>" % value)
    elif kind is list or kind is tuple:
        _emit_array(value, out, depth + 1)
    elif kind is dict:
        _emit_struct(value, out, depth + 1)
    elif value is None:
        out.append("<value><nil/></value>")
    elif kind is bytes or kind is bytearray or kind is memoryview:
        text = binascii.b2a_base64(value).decode().strip()
        out.append("<value><base64>%s</base64></value>" % text)
    elif kind is DateTime:
        out.append("<value><dateTime.iso8601>%s</dateTime.iso8601></value>" % escape(value.value))
    else:
        _emit_subclass(value, out, depth)


def _emit_array(value: "list[Any] | tuple[Any, ...]", out: "list[str]", depth: int) -> None:
    if depth > MAX_DEPTH:
        raise InvalidMessage("more than %d arrays and structs nested" % MAX_DEPTH)
    out.append("<value><array><data>")
    index = 0
    try:
        for item in value:
            _emit(item, out, depth)
            index += 1
    except InvalidMessage as error:
        raise _within("[%d]" % index, error) from None
    out.append("</data></array></value>")


def _emit_struct(value: "dict[str, Any]", out: "list[str]", depth: int) -> None:
    if depth > MAX_DEPTH:
        raise InvalidMessage("more than %d arrays and structs nested" % MAX_DEPTH)
    out.append("<value><struct>")
    for key, item in value.items():
        if not isinstance(key, str):
            raise InvalidMessage("a struct needs str keys, got %r" % (key,))
        out.append("<member><name>%s</name>" % escape(key))
        try:
            _emit(item, out, depth)
        except InvalidMessage as error:
            raise _within("." + key, error) from None
        out.append("</member>")
    out.append("</struct></value>")


def _emit_subclass(value: "Any", out: "list[str]", depth: int) -> None:
    """Subclasses (an IntEnum, a defaultdict, numpy's float64) go as what they are derived from."""
    kinds: tuple[Any, ...] = (int, float, str, bytes, bytearray, list, tuple, dict)
    for kind in kinds:
        if isinstance(value, kind):
            _emit(kind(value), out, depth)
            return
    raise InvalidMessage("a value of type %s cannot be sent as XML-RPC" % type(value).__name__)


# -- parsing


def parse_call(data: "Buffer") -> "tuple[str, list[Any]]":
    """Method name and parameters of a call. Raises ProtocolError."""
    pieces = _split(data)
    params: list[Any] = []
    try:
        at = _expect(pieces, 1, b"methodCall>")
        method = _string(pieces, at, _text(pieces, at, b"methodName")).strip()
        at = _expect(pieces, at + 1, b"/methodName>")
        if _is(pieces[at], b"params>"):
            at = _expect(pieces, at, b"params>")
            while _is(pieces[at], b"param>"):
                value, at = _value(pieces, _expect(pieces, at, b"param>"))
                params.append(value)
                at = _expect(pieces, at, b"/param>")
            at = _expect(pieces, at, b"/params>")
        elif _is(pieces[at], b"params/>"):
            at = _expect(pieces, at, b"params/>")
        _end(pieces, _expect(pieces, at, b"/methodCall>"))
    except IndexError:
        raise ProtocolError("truncated", "at byte %d" % _offset(pieces, len(pieces))) from None
    return method, params


def parse_response(data: "Buffer") -> "Any":
    """The value of a response. Raises Fault where it is a fault, ProtocolError where it is no response."""
    pieces = _split(data)
    try:
        at = _expect(pieces, 1, b"methodResponse>")
        fault = _is(pieces[at], b"fault>")
        if fault:
            value, at = _value(pieces, _expect(pieces, at, b"fault>"))
            at = _expect(pieces, at, b"/fault>")
        else:
            at = _expect(pieces, _expect(pieces, at, b"params>"), b"param>")
            value, at = _value(pieces, at)
            at = _expect(pieces, _expect(pieces, at, b"/param>"), b"/params>")
        _end(pieces, _expect(pieces, at, b"/methodResponse>"))
    except IndexError:
        raise ProtocolError("truncated", "at byte %d" % _offset(pieces, len(pieces))) from None
    if fault:
        code = value.get("faultCode") if isinstance(value, dict) else None
        text = value.get("faultString") if isinstance(value, dict) else None
        if type(code) is not int or not isinstance(text, str):
            raise ProtocolError("bad-document", "a fault without faultCode and faultString")
        raise Fault(code, text)
    return value


def _split(data: "Buffer") -> "list[bytes]":
    """The document cut before each tag: every piece but the first is `tag>text` or `/tag>text`.

    The first piece is what stands before the root: white space and the XML declaration. Checks what concerns
    the whole document: size, encoding, control characters, forbidden markup.
    """
    data = bytes(data)
    if len(data) > MAX_DOCUMENT:
        raise ProtocolError("too-large", "%d bytes, at most %d" % (len(data), MAX_DOCUMENT))
    start = 3 if data.startswith(b"\xef\xbb\xbf") else 0
    while data[start : start + 1] in _SPACES:
        start += 1
    declaration = b""
    if data[start : start + 5] == b"<?xml":
        end = data.find(b"?>", start)
        if end < 0:
            raise ProtocolError("truncated", "at byte %d: no end of the XML declaration" % len(data))
        declaration = data[start:end].lower()
        start = end + 2
    prefix = data[:start]
    data = to_utf8(data[start:] if start else data, declaration)
    control = find_control(data)
    if control >= 0:
        raise ProtocolError("control-character", "0x%02x in the document" % control)
    if data.count(b"<") > MAX_TAGS:
        raise ProtocolError("too-many-tags", "more than %d" % MAX_TAGS)
    if b"<!" in data or b"<?" in data:
        raise ProtocolError("forbidden-markup", "a declaration, comment, CDATA section or instruction")
    if b"\r" in data:
        data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    pieces = data.split(b"<")
    if pieces[0].strip():
        raise ProtocolError("unexpected-text", "at byte %d: text before the root element" % start)
    pieces[0] = prefix + pieces[0]
    return pieces


def _offset(pieces: "list[bytes]", at: int) -> int:
    """The byte of the document at which piece `at` begins; only computed for an error."""
    offset = len(pieces[0])
    for piece in pieces[1:at]:
        offset += len(piece) + 1
    return offset


def _fail(pieces: "list[bytes]", at: int, reason: str, message: str) -> ProtocolError:
    return ProtocolError(reason, "at byte %d: %s" % (_offset(pieces, at), message))


def _open(piece: bytes) -> "tuple[bytes, bytes]":
    """Tag name and text of a piece. Attributes are dropped; an empty element keeps its slash at the end."""
    tag, closed, text = piece.partition(b">")
    if not closed:
        raise IndexError  # cut inside a tag: reported as truncated
    if tag.endswith(b"/"):
        words = tag[:-1].split(None, 1)
        return (words[0] + b"/" if words else b"/"), text
    if b" " in tag or b"\n" in tag or b"\t" in tag:
        words = tag.split(None, 1)
        return (words[0] if words else b""), text
    return tag, text


def _is(piece: bytes, tag: bytes) -> bool:
    """Whether a piece is `tag`, given with its closing bracket."""
    return piece == tag or _open(piece)[0] == tag[:-1]


def _expect(pieces: "list[bytes]", at: int, tag: bytes) -> int:
    """The place after the piece at `at`, which must be `tag` (given with its bracket) and white space."""
    if pieces[at] != tag:
        text = _text(pieces, at, tag[:-1])
        if text and text.strip():
            raise _fail(pieces, at, "unexpected-text", "%r after <%s" % (text[:20], tag.decode()))
    return at + 1


def _text(pieces: "list[bytes]", at: int, tag: bytes) -> bytes:
    """The text after the tag at `at`, which must be `tag`."""
    name, text = _open(pieces[at])
    if name != tag:
        raise _fail(pieces, at, "unexpected-tag", "expected <%s>, got <%s>" % (tag.decode(), _printed(name)))
    return text


def _printed(name: bytes) -> str:
    return "".join([chr(byte) if 32 < byte < 127 else "?" for byte in name[:20]])


def _end(pieces: "list[bytes]", at: int) -> None:
    if at != len(pieces):
        raise _fail(pieces, at, "unexpected-tag", "something after the root element")


def _value(pieces: "list[bytes]", at: int) -> "tuple[Any, int]":
    """The value whose `<value>` is at `at`, and the place after its `</value>`.

    One loop over the pieces. `outer` holds the containers around the current one, so depth costs no stack.
    """
    outer: list[Any] = []
    container: Any = None
    key = ""
    while True:
        # A value begins here. First what nearly all are: <value><type>text</type></value> without white
        # space.
        tag, closed, content = pieces[at + 1].partition(b">")
        read = _READERS.get(tag)
        if read is not None and closed and pieces[at] == b"value>":
            value, at = _typed(pieces, at + 1, tag, content, read)
        else:
            value, at, opened, first = _begin(pieces, at)
            if opened:
                if len(outer) >= MAX_DEPTH:
                    raise _fail(pieces, at, "too-deep", "more than %d arrays and structs nested" % MAX_DEPTH)
                outer.append((container, key))
                container = value
                key = first
                continue
        # Put the value where it belongs, and end every container that ends with it.
        while container is not None:
            if type(container) is list:
                container.append(value)
                if pieces[at] == b"value>" or _is_value(pieces[at]):
                    break
                at = _expect(pieces, _expect(pieces, at, b"/data>"), b"/array>")
            else:
                container[key] = value
                at = _expect(pieces, at, b"/member>")
                if _is(pieces[at], b"member>"):
                    key, at = _name(pieces, at)
                    break
                at = _expect(pieces, at, b"/struct>")
            at = _expect(pieces, at, b"/value>")
            value = container
            container, key = outer.pop()
        else:
            return value, at


def _typed(
    pieces: "list[bytes]", at: int, tag: bytes, content: bytes, read: "Callable[[bytes], Any]"
) -> "tuple[Any, int]":
    """The value of the element `tag` at `at`, and the place after the `</value>` around it."""
    try:
        value = read(content)
    except ProtocolError as error:
        raise _fail(pieces, at, error.reason, error.message) from None
    at += 1
    at = at + 1 if pieces[at] == _CLOSERS[tag] else _expect(pieces, at, _CLOSERS[tag])
    at = at + 1 if pieces[at] == b"/value>" else _expect(pieces, at, b"/value>")
    return value, at


def _begin(pieces: "list[bytes]", at: int) -> "tuple[Any, int, bool, str]":
    """A value in any spelling: the value, the place after it, and False.

    Where an array or struct begins that is not empty: a new container, the place of its first value, True,
    and the name of that value.
    """
    name, text = _open(pieces[at])
    if name == b"value/":
        return "", _expect(pieces, at, b"value/>"), False, ""
    if name != b"value":
        raise _fail(pieces, at, "unexpected-tag", "expected <value>, got <%s>" % _printed(name))
    tag, content = _open(pieces[at + 1])
    if tag == b"/value":
        return _string(pieces, at, text), _expect(pieces, at + 1, b"/value>"), False, ""
    if text.strip():
        raise _fail(pieces, at, "unexpected-text", "text beside a typed value")
    at += 1
    value: Any
    if tag == b"array":
        at = _expect(pieces, at, b"array>")
        if _is(pieces[at], b"data>"):
            at = _expect(pieces, at, b"data>")
            if _is_value(pieces[at]):
                return [], at, True, ""
            at = _expect(pieces, at, b"/data>")
        else:
            at = _expect(pieces, at, b"data/>")
        value, at = [], _expect(pieces, at, b"/array>")
    elif tag == b"struct":
        at = _expect(pieces, at, b"struct>")
        if _is(pieces[at], b"member>"):
            first, at = _name(pieces, at)
            return {}, at, True, first
        value, at = {}, _expect(pieces, at, b"/struct>")
    elif tag in _EMPTY:
        value, at = _EMPTY[tag], _expect(pieces, at, tag + b">")
    elif tag == b"struct/":
        value, at = {}, _expect(pieces, at, b"struct/>")
    else:
        read = _READERS.get(tag)
        if read is None:
            raise _fail(pieces, at, "unexpected-tag", "<%s> is no type" % _printed(tag))
        value, at = _typed(pieces, at, tag, content, read)
        return value, at, False, ""
    return value, _expect(pieces, at, b"/value>"), False, ""


def _is_value(piece: bytes) -> bool:
    return _open(piece)[0] in (b"value", b"value/")


def _name(pieces: "list[bytes]", at: int) -> "tuple[str, int]":
    """The name of the member at `at`, and the place of its value."""
    at = _expect(pieces, at, b"member>")
    if _is(pieces[at], b"name/>"):
        return "", _expect(pieces, at, b"name/>")
    name = _string(pieces, at, _text(pieces, at, b"name"))
    return name, _expect(pieces, at + 1, b"/name>")


def _string(pieces: "list[bytes]", at: int, text: bytes) -> str:
    try:
        return _read_string(text)
    except ProtocolError as error:
        raise _fail(pieces, at, error.reason, error.message) from None


# Text of one element to its value. The document is known to be UTF-8 and was cut only at ASCII characters.


def _read_string(text: bytes) -> str:
    return unescape(text.decode()) if b"&" in text else text.decode()


def _read_int(text: bytes) -> int:
    text = text.strip()
    digits = text[1:] if text[:1] in (b"-", b"+") else text
    if digits.isdigit() and len(digits) < 20:
        value = int(text)
        if -0x8000000000000000 <= value <= 0x7FFFFFFFFFFFFFFF:
            return value
    raise ProtocolError("bad-int", "%r is no integer of 64 bits" % text[:24])


def _read_boolean(text: bytes) -> bool:
    text = text.strip()
    if text == b"1":
        return True
    if text == b"0":
        return False
    raise ProtocolError("bad-boolean", "%r is neither 0 nor 1" % text[:24])


def _read_double(text: bytes) -> float:
    # xmlrpcpp prints doubles as C does, Python as repr does. float() reads both, and underscores, which are
    # no XML-RPC.
    try:
        if b"_" not in text:
            return float(text)
    except ValueError:
        pass
    raise ProtocolError("bad-double", "%r is no number" % text[:24])


def _read_base64(text: bytes) -> bytes:
    try:
        return binascii.a2b_base64(text)
    except ValueError:
        raise ProtocolError("bad-base64", "%d characters that are no base64" % len(text)) from None


def _read_datetime(text: bytes) -> DateTime:
    return DateTime(_read_string(text).strip())


def _read_nil(text: bytes) -> None:
    if text.strip():
        raise ProtocolError("unexpected-text", "text inside nil")


_READERS: "dict[bytes, Callable[[bytes], Any]]" = {
    b"string": _read_string,
    b"i4": _read_int,
    b"int": _read_int,
    b"boolean": _read_boolean,
    b"double": _read_double,
    b"i8": _read_int,
    b"base64": _read_base64,
    b"dateTime.iso8601": _read_datetime,
    b"nil": _read_nil,
    b"ex:nil": _read_nil,
}
_CLOSERS = {_tag: b"/" + _tag + b">" for _tag in _READERS}
_EMPTY = {b"string/": "", b"base64/": b"", b"nil/": None, b"ex:nil/": None}
