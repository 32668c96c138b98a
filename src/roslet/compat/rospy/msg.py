"""`rospy.msg`: AnyMsg, and messages from the arguments of `publish` and of a service call."""

from __future__ import annotations

from struct import pack, unpack_from
from typing import TYPE_CHECKING, Any

from roslet.compat import genpy
from roslet.compat.messages import adapt, tidy
from roslet.compat.rospy.exceptions import ROSException, ROSSerializationException
from roslet.errors import InvalidMessage, MalformedMessage
from roslet.wire.message import Message
from roslet.wire.tcpros import MAX_FRAME

if TYPE_CHECKING:
    from collections.abc import Sequence
    from io import BytesIO


class AnyMsg(Message):
    """A message of any type, as its bytes. A Subscriber with this class hears every type; `_connection_header` of what
    it gets says which (`type`, `md5sum`, `message_definition`)."""

    __slots__ = ["_buff"]

    _type = "*"
    _md5sum = "*"
    _full_text = ""
    _has_header = False
    _slot_types: Sequence[str] = ()
    _buff: bytes | None

    def __init__(self, *args: Any) -> None:
        if args:
            raise ROSException("AnyMsg does not accept arguments")
        self._buff = None

    def serialize(self, buff: BytesIO | None = None) -> Any:
        """Write the bytes to `buff`. Raises ROSException where there are none."""
        if self._buff is None:
            raise ROSException("AnyMsg is not initialized")
        if buff is None:
            return self._buff
        buff.write(self._buff)
        return None

    def deserialize(self, data: Any) -> AnyMsg:  # type: ignore[override]
        """Keep the bytes."""
        self._buff = bytes(data)
        return self

    def __str__(self) -> str:
        return f"AnyMsg({len(self._buff or b'')} bytes)"

    __repr__ = __str__


def args_kwds_to_message(data_class: Any, args: tuple[Any, ...], kwds: dict[str, Any]) -> Any:
    """A message from what `publish` was given: a message, its fields in order, or some by name.

    Raises TypeError, or AttributeError for a name that is no field.
    """
    if args and kwds:
        raise TypeError("publish() can be called with arguments or keywords, but not both.")
    if kwds:
        return data_class(**kwds)
    if len(args) != 1:
        return data_class(*args)
    given = args[0]
    if type(given) is data_class:
        return given
    if isinstance(given, Message):
        if given._md5sum == data_class._md5sum and not isinstance(given, AnyMsg):
            return given
        if isinstance(given, AnyMsg) or data_class is AnyMsg:
            return given
        expected = [text for _name, text in data_class._fields_and_types]
        # One message in place of another may also be that one's only field.
        if len(expected) != 1 or expected[0] != given._type:
            raise TypeError(f"expected [{', '.join(expected)}] but got [{given._type}]")
    return data_class(*args)


def serialize_message(b: BytesIO, seq: int, msg: Any) -> None:
    """Write one frame, length and message, to `b`. Raises ROSSerializationException."""
    if getattr(msg, "_has_header", False):
        msg.header.seq = seq
        if msg.header.frame_id is None:
            msg.header.frame_id = "0"
    try:
        data = AnyMsg.serialize(msg) if isinstance(msg, AnyMsg) else Message.serialize(msg)
    except InvalidMessage as error:
        raise ROSSerializationException(str(error)) from None
    b.write(pack("<I", len(data)))
    b.write(data)


def deserialize_messages(
    b: BytesIO,
    msg_queue: list[Any],
    data_class: Any,
    queue_size: int | None = None,
    max_msgs: int | None = None,
    start: int = 0,
) -> None:
    """Move the complete frames of `b` into `msg_queue`, the last `queue_size` of them. Raises genpy.DeserializationError."""
    data = b.getvalue()[start : b.tell()]
    at = 0
    found: list[bytes] = []
    while at + 4 <= len(data) and (max_msgs is None or len(found) < max_msgs):
        size = unpack_from("<I", data, at)[0]
        if size > MAX_FRAME:
            raise genpy.DeserializationError(f"a message of {size} bytes; at most {MAX_FRAME} are accepted")
        if at + 4 + size > len(data):
            break
        found.append(data[at + 4 : at + 4 + size])
        at += 4 + size
    for body in found[-queue_size:] if queue_size else found:
        msg_queue.append(read(data_class, body))
    b.seek(0)
    b.truncate(0)
    b.write(data[at:])


def read(data_class: Any, body: bytes) -> Any:
    """The message of `data_class` that `body` is. Raises genpy.DeserializationError."""
    if data_class is AnyMsg:
        return AnyMsg().deserialize(body)
    try:
        message = data_class.deserialize_from(memoryview(bytearray(body)), 0, len(body))
    except MalformedMessage as error:
        raise genpy.DeserializationError(str(error)) from None
    tidy(data_class, message)
    return message


__all__ = ["AnyMsg", "adapt", "args_kwds_to_message", "deserialize_messages", "read", "serialize_message"]
