"""The node itself: names, arguments, addresses, parameters, the log, its end."""

from __future__ import annotations

import os
import pathlib
import signal
import socket
import subprocess
import sys
import threading
import time
from typing import Any

import pytest

import roslet
from nodes import Nodes, descriptors, ros1, serve, wait_until
from roslet.master.server import MasterServer
from roslet.node.values import parse_value

SOURCE = pathlib.Path(__file__).resolve().parent.parent.parent / "src"


def registered(master: MasterServer) -> list[Any]:
    return [part for part in master.call("getSystemState", "/test")[2] if part]


# -- names, arguments, addresses


def test_a_node_has_a_full_name_and_a_namespace(make: Nodes) -> None:
    assert (make("a").name, make("b", namespace="ns").name) == ("/a", "/ns/b")
    node = make("c", namespace="/x/y/")
    assert (node.name, node.namespace, node.resolve("t"), node.resolve("~p")) == (
        "/x/y/c",
        "/x/y",
        "/x/y/t",
        "/x/y/c/p",
    )
    assert make("d", environment={"ROS_NAMESPACE": "/env", "ROS_IP": "127.0.0.1"}).name == "/env/d"


@pytest.mark.parametrize(
    "options", [{"name": "a/b"}, {"name": ""}, {"name": "a", "namespace": "b c"}, {"name": "~a"}]
)
def test_an_illegal_name_is_refused_and_leaves_no_socket(make: Nodes, options: dict[str, str]) -> None:
    before = descriptors()
    with pytest.raises(roslet.InvalidName):
        make(**options)
    assert descriptors() == before


def test_a_node_that_cannot_begin_leaves_nothing_behind(make: Nodes, master: MasterServer) -> None:
    before = descriptors()
    with pytest.raises(roslet.InvalidMessage):
        make("a", arguments=["_p:=99999999999999999999"])  # more than 64 bits
    assert registered(master) == []
    wait_until(lambda: descriptors() <= before + 1, "every descriptor is closed")


def test_anonymous_nodes_have_names_of_their_own(make: Nodes) -> None:
    names = {make("a", anonymous=True).name for _ in range(5)}
    assert len(names) == 5 and all(name.startswith("/a_") for name in names)


def test_arguments_remap_and_set_private_parameters(make: Nodes, master: MasterServer) -> None:
    node = make(
        "a", arguments=["chatter:=/other", "_rate:=5", "_name:=text", "__ns:=/ns", "__name:=renamed", "file"]
    )
    assert node.name == "/ns/renamed"
    assert node.resolve("chatter") == "/other"
    assert node.arguments.rest == ["file"]
    assert master.call("getParam", "/test", "/ns/renamed/rate")[2] == 5
    assert node.get_parameter("~name") == "text"
    publisher = node.publisher("chatter", "std_msgs/String")
    assert publisher.topic == "/other" and "/other" in node.topics()


def test_ros_hostname_and_ros_ip_decide_what_is_advertised(make: Nodes) -> None:
    for environment, arguments, host in (
        ({"ROS_HOSTNAME": "localhost", "ROS_IP": "127.0.0.1"}, (), "localhost"),
        ({"ROS_IP": "127.0.0.1"}, (), "127.0.0.1"),
        ({}, (), "127.0.0.1"),
        ({"ROS_IP": "127.0.0.1"}, ("__hostname:=localhost",), "localhost"),
        ({"ROS_HOSTNAME": "localhost"}, ("__ip:=127.0.0.1",), "127.0.0.1"),
    ):
        node = make("a", environment=environment, arguments=arguments, anonymous=True)
        assert node.uri.startswith(f"http://{host}:")


def test_ros_master_uri_names_the_master(make: Nodes, master: MasterServer) -> None:
    environment = {"ROS_MASTER_URI": f"http://127.0.0.1:{master.port}/", "ROS_IP": "127.0.0.1"}
    node = make("a", network="ros1://", environment=environment)
    assert node.network == f"ros1://127.0.0.1:{master.port}"
    other = make(
        "b",
        network="ros1://",
        environment={"ROS_IP": "127.0.0.1"},
        arguments=[f"__master:={node.master_uri}"],
    )
    assert other.master_uri == node.master_uri == f"http://127.0.0.1:{master.port}"


