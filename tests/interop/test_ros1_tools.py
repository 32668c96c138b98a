"""Debian's rostopic, rosnode, rosservice, rosparam, rosbag, roslaunch with our node, on both masters."""

from __future__ import annotations

import contextlib
import json
import pathlib
import re
import threading
import time
from collections.abc import Iterator
from typing import Any

from rosbags import rosbag1

import roslet
from interop import exchange
from interop.exchange import Inbox, message
from interop.peers import samples
from interop.ros1 import Tools, wait_until
from roslet import Node, Publisher, Service

COORDINATE = "mros_comm_measure/Coordinate"


@contextlib.contextmanager
def talking(publisher: Publisher, size: int = 0, hz: float = 50.0) -> Iterator[None]:
    """Publishes message after message in the background."""
    ended = threading.Event()

    def talk() -> None:
        i = 0
        while not ended.wait(1 / hz):
            publisher.publish(message(publisher.type._type, i, size))
            i += 1

    thread = threading.Thread(target=talk)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()


def serving(node: Node, name: str) -> Service:
    return node.service(name, "peer_msgs/Scale", exchange.on_scale)


# ---- rostopic


def test_rostopic_echo_prints_what_we_publish(node: Node, tools: Tools, topic: str) -> None:
    with node.publisher(topic, COORDINATE, qos=roslet.QoS(durability="transient_local")) as publisher:
        publisher.publish(x=1.5, y=-2.0, z=0.25, time=roslet.Time(12, 34))
        text = tools.run("rostopic", "echo", "-n", "1", topic)
    assert text == "x: 1.5\ny: -2.0\nz: 0.25\ntime: \n  secs: 12\n  nsecs:        34\n---\n"


def test_rostopic_echo_filters_fields_of_nested_user_types(node: Node, tools: Tools, topic: str) -> None:
    with node.publisher(topic, "peer_msgs/Crowd", qos=roslet.QoS(durability="transient_local")) as publisher:
        publisher.publish(message("peer_msgs/Crowd", 5, 3))
        text = tools.run("rostopic", "echo", "-n", "1", f"{topic}/people[2]/name/first")
    assert "Grace 7" in text


def test_rostopic_pub_reaches_us(node: Node, tools: Tools, topic: str) -> None:
    inbox = Inbox()
    with node.subscribe(topic, COORDINATE, inbox):
        text = "{x: 1.5, y: 2.5, z: -1.0, time: {secs: 5, nsecs: 6}}"
        tools.run("rostopic", "pub", "-1", topic, COORDINATE, text)
        got = inbox.wait(1)[0]
    assert (got.x, got.y, got.z, got.time.secs, got.time.nsecs) == (1.5, 2.5, -1.0, 5, 6)


def test_rostopic_pub_at_a_rate_reaches_us_every_time(node: Node, tools: Tools, topic: str) -> None:
    inbox = Inbox()
    with node.subscribe(topic, "std_msgs/String", inbox):
        program = tools.start("rostopic", "pub", "-r", "50", topic, "std_msgs/String", "data: 'again'")
        got = inbox.wait(10)
        program.stop()
    assert {each.data for each in got} == {"again"}


def test_rostopic_hz_and_bw_measure_our_topic(node: Node, tools: Tools, topic: str) -> None:
    with node.publisher(topic, "std_msgs/String") as publisher, talking(publisher, size=1000):
        rates = tools.start("rostopic", "hz", topic)
        bandwidth = tools.start("rostopic", "bw", topic)
        rate = float(rates.wait_for("average rate: ")[0].split()[-1])
        average = bandwidth.wait_for("average: ")[0]
        rates.stop()
        bandwidth.stop()
    assert 1 < rate < 200
    assert re.fullmatch(r"average: [\d.]+K?B/s", average)


def test_rostopic_list_type_find_and_info_know_our_topics(node: Node, tools: Tools, topic: str) -> None:
    other = topic + "_in"
    with node.publisher(topic, COORDINATE), node.subscribe(other, "std_msgs/String", Inbox()):
        assert {topic, other} <= set(tools.run("rostopic", "list").split())
        assert tools.run("rostopic", "type", topic).strip() == COORDINATE
        assert topic in tools.run("rostopic", "find", COORDINATE).split()
        assert f"Publishers: \n * {node.name} ({node.uri})" in tools.run("rostopic", "info", topic)
        assert f"Subscribers: \n * {node.name} ({node.uri})" in tools.run("rostopic", "info", other)


# ---- rosservice


