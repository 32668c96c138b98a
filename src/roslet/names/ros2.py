"""Names of ROS 2: what is legal, what DDS calls it, how a name becomes a full one, what arguments remap.

Sources: the design documents "Topic and Service name mapping to DDS" and "ROS Command Line Arguments", and what rcl
accepts. Runs on MicroPython.
"""

from roslet.errors import InvalidName
from roslet.names.characters import DIGITS, LETTERS, MAX_NAME
from roslet.record import Record

_INSIDE = LETTERS + DIGITS + "_"

# What a topic or service name may have at most: 255, the limit of DDS, without the longest prefix and suffix.
MAX_ROS2_NAME = 247
# Characters of a node's own name.
MAX_NODE_NAME = 255

TOPIC, REQUEST, REPLY = "rt", "rq", "rr"
"""What a DDS topic carries, and its prefix there."""

_SUFFIXES = {TOPIC: "", REQUEST: "Request", REPLY: "Reply"}


def dds_topic(kind: str, name: str) -> str:
    """The DDS topic of a full ROS 2 name: `/a` is `rt/a`; the service `/s` is `rq/sRequest` and `rr/sReply`."""
    return kind + name + _SUFFIXES[kind]


def ros_topic(topic: str) -> "tuple[str, str] | None":
    """(TOPIC, REQUEST or REPLY; full name) of a DDS topic, or None where it is not one of ROS."""
    kind, found, name = topic.partition("/")
    suffix = _SUFFIXES.get(kind)
    if not found or suffix is None or not name.endswith(suffix) or len(name) == len(suffix):
        return None
    return kind, "/" + (name[: -len(suffix)] if suffix else name)


def dds_type(name: str) -> str:
    """`std_msgs/msg/String` is `std_msgs::msg::dds_::String_`. Raises InvalidName where it has not three parts."""
    parts = name.split("/")
    if len(parts) != 3 or "" in parts:
        raise InvalidName("%r is no type of ROS 2; write package/msg/Name" % name)
    return "%s::%s::dds_::%s_" % (parts[0], parts[1], parts[2])


def ros_type(name: str) -> "str | None":
    """The ROS type of a DDS type, or None where it is not one of ROS. Of a service's request and response it gives
    the message's own name, `pkg/srv/Name_Request`; see `ros_service_type`."""
    parts = name.split("::")
    if len(parts) != 4 or parts[2] != "dds_" or not parts[3].endswith("_") or len(parts[3]) < 2:
        return None
    return "%s/%s/%s" % (parts[0], parts[1], parts[3][:-1])


def dds_service_types(name: str) -> "tuple[str, str]":
    """The DDS types of a service's request and response. Raises InvalidName."""
    return dds_type(name + "_Request"), dds_type(name + "_Response")


def ros_service_type(name: str) -> "str | None":
    """The service whose request or response the DDS type `name` is, or None."""
    found = ros_type(name)
    for suffix in ("_Request", "_Response"):
        if found is not None and found.endswith(suffix) and not found.endswith("/" + suffix):
            return found[: -len(suffix)]
    return None


def check_ros2_name(name: str) -> str:
    """`name` itself, where it is a legal name of a topic or service: relative, global, private (`~`, `~/x`), with
    `{substitutions}`. Raises InvalidName and says which character is wrong."""
    if not name:
        raise InvalidName("a name must not be empty")
    if len(name) > MAX_NAME:
        raise InvalidName("a name of %d characters; at most %d are allowed" % (len(name), MAX_ROS2_NAME))
    if name != "~" and name[0] == "~" and name[1] != "/":
        raise InvalidName("%r: '~' is followed by '/'" % name)
    opened = -1
    for at, char in enumerate(name):
        if char == "{" and opened < 0:
            opened = at
        elif char == "}" and opened >= 0:
            if at == opened + 1 or name[opened + 1] in DIGITS:
                raise InvalidName("%r: character %d begins no substitution" % (name, opened + 1))
            opened = -1
        elif char not in _INSIDE and (opened >= 0 or char not in "/~" or (char == "~" and at)):
            raise InvalidName("%r: character %d, %r, is not allowed in a ROS name" % (name, at + 1, char))
        elif char in DIGITS and (at == 0 or name[at - 1] == "/"):
            raise InvalidName("%r: character %d, %r, must not begin a name" % (name, at + 1, char))
        elif char == "/" and at and name[at - 1] == "/":
            raise InvalidName("%r: an empty name between two slashes, at character %d" % (name, at + 1))
    if opened >= 0:
        raise InvalidName("%r: character %d, '{', is never closed" % (name, opened + 1))
    if name.endswith("/"):
        raise InvalidName("%r: character %d, '/', must not end a name" % (name, len(name)))
    return name


