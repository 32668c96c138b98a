"""ROS names: legality, resolution, arguments, URIs. Expected values are written by hand from the ROS 1 naming rules."""

import pytest

from roslet.errors import InvalidName, Unsupported
from roslet.names import (
    LOCALHOST,
    MAX_NAME,
    MAX_PEERS,
    OFF,
    SUBNET,
    SYSTEM_DEFAULT,
    Arguments,
    Ros2Network,
    SerialLine,
    canonical,
    check_base_name,
    check_name,
    join,
    namespace_of,
    parse_host_port,
    parse_network,
    parse_ros2_network,
    resolve,
)

pytestmark = pytest.mark.micropython


@pytest.mark.parametrize("name", ["", "a", "a1", "a_b", "/", "/a/b", "~", "~a", "~/a", "a/b/c", "A"])
def test_a_legal_name_is_itself(name: str) -> None:
    assert check_name(name) == name


@pytest.mark.parametrize(
    ("name", "where"),
    [
        ("1a", "character 1"),
        ("_a", "character 1"),
        ("a b", "character 2"),
        ("a~", "character 2"),
        ("a-b", "character 2"),
        ("/a/b.c", "character 5"),
        ("a\x00", "character 2"),
        ("n\u00e4me", "character 2"),
        ("a//b", "empty name between two slashes"),
    ],
)
def test_an_illegal_name_says_where_it_is_wrong(name: str, where: str) -> None:
    with pytest.raises(InvalidName, match=where):
        check_name(name)


def test_a_name_has_a_bound() -> None:
    assert check_name("a" * MAX_NAME)
    with pytest.raises(InvalidName, match="at most 4096"):
        check_name("a" * (MAX_NAME + 1))


@pytest.mark.parametrize("name", ["", "a/b", "~a", "/a"])
def test_a_node_name_has_no_namespace(name: str) -> None:
    with pytest.raises(InvalidName, match="no base name"):
        check_base_name(name)
    assert check_base_name("talker") == "talker"


@pytest.mark.parametrize(
    ("name", "namespace"), [("/a/b", "/a/"), ("/a", "/"), ("/", "/"), ("/a/b/", "/a/"), ("/a/b/c", "/a/b/")]
)
def test_the_namespace_of_a_name_ends_with_a_slash(name: str, namespace: str) -> None:
    assert namespace_of(name) == namespace


def test_canonical_drops_doubled_and_trailing_slashes() -> None:
    assert canonical("//a///b/") == "/a/b"
    assert canonical("/") == "/"
    assert join("/a/", "b") == "/a/b"
    assert join("/a", "") == "/a"
    assert join("/a", "/b") == "/b"
    assert join("", "b") == "b"


@pytest.mark.parametrize(
    ("name", "full"),
    [
        ("chatter", "/ns/chatter"),
        ("/chatter", "/chatter"),
        ("~rate", "/ns/node/rate"),
        ("~/rate", "/ns/node/rate"),
        ("~", "/ns/node"),
        ("", "/ns"),
        ("a/b", "/ns/a/b"),
        ("/a/", "/a"),
    ],
)
def test_a_name_resolves_by_its_first_character(name: str, full: str) -> None:
    assert resolve(name, "/ns/node") == full


def test_a_relative_name_in_the_root_namespace() -> None:
    assert resolve("chatter", "/node") == "/chatter"
    assert resolve("", "/node") == "/"


def test_remapping_comes_after_resolution() -> None:
    table = {"/ns/chatter": "/other"}
    assert resolve("chatter", "/ns/node", table) == "/other"
    assert resolve("/ns/chatter", "/ns/node", table) == "/other"
    assert resolve("/chatter", "/ns/node", table) == "/chatter"


def test_arguments_are_sorted_by_their_underscores() -> None:
    given = Arguments(["a:=b", "_p:=1", "__name:=x", "__ns:=/y", "file", "--flag", ":=z", "u:=http://h:1/"])
    assert given.remappings == {"a": "b", "u": "http://h:1/"}
    assert given.parameters == {"p": "1"}
    assert given.specials == {"name": "x", "ns": "/y"}
    assert given.rest == ["file", "--flag", ":=z"]


def test_remappings_are_resolved_on_both_sides() -> None:
    given = Arguments(["a:=b", "~c:=/d", "/e:=~f"])
    assert given.resolved("/ns/node") == {"/ns/a": "/ns/b", "/ns/node/c": "/d", "/e": "/ns/node/f"}
    with pytest.raises(InvalidName):
        Arguments(["a b:=c"]).resolved("/node")


