"""ROS names: what is legal, how a relative name becomes a full one, what arguments remap, and what DDS calls it.

Sources: ROS 1 graph resource names and name resolution; of ROS 2 the design documents "Topic and Service name mapping to
DDS" and "ROS Command Line Arguments", and what rcl accepts. Runs on MicroPython.
"""

from roslet.errors import InvalidName, Unsupported
from roslet.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping

_LETTERS = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
_DIGITS = "0123456789"
_FIRST = _LETTERS + "~/"
_REST = _LETTERS + _DIGITS + "_/"

# Longer names are refused: no real graph has them, and a name is copied into every header and log line.
MAX_NAME = 4096

# A host name has at most 253 characters (RFC 1035), and an address fewer.
MAX_HOST = 255

# The last domain whose ports fit 16 bits (RTPS 2.3, 9.6.1.1).
MAX_DOMAIN = 232

# Static peers of one node: each without a port is sent 32 datagrams every three seconds.
MAX_PEERS = 64

# Where a ROS 1 master is when nobody says otherwise.
DEFAULT_MASTER = "http://localhost:11311"


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


def parse_host_port(uri: str) -> "tuple[str, int]":
    """Host and port of `http://host:port/`, `rosrpc://host:port` or `ros1://host:port`.

    Raises InvalidName where it is no such URI. An IPv6 address stands in brackets. Peers send these: a host must be
    short and free of blanks and control characters before it goes to a resolver.
    """
    scheme, found, rest = uri.partition("://")
    if not found or not scheme:
        raise InvalidName("%r is no URI" % uri)
    rest = rest.partition("/")[0]
    host, found, port = rest.rpartition(":")
    number = _port(port)
    if not found or not host or not number or len(host) > MAX_HOST:
        raise InvalidName("%r: expected host:port" % uri[:MAX_HOST])
    if host.startswith("[") and host.endswith("]"):
        host = host[1:-1]
    for char in host:
        if char <= " " or char == "\x7f":
            raise InvalidName("%r: a host holds no blanks and no control characters" % uri)
    return host, number


def _port(text: str) -> int:
    """A port number in plain digits; 0 where it is none."""
    if not 0 < len(text) <= 5 or text.strip(_DIGITS):
        return 0
    number = int(text)
    return number if number < 65536 else 0


def parse_network(network: "str | None", master: "str | None" = None) -> "tuple[str, str]":
    """The URL of a network in full, and the URI of its master.

    `network` is "ros1://host:port", "ros1://host" for port 11311, or "ros1://" for `master` (what
    $ROS_MASTER_URI holds; localhost where that is empty too). Raises Unsupported for the ROS 2 network,
    InvalidName for anything else.
    """
    if network is None or network.startswith("ros2:"):
        raise Unsupported('the ROS 2 network is not there yet; use network="ros1://host:port" or "ros1://"')
    scheme, found, rest = network.partition("://")
    if scheme != "ros1" or not found:
        raise InvalidName("%r is no network; write ros1://host:port" % network)
    if not rest:
        network = master or DEFAULT_MASTER
    elif ":" not in rest:
        network = network.rstrip("/") + ":11311"
    host, port = parse_host_port(network)
    return "ros1://%s:%d" % (host, port), "http://%s:%d" % (host, port)


# -- ROS 2

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


_INSIDE = _LETTERS + _DIGITS + "_"


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
            if at == opened + 1 or name[opened + 1] in _DIGITS:
                raise InvalidName("%r: character %d begins no substitution" % (name, opened + 1))
            opened = -1
        elif char not in _INSIDE and (opened >= 0 or char not in "/~" or (char == "~" and at)):
            raise InvalidName("%r: character %d, %r, is not allowed in a ROS name" % (name, at + 1, char))
        elif char in _DIGITS and (at == 0 or name[at - 1] == "/"):
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
    if name[0] in _DIGITS:
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


OFF, LOCALHOST, SUBNET, SYSTEM_DEFAULT = "OFF", "LOCALHOST", "SUBNET", "SYSTEM_DEFAULT"
RANGES = (OFF, LOCALHOST, SUBNET, SYSTEM_DEFAULT)
"""How far a ROS 2 node looks for others, as $ROS_AUTOMATIC_DISCOVERY_RANGE spells it."""


