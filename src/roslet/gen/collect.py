"""All that a definition is made of, for backends that write files."""

from __future__ import annotations

from roslet.idl import Message, Service

TYPE_CHECKING = False
if TYPE_CHECKING:
    from roslet.idl import Interface, Registry


def collect(registry: Registry, interface: Interface, found: dict[str, Interface]) -> None:
    """Put `interface`, its parts, and all they are made of into `found`, each under a key of its own."""
    key = str(interface.name) + "#" + type(interface).__name__
    if key in found:
        return
    found[key] = interface
    if isinstance(interface, Message):
        for field in interface.fields:
            if field.type.message is not None:
                collect(registry, registry.message(field.type.message), found)
        return
    parts: list[Interface] = []
    if isinstance(interface, Service):
        parts += [interface.request, interface.response]
        if interface.event is not None:
            parts.append(interface.event)
    else:
        parts += [
            interface.goal,
            interface.result,
            interface.feedback,
            *interface.services,
            *interface.messages,
        ]
    for part in parts:
        collect(registry, part, found)
