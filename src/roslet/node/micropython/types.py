"""Message classes on MicroPython: those that the bundle holds, found by name. Stands where CPython has `roslet.gen.runtime`."""

from roslet.errors import UnknownType
from roslet.wire.message import Message, rescue_read, rescue_write

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

PACKAGE = "roslet.msgs."


class Compact(Message):
    """The base of a class without code of its own: it is written and read by its field table, which is smaller and slower."""

    def serialize_into(self, buffer: "Any", offset: int = 0, parts: "Any" = None) -> int:
        return rescue_write(self, buffer, offset, parts, ValueError())

    @classmethod
    def deserialize_from(cls, buffer: "Any", start: int, end: int) -> "Any":
        return rescue_read(cls, buffer, start, end)


def find(dialect: str, name: "Any", kind: str = "msg") -> "Any":
    """The class of a type by its name, or of a class that is one of the other network's. Raises UnknownType."""
    if not isinstance(name, str):
        encoding = getattr(name, "_encoding", None) or name.Request._encoding
        if (encoding == "ros1") == (dialect == "ros1"):
            return name
        name = name._type
    parts = name.split("/")
    if len(parts) == 2:
        parts.insert(1, kind)
    module = PACKAGE + dialect + "." + parts[0] + "." + parts[1]
    try:
        return getattr(__import__(module, None, None, (parts[2],)), parts[2])
    except (ImportError, AttributeError):
        raise UnknownType("%s is not in this bundle; name it with --types" % name) from None


def message_class(dialect: str, name: "Any") -> "Any":
    """The class of a message. Raises UnknownType."""
    return find(dialect, name)


def service_class(dialect: str, name: "Any") -> "Any":
    """The class of a service. Raises UnknownType."""
    return find(dialect, name, "srv")


class Types:
    """What `roslet.load` returns: packages as attributes. The definitions were read when the bundle was made."""

    def __init__(self, path: str) -> None:
        self._path = path

    def __getattr__(self, name: str) -> "Any":
        if name in ("msg", "srv"):
            return __import__(self._path + "." + name, None, None, (name,))
        return Types(self._path + "." + name)


def load(path: "Any", dialect: "str | None" = None) -> Types:
    """Classes of the bundle; `path` is not looked at."""
    from roslet.msgs import DIALECT  # type: ignore[attr-defined]  # a bundle's

    return Types(PACKAGE + (dialect or DIALECT))


def converted(kind: "Any", value: "Any", where: str) -> "Any":
    """`value` as a message of `kind`: one, a dict of its fields, None for an empty one. Raises TypeError."""
    if value is None:
        return kind()
    if isinstance(value, kind):
        return value
    if isinstance(value, dict):
        return kind(**value)
    raise TypeError("%s %s, not %s" % (where, kind._type, type(value).__name__))
