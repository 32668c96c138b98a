"""Options may stand anywhere among a command's arguments."""

from __future__ import annotations

import argparse
from typing import Any

import pytest

from roslet.cli.main import build


def parsed(*words: str) -> argparse.Namespace:
    return build(words[0]).parse_args(words)


@pytest.mark.parametrize(
    "words",
    [
        ("-1", "/x", "std_msgs/String", "data:=hello"),
        ("/x", "std_msgs/String", "data:=hello", "-1"),
        ("/x", "std_msgs/String", "-1", "data:=hello"),
        ("/x", "-1", "std_msgs/String", "data:=hello"),
    ],
)
def test_an_option_may_stand_anywhere(words: tuple[str, ...]) -> None:
    found = parsed("topic", "pub", *words)
    assert (found.topic, found.type, found.values, found.once) == (
        "/x",
        "std_msgs/String",
        ["data:=hello"],
        True,
    )


@pytest.mark.parametrize(
    ("words", "values"),
    [
        (("/x", "geometry_msgs/Point", "1", "2", "--", "-3"), ["1", "2", "-3"]),
        (("/x", "geometry_msgs/Point", "-1", "--", "1", "2", "-3"), ["1", "2", "-3"]),
        (("/x", "std_msgs/Empty"), []),
        (("/x", "std_msgs/Empty", "-1"), []),
    ],
)
def test_values_that_look_like_options_stand_behind_two_dashes(
    words: tuple[str, ...], values: list[str]
) -> None:
    assert parsed("topic", "pub", *words).values == values


def test_lists_of_names_may_follow_an_option() -> None:
    found: Any = parsed("gen", "python", "out", "--types", "ws", "my_msgs/Foo", "--json", "std_msgs")
    assert (found.directory, found.names, found.types, found.json) == (
        "out",
        ["my_msgs/Foo", "std_msgs"],
        ["ws"],
        True,
    )
    assert parsed("topic", "list", "--json").namespace == "/"
    assert parsed("topic", "list", "--json", "/camera").namespace == "/camera"


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (("topic", "pub", "/x"), "the following arguments are required: TYPE"),
        (("topic", "info", "/x", "superfluous"), "unrecognized arguments: superfluous"),
        (("topic", "info", "/x", "--nonsense"), "unrecognized arguments: --nonsense"),
        (("master", "--port", "x"), "argument -p/--port: x is no port"),
        (("master", "--port", "65536"), "argument -p/--port: 65536 is no port"),
    ],
)
def test_wrong_usage_is_named(
    words: tuple[str, ...], complaint: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as raised:
        parsed(*words)
    assert raised.value.code == 2
    assert complaint in capsys.readouterr().err
