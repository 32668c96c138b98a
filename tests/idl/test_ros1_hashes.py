"""ROS 1 MD5 sums and full texts, against genmsg and the classes that genpy generated."""

from __future__ import annotations

import functools
import hashlib
import json
import pathlib
import subprocess
from typing import Any

import pytest

import peers
from roslet.errors import Unsupported
from roslet.idl import Registry, full_text, md5sum

REFERENCE = pathlib.Path(peers.ROOT, "tests/reference/genmsg_definitions.py")
# tools/ros1_definitions.sh unpacks the second; the first is what Debian's packages install.
SHARES = ["/usr/share", str(peers.CACHE / "ros1-definitions/usr/share")]
# At least so many definitions lie there; fewer means that the test looks wrongly.
INSTALLED = 240
GENERATED = 150


@functools.cache
def reference(*arguments: str) -> dict[str, dict[str, Any]]:
    peers.require("genpy")
    command = [str(peers.DEBIAN_PYTHON), str(REFERENCE), *arguments]
    answer: dict[str, dict[str, Any]] = json.loads(
        subprocess.run(command, check=True, capture_output=True).stdout
    )
    return answer


def files() -> dict[str, dict[str, Any]]:
    peers.require("ros1-definitions")
    found = reference("files", *SHARES)
    assert len(found) >= INSTALLED
    return found


def part_names(name: str) -> tuple[str, str]:
    package, _, base = name.split("/")
    return f"{package}/{base}Request", f"{package}/{base}Response"


def test_genmsg_itself_understands_every_definition_of_debian() -> None:
    assert [name for name, verdict in files().items() if "error" in verdict] == []


def test_every_definition_of_debian_has_the_md5_sum_of_genmsg() -> None:
    registry = Registry("ros1", {"ROS_PACKAGE_PATH": ":".join(SHARES)})
    assert [name for name, verdict in files().items() if md5sum(registry, name) != verdict["md5"]] == []


def test_every_definition_of_debian_has_the_full_text_of_genmsg() -> None:
    registry = Registry("ros1", {"ROS_PACKAGE_PATH": ":".join(SHARES)})
    different = []
    for name, verdict in files().items():
        if "text" in verdict:
            texts, expected = [full_text(registry, name)], [verdict["text"]]
        else:
            texts = [full_text(registry, part) for part in part_names(name)]
            expected = [verdict["request"], verdict["response"]]
        if texts != expected:
            different.append(name)
    assert different == []


def test_every_bundled_definition_that_debian_has_gives_the_same_md5_sum() -> None:
    registry = Registry("ros1", None)
    packages = set(registry.packages())
    expected = {name: verdict for name, verdict in files().items() if name.split("/")[0] in packages}
    assert len(expected) >= 200
    assert [name for name, verdict in expected.items() if md5sum(registry, name) != verdict["md5"]] == []


def test_every_class_that_genpy_generated_has_the_md5_sum_of_our_bundled_definition() -> None:
    classes = reference("classes")
    assert len(classes) >= GENERATED
    registry = Registry("ros1", None)
    packages = set(registry.packages())
    judged = {name: verdict for name, verdict in classes.items() if name.split("/")[0] in packages}
    assert {"roscpp/srv/GetLoggers", "std_msgs/msg/Header", "tf2_msgs/msg/LookupTransformAction"} <= set(
        judged
    )
    assert [name for name, verdict in judged.items() if md5sum(registry, name) != verdict["md5"]] == []


def test_the_messages_that_an_action_implies_have_the_md5_sums_of_those_that_actionlib_wrote() -> None:
    registry = Registry("ros1", None)
    actions = registry.names("action")
    names = [message.name for action in actions for message in registry.action(action).messages]
    expected = {name: verdict for name, verdict in files().items() if name in set(map(str, names))}
    assert len(expected) == 7 * 6  # three of actionlib, one each of tf2_msgs, nav_msgs and move_base_msgs
    assert [name for name, verdict in expected.items() if md5sum(registry, name) != verdict["md5"]] == []


# Without peers, by hand from http://wiki.ros.org/ROS/Technical%20Overview


def digest(text: str) -> str:
    return hashlib.md5(text.encode()).hexdigest()


def package(path: pathlib.Path, **messages: str) -> Registry:
    folder = path / "pkg"
    for name, text in messages.items():
        kind = "srv" if "---" in text else "msg"
        (folder / kind).mkdir(parents=True, exist_ok=True)
        (folder / kind / f"{name}.{kind}").write_text(text)
    registry = Registry("ros1", None)
    registry.load(folder)
    return registry