@pytest.mark.parametrize(
    ("uri", "expected"),
    [
        ("http://host:11311/", ("host", 11311)),
        ("http://127.0.0.1:1", ("127.0.0.1", 1)),
        ("rosrpc://robot.local:65535", ("robot.local", 65535)),
        ("http://[::1]:80/RPC2", ("::1", 80)),
    ],
)
def test_a_uri_gives_host_and_port(uri: str, expected: "tuple[str, int]") -> None:
    assert parse_host_port(uri) == expected


@pytest.mark.parametrize(
    "uri",
    [
        "",
        "host:1",
        "http://",
        "http://host",
        "http://host:",
        "http://:80",
        "http://host:0",
        "http://host:65536",
        "http://host:-1",
        "http://host:1x",
        "http://host:\u00b2",  # a digit to str.isdigit, no number to int
        "http://host:" + "9" * 5000,  # longer than int accepts
        "http://ho st:80",
        "http://host\x00:80",
        "http://ho\nst:80",
        "http://" + "h" * 300 + ":80",
    ],
)
def test_what_is_no_uri_of_a_peer_is_refused(uri: str) -> None:
    with pytest.raises(InvalidName):
        parse_host_port(uri)


def test_a_network_names_its_master() -> None:
    assert parse_network("ros1://robot:5") == ("ros1://robot:5", "http://robot:5")
    assert parse_network("ros1://robot") == ("ros1://robot:11311", "http://robot:11311")
    assert parse_network("ros1://") == ("ros1://localhost:11311", "http://localhost:11311")
    assert parse_network("ros1://", "http://m:7/") == ("ros1://m:7", "http://m:7")


def test_other_networks_are_refused_with_a_sentence() -> None:
    with pytest.raises(Unsupported, match="ROS 2 network"):
        parse_network("ros2://42")
    with pytest.raises(InvalidName, match="write ros1://host:port"):
        parse_network("tcp://x:1")


@pytest.mark.parametrize(
    ("network", "environment", "expected"),
    [
        (None, {}, Ros2Network()),
        ("ros2://", {"ROS_DOMAIN_ID": ""}, Ros2Network()),
        (
            "ros2://42?slip=/dev/ttyUSB0&baud=1000000&address=10.0.0.1/24&peers=10.0.0.2",
            {"ROS_LOCALHOST_ONLY": "1", "ROS_STATIC_PEERS": "10.9.9.9"},
            Ros2Network(
                42, (), (("10.0.0.2", None),), SUBNET, SerialLine("/dev/ttyUSB0", 1000000, "10.0.0.1/24")
            ),
        ),
        (
            "ros2://?slip=COM3&address=10.0.0.1/30",
            {"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF", "ROS_DOMAIN_ID": "7"},
            Ros2Network(7, line=SerialLine("COM3", 115200, "10.0.0.1/30")),
        ),
        ("ros2://", {"ROS_DOMAIN_ID": "7"}, Ros2Network(7)),
        ("ros2://0", {"ROS_DOMAIN_ID": "7"}, Ros2Network(0)),
        ("ros2://42/", {}, Ros2Network(42)),
        ("ros2://232", {}, Ros2Network(232)),
        ("ros2://?interface=eth0&interface=10.0.0.7", {}, Ros2Network(0, ("eth0", "10.0.0.7"))),
        (
            "ros2://1?peers=10.0.0.7,robot-1.local:7412&peers=10.0.0.9",
            {},
            Ros2Network(1, (), (("10.0.0.7", None), ("robot-1.local", 7412), ("10.0.0.9", None))),
        ),
        (
            "ros2://?peers=a,a,b",
            {"ROS_STATIC_PEERS": "b;c;"},
            Ros2Network(0, (), (("a", None), ("b", None), ("c", None))),
        ),
        (None, {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}, Ros2Network(range=LOCALHOST)),
        (None, {"ROS_AUTOMATIC_DISCOVERY_RANGE": ""}, Ros2Network(range=SUBNET)),
        ("ros2://?range=subnet", {"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF"}, Ros2Network(range=SUBNET)),
        ("ros2://?localhost=1", {}, Ros2Network(range=LOCALHOST)),
        ("ros2://?localhost=0", {"ROS_LOCALHOST_ONLY": "1"}, Ros2Network(range=SUBNET)),
        (None, {"ROS_LOCALHOST_ONLY": "0"}, Ros2Network()),
        # rcl: "'automatic_discovery_range' and 'static_peers' will be ignored"
        (
            None,
            {
                "ROS_LOCALHOST_ONLY": "1",
                "ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET",
                "ROS_STATIC_PEERS": "10.0.0.1",
            },
            Ros2Network(range=LOCALHOST),
        ),
        (
            "ros2://?peers=10.0.0.1",
            {"ROS_LOCALHOST_ONLY": "1"},
            Ros2Network(0, (), (("10.0.0.1", None),), LOCALHOST),
        ),
        (None, {"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF", "ROS_STATIC_PEERS": "a"}, Ros2Network(range=OFF)),
        ("ros2://?range=system_default&peers=a", {}, Ros2Network(range=SYSTEM_DEFAULT)),
    ],
)
def test_a_ros2_network_is_what_the_url_says_and_else_the_environment(
    network: "str | None", environment: "dict[str, str]", expected: Ros2Network
) -> None:
    assert parse_ros2_network(network, environment) == expected