# -- the graph and parameters


def test_the_graph_is_told(make: Nodes) -> None:
    a, b = make("a"), make("b")
    a.publisher("chatter", "std_msgs/String")
    b.subscribe("chatter", "std_msgs/String")
    a.service("empty", "std_srvs/Empty", lambda request: None)
    assert b.topics()["/chatter"] == "std_msgs/String" and b.topic_type("chatter") == "std_msgs/String"
    assert b.topic_type("nothing") is None
    assert {"/a", "/b"} <= set(b.nodes()) and b.services() == ["/empty"]
    publishers, subscribers, services = b.system_state()
    assert (
        publishers["/chatter"] == ["/a"]
        and subscribers["/chatter"] == ["/b"]
        and services["/empty"] == ["/a"]
    )
    assert b.lookup_node("/a") == a.uri and b.lookup_node("/nobody") is None
    assert str(b.lookup_service("empty")).startswith("rosrpc://127.0.0.1:") and b.lookup_service("no") is None
    assert b.call_node(a.uri, "getPid") == os.getpid()
    with pytest.raises(roslet.Unreachable):
        b.call_node("http://127.0.0.1:1/", "getPid")
    with pytest.raises(roslet.Fault):
        b.call_master("noSuchMethod")


def test_parameters_are_set_read_searched_and_deleted(make: Nodes) -> None:
    node = make("a", namespace="/ns")
    values = [True, 5, -2.5, "text \u00fc", b"\x00\xff", [1, "x", [2.0]], {"k": {"deep": 1}}, 2**31 - 1]
    for value in values:
        node.set_parameter("p", value)
        assert node.get_parameter("/ns/p") == value
    assert node.has_parameter("p") and not node.has_parameter("q")
    assert node.get_parameter("q", 7) == 7
    with pytest.raises(roslet.ParameterNotSet, match="/ns/q"):
        node.get_parameter("q")
    assert node.search_parameter("p") == "/ns/p" and node.search_parameter("nothing") is None
    assert "/ns/p" in node.parameter_names()
    node.delete_parameter("p")
    with pytest.raises(roslet.ParameterNotSet):
        node.delete_parameter("p")
    with pytest.raises(roslet.InvalidMessage):
        node.set_parameter("p", object())
    with pytest.raises(roslet.InvalidMessage, match="2147483648, an integer of more than 32 bits"):
        node.set_parameter("p", {"k": [1, 2**31]})
    assert node.get_parameter("p", None) is None


def test_a_change_of_a_parameter_is_told_inside_spin(make: Nodes) -> None:
    a, b = make("a"), make("b")
    a.set_parameter("/p", 1)
    seen: list[Any] = []
    assert b.on_parameter("/p", seen.append) == 1
    assert b.on_parameter("/unset", seen.append) == {}
    a.set_parameter("/p", 2)
    a.set_parameter("/else", 3)
    wait_until(lambda: seen == [2], "the change is told")
    a.set_parameter("/p", {"deep": 4})
    wait_until(lambda: len(seen) == 2, "and the next")


def test_a_namespace_is_told_whole_whoever_changed_it(make: Nodes) -> None:
    a, b = make("a"), make("b")
    seen: list[Any] = []
    a.set_parameter("/ns", {"left": 1, "right": {"gain": 2}})
    assert a.on_parameter("/ns", seen.append) == {"left": 1, "right": {"gain": 2}}
    b.set_parameter("/ns/right/gain", 3)
    wait_until(lambda: seen == [{"left": 1, "right": {"gain": 3}}], "another node's change is told")
    a.set_parameter("/ns/left", 4)
    wait_until(lambda: seen[1:] == [{"left": 4, "right": {"gain": 3}}], "its own change is told")
    a.delete_parameter("/ns/left")
    wait_until(lambda: seen[2:] == [{"right": {"gain": 3}}], "and that something is gone")


