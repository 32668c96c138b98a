"""Immutable value classes and name tables for the core, without dataclasses or enum (MicroPython has neither)."""

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing_extensions import Self


class Record:
    """A value with named fields.

    A subclass lists its field names in `_fields` and takes them in that order in `__init__`, which sets them through
    `_set`. Records of one class
    with equal fields are equal; a record is hashable where its fields are. Treat it as immutable: nothing assigns
    to a field after `__init__`.
    """

    _fields: tuple[str, ...] = ()
    __slots__ = ()

    def _set(self, *values: object) -> None:
        """Set the fields, in the order of `_fields`."""
        for name, value in zip(self._fields, values):  # noqa: B905 - MicroPython's zip is not strict
            setattr(self, name, value)

    def _values(self) -> tuple[object, ...]:
        return tuple([getattr(self, name) for name in self._fields])

    def replace(self, **changes: object) -> "Self":
        """A copy with some fields changed. Raises TypeError for a name that is no field."""
        values = []
        for name in self._fields:
            values.append(changes.pop(name) if name in changes else getattr(self, name))
        if changes:
            raise TypeError("%s has no field %s" % (type(self).__name__, ", ".join(sorted(changes))))
        return type(self)(*values)

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and self._values() == other._values()

    def __hash__(self) -> int:
        return hash((type(self).__name__,) + self._values())  # noqa: RUF005 - as MicroPython compiles it

    def __repr__(self) -> str:
        inside = ", ".join(["%s=%r" % (name, getattr(self, name)) for name in self._fields])
        return "%s(%s)" % (type(self).__name__, inside)


class Names:
    """A table of integer constants and their printed names; `names[3]` prints unknown values as `prefix(3)`."""

    def __init__(self, prefix: str, table: dict[int, str]) -> None:
        self.prefix = prefix
        self.table = table

    def __getitem__(self, value: int) -> str:
        name = self.table.get(value)
        return name if name is not None else "%s(%d)" % (self.prefix, value)
