"""Parameter lists as values: a table says which parameter becomes which field. RTPS 2.3, 9.6.2.2."""

from roslet.errors import ProtocolError
from roslet.record import Record
from roslet.wire.rtps import parameter_list
from roslet.wire.rtps.locator import MAX_LOCATORS
from roslet.wire.rtps.parameter_list import FLAG_MUST_UNDERSTAND, FLAG_VENDOR

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from roslet.wire.rtps.values import Codec


class Parameter(Record):
    """Parameter `pid` is field `name`; `many`: it may come again, and the field is a tuple."""

    _fields = ("pid", "name", "codec", "many")
    __slots__ = _fields

    def __init__(self, pid: int, name: str, codec: "Codec", many: bool = False) -> None:
        self.pid = pid
        self.name = name
        self.codec = codec
        self.many = many


def table(parameters: "tuple[Parameter, ...]") -> "dict[int, Parameter]":
    """By parameter id."""
    return {parameter.pid: parameter for parameter in parameters}


def parse(
    data: "bytes | bytearray | memoryview", at: int, end: int, flags: int, known: "dict[int, Parameter]"
) -> "dict[str, Any]":
    """Fields by name, those of absent parameters left out. Of a parameter that comes twice the first counts.

    A known parameter of no octets is as good as absent. A standard parameter that must be understood and is
    not makes the whole list void. Of a field that may come again, what is beyond MAX_LOCATORS is left out.
    Raises ProtocolError: parameter-not-understood, parameter-truncated, parameter-too-many-elements, and what a list
    may be wrong in.
    """
    found: dict[str, Any] = {}
    for pid, start, stop in parameter_list.parse(data, at, end, flags):
        parameter = known.get(pid)
        if parameter is None:
            if pid & FLAG_MUST_UNDERSTAND and not pid & FLAG_VENDOR:
                raise ProtocolError("parameter-not-understood", "pid %d" % pid)
            continue
        if start == stop:
            continue
        name = parameter.name
        if parameter.many:
            held = list(found.get(name, ()))
            if len(held) < MAX_LOCATORS:
                held.append(parameter.codec[0](data, start, stop, flags))
                found[name] = tuple(held)
        elif name not in found:
            found[name] = parameter.codec[0](data, start, stop, flags)
    return found


def emit(
    value: object, parameters: "tuple[Parameter, ...]", defaults: object, little: bool
) -> "list[tuple[int, bytes]]":
    """(pid, octets) of every field that is not as in `defaults`, in the order of `parameters`."""
    found = []
    for parameter in parameters:
        field = getattr(value, parameter.name)
        if field is None or field == getattr(defaults, parameter.name):
            continue
        for one in field if parameter.many else (field,):
            found.append((parameter.pid, parameter.codec[1](one, little)))
    return found
