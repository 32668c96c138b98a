"""Networks by URL: `ros1://host:port` and `ros2://domain?options`, with what the environment adds. Runs on MicroPython."""

from roslet.errors import InvalidName, Unsupported
from roslet.names.characters import DIGITS, LETTERS
from roslet.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping

# A host name has at most 253 characters (RFC 1035), and an address fewer.
MAX_HOST = 255

# The last domain whose ports fit 16 bits (RTPS 2.3, 9.6.1.1).
MAX_DOMAIN = 232

# Static peers of one node: each without a port is sent 32 datagrams every three seconds.
MAX_PEERS = 64

# Where a ROS 1 master is when nobody says otherwise.
DEFAULT_MASTER = "http://localhost:11311"


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
    if not 0 < len(text) <= 5 or text.strip(DIGITS):
        return 0
    number = int(text)
    return number if number < 65536 else 0


def parse_network(network: "str | None", master: "str | None" = None) -> "tuple[str, str]":
    """The URL of a ROS 1 network in full, and the URI of its master.

    `network` is "ros1://host:port", "ros1://host" for port 11311, or "ros1://" for `master` (what
    $ROS_MASTER_URI holds; localhost where that is empty too). Raises Unsupported for the ROS 2 network,
    InvalidName for anything else.
    """
    if network is None or network.startswith("ros2:"):
        raise Unsupported("the ROS 2 network has no master; write ros1://host:port or ros1://")
    scheme, found, rest = network.partition("://")
    if scheme != "ros1" or not found:
        raise InvalidName("%r is no network; write ros1://host:port" % network)
    if not rest:
        network = master or DEFAULT_MASTER
        if "://" not in network:
            raise InvalidName("%r is no URI of a master; write http://host:port" % network)
    elif ":" not in rest:
        network = network.rstrip("/") + ":11311"
    host, port = parse_host_port(network)
    return "ros1://%s:%d" % (host, port), "http://%s:%d" % (host, port)


OFF, LOCALHOST, SUBNET, SYSTEM_DEFAULT = "OFF", "LOCALHOST", "SUBNET", "SYSTEM_DEFAULT"
RANGES = (OFF, LOCALHOST, SUBNET, SYSTEM_DEFAULT)
"""How far a ROS 2 node looks for others, as $ROS_AUTOMATIC_DISCOVERY_RANGE spells it."""


# What a serial line has where nobody says otherwise.
DEFAULT_BAUD = 115200


class SerialLine(Record):
    """A serial line in place of interfaces: `device`, its path; `baud`, bits a second; `address`, ours on it, with the
    length of the prefix behind a slash."""

    _fields = ("device", "baud", "address")
    __slots__ = _fields

    def __init__(self, device: str, baud: int, address: str) -> None:
        self.device = device
        self.baud = baud
        self.address = address


class Ros2Network(Record):
    """Which ROS 2 network, and how far it reaches.

    domain_id    0 to 232
    interfaces   names or IPv4 addresses of the interfaces to use; empty: all
    peers        (host, port) that are looked for besides; port None: the ports of participants 0 to 31 of that host
    line         a serial line, which is then all of the network; None: the interfaces of this host
    range        OFF: nobody is looked for, and nobody taken; LOCALHOST: participants of this host, and static peers of
                 either side; SUBNET: whatever multicast reaches, and peers; SYSTEM_DEFAULT: as SUBNET, without peers
    """

    _fields = ("domain_id", "interfaces", "peers", "range", "line")
    __slots__ = _fields

    def __init__(
        self,
        domain_id: int = 0,
        interfaces: "tuple[str, ...]" = (),
        peers: "tuple[tuple[str, int | None], ...]" = (),
        range: str = SUBNET,  # noqa: A002 - the field's name
        line: "SerialLine | None" = None,
    ) -> None:
        self.domain_id = domain_id
        self.interfaces = interfaces
        self.peers = peers
        self.range = range
        self.line = line

    @property
    def url(self) -> str:
        """The URL that says the same."""
        options = ["interface=" + one for one in self.interfaces]
        if self.line is not None:
            options.append(
                "slip=%s&baud=%d&address=%s" % (self.line.device, self.line.baud, self.line.address)
            )
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
    `interface` and `peers` may be given several times. "ros2://42?slip=/dev/ttyUSB0&baud=1000000&address=10.0.0.1/24" is a
    network of a serial line and nothing else; of the environment only ROS_DOMAIN_ID is said of it. Raises InvalidName and
    says what is wrong.
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
    serial = {"slip": "", "baud": "", "address": ""}
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
        elif key in serial:
            serial[key] = value
        elif key == "localhost" and value in ("0", "1"):
            reach = LOCALHOST if value == "1" else reach or SUBNET
        else:
            raise InvalidName(
                "%r: the option %r is none of interface=, peers=, range=, localhost=0, localhost=1, slip=, baud= or "
                "address=" % (text, option)
            )
    line = _line(serial, text)
    if line is not None and interfaces:
        raise InvalidName("%r: a network is a serial line or interfaces, not both" % text)
    only_local = environment.get("ROS_LOCALHOST_ONLY", "") == "1"
    if line is not None:
        reach = reach or SUBNET
    elif not only_local:
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
    return Ros2Network(number, tuple(interfaces), tuple(distinct), reach, line)


def _line(said: "dict[str, str]", where: str) -> "SerialLine | None":
    if not said["slip"]:
        if said["baud"] or said["address"]:
            raise InvalidName("%r: baud= and address= go with slip=" % where)
        return None
    baud = said["baud"] or str(DEFAULT_BAUD)
    if len(baud) > 8 or baud.strip(DIGITS) or not int(baud):
        raise InvalidName("%r: %r is no number of bits a second" % (where, baud))
    address, _, bits = said["address"].partition("/")
    octets = address.split(".")
    numbers = [int(one) for one in octets if 0 < len(one) <= 3 and not one.strip(DIGITS)]
    if len(octets) != 4 or len(numbers) != 4 or max(numbers) > 255 or not 0 < numbers[0] < 224:
        raise InvalidName("%r: a serial line needs address=, an IPv4 address such as 10.0.0.1/24" % where)
    if not 0 < len(bits) <= 2 or bits.strip(DIGITS) or not 1 <= int(bits) <= 30:
        raise InvalidName(
            "%r: behind address=%s there must be /24 or another prefix, 1 to 30" % (where, address)
        )
    return SerialLine(said["slip"], int(baud), said["address"])


def _domain(text: str, where: str) -> int:
    if not 0 < len(text) <= 3 or text.strip(DIGITS) or int(text) > MAX_DOMAIN:
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
        if char not in LETTERS + DIGITS + "-._":
            raise InvalidName("%s: %r is no host name and no IPv4 address" % (where, host))
    return host, number