def test_rosservice_calls_our_service(node: Node, tools: Tools, topic: str) -> None:
    with serving(node, topic):
        text = tools.run("rosservice", "call", topic, "{points: [{x: 1.0, y: 2.0, z: 4.0}], factor: 0.5}")
        refused = tools.run("rosservice", "call", topic, "{points: [], factor: 0.0}", code=None)
    assert "x: 0.5" in text and "y: 1.0" in text and "scaled 1" in text
    assert "scaled" not in refused


def test_rosservice_list_type_info_and_args_know_our_service(node: Node, tools: Tools, topic: str) -> None:
    with serving(node, topic):
        assert topic in tools.run("rosservice", "list").split()
        assert tools.run("rosservice", "type", topic).strip() == "peer_msgs/Scale"
        assert tools.run("rosservice", "args", topic).strip() == "points factor"
        text = tools.run("rosservice", "info", topic)
        assert f"Node: {node.name}" in text and "Type: peer_msgs/Scale" in text
    assert topic not in tools.run("rosservice", "list").split()


# ---- rosparam


def test_rosparam_sets_what_we_read(node: Node, tools: Tools, topic: str) -> None:
    told: list[Any] = []
    node.on_parameter(topic, told.append)
    text = "{gains: {p: 1.5, i: 2}, name: 'arm', turned: true, list: [1, 2.5, three]}"
    tools.run("rosparam", "set", topic, text)
    expected = {"gains": {"p": 1.5, "i": 2}, "name": "arm", "turned": True, "list": [1, 2.5, "three"]}
    assert node.get_parameter(topic) == expected
    assert node.get_parameter(topic + "/gains/p") == 1.5
    wait_until(lambda: told, "the change is told")


def test_rosparam_gets_lists_dumps_and_deletes_what_we_set(node: Node, tools: Tools, topic: str) -> None:
    node.set_parameter(topic, {"gains": {"p": 1.5}, "text": "žluť & <b>"})
    assert tools.run("rosparam", "get", topic + "/gains/p").strip() == "1.5"
    assert topic + "/gains/p" in tools.run("rosparam", "list").split()
    assert yaml_string(tools.run("rosparam", "get", topic + "/text")) == "žluť & <b>"
    tools.run("rosparam", "dump", "dumped.yaml", topic)
    tools.run("rosparam", "delete", topic)
    assert not node.has_parameter(topic)
    tools.run("rosparam", "load", "dumped.yaml", topic)
    assert node.get_parameter(topic) == {"gains": {"p": 1.5}, "text": "žluť & <b>"}


def yaml_string(text: str) -> str:
    """A string as YAML prints it: quoted, with escapes, where it is not ASCII."""
    text = text.strip()
    return str(json.loads(text.replace("\\x", "\\u00"))) if text.startswith('"') else text


# ---- rosnode


def test_rosnode_list_info_and_ping_know_our_node(node: Node, tools: Tools, topic: str) -> None:
    service = topic + "_service"
    with (
        node.publisher(topic, "std_msgs/String"),
        node.service(service, "peer_msgs/Scale", exchange.on_scale),
    ):
        assert node.name in tools.run("rosnode", "list").split()
        text = tools.run("rosnode", "info", node.name)
        assert f" * {topic} [std_msgs/String]" in text
        assert f" * {service}" in text
        assert re.search(r"Pid: \d+", text)
        assert "xmlrpc reply from" in tools.run("rosnode", "ping", "-c", "2", node.name)


def test_rosnode_info_tells_our_connections(node: Node, tools: Tools, topic: str) -> None:
    with node.publisher(topic, "std_msgs/String") as publisher:
        listener = tools.start("rostopic", "echo", topic)
        wait_until(lambda: publisher.subscriber_count == 1, "rostopic echo subscribes")
        text = tools.run("rosnode", "info", node.name)
        listener.stop()
        wait_until(lambda: publisher.subscriber_count == 0, "we notice that it went")
    assert re.search(rf"\* topic: {topic}\n.*to: /rostopic_.*\n.*direction: outbound", text)
    assert "transport: TCPROS" in text


def test_rosnode_kill_ends_our_node_and_unregisters_it(master: Any, tools: Tools, topic: str) -> None:
    ended: list[bool] = []
    with roslet.Node("victim", network=master.network) as victim:
        victim.publisher(topic, "std_msgs/String")
        victim.on_shutdown(lambda: ended.append(True))
        victim.start()
        assert "killed" in tools.run("rosnode", "kill", "/victim")
        wait_until(lambda: victim.is_shutdown, "the node ends")
        wait_until(
            lambda: "/victim" not in tools.run("rosnode", "list").split(), "the master forgets the node"
        )
    assert ended == [True]
    assert topic not in tools.run("rostopic", "list").split()


