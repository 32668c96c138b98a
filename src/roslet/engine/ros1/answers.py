"""What a master answers about the graph, as dicts. Runs on MicroPython.

Source: ROS Master API, getSystemState and getTopicTypes; Parameter Server API, getParamNames. All raise
ProtocolError("bad-reply") for a value of another shape.
"""

from roslet.errors import ProtocolError

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    Part = dict[str, list[str]]


def system_state(value: "Any") -> "tuple[Part, Part, Part]":
    """Publishers, subscribers and services: each name with its nodes."""
    try:
        publishers, subscribers, services = [
            {str(name): _texts(nodes) for name, nodes in _rows(part)} for part in _rows(value)
        ]
    except (TypeError, ValueError):
        raise _wrong("[publishers, subscribers, services]", value) from None
    return publishers, subscribers, services


def topic_types(value: "Any") -> "dict[str, str]":
    """Each topic with its type."""
    try:
        return {str(topic): str(kind) for topic, kind in _rows(value)}
    except (TypeError, ValueError):
        raise _wrong("[[topic, type], ...]", value) from None


def parameter_names(value: "Any") -> "list[str]":
    """The full name of every parameter."""
    try:
        return _texts(value)
    except TypeError:
        raise _wrong("a list of names", value) from None


def _rows(value: "Any") -> "list[Any]":
    """Text and dicts can be iterated as well, and are no list."""
    if not isinstance(value, (list, tuple)):
        raise TypeError
    return list(value)


def _texts(value: "Any") -> "list[str]":
    return [str(one) for one in _rows(value)]


def _wrong(expected: str, value: "Any") -> ProtocolError:
    return ProtocolError("bad-reply", "expected %s, got %s" % (expected, repr(value)[:80]))
