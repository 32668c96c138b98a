"""The service that tells others what a type is made of: `~/get_type_description`."""

from __future__ import annotations

from roslet.errors import DefinitionError, InvalidName

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from roslet.node.ros2.network import Ros2Network

SERVICE = "type_description_interfaces/srv/GetTypeDescription"


def offer(network: Ros2Network) -> None:
    """Offer the service for every type that this process can find."""
    network.service(network.own_service("get_type_description"), SERVICE, describe, background=True)


def describe(request: Any) -> dict[str, Any]:
    """The response to a request: the description where the hash is ours too. Texts of the definitions are not sent."""
    from roslet.gen.runtime import message_class, registry
    from roslet.idl.rihs import type_description, type_hash

    types = registry("ros2")
    try:
        description = type_description(types, request.type_name, defaults=True)
        own = type_hash(types, request.type_name)
    except (DefinitionError, InvalidName) as error:
        return {"successful": False, "failure_reason": str(error)}
    if request.type_hash and request.type_hash != own:
        reason = f"{request.type_name} is {own} here, not {request.type_hash}"
        return {"successful": False, "failure_reason": reason}
    return {
        "successful": True,
        "type_description": _message(
            message_class("ros2", "type_description_interfaces/msg/TypeDescription"), description
        ),
    }


def _message(kind: Any, value: dict[str, Any]) -> Any:
    """A message of nested dicts."""
    from roslet.gen.runtime import message_class

    made = kind()
    for name, item in value.items():
        spelled = dict(kind._fields_and_types)[name]
        inner = spelled.partition("[")[0]
        if isinstance(item, dict):
            item = _message(message_class("ros2", inner), item)
        elif isinstance(item, list):
            item = [_message(message_class("ros2", inner), one) for one in item]
        setattr(made, name, item)
    return made