def test_the_sum_is_of_constants_first_and_fields_without_comments_and_blanks(tmp_path: pathlib.Path) -> None:
    registry = package(
        tmp_path,
        A="# A\n  uint8   x # x\nstring S =  a # b \nbyte[ 3] y\nint8 C = 1 # c\n".replace("[ 3", "[3"),
    )
    assert md5sum(registry, "pkg/A") == digest("string S=a # b\nint8 C=1\nuint8 x\nbyte[3] y")


def test_a_nested_type_counts_by_its_own_sum_and_loses_brackets_and_package(tmp_path: pathlib.Path) -> None:
    registry = package(tmp_path, A="B[3] b\npkg/C c\ntime t\n", B="C[] c\n", C="int8 x\n")
    c = digest("int8 x")
    b = digest(f"{c} c")
    assert md5sum(registry, "pkg/A") == digest(f"{b} b\n{c} c\ntime t")


def test_a_service_is_summed_over_both_parts_without_a_break_between(tmp_path: pathlib.Path) -> None:
    registry = package(tmp_path, Ask="int64 a\nint64 b\n---\nint64 sum\n")
    assert md5sum(registry, "pkg/Ask") == digest("int64 a\nint64 bint64 sum")
    assert md5sum(registry, "pkg/srv/Ask") == md5sum(registry, "pkg/Ask")
    assert md5sum(registry, "pkg/AskRequest") == digest("int64 a\nint64 b")


def test_well_known_sums_of_the_bundled_packages() -> None:
    registry = Registry("ros1", None)
    assert md5sum(registry, "std_msgs/String") == "992ce8a1687cec8c8bd883ec73ca41d1"
    assert md5sum(registry, "std_msgs/Empty") == "d41d8cd98f00b204e9800998ecf8427e"
    assert md5sum(registry, "std_msgs/Header") == "2176decaecbce78abc3b96ef049fabed"
    assert md5sum(registry, "sensor_msgs/Image") == "060021388200f6f0f447d0fcd9c64743"
    assert md5sum(registry, "rospy_tutorials/AddTwoInts") == "6a2e34150c00229791cc89ff309fff21"


def test_the_full_text_lists_each_nested_type_once_depth_first(tmp_path: pathlib.Path) -> None:
    registry = package(tmp_path, A="B b\nC c\nB again\n", B="C c\nD[] d\n", C="int8 x", D="int8 y\n")
    rule = "=" * 80
    assert full_text(registry, "pkg/A") == (
        f"B b\nC c\nB again\n\n{rule}\nMSG: pkg/B\nC c\nD[] d\n\n"
        f"{rule}\nMSG: pkg/C\nint8 x\n{rule}\nMSG: pkg/D\nint8 y\n"
    )


def test_the_full_text_keeps_comments_and_bytes_that_are_no_utf8(tmp_path: pathlib.Path) -> None:
    registry = package(tmp_path, A="")
    (tmp_path / "pkg/msg/A.msg").write_bytes(b"# caf\xe9\r\nstring S=\xe9\r\n")
    assert full_text(registry, "pkg/A").encode("utf-8", "surrogateescape") == b"# caf\xe9\nstring S=\xe9\n"
    assert md5sum(registry, "pkg/A") == hashlib.md5(b"string S=\xe9").hexdigest()


def test_chains_of_diamonds_are_summed_in_linear_time(tmp_path: pathlib.Path) -> None:
    levels = {f"L{level}": f"L{level + 1} a\nL{level + 1} b\n" for level in range(200)}
    registry = package(tmp_path, **levels, L200="int8 x\n")
    expected = digest("int8 x")
    for _ in range(200):
        expected = digest(f"{expected} a\n{expected} b")
    assert md5sum(registry, "pkg/L0") == expected
    assert full_text(registry, "pkg/L0").count("MSG: ") == 200


def test_ros2_and_actions_have_no_md5_sum() -> None:
    with pytest.raises(Unsupported, match="ROS 2 types have a type hash"):
        md5sum(Registry("ros2", None), "std_msgs/msg/String")
    with pytest.raises(Unsupported, match="its messages have"):
        md5sum(Registry("ros1", None), "actionlib/action/Test")
    with pytest.raises(Unsupported, match="its messages have"):
        full_text(Registry("ros1", None), "actionlib/action/Test")