class Ros2Network(Record):
    """Which ROS 2 network, and how far it reaches.

    domain_id    0 to 232
    interfaces   names or IPv4 addresses of the interfaces to use; empty: all
    peers        (host, port) that are looked for besides; port None: the ports of participants 0 to 31 of that host
    range        OFF: nobody is looked for, and nobody taken; LOCALHOST: participants of this host, and static peers of
                 either side; SUBNET: whatever multicast reaches, and peers; SYSTEM_DEFAULT: as SUBNET, without peers
    """

    _fields = ("domain_id", "interfaces", "peers", "range")
    __slots__ = _fields

    def __init__(
        self,
        domain_id: int = 0,
        interfaces: "tuple[str, ...]" = (),
        peers: "tuple[tuple[str, int | None], ...]" = (),
        range: str = SUBNET,  # noqa: A002 - the field's name
    ) -> None:
        self.domain_id = domain_id
        self.interfaces = interfaces
        self.peers = peers
        self.range = range

    @property
    def url(self) -> str:
        """The URL that says the same."""
        options = ["interface=" + one for one in self.interfaces]
        if self.peers:
            hosts = [host if port is None else "%s:%d" % (host, port) for host, port in self.peers]
            options.append("peers=" + ",".join(hosts))
        if self.range != SUBNET:
            options.append("range=" + self.range.lower())
        return "ros2://%d%s%s" % (self.domain_id, "?" if options else "", "&".join(options))


def parse_ros2_network(network: "str | None", environment: "Mapping[str, str]") -> Ros2Network:
    """The network of "ros2://42?interface=eth0&peers=10.0.0.7,robot:7412&range=localhost"; every part may be missing.

    What the URL leaves open the environment says: ROS_DOMAIN_ID, ROS_AUTOMATIC_DISCOVERY_RANGE. ROS_STATIC_PEERS adds to
    its peers. ROS_LOCALHOST_ONLY=1 stands for the range LOCALHOST and, as in rcl, puts the environment's range and peers
    out of force. `localhost=1` in a URL is `range=localhost`. OFF and SYSTEM_DEFAULT use no peers, as in ROS 2.
    `interface` and `peers` may be given several times. Raises InvalidName and says what is wrong.
    """
    text = "ros2://" if network is None else network
    scheme, found, rest = text.partition("://")
    if scheme != "ros2" or not found:
        raise InvalidName("%r is no ROS 2 network; write ros2:// or ros2://42" % text)
    domain, _, query = rest.partition("?")
    domain = domain[:-1] if domain.endswith("/") else domain
    interfaces: list[str] = []
    peers: list[tuple[str, int | None]] = []
    reach = ""
    for option in query.split("&") if query else ():
        key, _, value = option.partition("=")
        if not value:
            raise InvalidName("%r: the option %r has no value" % (text, key))
        if key == "interface":
            interfaces.append(value)
        elif key == "peers":
            peers += [_peer(one, text) for one in value.split(",") if one]
        elif key == "range":
            reach = _range(value.upper(), text)
        elif key == "localhost" and value in ("0", "1"):
            reach = LOCALHOST if value == "1" else reach or SUBNET
        else:
            raise InvalidName(
                "%r: the option %r is none of interface=, peers=, range=, localhost=0 or localhost=1"
                % (text, option)
            )
    only_local = environment.get("ROS_LOCALHOST_ONLY", "") == "1"
    if not only_local:
        peers += [
            _peer(one, "ROS_STATIC_PEERS")
            for one in environment.get("ROS_STATIC_PEERS", "").split(";")
            if one
        ]
    if not reach:
        said = environment.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "") or SUBNET
        reach = LOCALHOST if only_local else _range(said, "ROS_AUTOMATIC_DISCOVERY_RANGE")
    said = environment.get("ROS_DOMAIN_ID", "") or "0"
    number = _domain(domain, text) if domain else _domain(said, "ROS_DOMAIN_ID")
    if len(peers) > MAX_PEERS:
        raise InvalidName("%d static peers; at most %d are taken" % (len(peers), MAX_PEERS))
    distinct: list[tuple[str, int | None]] = []
    for peer in peers if reach in (LOCALHOST, SUBNET) else ():
        if peer not in distinct:
            distinct.append(peer)
    return Ros2Network(number, tuple(interfaces), tuple(distinct), reach)


def _domain(text: str, where: str) -> int:
    if not 0 < len(text) <= 3 or text.strip(_DIGITS) or int(text) > MAX_DOMAIN:
        raise InvalidName("%s: a domain id is 0 to %d, not %r" % (where, MAX_DOMAIN, text))
    return int(text)


def _range(text: str, where: str) -> str:
    if text not in RANGES:
        raise InvalidName("%s: a discovery range is one of %s, not %r" % (where, ", ".join(RANGES), text))
    return text


def _peer(text: str, where: str) -> "tuple[str, int | None]":
    host, found, port = text.partition(":")
    number = _port(port) if found else None
    if not host or number == 0 or len(host) > MAX_HOST:
        raise InvalidName("%s: a peer is host or host:port (IPv4 only), not %r" % (where, text[:MAX_HOST]))
    for char in host:
        if char not in _LETTERS + _DIGITS + "-._":
            raise InvalidName("%s: %r is no host name and no IPv4 address" % (where, host))
    return host, number