def test_a_second_node_of_our_name_ends_ours(master: Any, tools: Tools, topic: str) -> None:
    with roslet.Node("twin", network=master.network) as first:
        first.publisher(topic, "std_msgs/String")
        first.start()
        second = tools.start("rostopic", "pub", topic, "std_msgs/String", "data: 'me'", "__name:=twin")
        wait_until(lambda: first.is_shutdown, "the first of the name ends")
        info = ("rostopic", "info", topic)
        wait_until(lambda: "Publishers: \n * /twin" in tools.run(*info, code=None), "the second stays")
        second.stop()


# ---- rosbag


def test_rosbag_records_what_we_publish_and_plays_it_to_us(node: Node, tools: Tools, topic: str) -> None:
    bag = tools.folder / f"{topic[1:]}.bag"
    cases = [(topic + "/cloud", "sensor_msgs/PointCloud2", 100), (topic + "/crowd", "peer_msgs/Crowd", 3)]
    publishers = [node.publisher(name, kind) for name, kind, _ in cases]
    recorder = tools.start("rosbag", "record", "-O", str(bag), *(name for name, _, _ in cases))
    for publisher in publishers:
        assert publisher.wait_for_subscribers(1, timeout=20), "rosbag record subscribes"
    for i in range(5):
        for publisher, (_, kind, size) in zip(publishers, cases, strict=True):
            publisher.publish(message(kind, i, size))
    time.sleep(0.3)  # the recorder tells nobody that it has taken everything from its sockets
    recorder.stop()
    for publisher in publishers:
        publisher.close()
    info = tools.run("rosbag", "info", str(bag))
    assert "messages:    10" in info and "peer_msgs/Crowd" in info

    inboxes = [Inbox() for _ in cases]
    pairs = list(zip(cases, inboxes, strict=True))
    subscriptions = [node.subscribe(name, kind, inbox) for (name, kind, _), inbox in pairs]
    tools.run("rosbag", "play", "-q", "-d", "0.7", "-r", "20", str(bag))
    for (_, kind, size), inbox in pairs:
        for i, got in enumerate(inbox.wait(5)):
            assert samples.differences(samples.sample(kind, i, size), got) == []
    for subscription in subscriptions:
        subscription.close()


def test_a_recording_carries_our_full_definitions(node: Node, tools: Tools, topic: str) -> None:
    """Another implementation, which has never heard of the type, reads the bag."""
    bag = tools.folder / f"{topic[1:]}.bag"
    with node.publisher(topic, "peer_msgs/Crowd", qos=roslet.QoS(durability="transient_local")) as publisher:
        publisher.publish(message("peer_msgs/Crowd", 1, 2))
        recorder = tools.start("rosbag", "record", "-l", "1", "-O", str(bag), topic)
        recorder.finish()
    with rosbag1.Reader(pathlib.Path(bag)) as reader:
        (connection,) = reader.connections
        definition = str(getattr(connection.msgdef, "data", connection.msgdef))
        assert connection.msgtype == "peer_msgs/msg/Crowd"
        assert "MSG: mros_comm_measure/Coordinate" in definition
        assert len(list(reader.messages())) == 1


# ---- roslaunch


def test_roslaunch_starts_nodes_that_we_talk_to(node: Node, tools: Tools) -> None:
    launched = tools.start("roslaunch", "--skip-log-check", "peer_msgs", "shout.launch")
    try:
        inbox = Inbox()
        with (
            node.subscribe("/house/louder", "std_msgs/String", inbox),
            node.publisher("/house/quiet", "std_msgs/String") as publisher,
        ):
            assert publisher.wait_for_subscribers(1, timeout=20), "the launched node subscribes"
            wait_until(lambda: node.has_parameter("/house/shout/times"), "its parameter is there")
            wait_until(lambda: _say_and_hear(publisher, inbox), "the launched node answers")
        assert inbox.messages[0].data == "HELLO HELLO "
        assert node.get_parameter("/launched") == "yes"
    finally:
        launched.stop()
    wait_until(lambda: node.lookup_node("/house/shout") is None, "the launched node goes")


def _say_and_hear(publisher: Publisher, inbox: Inbox) -> bool:
    publisher.publish(data="hello ")
    time.sleep(0.05)
    return bool(inbox.messages)