def test_a_callback_of_a_parameter_can_be_taken_back(make: Nodes, master: MasterServer) -> None:
    a, b = make("a"), make("b")
    first: list[Any] = []
    second: list[Any] = []
    b.on_parameter("/p", first.append)
    b.on_parameter("/p", second.append)
    b.off_parameter("/p", first.append)
    b.off_parameter("/p", first.append)
    b.off_parameter("/never", first.append)
    a.set_parameter("/p", 1)
    wait_until(lambda: second == [1], "the other callback is told")
    b.off_parameter("/p", second.append)
    b.get_parameter("/p")  # the calls to the master are in order, so it knows
    a.set_parameter("/p", 2)
    assert b.on_parameter("/p", first.append) == 2
    a.set_parameter("/p", 3)
    wait_until(lambda: first == [3], "set again, it is told again")
    assert second == [1] and "parameter-not-subscribed" not in b.counters


def test_the_node_follows_use_sim_time_on_after_a_callback_of_it(make: Nodes) -> None:
    a, b = make("a"), make("b")
    b.on_parameter("/use_sim_time", print)
    b.off_parameter("/use_sim_time", print)
    a.set_parameter("/use_sim_time", True)
    wait_until(lambda: b.clock.simulated, "it still hears of it")


def test_callbacks_that_peers_cause_have_a_bound(make: Nodes) -> None:
    from roslet.node import node as module

    a = make("a")
    a.on_parameter("/p", lambda value: None)
    with a.reactor.lock:
        for index in range(module.MAX_CALLBACKS + 10):
            ros1(a).engine.parameter_changed("/p", index)
    assert a.counters == {"too-many-callbacks": 10}


# -- the log


def test_the_log_goes_to_rosout_and_to_standard_error(make: Nodes, capfd: pytest.CaptureFixture[str]) -> None:
    a, b = make("a"), make("b")
    a.publisher("chatter", "std_msgs/String")
    log = b.subscribe("/rosout", "rosgraph_msgs/Log", qos=10)
    wait_until(lambda: log.publisher_count == 2, "both logs are connected, b's own too")
    a.log.quiet = False
    a.log.warning("careful \u00fc")
    a.log.debug("not said")
    message = log.take(3)
    assert (message.name, message.msg, message.level) == ("/a", "careful \u00fc", 4)
    assert message.file == "test_node.py" and message.function.startswith("test_the_log") and message.line > 0
    assert "/chatter" in message.topics and message.header.stamp.secs > 1_600_000_000
    for name, level in (("info", 2), ("error", 8), ("fatal", 16)):
        getattr(a.log, name)("x")
        assert log.take(3).level == level
    text = capfd.readouterr().err
    assert "[WARN]" in text and "[/a]: careful" in text and "not said" not in text


# -- the end


def test_closing_unregisters_everywhere_at_once(make: Nodes, master: MasterServer) -> None:
    before = descriptors()
    nodes = [make(f"n{index}") for index in range(5)]
    for node in nodes:
        for index in range(10):
            node.publisher(f"t{index}", "std_msgs/String")
            node.subscribe(f"t{index}", "std_msgs/String")
        node.service(f"~s{index}", "std_srvs/Empty", lambda request: None)
        node.on_parameter("/p", print)
    serve(0.3)
    assert registered(master)
    begin = time.monotonic()
    for node in nodes:
        node.close()
    assert time.monotonic() - begin < 1.0
    assert registered(master) == []
    assert all(node.is_shutdown for node in nodes)
    wait_until(
        lambda: descriptors() <= before + 1, "every descriptor is closed"
    )  # the master keeps one for telling


def test_what_is_closed_refuses_and_closing_again_is_allowed(make: Nodes) -> None:
    node = make("a")
    publisher = node.publisher("chatter", "std_msgs/String")
    subscription = node.subscribe("chatter", "std_msgs/String")
    service = node.service("s", "std_srvs/Empty", lambda request: None)
    node.close()
    node.close()
    for close in (publisher.close, subscription.close, service.close):
        close()
    for use in (
        lambda: node.publisher("x", "std_msgs/String"),
        lambda: node.subscribe("x"),
        lambda: node.get_parameter("/x"),
        lambda: node.client("x", "std_srvs/Empty"),
        lambda: publisher.publish(data="x"),
    ):
        with pytest.raises(roslet.NodeClosed):
            use()
    node.spin()  # returns at once


