"""The master's answers about the graph, right and wrong."""

import pytest

from roslet.engine.ros1 import answers
from roslet.errors import ProtocolError

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

pytestmark = pytest.mark.micropython


def test_the_system_state_is_three_dicts() -> None:
    state = answers.system_state([[["/t", ["/a", "/b"]]], [], [["/s", ["/a"]]]])
    assert state == ({"/t": ["/a", "/b"]}, {}, {"/s": ["/a"]})


def test_topic_types_are_a_dict_and_parameter_names_a_list() -> None:
    assert answers.topic_types([["/t", "std_msgs/String"]]) == {"/t": "std_msgs/String"}
    assert answers.parameter_names(["/a", "/b"]) == ["/a", "/b"]


@pytest.mark.parametrize(
    "value", [5, "abc", [], [[], []], [[], [], 5], [[["/t"]], [], []], [[["/t", "/a"]], [], []]]
)
def test_a_state_of_another_shape_is_a_bad_reply(value: "Any") -> None:
    with pytest.raises(
        ProtocolError, match="bad-reply: expected \\[publishers, subscribers, services\\], got "
    ):
        answers.system_state(value)


@pytest.mark.parametrize("value", [5, "ab", {"ab": 1}, [5], [["/t"]]])
def test_types_of_another_shape_are_a_bad_reply(value: "Any") -> None:
    with pytest.raises(ProtocolError, match="bad-reply: expected "):
        answers.topic_types(value)


@pytest.mark.parametrize("value", [5, "abc", None])
def test_names_of_another_shape_are_a_bad_reply(value: "Any") -> None:
    with pytest.raises(ProtocolError, match="bad-reply: expected a list of names, got "):
        answers.parameter_names(value)