def check_full_name(name: str) -> str:
    """`name` itself, where it is a legal full name of a topic or service. Raises InvalidName."""
    check_ros2_name(name)
    if name[0] != "/":
        raise InvalidName("%r does not begin with '/'" % name)
    if "{" in name:
        raise InvalidName("%r: character %d, '{', is not allowed in a full name" % (name, name.find("{") + 1))
    if len(name) > MAX_ROS2_NAME:
        raise InvalidName("a name of %d characters; at most %d are allowed" % (len(name), MAX_ROS2_NAME))
    return name


def check_namespace(name: str) -> str:
    """`name` itself, where it is a legal namespace: `/`, or a full name. Raises InvalidName."""
    return name if name == "/" else check_full_name(name)


def check_node_name(name: str) -> str:
    """`name` itself, where a ROS 2 node may have it: letters, digits and `_`, not a digit first. Raises InvalidName."""
    if not name:
        raise InvalidName("a node's name must not be empty")
    if len(name) > MAX_NODE_NAME:
        raise InvalidName(
            "a node's name of %d characters; at most %d are allowed" % (len(name), MAX_NODE_NAME)
        )
    for at, char in enumerate(name):
        if char not in _INSIDE:
            raise InvalidName("%r: character %d, %r, is not allowed in a node's name" % (name, at + 1, char))
    if name[0] in DIGITS:
        raise InvalidName("%r: character 1, %r, must not begin a name" % (name, name[0]))
    return name


def expand(name: str, node_name: str, namespace: str = "/") -> str:
    """The full name of a ROS 2 name within a node, before remapping. Raises InvalidName."""
    check_ros2_name(name)
    within = "" if namespace == "/" else namespace
    if name[0] == "~":
        name = "%s/%s%s" % (within, node_name, name[1:])
    parts = name.split("{")
    name = parts[0]
    for part in parts[1:]:
        key, _, rest = part.partition("}")
        if key == "node":
            name += node_name
        elif key == "ns" or key == "namespace":
            name += namespace
        else:
            raise InvalidName("{%s} is no substitution; there are {node}, {ns} and {namespace}" % key)
        name += rest
    return check_full_name(name if name[0] == "/" else within + "/" + name)


class Remapping(Record):
    """One rule: within node `node` (any where empty), `source` becomes `target`. `only`: TOPIC or REQUEST where the rule
    is for topics or services alone, else empty. Names as written; `__node` and `__ns` are rules as well."""

    _fields = ("node", "source", "target", "only")
    __slots__ = _fields

    def __init__(self, node: str, source: str, target: str, only: str = "") -> None:
        self.node = node
        self.source = source
        self.target = target
        self.only = only


def resolve_ros2(
    name: str,
    node_name: str,
    namespace: str = "/",
    remappings: "list[Remapping] | tuple[Remapping, ...]" = (),
    kind: str = TOPIC,
) -> str:
    """The full name that a topic (`kind` TOPIC) or service (REQUEST) has within a node. The first rule that fits is taken,
    and its result is not remapped again. Raises InvalidName."""
    full = expand(name, node_name, namespace)
    for rule in remappings:
        if (rule.node and rule.node != node_name) or rule.source.startswith("__"):
            continue
        if rule.only and rule.only != (TOPIC if kind == TOPIC else REQUEST):
            continue
        if expand(rule.source, node_name, namespace) == full:
            return expand(rule.target, node_name, namespace)
    return full


def _special(node_name: str, remappings: "list[Remapping]", keys: "tuple[str, ...]") -> "str | None":
    for rule in remappings:
        if rule.source in keys and rule.node in ("", node_name):
            return rule.target
    return None


class ParameterOverride(Record):
    """`name` of node `node` (any where empty) is the YAML text `value`; or all that the file `file` says."""

    _fields = ("node", "name", "value", "file")
    __slots__ = _fields

    def __init__(self, node: str, name: str, value: str, file: str = "") -> None:
        self.node = node
        self.name = name
        self.value = value
        self.file = file