def test_a_node_may_be_closed_from_a_callback_and_from_on_shutdown(make: Nodes, master: MasterServer) -> None:
    a, b = make("a"), make("b")
    publisher = a.publisher("chatter", "std_msgs/String")
    ended: list[str] = []

    def last_words() -> None:
        ended.append("once")
        b.close()

    b.on_shutdown(last_words)
    b.on_shutdown(lambda: 1 / 0)
    b.subscribe("chatter", "std_msgs/String", lambda message: b.close())
    assert publisher.wait_for_subscribers(1, 3)
    for _ in range(3):
        publisher.publish(data="x")
    begin = time.monotonic()
    b.spin(5)
    assert b.is_shutdown and time.monotonic() - begin < 1.5
    assert ended == ["once"]
    wait_until(lambda: publisher.subscriber_count == 0, "the publisher sees it go")
    assert "/b" not in a.nodes()


def test_a_second_node_of_the_same_name_shuts_the_first_down(make: Nodes) -> None:
    first = make("a")
    first.publisher("chatter", "std_msgs/String")
    second = make("a")
    second.publisher("chatter", "std_msgs/String")
    first.spin(5)
    assert first.is_shutdown and not second.is_shutdown
    wait_until(lambda: second.lookup_node("/a") == second.uri, "the name is the second's")
    assert second.system_state()[0]["/chatter"] == ["/a"]


def test_a_tool_may_ask_a_node_to_end(make: Nodes) -> None:
    a, b = make("a"), make("b")
    assert b.call_node(a.uri, "shutdown", "because") == 0
    a.spin(5)
    assert a.is_shutdown


def test_start_spins_in_a_thread_and_survives_what_callbacks_raise(
    make: Nodes, capfd: pytest.CaptureFixture[str]
) -> None:
    a, b = make("a"), make("b")
    publisher = a.publisher("chatter", "std_msgs/String")
    threads: list[str] = []

    def callback(message: Any) -> None:
        threads.append(threading.current_thread().name)
        if message.data == "bad":
            raise ValueError("mine")

    b.subscribe("chatter", "std_msgs/String", callback)
    assert publisher.wait_for_subscribers(1, 3)
    b.start()
    b.start()
    for text in ("ok", "bad", "ok"):
        publisher.publish(data=text)
    end = time.monotonic() + 5
    while len(threads) < 3 and time.monotonic() < end:
        time.sleep(0.01)
    assert threads == ["roslet /b"] * 3
    time.sleep(0.05)
    assert "ValueError: mine" in capfd.readouterr().err


def test_spin_once_and_spin_until_serve_what_they_say(make: Nodes) -> None:
    node = make("a")
    publisher = node.publisher("chatter", "std_msgs/String")
    got: list[Any] = []
    node.subscribe("chatter", "std_msgs/String", got.append)
    begin = time.monotonic()
    node.spin_once()
    assert time.monotonic() - begin < 0.5 and got == []
    publisher.publish(data="x")
    node.spin_once()
    assert len(got) == 1
    assert not node.spin_until(lambda: len(got) == 2, 0.1)
    publisher.publish(data="y")
    assert node.spin_until(lambda: len(got) == 2, 3)


def run(program: str, master: MasterServer) -> subprocess.Popen[bytes]:
    text = f"import os, sys, time, roslet\nnode = roslet.Node('child', network='ros1://127.0.0.1:{master.port}')\n{program}\n"
    environment = {**os.environ, "PYTHONPATH": str(SOURCE)}
    return subprocess.Popen(
        [sys.executable, "-c", text], stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment
    )


