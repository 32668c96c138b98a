"""ROS 2 type descriptions and hashes, against those that the wheels ship and those that ROS 2's generator
makes."""

from __future__ import annotations

import json
import pathlib
import subprocess
from typing import Any

import pytest

import peers
from roslet.errors import UnknownType, Unsupported
from roslet.idl import Registry, type_description, type_hash

REFERENCE = pathlib.Path(peers.ROOT, "tests/reference/rosidl_definitions.py")
# At least this many interfaces come with each of the wheels' installations; fewer means that the test looks
# wrongly.
SHIPPED = 180


def shipped(distribution: str) -> tuple[str, dict[str, dict[str, Any]]]:
    """The prefix of an installation, and by type name the JSON files that it ships."""
    prefix = peers.require(distribution).parent.parent
    found = {}
    for path in sorted(prefix.glob("share/*/*/*.json")):
        content = json.loads(path.read_text())
        # A few of test_msgs are written in IDL, which has keys that `.msg` has not, and which roslet does not read.
        if "type_hashes" in content and path.with_suffix("." + path.parent.name).exists():
            found[content["type_description_msg"]["type_description"]["type_name"]] = content
    assert len(found) >= SHIPPED
    return str(prefix), found


def differences(registry: Registry, expected: dict[str, dict[str, Any]]) -> list[str]:
    different = []
    for name, content in expected.items():
        if type_description(registry, name, defaults=True) != content["type_description_msg"]:
            different.append(name + ": description")
        for entry in content["type_hashes"]:
            if type_hash(registry, entry["type_name"]) != entry["hash_string"]:
                different.append(f"{entry['type_name']}: hash")
    return different


@pytest.mark.parametrize("distribution", ["kilted", "jazzy"])
def test_every_interface_of_a_distribution_has_the_description_and_hash_that_it_ships(
    distribution: str,
) -> None:
    prefix, expected = shipped(distribution)
    assert differences(Registry("ros2", {"AMENT_PREFIX_PATH": prefix}), expected) == []


@pytest.mark.parametrize("distribution", ["kilted", "jazzy"])
def test_no_definition_of_a_distribution_is_left_unjudged(distribution: str) -> None:
    prefix, expected = shipped(distribution)
    files = [
        path
        for kind in ("msg", "srv", "action")
        for path in pathlib.Path(prefix).glob(f"share/*/{kind}/*.{kind}")
    ]
    names = {f"{path.parts[-3]}/{path.parts[-2]}/{path.stem}" for path in files}
    assert names - set(expected) == set()


@pytest.mark.parametrize("distribution", ["kilted", "jazzy"])
def test_the_bundled_definitions_have_the_hashes_that_a_distribution_ships(distribution: str) -> None:
    _, expected = shipped(distribution)
    bundled = Registry("ros2", None)
    packages = set(bundled.packages())
    expected = {name: content for name, content in expected.items() if name.split("/")[0] in packages}
    assert len(expected) >= SHIPPED
    assert differences(bundled, expected) == []


PACKAGE = {
    "msg/Nothing.msg": "# nothing\n",
    "msg/Plain.msg": """
bool a true
byte b
char c 65
int8 d -5
uint8 e
int16 f
uint16 g
int32 h
uint32 i
int64 j
uint64 k
float32 l 1.5
float64 m
string n "with \\"quotes\\""
wstring o
string<=5 p
wstring<=6 q
byte BYTE=1
string TEXT="no part of the hash"
""",
    "msg/Fixed.msg": """
bool[1] a
byte[2] b
char[3] c
float32[4] d
string[5] e
wstring[6] f
string<=7[8] g
wstring<=9[10] h
Plain[11] i
geometry_msgs/Pose[12] j
int16[2] k [1, -2]
""",
    "msg/Bounded.msg": """
bool[<=1] a
byte[<=2] b
char[<=3] c
float64[<=4] d
string[<=5] e
wstring[<=6] f
string<=7[<=8] g
wstring<=9[<=10] h
Fixed[<=11] i
std_msgs/Header[<=12] j
""",
    "msg/Unbounded.msg": """
bool[] a
byte[] b
char[] c
uint64[] d
string[] e
wstring[] f
string<=7[] g
wstring<=9[] h
Bounded[] i
builtin_interfaces/Time[] j
int32[] k [1, 2, 3]
bool[] l [true, false]
string[] m ["a", 'b']
float32[] n [1, 2.5]
""",
    "srv/Ask.srv": "Plain a\n---\nPlain[] b\nint8 c 3\n",
    "srv/Silent.srv": "---\n",
    "action/Do.action": "int32 order 7\n---\nNothing[] r\n---\nint32[<=9] f\n",
    "action/Idle.action": "---\n---\n",
}


def test_every_shape_of_field_is_described_and_hashed_as_the_generator_of_ros2_does(
    tmp_path: pathlib.Path,
) -> None:
    python = peers.require("kilted")
    for file, text in PACKAGE.items():
        path = tmp_path / "shapes" / file
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    share = str(python.parent.parent / "share")
    command = [str(python), str(REFERENCE), "describe", share, "shapes", str(tmp_path / "shapes")]
    expected = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
    assert len(expected) == 5 + 2 * 4 + 2 * 13
    registry = Registry("ros2", None)
    registry.load(tmp_path / "shapes")
    assert differences(registry, expected) == []


def test_a_description_without_defaults_has_no_such_key() -> None:
    description = type_description(Registry("ros2", None), "builtin_interfaces/msg/Time")
    assert description == {
        "type_description": {
            "type_name": "builtin_interfaces/msg/Time",
            "fields": [
                {
                    "name": "sec",
                    "type": {"type_id": 6, "capacity": 0, "string_capacity": 0, "nested_type_name": ""},
                },
                {
                    "name": "nanosec",
                    "type": {"type_id": 7, "capacity": 0, "string_capacity": 0, "nested_type_name": ""},
                },
            ],
        },
        "referenced_type_descriptions": [],
    }


def test_a_known_hash_stands_here_for_machines_without_peers() -> None:
    # What `ros2 topic info -v` shows of any Iron or later system.
    expected = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
    assert type_hash(Registry("ros2", None), "std_msgs/msg/String") == expected


def test_ros1_has_no_type_hash_and_an_unknown_type_none_either() -> None:
    with pytest.raises(Unsupported, match="belong to ROS 2"):
        type_hash(Registry("ros1", None), "std_msgs/String")
    with pytest.raises(UnknownType, match="unknown type no_msgs/msg/Such: not in what was loaded"):
        type_hash(Registry("ros2", None), "no_msgs/msg/Such")