@pytest.mark.parametrize(
    ("network", "environment", "reason"),
    [
        ("ros1://", {}, "is no ROS 2 network"),
        ("42", {}, "is no ROS 2 network"),
        ("ros2://233", {}, "a domain id is 0 to 232, not '233'"),
        ("ros2://-1", {}, "a domain id is 0 to 232, not '-1'"),
        ("ros2://+1", {}, "a domain id is 0 to 232"),
        ("ros2://robot", {}, "a domain id is 0 to 232, not 'robot'"),
        (None, {"ROS_DOMAIN_ID": "zero"}, "ROS_DOMAIN_ID: a domain id is 0 to 232, not 'zero'"),
        (
            "ros2://?range=world",
            {},
            "a discovery range is one of OFF, LOCALHOST, SUBNET, SYSTEM_DEFAULT, not 'WORLD'",
        ),
        (None, {"ROS_AUTOMATIC_DISCOVERY_RANGE": "1"}, "ROS_AUTOMATIC_DISCOVERY_RANGE: a discovery range is"),
        ("ros2://?interface", {}, "the option 'interface' has no value"),
        ("ros2://?peers=", {}, "the option 'peers' has no value"),
        ("ros2://?colour=red", {}, "the option 'colour=red' is none of"),
        (
            "ros2://?slip=/dev/ttyUSB0",
            {},
            "a serial line needs address=, an IPv4 address such as 10.0.0.1/24",
        ),
        ("ros2://?slip=a&address=10.0.0.256/24", {}, "a serial line needs address="),
        ("ros2://?slip=a&address=10.0.0.1", {}, "there must be /24 or another prefix, 1 to 30"),
        ("ros2://?slip=a&address=10.0.0.1/31", {}, "there must be /24 or another prefix, 1 to 30"),
        ("ros2://?slip=a&address=10.0.0.1/24&baud=fast", {}, "'fast' is no number of bits a second"),
        ("ros2://?baud=9600", {}, "baud= and address= go with slip="),
        ("ros2://?slip=a&address=10.0.0.1/24&interface=lo", {}, "is a serial line or interfaces, not both"),
        ("ros2://?localhost=yes", {}, "the option 'localhost=yes' is none of"),
        ("ros2://?peers=10.0.0.7:0", {}, "a peer is host or host:port (IPv4 only), not '10.0.0.7:0'"),
        ("ros2://?peers=10.0.0.7:65536", {}, "a peer is host or host:port"),
        ("ros2://?peers=[::1]:7400", {}, "a peer is host or host:port (IPv4 only)"),
        ("ros2://?peers=fe80::1", {}, "a peer is host or host:port (IPv4 only)"),
        (None, {"ROS_STATIC_PEERS": "a b"}, "ROS_STATIC_PEERS: 'a b' is no host name"),
        ("ros2://?peers=" + "h" * 256, {}, "a peer is host or host:port"),
        (
            "ros2://?peers=" + ",".join(["h%d" % i for i in range(MAX_PEERS + 1)]),
            {},
            "65 static peers; at most 64",
        ),
    ],
)
def test_a_wrong_ros2_network_says_what_is_wrong(
    network: "str | None", environment: "dict[str, str]", reason: str
) -> None:
    with pytest.raises(InvalidName) as caught:
        parse_ros2_network(network, environment)
    assert reason in str(caught.value)


def test_a_ros2_networks_url_says_the_same() -> None:
    text = "ros2://42?interface=eth0&interface=10.0.0.7&peers=10.0.0.8,robot:7412&range=localhost"
    network = parse_ros2_network(text, {})
    assert network.url == text
    assert parse_ros2_network(network.url, {}) == network
    assert Ros2Network().url == "ros2://0"
