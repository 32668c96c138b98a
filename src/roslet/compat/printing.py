"""A message as rospy prints it: one field a line, nested messages indented, lists of messages with dashes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from roslet.wire.message import Message
from roslet.wire.time import Duration, Time

if TYPE_CHECKING:
    from collections.abc import Callable

    FieldFilter = Callable[[Message], list[str]]


def text_of(value: Any, indent: str = "", field_filter: FieldFilter | None = None) -> str:
    """The text of a field's value. What takes several lines begins with a line break and is indented by `indent`.

    `field_filter(message)` says which fields of a message to print.
    """
    if isinstance(value, Message):
        return _message(value, indent, field_filter)
    if isinstance(value, (Time, Duration)):
        return f"\n{indent}secs: {value.secs}\n{indent}nsecs: {value.nsecs:9d}"
    if isinstance(value, str):
        from roslet.compat.scalars import double_quoted  # only a program that prints needs it

        return double_quoted(value) if value else "''"
    if isinstance(value, (list, tuple)):
        return _list(value, indent, field_filter)
    return str(value)


def _message(message: Message, indent: str, field_filter: FieldFilter | None) -> str:
    names = [row[0] for row in message._spec]
    if field_filter is not None:
        wanted = field_filter(message)
        names = [name for name in names if name in wanted]
    octets = {
        row[0]
        for row, (_, text) in zip(message._spec, message._fields_and_types, strict=True)
        if text[:6] == "uint8["
    }
    lines = []
    for name in names:
        value = getattr(message, name)
        if name in octets and isinstance(value, (bytes, bytearray, memoryview)):
            value = list(value)
        lines.append(f"{indent}{name}: {text_of(value, indent + '  ', field_filter)}")
    return "\n" + "\n".join(lines)


def _list(values: list[Any] | tuple[Any, ...], indent: str, field_filter: FieldFilter | None) -> str:
    if not values:
        return "[]"
    first = values[0]
    if isinstance(first, (int, float)):
        return str(list(values))
    dash = f"\n{indent}- "
    if isinstance(first, str):
        from roslet.compat.scalars import plain_or_quoted

        return "".join([dash + plain_or_quoted(value).replace("\n", "\n" + indent) for value in values])
    return "".join([dash + text_of(value, indent + "  ", field_filter) for value in values])


def message_text(message: Message) -> str:
    """`str(message)` in a rospy program."""
    return text_of(message)[1:]
