"""Message classes on MicroPython: those that the bundle holds, found by name. Stands where CPython has
`roslet.gen.runtime`."""

from roslet.errors import UnknownType
from roslet.wire.message import Message, rescue_read, rescue_write

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class Compact(Message):
    """The base of a class without code of its own: it is written and read by its field table, which is smaller and
    slower."""

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
    if name.count("/") == 1:
        name = name.replace("/", "/" + kind + "/")
    from roslet.msgs import TYPES  # type: ignore[attr-defined]  # a bundle's

    found = TYPES.get(name)
    if found is None:
        raise UnknownType("%s is not in this bundle; name it with --type" % name)
    return found


def message_class(dialect: str, name: "Any") -> "Any":
    """The class of a message. Raises UnknownType."""
    return find(dialect, name)


def service_class(dialect: str, name: "Any") -> "Any":
    """The class of a service. Raises UnknownType."""
    return find(dialect, name, "srv")


class Types:
    """What `roslet.load` returns: packages as attributes. The definitions were read when the bundle was made."""

    def __init__(self, path: str = "") -> None:
        self._path = path

    def __getattr__(self, name: str) -> "Any":
        path = self._path + name
        return find("", path) if path.count("/") == 2 else Types(path + "/")


def load(path: "Any", dialect: "str | None" = None) -> Types:
    """Classes of the bundle; `path` and `dialect` are not looked at."""
    return Types()


def converted(kind: "Any", value: "Any", where: str) -> "Any":
    """`value` as a message of `kind`: one, a dict of its fields, None for an empty one. Raises TypeError."""
    if value is None:
        return kind()
    if isinstance(value, kind):
        return value
    if isinstance(value, dict):
        return kind(**value)
    raise TypeError("%s %s, not %s" % (where, kind._type, type(value).__name__))
