"""`rospy.names`: graph resource names. Like rospy's, these accept what is no legal name and only tidy it."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING

from roslet.compat.session import session
from roslet.errors import InvalidName
from roslet.names import canonical, check_name, join, namespace_of

if TYPE_CHECKING:
    from collections.abc import Sequence

SEP = "/"
GLOBALNS = "/"
PRIV_NAME = "~"
REMAP = ":="
ANYTYPE = "*"
TOPIC_ANYTYPE = ANYTYPE
SERVICE_ANYTYPE = ANYTYPE


def canonicalize_name(name: str) -> str:
    """`name` without doubled or trailing slashes."""
    return canonical(name) if name and name != SEP else name


def is_global(name: str) -> bool:
    return name.startswith(SEP)


def is_private(name: str) -> bool:
    return name.startswith(PRIV_NAME)


def namespace(name: str) -> str:
    """The namespace of a full name, with a slash at its end."""
    return namespace_of(name)


def make_global_ns(name: str) -> str:
    """`name` with a slash at both ends. Raises ValueError for a private name."""
    if is_private(name):
        raise ValueError(f"cannot turn a private name [{name}] into a global one")
    full = name if name.startswith(SEP) else SEP + name
    return full if full.endswith(SEP) else full + SEP


def global_name(name: str) -> str:
    return name if name.startswith(SEP) else SEP + name


def ns_join(ns: str, name: str) -> str:
    """`name` in the namespace `ns`; a global or private name is itself."""
    if is_private(name) or is_global(name):
        return name
    if ns == PRIV_NAME:
        return PRIV_NAME + name
    if not ns:
        return name
    return ns + name if ns.endswith(SEP) else ns + SEP + name


def scoped_name(caller_id: str, name: str) -> str:
    """`name` as seen from the namespace of `caller_id`, where it lies within it."""
    caller = canonicalize_name(caller_id)
    full = canonicalize_name(name)
    if not is_global(caller):
        raise ValueError("caller_id must be global")
    prefix = namespace_of(caller)
    return full[len(prefix) :] if full != prefix and full.startswith(prefix) else full


def get_caller_id() -> str:
    """The node's full name."""
    return session.name


def get_name() -> str:
    """The node's full name."""
    return session.name


def get_namespace() -> str:
    """The node's namespace, with a slash at its end."""
    return namespace_of(session.name)


def get_ros_namespace(env: dict[str, str] | None = None, argv: Sequence[str] | None = None) -> str:
    """The namespace of a command line and an environment, with a slash at both ends."""
    for argument in sys.argv if argv is None else argv:
        if argument.startswith("__ns:="):
            return make_global_ns(argument[len("__ns:=") :])
    environment = os.environ if env is None else env
    return make_global_ns(environment.get("ROS_NAMESPACE", SEP))


def load_mappings(argv: Sequence[str]) -> dict[str, str]:
    """The remappings `from:=to` of a command line, as written; private parameters `_p:=v` are none."""
    found = {}
    for argument in argv:
        key, assigned, value = argument.partition(REMAP)
        if assigned and key and value and not (key.startswith("_") and not key.startswith("__")):
            found[key] = value
    return found


def get_mappings() -> dict[str, str]:
    """The remappings of this program, as written."""
    given = session.arguments
    return {**given.remappings, **{"__" + key: value for key, value in given.specials.items()}}


def get_resolved_mappings() -> dict[str, str]:
    """The remappings of this program as full names."""
    return session.arguments.resolved(session.name)


def resolve_name(name: str, caller_id: str | None = None) -> str:
    """The full name of `name` in this node, or in the node `caller_id`; remapped as soon as there is a node."""
    full = _full(name, session.name if caller_id is None else caller_id)
    return get_resolved_mappings().get(full, full) if session.initialized else full


def _full(name: str, caller_id: str) -> str:
    if not name:
        return namespace_of(caller_id)
    if is_global(name):
        return canonical(name)
    if is_private(name):
        return canonical(caller_id + SEP + name[1:])
    return join(namespace_of(caller_id), canonical(name))


def resolve_name_without_node_name(name: str) -> str:
    """The full name, remapped, of a name that is not private, while the node has no name yet. Raises ValueError for a
    private one."""
    if is_private(name):
        raise ValueError("~name topics cannot be created before init_node() has been called")
    full = _full(name, session.name)
    return get_resolved_mappings().get(full, full)


def remap_name(name: str, caller_id: str | None = None, resolved: bool = True) -> str:
    """`name`, or what a remapping puts in its place; with `resolved` that is a full name."""
    given = session.arguments.remappings
    if name in given:
        return resolve_name(given[name], caller_id) if resolved else given[name]
    return name


def valid_name(param_name: str, require_value: bool = True) -> object:
    """A validator of rospy's: a function (name, caller_id) -> name that raises ValueError for what is no name."""

    def check(value: object, caller_id: str) -> str:
        if not isinstance(value, str) or (require_value and not value):
            raise ValueError(f"ERROR: parameter [{param_name}] must be a non-empty string")
        try:
            check_name(value)
        except InvalidName as error:
            raise ValueError(f"ERROR: parameter [{param_name}]: {error}") from None
        return _full(value, caller_id)

    return check
