"""Python source of message, service and action classes."""

from __future__ import annotations

from roslet.gen.lines import render
from roslet.gen.python_names import attribute, class_reference
from roslet.gen.python_read import Deserializer
from roslet.gen.python_write import Serializer
from roslet.idl.records import Service
from roslet.layout import PRIMITIVE_SIZE
from roslet.wire.cursor import BOUNDED, FIXED, SINGLE, UNBOUNDED

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator

    from roslet.gen.lines import Block
    from roslet.idl.records import Action, Field, FieldType, Message, TypeName
    from roslet.layout import Layout

_KINDS = {"fixed": FIXED, "bounded": BOUNDED, "unbounded": UNBOUNDED}

PRELUDE = {
    "_BOOL": "BOOL",
    "_FAILURES": "FAILURES",
    "_ZEROS": "ZEROS",
    "_decode_wide": "decode_wide",
    "_encode_wide": "encode_wide",
    "_new": "new",
    "_bytes_packer": "bytes_packer",
    "_packer": "packer",
    "_packers": "packers",
    "_padded_text_packers": "padded_text_packers",
    "_padded_text_unpackers": "padded_text_unpackers",
    "_text_bytes_packers": "text_bytes_packers",
    "_text_packers": "text_packers",
    "_text_unpackers": "text_unpackers",
    "_unpacker": "unpacker",
}
"""Globals of generated code that `roslet.wire.primitives` has, and their names there."""


class Method:
    """The source of one method, with what it needs."""

    def __init__(self, block: Block, globals_: dict[str, str], references: dict[str, object]) -> None:
        self.block = list(block)
        self.globals_ = globals_
        self.references = references

    def text(self) -> str:
        """The globals and the function, for `exec` in a namespace that has the references and the prelude."""
        lines = ["%s = %s" % item for item in self.globals_.items()]
        return render([*lines, *self.block])


def serializer(layout: Layout) -> Method:
    """`serialize_into` of a message."""
    codec = Serializer(layout)
    block = list(codec.source())
    return Method(block, codec.globals_, codec.references)


def deserializer(layout: Layout) -> Method:
    """The function `_read` of a message, which as a class method is its `deserialize_from` and
    its `deserialize`."""
    codec = Deserializer(layout)
    block = list(codec.source())
    return Method(block, codec.globals_, codec.references)


def bytes_serializer(layout: Layout) -> Method | None:
    """`serialize` of a message that one `struct` call makes; None for others, which inherit it."""
    codec = Serializer(layout)
    codec.prefix = "make"
    block = codec.whole()
    return None if block is None else Method(block, codec.globals_, codec.references)


def initializer(message: Message) -> Method:
    """`__init__` of a message: fields by position or name, and their defaults."""
    references: dict[str, object] = {}
    globals_: dict[str, str] = {}
    parameters: list[str] = []
    body: list[str] = []
    for field in message.fields:
        name = attribute(field.name)
        literal, made = _default(field, references, globals_)
        parameters.append("%s=%s" % (name, literal))
        if made is None:
            body.append("self.%s = %s" % (name, name))
        else:
            body.append("self.%s = %s if %s is None else %s" % (name, made, name, name))
    head = "def __init__(self%s):" % "".join([", " + parameter for parameter in parameters])
    return Method([head, body or ["pass"]], globals_, references)


