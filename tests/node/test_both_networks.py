"""One program, one definition of a message, both networks."""

from __future__ import annotations

from typing import Any

import pytest

import roslet
from nodes import network, wait_until
from roslet.gen.runtime import message_class
from roslet.idl import Dialect

__all__ = ["network"]

FILES = {
    "msg/Part.msg": "string name\nduration[] laps\n",
    "msg/Reading.msg": "Header header\ntime stamp\ntime[2] ends\nPart[] parts\nPart[2] pair\nfloat32[] values\n",
    "srv/Shift.srv": "time from\nduration by\n---\ntime to\nPart part\n",
}


@pytest.fixture(scope="module")
def types(tmp_path_factory: pytest.TempPathFactory) -> Any:
    root = tmp_path_factory.mktemp("definitions") / "both_msgs"
    for name, text in FILES.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)
    return roslet.load(root)


def fill(types: Any) -> Any:
    part = types.both_msgs.msg.Part
    message: Any = types.both_msgs.msg.Reading(stamp=roslet.Time(7, 8), values=[1.0, 2.5])
    message.header.frame_id = "map"
    message.header.stamp = roslet.Time(1, 2)
    message.ends = [roslet.Time(3), roslet.Time(4, 5)]
    message.parts = [part(name="a", laps=[roslet.Duration(0.25), roslet.Duration(-0.5)]), part(name="b")]
    message.pair[1].laps = [roslet.Duration(9)]
    return message


def own_class(publisher: roslet.Publisher) -> Any:
    """Of the header, as the publisher's network has it."""
    made: Any = publisher.type()
    return type(made.header)


def check(message: Any) -> None:
    assert (message.header.frame_id, message.header.stamp.to_nsec()) == ("map", 1_000_000_002)
    assert (message.stamp.secs, message.stamp.nsecs) == (7, 8) == (message.stamp.sec, message.stamp.nanosec)
    assert [one.to_sec() for one in message.ends] == [3.0, 4.000000005]
    assert [(one.name, [lap.to_sec() for lap in one.laps]) for one in message.parts] == [
        ("a", [0.25, -0.5]),
        ("b", []),
    ]
    assert [[lap.to_nsec() for lap in one.laps] for one in message.pair] == [[], [9_000_000_000]]
    assert list(message.values) == [1.0, 2.5]


@pytest.mark.parametrize("form", ["class", "dict", "fields"])
def test_a_message_of_ones_own_with_times_and_arrays_arrives(network: str, types: Any, form: str) -> None:
    """Through sockets on ROS 1, from node to node; the copy that a node's own subscription gets is looked at too."""
    heard: list[Any] = []
    own: list[Any] = []
    with (
        roslet.Node("talker", network=network) as talker,
        roslet.Node("listener", network=network) as listener,
    ):
        listener.subscribe("readings", "both_msgs/Reading", heard.append)
        talker.subscribe("readings", types.both_msgs.msg.Reading, own.append)
        publisher = talker.publisher("readings", types.both_msgs.msg.Reading)
        wait_until(lambda: publisher.subscriber_count == 2, "both subscriptions are matched")
        message = fill(types)
        if form == "class":
            publisher.publish(message)
        else:
            values = {name: getattr(message, name) for name in message.__slots__}
            # What stands in a field has the fields of the network's own class: here ROS 1's `seq` as well.
            values["header"] = own_class(publisher)(frame_id="map", stamp=roslet.Time(1, 2))
            if form == "dict":
                publisher.publish(values)
            else:
                publisher.publish(**values)
        wait_until(lambda: heard and own, "the message arrives")
    check(heard[0])
    check(own[0])


def test_a_received_stamp_is_what_was_published(network: str, types: Any) -> None:
    heard: list[Any] = []
    with roslet.Node("both", network=network) as node:
        node.subscribe("readings", types.both_msgs.msg.Reading, heard.append)
        publisher = node.publisher("readings", types.both_msgs.msg.Reading)
        wait_until(lambda: publisher.subscriber_count, "matched")
        now = node.now()
        publisher.publish(stamp=now)
        wait_until(lambda: heard, "the message arrives")
    assert heard[0].stamp == now and now == heard[0].stamp


def test_a_service_of_ones_own_takes_and_gives_times(network: str, types: Any) -> None:
    def shift(request: Any) -> Any:
        to = roslet.Time(request.from_.sec, request.from_.nanosec) + roslet.Duration(request.by.to_sec())
        part = types.both_msgs.msg.Part(name="shifted", laps=[request.by])
        return types.both_msgs.srv.Shift.Response(to=to, part=part)

    with roslet.Node("server", network=network) as server, roslet.Node("client", network=network) as client:
        server.service("shift", types.both_msgs.srv.Shift, shift)
        server.start()
        caller = client.client("shift", types.both_msgs.srv.Shift)
        assert caller.wait(5.0)
        request = types.both_msgs.srv.Shift.Request(from_=roslet.Time(10), by=roslet.Duration(2.5))
        for response in (
            caller.call(request, timeout=5.0),
            caller.call(from_=roslet.Time(10), by=request.by, timeout=5.0),
        ):
            assert response.to.to_sec() == 12.5
            assert (response.part.name, response.part.laps[0].to_sec()) == ("shifted", 2.5)


def test_a_message_whose_fields_the_other_network_has_not_is_refused_by_name(network: str) -> None:
    other: Dialect = "ros2" if network.startswith("ros1") else "ros1"
    message: Any = message_class(other, "sensor_msgs/CameraInfo")()
    with roslet.Node("talker", network=network) as node:
        publisher = node.publisher("info", "sensor_msgs/CameraInfo")
        with pytest.raises(
            TypeError, match=r"sensor_msgs/(msg/)?CameraInfo has no field [dD], which the other"
        ):
            publisher.publish(message)


def test_a_node_that_is_closed_in_a_callback_is_closed_whatever_another_callback_raised(network: str) -> None:
    node = roslet.Node("node", network=network)
    publisher = node.publisher("/chatter", "std_msgs/String")

    def fail() -> None:
        raise ValueError("of another")

    node.reactor.call_soon(fail, user=True)
    node.reactor.call_soon(node.close, user=True)
    with pytest.raises(ValueError, match="of another"):
        node.spin(5)
    with pytest.raises(roslet.NodeClosed):
        publisher.publish(data="x")
