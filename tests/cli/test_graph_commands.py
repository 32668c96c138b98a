"""Commands that ask the master and nodes: topic list/info/type, node, service, param."""

from __future__ import annotations

import json
import pathlib
import socket
import sys
import threading
from collections.abc import Callable, Iterator
from typing import Any
from xmlrpc.server import SimpleXMLRPCServer

import pytest

import roslet
from roslet.master.server import MasterServer
from roslet.wire.xmlrpc import emit_response

Run = Callable[..., Any]


@pytest.fixture
def robot(master: MasterServer) -> Iterator[roslet.Node]:
    """A node with something of everything."""
    with roslet.Node("robot", network=f"ros1://127.0.0.1:{master.port}") as node:
        node.publisher("chatter", "std_msgs/String")
        node.subscribe("cmd/vel", "geometry_msgs/Twist", lambda message: None)
        node.service("enable", "std_srvs/SetBool", enable)
        node.start()
        yield node


def enable(request: Any) -> dict[str, Any]:
    if not request.data:
        raise ValueError("it cannot be switched off")
    return {"success": True, "message": "on"}


def columns(text: str) -> list[list[str]]:
    """The cells of a table, which are two spaces apart."""
    return [[cell.strip() for cell in line.split("  ") if cell.strip()] for line in text.splitlines()]


@pytest.mark.parametrize(
    "command", ["topic list", "topic type /t", "node list", "service list", "param list"]
)
def test_a_master_that_answers_something_else_is_one_line(command: str, run: Run) -> None:
    server = SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False)
    for method in ("getSystemState", "getTopicTypes", "getParamNames"):
        server.register_function(lambda caller: [1, "", 5], method)
    thread = threading.Thread(target=server.serve_forever, args=(0.01,))
    thread.start()
    try:
        outcome = run(*command.split(), "--network", f"ros1://127.0.0.1:{server.server_address[1]}")
    finally:
        server.shutdown()
        thread.join(5)
        server.server_close()
    assert (outcome.code, outcome.out) == (1, "")
    assert outcome.err.startswith("roslet: bad-reply: expected ")
    assert outcome.err.endswith(", got 5\n")


# topics


@pytest.mark.parametrize("command", ["topic list", "node list", "service list", "param list"])
def test_where_nothing_is_there_the_list_is_empty_and_a_note_says_so(
    command: str, run: Run, master: MasterServer
) -> None:
    outcome = run(*command.split())
    thing = {"topic": "topics", "node": "nodes", "service": "services", "param": "parameters"}[
        command.split()[0]
    ]
    assert (outcome.code, outcome.out, outcome.err) == (0, "", f"no {thing}\n")
    outcome = run(*command.split(), "--json")
    assert (json.loads(outcome.out), outcome.err) == ([], "")


def test_topics_are_listed_with_type_and_counts_in_aligned_columns(run: Run, robot: roslet.Node) -> None:
    outcome = run("topic", "list")
    assert columns(outcome.out) == [
        ["TOPIC", "TYPE", "PUBLISHERS", "SUBSCRIBERS"],
        ["/chatter", "std_msgs/String", "1", "0"],
        ["/cmd/vel", "geometry_msgs/Twist", "0", "1"],
        ["/rosout", "rosgraph_msgs/Log", "1", "0"],
    ]
    lines = outcome.out.splitlines()
    assert {line.find("TYPE") for line in lines[:1]} == {
        line.index("geometry") for line in lines if "geometry" in line
    }
    assert run("topic", "list", "--names").out == "/chatter\n/cmd/vel\n/rosout\n"
    assert run("topic", "list", "/cmd", "--names").out == "/cmd/vel\n"


def test_topics_as_json_name_the_nodes(run: Run, robot: roslet.Node) -> None:
    assert json.loads(run("topic", "list", "--json").out)[0] == {
        "topic": "/chatter",
        "type": "std_msgs/String",
        "publishers": ["/robot"],
        "subscribers": [],
    }


def test_topic_info_shows_who_publishes_and_where(run: Run, robot: roslet.Node) -> None:
    assert run("topic", "info", "chatter").out.splitlines() == [
        "Topic: /chatter",
        "Type:  std_msgs/String",
        "",
        "Publishers:",
        f"  /robot  {robot.uri}",
        "",
        "Subscribers: none",
    ]
    assert json.loads(run("topic", "info", "/cmd/vel", "--json").out)["subscribers"] == [
        {"node": "/robot", "uri": robot.uri}
    ]


def test_topic_type_prints_the_name_alone(run: Run, robot: roslet.Node) -> None:
    assert run("topic", "type", "/chatter").out == "std_msgs/String\n"


