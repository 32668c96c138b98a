"""What a program hands over as a message: one of the right class, a dict of its fields, or one of the same definition that
belongs to the other network."""

from __future__ import annotations

from roslet.wire.cursor import SINGLE
from roslet.wire.message import Message
from roslet.wire.time import Duration, Time

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def message_of(kind: type[Message], value: Any, where: str) -> Message:
    """`value` as a message of class `kind`.

    It may be one; a dict of its fields; a message of another class made from an equal definition; a message of the class
    that the definition of this name has on the other network, as `load` and `roslet.msgs` give them. The last is copied
    field by field. Raises TypeError; `where` begins its sentence, as in "/chatter carries".
    """
    if isinstance(value, kind):
        return value
    if isinstance(value, dict):
        return kind(**value)
    hashes = getattr(value, "_md5sum", ""), getattr(value, "_type_hash", "")
    if hashes == (kind._md5sum, kind._type_hash) and hasattr(value, "serialize"):
        return kind.deserialize(value.serialize())
    if isinstance(value, Message) and _key(value._type) == _key(kind._type):
        return _across(kind, value)
    raise TypeError(f"{where} {kind._type}, not {getattr(value, '_type', type(value).__name__)}")


def _key(name: str) -> tuple[str, str]:
    """What a type's names on both networks have in common: `p/AddRequest` is `p/srv/Add_Request`."""
    package, _, rest = name.partition("/")
    return package, rest.rpartition("/")[2].replace("_", "")


def _across(kind: type[Message], message: Message) -> Message:
    """The message of `kind` with the values of one whose class belongs to the other network. The sequence number of ROS 1's
    header, which ROS 2 has not, is left out or zero; any other field that only one of them has raises TypeError."""
    theirs = {row[0] for row in message._spec}
    for one in sorted(theirs ^ {row[0] for row in kind._spec}):
        if not (kind.__name__ == "Header" and one == "seq"):
            lacking = message if one not in theirs else kind
            raise TypeError(f"{lacking._type} has no field {one}, which the other network's has")
    made = kind()
    for attribute, base, array, _size, _bound in kind._spec:
        if attribute in theirs:
            value = getattr(message, attribute)
            if array != SINGLE and not _is_plain(base):
                value = [_one(base, element) for element in value]
            elif array == SINGLE:
                value = _one(base, value)
            setattr(made, attribute, value)
    return made


def _is_plain(base: Any) -> bool:
    return isinstance(base, str) and base not in ("time", "duration")


def _one(base: Any, value: Any) -> Any:
    if base == "time" or base == "duration":
        made = (Time if base == "time" else Duration)()
        made.set(value.secs, value.nsecs)
        return made
    if isinstance(base, str) or not isinstance(value, Message):
        return value
    return _across(base, value) if value.__class__ is not base else value