_SWITCHES = ("rosout-logs", "stdout-logs", "external-lib-logs")


class Ros2Arguments:
    """A program's arguments, sorted as rcl sorts them: what stands between `--ros-args` and `--` or the end.

    remappings   Remapping rules, in order
    overrides    ParameterOverride, in order: the last one counts
    log_levels   logger's name -> level as written; "" is the default of all
    switches     "rosout-logs", "stdout-logs", "external-lib-logs" -> enabled or not, where said
    enclave, log_config_file, log_file_name   as written, or None
    unknown      what stands there and means nothing
    rest         every other argument

    Raises InvalidName for a rule that is none, and where a flag lacks its value.
    """

    def __init__(self, arguments: "list[str] | tuple[str, ...]") -> None:
        self.remappings: list[Remapping] = []
        self.overrides: list[ParameterOverride] = []
        self.log_levels: dict[str, str] = {}
        self.switches: dict[str, bool] = {}
        self.enclave: str | None = None
        self.log_config_file: str | None = None
        self.log_file_name: str | None = None
        self.unknown: list[str] = []
        self.rest: list[str] = []
        within = False
        at = 0
        while at < len(arguments):
            argument = arguments[at]
            at += 1
            if argument == "--ros-args":
                within = True
            elif not within:
                self.rest.append(argument)
            elif argument == "--":
                within = False
            elif argument in _VALUED:
                if at == len(arguments):
                    raise InvalidName("%s needs a value" % argument)
                self._valued(_VALUED[argument], arguments[at])
                at += 1
            elif argument.startswith("--enable-") and argument[9:] in _SWITCHES:
                self.switches[argument[9:]] = True
            elif argument.startswith("--disable-") and argument[10:] in _SWITCHES:
                self.switches[argument[10:]] = False
            else:
                self.unknown.append(argument)

    def _valued(self, flag: str, value: str) -> None:
        if flag == "remap":
            self.remappings.append(_remapping(value))
        elif flag == "param":
            left, found, text = value.partition(":=")
            node, named, name = left.partition(":")
            if not named:
                node, name = "", left
            if not found or not name:
                raise InvalidName("%r sets no parameter; write name:=value or node:name:=value" % value)
            self.overrides.append(ParameterOverride(node, name, text))
        elif flag == "params_file":
            self.overrides.append(ParameterOverride("", "", "", value))
        elif flag == "log_level":
            logger, found, level = value.partition(":=")
            self.log_levels[logger if found else ""] = level if found else value
        else:
            setattr(self, flag, value)

    def node_name(self, name: str) -> str:
        """The name that a node made as `name` has. Raises InvalidName."""
        return check_node_name(_special(name, self.remappings, ("__node", "__name")) or name)

    def namespace(self, node_name: str, namespace: str = "/") -> str:
        """The namespace of the node that is now called `node_name`. Raises InvalidName."""
        found = _special(node_name, self.remappings, ("__ns",)) or namespace or "/"
        return check_namespace(found if found[0] == "/" else "/" + found)


_VALUED = {
    "-r": "remap",
    "--remap": "remap",
    "-p": "param",
    "--param": "param",
    "--params-file": "params_file",
    "--log-level": "log_level",
    "-e": "enclave",
    "--enclave": "enclave",
    "--log-config-file": "log_config_file",
    "--log-file-name": "log_file_name",
}

_SCHEMES = {"rostopic://": TOPIC, "rosservice://": REQUEST}


def _remapping(text: str) -> Remapping:
    """The rule in `[node:][rostopic://|rosservice://]from:=to`."""
    left, found, target = text.partition(":=")
    node = only = ""
    head, colon, tail = left.partition(":")
    if colon and not tail.startswith("//"):
        node, left = check_node_name(head), tail
    for scheme, kind in _SCHEMES.items():
        if left.startswith(scheme):
            only, left = kind, left[len(scheme) :]
    if not found or not left or not target:
        raise InvalidName("%r is no remapping; write from:=to or node:from:=to" % text)
    if left in ("__node", "__name"):
        check_node_name(target)
    elif left == "__ns":
        check_namespace(target if target[0] == "/" else "/" + target)
    else:
        check_ros2_name(left)
        check_ros2_name(target)
    return Remapping(node, left, target, only)
