"""`genpy.message`: message classes by name, printing, filling a message from values."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from roslet.compat.messages import DeserializationError, MessageException, SerializationError, adapt
from roslet.compat.printing import text_of
from roslet.errors import RosletError
from roslet.gen import runtime
from roslet.wire.cursor import SINGLE
from roslet.wire.message import Message
from roslet.wire.time import Duration, Time

if TYPE_CHECKING:
    from collections.abc import Callable


def get_message_class(message_type: str, reload_on_error: bool = False) -> type[Message] | None:
    """The class of `pkg/Name`; None where there is none. `reload_on_error` has no effect."""
    try:
        return adapt(runtime.message_class("ros1", message_type))  # type: ignore[no-any-return]
    except RosletError:
        return None


def get_service_class(service_type: str, reload_on_error: bool = False) -> Any:
    """The class of the service `pkg/Name`; None where there is none. `reload_on_error` has no effect."""
    try:
        return adapt(runtime.service_class("ros1", service_type))
    except RosletError:
        return None


def strify_message(
    val: Any,
    indent: str = "",
    time_offset: Time | None = None,
    current_time: Time | None = None,
    field_filter: Callable[[Message], list[str]] | None = None,
    fixed_numeric_width: int | None = None,
) -> str:
    """The text of a message or value, as `print` shows it. Offsets and widths of rostopic's options have no effect."""
    text = text_of(val, indent, field_filter)
    return text[1:] if text.startswith("\n") and isinstance(val, Message) else text


def fill_message_args(msg: Message, msg_args: Any, keys: dict[str, Any] | None = None) -> None:
    """Set the fields of `msg` from a list (all fields), a list of one dict, or a dict of some. `keys` are values that a
    string may stand for, such as `now`. Raises MessageException for what does not fit."""
    if isinstance(msg_args, dict):
        _fill(msg, msg_args, keys or {}, "")
    elif isinstance(msg_args, (list, tuple)):
        if len(msg_args) == 1 and isinstance(msg_args[0], dict):
            _fill(msg, msg_args[0], keys or {}, "")
        else:
            _fill(msg, list(msg_args), keys or {}, "")
    else:
        raise MessageException(f"invalid message_args type: {msg_args}")


def _fill(message: Any, values: Any, keys: dict[str, Any], path: str) -> None:
    if isinstance(message, (Time, Duration)):
        if isinstance(values, dict):
            message.set(int(values.get("secs", 0)), int(values.get("nsecs", 0)))
        else:
            message.set(int(values[0]), int(values[1]))
        return
    names = [row[0] for row in message._spec]
    if isinstance(values, dict):
        for name in values:
            if name not in names:
                raise MessageException(f"No field name [{path}{name}]")
        pairs = list(values.items())
    elif isinstance(values, (list, tuple)):
        if len(values) != len(names):
            raise MessageException(
                f"{path or message._type}: expected {len(names)} values, got {len(values)}"
            )
        pairs = list(zip(names, values, strict=True))
    else:
        raise MessageException(f"{path or message._type}: cannot be filled from {values!r}")
    rows = {row[0]: row for row in message._spec}
    for name, value in pairs:
        if isinstance(value, str) and value in keys:
            setattr(message, name, keys[value])
            continue
        _name, base, shape, _size, _bound = rows[name]
        deep = not isinstance(base, str) or base in ("time", "duration")
        if not deep:
            setattr(message, name, value)
        elif shape == SINGLE:
            _fill(getattr(message, name), value, keys, f"{path}{name}.")
        else:
            made = []
            for at, element in enumerate(value):
                made.append(_new(base))
                _fill(made[-1], element, keys, f"{path}{name}[{at}].")
            setattr(message, name, made)


def _new(base: Any) -> Any:
    return {"time": Time, "duration": Duration}[base]() if isinstance(base, str) else base()


__all__ = [
    "DeserializationError",
    "Duration",
    "Message",
    "MessageException",
    "SerializationError",
    "Time",
    "fill_message_args",
    "get_message_class",
    "get_service_class",
    "strify_message",
]
