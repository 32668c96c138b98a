"""Names of ROS 1: what is legal, how a relative name becomes a full one, what arguments remap.

Source: ROS 1 graph resource names and name resolution. Runs on MicroPython.
"""

from roslet.errors import InvalidName
from roslet.names.characters import DIGITS, LETTERS, MAX_NAME

_FIRST = LETTERS + "~/"
_REST = LETTERS + DIGITS + "_/"


def check_name(name: str) -> str:
    """`name` itself, where it is a legal graph resource name (relative, global or private; may be empty).

    Raises InvalidName and says which character is wrong.
    """
    if len(name) > MAX_NAME:
        raise InvalidName("a name of %d characters; at most %d are allowed" % (len(name), MAX_NAME))
    for at, char in enumerate(name):
        if char not in (_REST if at else _FIRST):
            raise InvalidName("%r: character %d, %r, is not allowed in a ROS name" % (name, at + 1, char))
    if "//" in name:
        raise InvalidName("%r: an empty name between two slashes" % name)
    return name


def check_base_name(name: str) -> str:
    """`name` itself, where it is legal and has no namespace, as a node's own name must be. Raises InvalidName."""
    check_name(name)
    if not name or "/" in name or "~" in name:
        raise InvalidName("%r is no base name: it must not be empty and must hold neither '/' nor '~'" % name)
    return name


def canonical(name: str) -> str:
    """`name` without doubled or trailing slashes."""
    while "//" in name:
        name = name.replace("//", "/")
    if len(name) > 1 and name.endswith("/"):
        name = name[:-1]
    return name


def namespace_of(name: str) -> str:
    """The namespace of a full name, with a slash at its end: `/a/b` is in `/a/`, `/a` in `/`."""
    if name == "/":
        return "/"
    if name.endswith("/"):
        name = name[:-1]
    return name[: name.rfind("/") + 1] or "/"


def join(namespace: str, name: str) -> str:
    """`name` within `namespace`; a global name is itself."""
    if name.startswith("/") or not namespace:
        return name
    if not name:
        return canonical(namespace)
    return canonical(namespace + "/" + name)


def resolve(name: str, node_name: str, remappings: "dict[str, str] | None" = None) -> str:
    """The full name that `name` has within the node `node_name` (a full name), after remapping.

    A name that starts with '/' is global, with '~' private to the node, otherwise relative to the node's namespace.
    Remappings are full name to full name. Raises InvalidName.
    """
    check_name(name)
    if not name:
        return canonical(namespace_of(node_name))
    if name[0] == "/":
        full = canonical(name)
    elif name[0] == "~":
        full = join(node_name, name[1:].lstrip("/"))
    else:
        full = join(namespace_of(node_name), name)
    if remappings:
        return remappings.get(full, full)
    return full


class Arguments:
    """A program's arguments, sorted as ROS 1 sorts them.

    remappings   `from:=to`, names as written
    parameters   `_name:=value`, set as private parameters; values as text (YAML is read by whoever sets them)
    specials     `__name:=x`, without the underscores: name, ns, master, ip, hostname, log
    rest         every other argument
    """

    def __init__(self, arguments: "list[str] | tuple[str, ...]") -> None:
        self.remappings: dict[str, str] = {}
        self.parameters: dict[str, str] = {}
        self.specials: dict[str, str] = {}
        self.rest: list[str] = []
        for argument in arguments:
            key, found, value = argument.partition(":=")
            if not found or not key:
                self.rest.append(argument)
            elif key.startswith("__"):
                self.specials[key[2:]] = value
            elif key.startswith("_"):
                self.parameters[key[1:]] = value
            else:
                self.remappings[key] = value

    def resolved(self, node_name: str) -> "dict[str, str]":
        """The remappings as full names, for the node `node_name`. Raises InvalidName."""
        table = {}
        for key, value in self.remappings.items():
            table[resolve(key, node_name)] = resolve(value, node_name)
        return table
