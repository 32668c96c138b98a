"""What every node of ROS 2 has beside what its program makes - log, simulated time, descriptions of its types - between
roslet's nodes and rclpy's.
"""

from __future__ import annotations

import time
from collections.abc import Iterator

import pytest

from interop import ros2_exchange as exchange
from interop.ros2_peers import Host, Peer, wait_until

LEVELS = (10, 20, 30, 40, 50)  # rcl_interfaces/msg/Log
IMAGE = "sensor_msgs/msg/Image"


@pytest.fixture(scope="module", params=["kilted", "jazzy"])
def two(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[list[Peer]]:
    with Host(tmp_path_factory.mktemp("conventions")) as host:
        yield [host.peer("roslet", "ours", "/deep/space"), host.peer(request.param, "theirs", "/far/away")]


@pytest.fixture(params=["roslet", "rclpy"])
def sides(two: list[Peer], request: pytest.FixtureRequest) -> tuple[Peer, Peer]:
    """Who does, and who witnesses."""
    ours, theirs = two
    ours.node, theirs.node = "/deep/space/ours", "/far/away/theirs"
    return (ours, theirs) if request.param == "roslet" else (theirs, ours)


def test_what_a_node_logs_is_heard_on_rosout(sides: tuple[Peer, Peer]) -> None:
    """From INFO on, as it is; a listener that comes late hears what has been logged in the last ten seconds."""
    logs, hears = sides
    texts = [f"{level} \u017elu\u0165" for level in LEVELS]
    logs.ask("log", [f"early {text}" for text in texts])
    hears.ask("hear_log")
    name = logs.node[1:].replace("/", ".")

    def heard(prefix: str) -> list[list[object]]:
        return [one for one in hears.ask("heard_log") if one[0] == name and str(one[2]).startswith(prefix)]

    wait_until(lambda: len(heard("early")) == 4, "the early ones arrive")
    logs.ask("log", [f"late {text}" for text in texts])
    wait_until(lambda: len(heard("late")) == 4, "the late ones arrive")
    for prefix in ("early", "late"):
        entries = heard(prefix)
        assert [one[1:3] for one in entries] == [
            [level, f"{prefix} {text}"] for level, text in zip(LEVELS[1:], texts[1:], strict=True)
        ]
        program = "roslet_ros2.py" if logs.kind == "roslet" else "rclpy_ros2.py"
        assert {tuple(one[3:6]) for one in entries} == {(program, "log", True)}
        assert all(abs(float(str(one[6])) - time.time()) < 20 for one in entries)


def test_a_node_follows_the_clock_that_another_publishes(sides: tuple[Peer, Peer]) -> None:
    tells, follows = sides
    follows.ask("simulate", True)
    tells.ask("tell_time", 1.0)
    wait_until(lambda: tells.ask("counts", "/clock")[1] >= 1, "somebody listens to the clock")
    for seconds in (100.25, 101.5, 50.125):  # it may jump back

        def told(seconds: float = seconds) -> bool:
            tells.ask("tell_time", seconds)
            return bool(follows.ask("now") == seconds)

        wait_until(told, f"it is {seconds}")
    follows.ask("simulate", False)
    assert follows.ask("now") > 1e9


def test_a_node_describes_a_type_as_the_other_does(two: list[Peer], sides: tuple[Peer, Peer]) -> None:
    """A type that both use, nested ones and their defaults included; and none by a wrong hash."""
    asked, asks = sides
    topic = exchange.name()
    for peer in two:
        peer.ask("publisher", topic, topic, IMAGE, {})
    (type_hash,) = {one["hash"] for one in asks.ask("endpoints", topic) if one["node"] == asks.node}
    answers = [asks.ask("describe", node, IMAGE, type_hash, 10.0) for node in (asked.node, asks.node)]
    assert answers[0] == answers[1]
    known, (image, *nested) = answers[0]
    assert known is True and image[0] == IMAGE
    assert [one[0] for one in nested] == ["builtin_interfaces/msg/Time", "std_msgs/msg/Header"]
    assert asks.ask("describe", asked.node, IMAGE, "RIHS01_" + 64 * "0", 10.0)[0] is False
    for peer in two:
        peer.ask("close", topic)
