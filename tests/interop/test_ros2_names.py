"""What our names, arguments and remappings amount to is what rclpy's do."""

from __future__ import annotations

import json
import pathlib
from typing import Any

import pytest

import peers
from interop.namespace import Namespace
from roslet.errors import InvalidName
from roslet.names import REQUEST, TOPIC, Ros2Arguments, resolve_ros2

# Not compared: `~a`, which the design document forbids and rclpy takes for the node's name with an `a`; and the longest name
# of a node, for rclpy refuses names that leave no room for its own services.
NAMES = [
    "a",
    "/a",
    "~",
    "~/a",
    "a/b",
    "{node}",
    "{ns}/a",
    "/{node}/a",
    "b",
    "/n/a",
    "_hidden",
    "a/_b",
    "a__b",
    "{namespace}/x",
]
BAD = [
    "", "1a", "/a/1b", "a b", "a~", "/~/a", "a-b", "a//b", "a/", "/", "a{b", "a}b", "a{}", "a{1}", "{a/b}", "{nose}",
    "\u00e4", "/" + "x" * 246, "/" + "x" * 247, "a.b", "{ns}{node}",
]  # fmt: skip
REMAPPED = [
    ["-r", "a:=b"],
    ["-r", "a:=b", "-r", "b:=c"],
    ["-r", "a:=b", "-r", "a:=c"],
    ["-r", "/a:=/z", "-r", "/n/a:=q"],
    ["-r", "~/a:=~/z"],
    ["-r", "me:a:=mine", "-r", "other:a:=others"],
    ["-r", "rostopic://a:=topic", "-r", "rosservice://a:=service"],
    ["-r", "me:rostopic://a:=topic"],
    ["-r", "__node:=you", "-r", "a:=b"],
    ["-r", "__name:=you", "-r", "you:a:=b", "-r", "me:/a:=c"],
    ["-r", "__ns:=/other", "-r", "a:=b", "-r", "/n/a:=c"],
    ["-r", "me:__node:=you", "-r", "you:__ns:=/other"],
    ["--remap", "a:=b", "--", "rest", "--ros-args", "-r", "b:=c", "-e", "/e"],
    ["-p", "x:=1", "--log-level", "warn", "--disable-stdout-logs", "--enable-rosout-logs"],
]  # fmt: skip
REFUSED = [
    ["-r", "a"],
    ["-r", "a:="],
    ["-r", ":=b"],
    ["-r"],
    ["-r", "a b:=c"],
    ["-r", "__node:=a/b"],
    ["-p", "a"],
    ["--wrong"],
]


def case(arguments: list[str], names: list[str], node: str = "me", namespace: str = "/") -> dict[str, Any]:
    return {"arguments": arguments, "node": node, "namespace": namespace, "names": names}


def cases() -> list[dict[str, Any]]:
    found = [case([], NAMES + BAD, namespace=namespace) for namespace in ("/", "/n", "n", "/n/m")]
    for words in REMAPPED:
        for namespace in ("/", "/n"):
            found.append(case(["first", "--ros-args", *words], NAMES, namespace=namespace))
    found += [case(["--ros-args", *words], []) for words in REFUSED]
    found += [case([], [], node) for node in ("1a", "a b", "a/b", "", "_a", "a" * 256, "a-b")]
    found += [case([], [], namespace=namespace) for namespace in ("/1", "a b", "/a/", "//", "/a//b", "/_a")]
    return found


def ours(one: dict[str, Any]) -> dict[str, Any]:
    """The same in our terms."""
    try:
        arguments = Ros2Arguments(one["arguments"])
        if arguments.unknown:
            return {"refused": True}
        node = arguments.node_name(one["node"])
        namespace = arguments.namespace(node, one["namespace"])
    except InvalidName:
        return {"refused": True}
    found: dict[str, Any] = {"node": node, "namespace": namespace, "rest": arguments.rest}
    for key, kind in (("topics", TOPIC), ("services", REQUEST)):
        found[key] = []
        for name in one["names"]:
            try:
                found[key].append(resolve_ros2(name, node, namespace, arguments.remappings, kind))
            except InvalidName:
                found[key].append(None)
    return found


@pytest.mark.parametrize("peer", ["kilted", "jazzy"])
def test_every_name_and_argument_is_taken_as_rclpy_takes_it(tmp_path: pathlib.Path, peer: str) -> None:
    (tmp_path / "cases").write_text(json.dumps(cases()))
    program = str(peers.ROOT / "tests/interop/peers/rclpy_names.py")
    with Namespace(tmp_path) as namespace:
        command = f"exec {peers.require(peer)} {program} < {tmp_path / 'cases'}"
        theirs = json.loads("\n".join(namespace.start("sh", "-c", command, name="names").finish(120)))
    different = []
    for one, their in zip(cases(), theirs, strict=True):
        mine = ours(one)
        if mine != their:
            different.append((one["arguments"], one["node"], one["namespace"], _difference(one, mine, their)))
    assert not different, "\n".join(map(str, different))


def _difference(one: dict[str, Any], mine: dict[str, Any], their: dict[str, Any]) -> Any:
    if "refused" in mine or "refused" in their:
        return "ours refused" if "refused" in mine else "theirs refused"
    found = [(key, mine[key], their[key]) for key in ("node", "namespace", "rest") if mine[key] != their[key]]
    for key in ("topics", "services"):
        for name, a, b in zip(one["names"], mine[key], their[key], strict=True):
            if a != b:
                found.append((key, name, f"ours {a}, theirs {b}"))
    return found