@pytest.mark.parametrize("command", ["info", "type"])
def test_a_topic_that_nobody_has_is_exit_code_1(command: str, run: Run, master: MasterServer) -> None:
    outcome = run("topic", command, "/nothing")
    assert (outcome.code, outcome.err) == (1, "roslet: nobody publishes or subscribes /nothing\n")


def test_relative_names_are_in_ros_namespace(
    run: Run, robot: roslet.Node, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_NAMESPACE", "/cmd")
    assert run("topic", "type", "vel").out == "geometry_msgs/Twist\n"
    assert run("topic", "type", "/chatter").code == 0


def test_the_network_option_comes_before_the_environment(
    run: Run, robot: roslet.Node, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_MASTER_URI", "http://127.0.0.1:1")
    assert run("topic", "type", "/chatter", "--network", robot.network).code == 0


# nodes


def test_nodes_are_listed_with_what_they_have(run: Run, robot: roslet.Node) -> None:
    assert columns(run("node", "list").out) == [
        ["NODE", "PUBLISHES", "SUBSCRIBES", "SERVICES"],
        ["/robot", "2", "1", "1"],
    ]
    assert json.loads(run("node", "list", "--json").out) == [
        {"node": "/robot", "publishes": 2, "subscribes": 1, "services": 1}
    ]


def test_node_info_shows_topics_services_and_connections(run: Run, robot: roslet.Node) -> None:
    import os

    with roslet.Node("ear", network=robot.network) as ear:
        ear.subscribe("chatter", "std_msgs/String").wait_for_publishers(1, 5)
        text = run("node", "info", "/robot").out
        shown = json.loads(run("node", "info", "/ear", "--json").out)
    assert f"PID:  {os.getpid()}\n" in text
    assert "Publishes:\n  /chatter  std_msgs/String\n  /rosout   rosgraph_msgs/Log\n" in text
    assert "Subscribes:\n  /cmd/vel  geometry_msgs/Twist\n" in text
    assert "Services:\n  /enable\n" in text
    assert "Connections:\n  /chatter  to  /ear  TCPROS\n" in text
    assert shown["connections"] == [
        {"topic": "/chatter", "direction": "in", "peer": "/robot", "transport": "TCPROS", "connected": True}
    ]


def test_a_node_that_is_gone_is_shown_as_the_master_knows_it_with_exit_code_3(
    run: Run, master: MasterServer
) -> None:
    master.call("registerPublisher", "/ghost", "/t", "std_msgs/String", "http://127.0.0.1:1/")
    outcome = run("node", "info", "/ghost")
    assert outcome.code == 3
    assert "Publishes:\n  /t  std_msgs/String\n" in outcome.out
    assert outcome.err.startswith("roslet: the node does not answer: 127.0.0.1:1")


def test_ping_counts_and_sums_up(run: Run, robot: roslet.Node) -> None:
    outcome = run("node", "ping", "/robot", "-n", "2", "--every", "0.01")
    assert outcome.code == 0
    lines = outcome.out.splitlines()
    assert [line.split()[0] for line in lines[:2]] == ["/robot", "/robot"]
    assert columns(outcome.out)[-1][:3] == ["/robot", "2", "0"]
    rows = [json.loads(line) for line in run("node", "ping", "--all", "-n", "1", "--json").out.splitlines()]
    assert [(row["node"], row["seconds"] > 0) for row in rows] == [("/robot", True)]


def test_ping_without_an_answer_is_exit_code_3(run: Run, master: MasterServer) -> None:
    master.call("registerPublisher", "/ghost", "/t", "std_msgs/String", "http://127.0.0.1:1/")
    outcome = run("node", "ping", "/ghost", "-n", "1")
    assert outcome.code == 3
    assert "no answer" in outcome.out
    assert outcome.err == "roslet: no answer from /ghost\n"


def test_kill_ends_a_node(
    run: Run, robot: roslet.Node, eventually: Callable[..., None], master: MasterServer
) -> None:
    outcome = run("node", "kill", "/robot")
    assert (outcome.code, outcome.out) == (0, "asked /robot to end\n")
    eventually(lambda: robot.is_shutdown, "the node is shut down")
    eventually(lambda: run("node", "list", "--names").out == "", "the master forgets the node")


@pytest.mark.parametrize("arguments", [["ping"], ["kill"], ["kill", "--all", "/robot"]])
def test_ping_and_kill_want_either_names_or_all(arguments: list[str], run: Run, master: MasterServer) -> None:
    assert run("node", *arguments).code == 2


def test_an_unknown_node_is_exit_code_1(run: Run, master: MasterServer) -> None:
    for command in ("info", "ping", "kill"):
        outcome = run("node", command, "/nobody")
        assert (outcome.code, outcome.err) == (1, "roslet: the master knows no node /nobody\n")


# services


def test_services_are_listed_with_their_nodes_and_on_request_their_types(
    run: Run, robot: roslet.Node
) -> None:
    assert columns(run("service", "list").out) == [["SERVICE", "NODE"], ["/enable", "/robot"]]
    assert columns(run("service", "list", "--types-too").out)[1] == ["/enable", "std_srvs/SetBool", "/robot"]
    assert run("service", "type", "/enable").out == "std_srvs/SetBool\n"


def test_service_info_shows_type_and_definition(run: Run, robot: roslet.Node) -> None:
    text = run("service", "info", "/enable").out
    assert "Type:    std_srvs/SetBool\nMD5:     09fb03525b03e7ea1fd3992bafd87e16\nNode:    /robot\n" in text
    assert text.endswith("Request:\n  bool data\n\nResponse:\n  bool success\n  string message\n")
    assert json.loads(run("service", "info", "/enable", "--json").out)["request"] == ["bool data"]


@pytest.mark.parametrize("values", [["data:=true"], ["true"], ['{"data": true}']])
def test_a_service_is_called_with_fields_or_values_or_a_mapping(
    values: list[str], run: Run, robot: roslet.Node
) -> None:
    outcome = run("service", "call", "/enable", *values)
    assert (outcome.code, outcome.out) == (0, 'success: true\nmessage: "on"\n')
    assert json.loads(run("service", "call", "/enable", *values, "--json").out) == {
        "success": True,
        "message": "on",
    }


def test_what_a_handler_raises_is_the_error(run: Run, robot: roslet.Node) -> None:
    outcome = run("service", "call", "/enable", "false")
    assert outcome.code == 1
    assert outcome.err.splitlines()[-1] == "roslet: /enable failed: it cannot be switched off"


def test_a_wrong_request_is_refused_here_with_its_place(run: Run, robot: roslet.Node) -> None:
    outcome = run("service", "call", "/enable", "date:=true")
    assert (outcome.code, outcome.err) == (
        2,
        "roslet: std_srvs/SetBoolRequest has no field date; it has data\n",
    )
    assert run("service", "call", "/enable", '{"data": "maybe"}').err.startswith("roslet: data: ")


def test_a_service_that_is_not_there_is_exit_code_1_and_one_that_does_not_come_3(
    run: Run, master: MasterServer
) -> None:
    outcome = run("service", "call", "/nothing")
    assert (outcome.code, outcome.err) == (1, "roslet: there is no service /nothing\n")
    assert run("service", "call", "/nothing", "--wait", "0.1").code == 3


def test_a_service_whose_server_is_gone_is_exit_code_3(run: Run, master: MasterServer) -> None:
    master.call("registerService", "/ghost", "/s", "rosrpc://127.0.0.1:1", "http://127.0.0.1:1/")
    outcome = run("service", "type", "/s")
    assert outcome.code == 3
    assert outcome.err.startswith("roslet: cannot reach the server of /s: ")
    assert columns(run("service", "list", "--types-too").out)[1] == ["/s", "no answer", "/ghost"]


def test_a_service_of_a_type_that_is_loaded_can_be_called(
    run: Run, master: MasterServer, tmp_path: pathlib.Path
) -> None:
    (tmp_path / "cli_srvs" / "srv").mkdir(parents=True)
    (tmp_path / "cli_srvs" / "srv" / "Twice.srv").write_text("int32 a\n---\nint32 b\n")
    types = roslet.load(tmp_path)
    with roslet.Node("server", network=f"ros1://127.0.0.1:{master.port}") as node:
        node.service("twice", "cli_srvs/Twice", lambda request: {"b": 2 * request.a})
        node.start()
        assert run("service", "call", "/twice", "21", "--types", tmp_path).out == "b: 42\n"
        assert "Request:\n  int32 a\n" in run("service", "info", "/twice", "--types", tmp_path).out
        assert "Request: cli_srvs/Twice is not installed here" in run("service", "info", "/twice").out
    assert types.names


# parameters


@pytest.mark.parametrize(
    "text, value",
    [
        ("5", 5),
        ("-5", -5),
        ("0.5", 0.5),
        ("true", True),
        ("hello", "hello"),
        ("[1, 2.5]", [1, 2.5]),
        ('{"a": 1}', {"a": 1}),
    ],
)
def test_a_parameter_keeps_its_value_and_its_type(
    text: str, value: Any, run: Run, master: MasterServer
) -> None:
    assert run("param", "set", "/p", "--", text).code == 0
    assert master.call("getParam", "/test", "/p")[2] == value
    assert json.loads(run("param", "get", "/p", "--json").out) == value


def test_a_scalar_is_printed_bare_and_a_namespace_as_yaml(run: Run, master: MasterServer) -> None:
    run("param", "set", "/a/name", "left")
    run("param", "set", "/a/rates", "[1, 2]")
    assert run("param", "get", "/a/name").out == "left\n"
    assert run("param", "get", "/a").out == 'name: "left"\nrates: [1, 2]\n'
    assert run("param", "list", "/a").out == "/a/name\n/a/rates\n"


def test_text_stays_text_where_that_is_wanted(run: Run, master: MasterServer) -> None:
    run("param", "set", "--string", "/serial", "0042")
    assert master.call("getParam", "/test", "/serial")[2] == "0042"


def test_a_parameter_that_is_not_set_is_exit_code_1_or_the_default(run: Run, master: MasterServer) -> None:
    outcome = run("param", "get", "/nothing")
    assert (outcome.code, outcome.err) == (1, "roslet: parameter /nothing is not set\n")
    assert run("param", "get", "/nothing", "--default", "7").out == "7\n"
    outcome = run("param", "delete", "/nothing")
    assert (outcome.code, outcome.err) == (1, "roslet: not set: /nothing\n")


def test_delete_deletes(run: Run, master: MasterServer) -> None:
    run("param", "set", "/a", "1")
    assert run("param", "delete", "/a").code == 0
    assert master.call("hasParam", "/test", "/a")[2] is False


@pytest.mark.parametrize("yaml", [True, False])
def test_what_is_dumped_can_be_loaded_with_and_without_pyyaml(
    yaml: bool, run: Run, master: MasterServer, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if not yaml:
        monkeypatch.setitem(sys.modules, "yaml", None)
    value = {
        "name": "näme: yes",
        "on": True,
        "rates": [1, 2.5, "x"],
        "deep": {"er": {"value": -1}},
        "none": {},
    }
    master.call("setParam", "/test", "/a", value)
    assert run("param", "dump", tmp_path / "file", "/a").code == 0
    text = (tmp_path / "file").read_text(encoding="utf-8")
    assert text.startswith("{") is not yaml
    assert run("param", "load", tmp_path / "file", "/b").code == 0
    assert master.call("getParam", "/test", "/b")[2] == value
    assert run("param", "dump", "-", "/a").out == text


def test_load_keeps_what_the_file_does_not_name(
    run: Run, master: MasterServer, tmp_path: pathlib.Path
) -> None:
    master.call("setParam", "/test", "/a", {"kept": 1, "changed": 2})
    (tmp_path / "file").write_text('{"changed": 3}')
    run("param", "load", tmp_path / "file", "/a")
    assert master.call("getParam", "/test", "/a")[2] == {"kept": 1, "changed": 3}


def test_a_parameter_file_that_is_wrong_is_named(
    run: Run, master: MasterServer, tmp_path: pathlib.Path
) -> None:
    (tmp_path / "file").write_text("{")
    outcome = run("param", "load", tmp_path / "file")
    assert outcome.code == 1
    assert outcome.err.startswith(f"roslet: {tmp_path / 'file'}: ")
    (tmp_path / "file").write_text("5")
    assert "expected names and values, not int" in run("param", "load", tmp_path / "file").err


def test_a_node_that_hangs_up_instead_of_answering_that_it_ends_was_asked(
    run: Run, master: MasterServer
) -> None:
    """rospy may do so: it closes its server before the reply is out."""
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        listener.listen()

        def serve() -> None:
            for answer in (emit_response([1, "", 7]), None):
                connection, _ = listener.accept()
                with connection:
                    connection.recv(4096)
                    if answer is not None:
                        connection.sendall(
                            b"HTTP/1.0 200 OK\r\nContent-Length: %d\r\n\r\n%s" % (len(answer), answer)
                        )

        thread = threading.Thread(target=serve)
        thread.start()
        uri = f"http://127.0.0.1:{listener.getsockname()[1]}/"
        master.call("registerPublisher", "/hasty", "/t", "std_msgs/String", uri)
        outcome = run("node", "kill", "/hasty")
        thread.join(5)
    assert (outcome.code, outcome.out) == (0, "asked /hasty to end\n")


def test_a_node_that_cannot_be_asked_to_end_is_exit_code_3(run: Run, master: MasterServer) -> None:
    master.call("registerPublisher", "/ghost", "/t", "std_msgs/String", "http://127.0.0.1:1/")
    outcome = run("node", "kill", "/ghost")
    assert outcome.code == 3
    assert outcome.err.startswith("roslet: not asked: /ghost: 127.0.0.1:1")
