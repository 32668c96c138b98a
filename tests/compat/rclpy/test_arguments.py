"""Arguments, as rclpy raises what is wrong with them, and files of parameters."""

from __future__ import annotations

import pathlib
from collections.abc import Iterator

import pytest

from roslet.compat.rclpy import logging
from roslet.compat.rclpy.context import Context
from roslet.compat.rclpy.exceptions import RCLError, UnknownROSArgsError
from roslet.compat.rclpy.parameter import parameter_dict_from_yaml_file
from roslet.compat.rclpy.utilities import remove_ros_args


@pytest.fixture(autouse=True)
def levels() -> Iterator[None]:
    yield
    logging.clear_config()


def test_unknown_words_are_named_together() -> None:
    with pytest.raises(UnknownROSArgsError) as caught:
        Context().init(["p", "--ros-args", "--one", "-p", "a:=1", "two"])
    assert caught.value.args == (["--one", "two"],)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["-r"], "needs a value"),
        (["-r", "nonsense"], "nonsense"),
        (["-p", "nonsense"], "nonsense"),
        (["--log-level", "loud"], "loud"),
    ],
)
def test_what_is_wrong_is_named(words: list[str], said: str) -> None:
    with pytest.raises(RCLError, match=said):
        Context().init(["p", "--ros-args", *words])


def test_a_bare_remapping_holds_and_is_warned_of(capsys: pytest.CaptureFixture[str]) -> None:
    context = Context()
    context.init(["p", "a:=b", "c"])
    assert [(rule.source, rule.target) for rule in context.arguments.ros.remappings] == [("a", "b")]
    assert "[rcl]: Found remap rule 'a:=b'. This syntax is deprecated." in capsys.readouterr().err
    assert remove_ros_args(["p", "a:=b", "c"]) == ["p", "c"]
    context.shutdown()


def test_levels_hold_for_all_loggers_or_for_one_and_those_below() -> None:
    context = Context()
    context.init(["p", "--ros-args", "--log-level", "ERROR", "--log-level", "a.b:=debug"])
    names = ("x", "a", "a.b", "a.b.c")
    found = [logging.get_logger_effective_level(name).name for name in names]
    assert found == ["ERROR", "ERROR", "DEBUG", "DEBUG"]
    context.shutdown()


@pytest.mark.parametrize("number", ["x", "233", "-1"])
def test_a_domain_that_cannot_be_is_refused(monkeypatch: pytest.MonkeyPatch, number: str) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", number)
    with pytest.raises(RCLError, match=r"domain|ROS_DOMAIN_ID"):
        Context().init([])


FILE = """
/**:
  ros__parameters: {everywhere: true, number: 1}
/ns:
  talker:
    ros__parameters:
      group: {inner: 2.5}
talker:
  ros__parameters: {number: 2}
"""


@pytest.fixture
def file(tmp_path: pathlib.Path) -> str:
    path = tmp_path / "p.yaml"
    path.write_text(FILE, encoding="utf-8")
    return str(path)


def test_a_node_s_own_parameters_come_before_those_of_all(file: str) -> None:
    found = parameter_dict_from_yaml_file(file, use_wildcard=True, target_nodes=["/talker"])
    assert {name: one.value.integer_value for name, one in found.items()} == {"everywhere": 0, "number": 2}


def test_names_get_the_namespace_that_is_asked_for(file: str) -> None:
    found = parameter_dict_from_yaml_file(file, target_nodes=["/ns/talker"], namespace="left")
    assert {name: one.value.double_value for name, one in found.items()} == {"left.group.inner": 2.5}


def test_a_node_that_the_file_does_not_name_is_an_error(file: str) -> None:
    with pytest.raises(RuntimeError, match="for /nobody, only for nodes"):
        parameter_dict_from_yaml_file(file, target_nodes=["/nobody"])