def _default(field: Field, references: dict[str, object], globals_: dict[str, str]) -> tuple[str, str | None]:
    """A parameter's default, and the expression that makes the field's value if that default is None."""
    kind = field.type
    primitive = kind.primitive
    array = kind.array
    if array is None:
        if primitive is None or primitive in ("time", "duration"):
            return "None", _element(kind, references)
        if field.default is not None:
            return repr(field.default), None
        return _zero(primitive), None
    if field.default is not None:
        values = tuple(field.default) if isinstance(field.default, tuple) else (field.default,)
        if primitive == "uint8":
            return repr(bytes([int(value) for value in values])), None  # type: ignore[arg-type]
        return "None", repr(list(values))
    if primitive == "uint8":
        return ("bytes(%d)" % (array.size or 0) if array.kind == "fixed" else 'b""'), None
    if array.kind != "fixed":
        return "None", "[]"
    size = array.size or 0
    if primitive in PRIMITIVE_SIZE:
        globals_["_%s_zeros" % primitive] = '_numbers("%s").zeros' % primitive
        return "None", "_%s_zeros(%d)" % (primitive, size)
    if primitive in ("string", "wstring"):
        return "None", '[""] * %d' % size
    return "None", "[%s for _ in range(%d)]" % (_element(kind, references), size)


def _element(kind: FieldType, references: dict[str, object]) -> str:
    name: TypeName | str = kind.message or kind.primitive or ""
    reference = class_reference(name)
    references[reference] = name
    return reference + "()"


def _zero(primitive: str) -> str:
    if primitive == "bool":
        return "False"
    if primitive in ("string", "wstring"):
        return '""'
    return "0.0" if primitive.startswith("float") else "0"


def field_entry(field: Field) -> tuple[str, TypeName | str, int, int, int | None]:
    """A row of the field table (see `roslet.wire.cursor`), the nested class as its type name."""
    kind = field.type
    base: TypeName | str = kind.message if kind.message is not None else kind.primitive or ""
    array = kind.array
    if array is None:
        return attribute(field.name), base, SINGLE, 0, kind.string_bound
    return attribute(field.name), base, _KINDS[array.kind], array.size or 0, kind.string_bound


def fields_and_types(message: Message) -> tuple[tuple[str, str], ...]:
    """Every field's name and type as the definition spells them; nested types by their full names."""
    rows = []
    for field in message.fields:
        kind = field.type
        text = str(kind)
        if kind.message is not None:
            text = kind.message.text(message.dialect) + text[len(kind.spelled) :]
        rows.append((field.name, text))
    return tuple(rows)


def base(message: Message) -> str:
    """The class of roslet.wire.message that a message's class is made from."""
    stamp = message.dialect == "ros2" and message.name.package == "builtin_interfaces"
    return "Stamp" if stamp and message.name.name in ("Time", "Duration") else "Message"


def has_header(message: Message) -> bool:
    """Whether a ROS 1 message begins with a std_msgs/Header named header."""
    first = message.fields[0] if message.fields else None
    return first is not None and first.name == "header" and str(first.type.message) == "std_msgs/msg/Header"


def parts(interface: Service | Action) -> dict[str, TypeName]:
    """The attributes of a service's or an action's class: what it is made of and what is derived of it."""
    if isinstance(interface, Service):
        found = {"Request": interface.request.name, "Response": interface.response.name}
        if interface.event is not None:
            found["Event"] = interface.event.name
        return found
    found = {
        "Goal": interface.goal.name,
        "Result": interface.result.name,
        "Feedback": interface.feedback.name,
    }
    own = interface.name.name
    derived = [service.name for service in interface.services]
    derived += [message.name for message in interface.messages]
    for part in derived:
        short = part.name[len(own) :].lstrip("_") if part.name.startswith(own) else part.name
        found.setdefault(short, part)
    return found


def slots(message: Message) -> tuple[str, ...]:
    """The attributes of a message, in the order of its fields."""
    return tuple([attribute(field.name) for field in message.fields])


def spec_source(message: Message, references: dict[str, object]) -> Iterator[str | Block]:
    """The field table as an expression's lines."""
    yield "_spec = ("
    rows = []
    for field in message.fields:
        name, base, kind, size, bound = field_entry(field)
        if isinstance(base, str):
            text = '"%s"' % base
        else:
            text = class_reference(base)
            references[text] = base
        rows.append('("%s", %s, %d, %d, %r),' % (name, text, kind, size, bound))
    yield rows
    yield ")"