def test_ctrl_c_ends_a_program_and_unregisters_it_well_under_a_second(master: MasterServer) -> None:
    process = run(
        "node.publisher('t', 'std_msgs/String'); node.subscribe('u'); print('ready', flush=True); node.spin()",
        master,
    )
    try:
        assert process.stdout is not None and process.stdout.readline() == b"ready\n"
        assert len(registered(master)) == 2
        begin = time.monotonic()
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=5)
        assert time.monotonic() - begin < 0.9
        assert registered(master) == []
        assert b"KeyboardInterrupt" in errors and process.returncode != 0
    finally:
        process.kill()
        process.wait()


def test_a_program_that_ends_without_closing_unregisters_at_exit(master: MasterServer) -> None:
    process = run("node.publisher('t', 'std_msgs/String')", master)
    _, errors = process.communicate(timeout=8)
    assert process.returncode == 0, errors.decode()
    assert errors == b"" and registered(master) == []


def test_a_forked_child_neither_unregisters_nor_disturbs_its_parent(master: MasterServer) -> None:
    process = run(
        """
got = []
p = node.publisher('t', 'std_msgs/String')
other = roslet.Node('other', network=node.network)
other.subscribe('t', 'std_msgs/String', got.append)
assert p.wait_for_subscribers(1, 3)
pid = os.fork()
if pid == 0:
    assert node.is_shutdown
    fresh = roslet.Node('fresh', network=node.network)
    fresh.publisher('u', 'std_msgs/String')
    assert '/u' in fresh.topics()
    sys.exit(0)  # runs what is registered for the exit
assert os.waitpid(pid, 0)[1] == 0
assert {'/child', '/other'} <= set(node.nodes()) and '/fresh' not in node.nodes(), node.nodes()
p.publish(data='still here')
assert node.spin_until(lambda: got, 3)
print('fine')
""",
        master,
    )
    output, errors = process.communicate(timeout=15)
    assert output == b"fine\n" and process.returncode == 0, errors.decode()


# -- small things


@pytest.mark.parametrize(
    ("text", "value"),
    [("5", 5), ("-2.5", -2.5), ("true", True), ("text", "text"), ("[1, 2]", [1, 2]), ("", ""), ("0x10", 16)],
)
def test_a_parameter_of_the_command_line_is_read_as_ros_reads_it(text: str, value: object) -> None:
    assert parse_value(text) == value


def test_qos_takes_what_exists_and_nothing_else() -> None:
    assert roslet.QoS() == roslet.QoS(10) != roslet.QoS(11) and hash(roslet.QoS()) == hash(roslet.QoS(10))
    assert "depth=3" in repr(roslet.QoS(3))
    for wrong in ({"depth": 0}, {"depth": "1"}, {"reliability": "x"}, {"durability": "x"}, {"history": "x"}):
        with pytest.raises(ValueError, match=next(iter(wrong))):
            roslet.QoS(**wrong)


def test_a_host_that_is_a_name_is_looked_up_without_blocking(
    make: Nodes, monkeypatch: pytest.MonkeyPatch
) -> None:
    looked: list[str] = []
    plain = socket.getaddrinfo

    def slow(host: str, *rest: Any, **named: Any) -> Any:
        if host.startswith("robot"):
            looked.append(host)
            time.sleep(0.3)
            raise socket.gaierror("no such host")
        return plain(host, *rest, **named)

    monkeypatch.setattr(socket, "getaddrinfo", slow)
    node = make("a")
    begin = time.monotonic()
    futures = []
    for index in range(20):
        with node.reactor.lock:
            ros1(node).engine.call_slave(
                f"http://robot{index}:1/",
                "getPid",
                ["/a"],
                lambda *given: futures.append(given[1]),
                node.reactor.now(),
            )
            ros1(node).update()
    node.call_master("getPid")
    assert time.monotonic() - begin < 0.25
    assert sum(thread.name == "roslet-lookup" for thread in threading.enumerate()) <= 8
    wait_until(lambda: len(futures) == 20, "every call fails")
    assert all(isinstance(error, roslet.Unreachable) for error in futures) and len(looked) == 20
