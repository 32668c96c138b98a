"""What follows --ros-args, and files of parameters."""

from __future__ import annotations

import pathlib

import pytest

from roslet.compat.ros_arguments import BadArgument, RosArguments, UnknownArguments, read_parameter_file


def test_words_around_those_of_ros_are_the_program_s() -> None:
    found = RosArguments(
        ["p", "a", "--ros-args", "-r", "x:=y", "--", "-b", "--ros-args", "--log-level", "warn"]
    )
    assert found.rest == ["p", "a", "-b"]
    assert [(rule.node, rule.source, rule.target) for rule in found.remappings] == [("", "x", "y")]
    assert found.level == 30


def test_the_name_of_a_node_and_its_namespace_are_remapped_for_one_or_for_all() -> None:
    words = ["--ros-args", "-r", "one:__node:=uno", "-r", "__ns:=/all", "-r", "one:a:=b"]
    found = RosArguments(words)
    assert (found.node_name("one"), found.node_name("two")) == ("uno", "two")
    assert found.namespace("two", "/given") == "/all"
    assert found.remappings[2].node == "one"


def test_levels_of_single_loggers() -> None:
    found = RosArguments(["--ros-args", "--log-level", "a.b:=debug", "--log-level", "ERROR"])
    assert (found.level, found.levels) == (40, {"a.b": 10})


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["-r"], "needs a value"),
        (["-r", "nonsense"], "-r nonsense"),
        (["-p", "nonsense"], "-p nonsense"),
        (["--log-level", "loud"], "no such level"),
    ],
)
def test_what_is_wrong_is_named(words: list[str], said: str) -> None:
    with pytest.raises(BadArgument, match=said):
        RosArguments(["--ros-args", *words])


def test_unknown_words_are_named_together() -> None:
    with pytest.raises(UnknownArguments) as caught:
        RosArguments(["--ros-args", "--one", "-p", "a:=1", "two"])
    assert caught.value.words == ["--one", "two"]


def test_parameters_are_for_all_nodes_or_for_one_and_the_last_holds() -> None:
    words = ["--ros-args", "-p", "a:=1", "-p", "talker:b:=[x, y]", "-p", "a:=2"]
    found = RosArguments(words)
    assert found.parameters_of("/ns/talker") == {"a": 2, "b": ["x", "y"]}
    assert found.parameters_of("/listener") == {"a": 2}


FILE = """
/**:
  ros__parameters: {everywhere: true}
/ns/*:
  ros__parameters: {one_below: 1}
/ns:
  talker:
    ros__parameters:
      group: {inner: 2.5}
talker:
  ros__parameters: {root: yes}
"""


def test_a_file_s_sections_fit_by_pattern_and_by_nesting(tmp_path: pathlib.Path) -> None:
    path = tmp_path / "p.yaml"
    path.write_text(FILE, encoding="utf-8")
    found = RosArguments(["--ros-args", "--params-file", str(path), "-p", "one_below:=3"])
    assert found.parameters_of("/ns/talker") == {"everywhere": True, "one_below": 3, "group.inner": 2.5}
    assert found.parameters_of("/talker") == {"everywhere": True, "one_below": 3, "root": True}
    assert found.parameters_of("/a/b/c") == {"everywhere": True, "one_below": 3}


@pytest.mark.parametrize("text", ["5", "[1, 2]", "node: 5", "node: {ros__parameters: 5}", "{", "- a"])
def test_what_is_no_file_of_parameters_is_refused(tmp_path: pathlib.Path, text: str) -> None:
    path = tmp_path / "p.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(RuntimeError, match=r"p\.yaml"):
        read_parameter_file(str(path))
