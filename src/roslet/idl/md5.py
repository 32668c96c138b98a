"""ROS 1: the MD5 sum of a definition and its full text (http://wiki.ros.org/ROS/Technical%20Overview,
"Message serialization and msg MD5 sums"; the full text is the `message_definition` of a TCPROS header)."""

from __future__ import annotations

from roslet.errors import Unsupported
from roslet.idl.records import Action, Message, Service, TypeName
from roslet.idl.spelling import RULE_LENGTH

TYPE_CHECKING = False
if TYPE_CHECKING:
    from roslet.idl.registry import Registry

_RULE = "=" * RULE_LENGTH + "\n"


def md5sum(registry: Registry, name: TypeName | str) -> str:
    """The MD5 sum of a ROS 1 message or service, 32 hexadecimal digits.

    Raises Unsupported for ROS 2 and for actions, which have none, and what `Registry.interface` raises.
    """
    _refuse_ros2(registry)
    interface = registry.interface(name)
    sums: dict[TypeName, str] = {}
    for message in _inner_first(registry, interface):
        sums[message.name] = _digest(_md5_text(message, sums))
    if isinstance(interface, Message):
        return _digest(_md5_text(interface, sums))
    if isinstance(interface, Service):
        return _digest(_md5_text(interface.request, sums) + _md5_text(interface.response, sums))
    raise Unsupported("an action of ROS 1 has no MD5 sum: its messages have")


def full_text(registry: Registry, name: TypeName | str) -> str:
    """The ROS 1 definition with those of all nested types after it, as the `message_definition` of a header
    carries it.

    For a service that is the text of the file; ask for `pkg/NameRequest` to get a part's. Raises as `md5sum`
    does.
    """
    _refuse_ros2(registry)
    interface = registry.interface(name)
    if isinstance(interface, Action):
        raise Unsupported("an action of ROS 1 has no full text: its messages have")
    pieces = [interface.text]
    for message in registry.dependencies(interface.name):
        pieces.append("{}MSG: {}\n{}".format(_RULE, message.name.text("ros1"), message.text))
    return "\n".join(pieces)


def _refuse_ros2(registry: Registry) -> None:
    if registry.dialect != "ros1":
        raise Unsupported("MD5 sums and full texts belong to ROS 1: ROS 2 types have a type hash")


def _inner_first(registry: Registry, interface: Message | Service | Action) -> list[Message]:
    """The dependencies, each after all that it is made of."""
    messages = {message.name: message for message in registry.dependencies(interface.name)}
    ordered: dict[TypeName, Message] = {}
    waiting = list(messages)
    while waiting:
        name = waiting[-1]
        missing = [
            field.type.message
            for field in messages[name].fields
            if field.type.message is not None and field.type.message not in ordered
        ]
        if missing:
            waiting += missing
        else:
            ordered.setdefault(name, messages[name])
            waiting.pop()
    return list(ordered.values())


def _md5_text(message: Message, sums: dict[TypeName, str]) -> str:
    """Constants in order, then fields; a nested type is its own sum and loses its brackets."""
    lines = [f"{constant.type.spelled} {constant.name}={constant.text}" for constant in message.constants]
    for field in message.fields:
        nested = field.type.message
        lines.append(f"{field.type if nested is None else sums[nested]} {field.name}")
    return "\n".join(lines).strip()


def _digest(text: str) -> str:
    import hashlib  # the costliest import of this room, and only a hash needs it

    return hashlib.md5(text.encode("utf-8", "surrogateescape"), usedforsecurity=False).hexdigest()
