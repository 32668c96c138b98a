"""`roslet doctor`: what it finds in the environment, on this host, and in a graph."""

from __future__ import annotations

import json
import os
import socket
from collections.abc import Callable
from typing import Any
from xmlrpc.client import ServerProxy

import pytest

import roslet
from roslet.cli.doctor import PROBLEM, WARNING
from roslet.cli.ros1.doctor import environment as environment1
from roslet.cli.ros2.doctor import _ports
from roslet.cli.ros2.doctor import environment as environment2
from roslet.cli.ros2.multicast import hears_itself
from roslet.master.server import MasterServer
from roslet.wire.rtps import locator

Run = Callable[..., Any]

NETWORK = f"ros2://{20 + os.getpid() % 80}?range=localhost"


def found(findings: list[Any]) -> list[tuple[str, str]]:
    """The texts of what is not right."""
    return [(one.level, one.text) for one in findings if one.level in (WARNING, PROBLEM)]


@pytest.mark.parametrize(
    "variables, level, text",
    [
        (
            {"ROS_LOCALHOST_ONLY": "1", "ROS_STATIC_PEERS": "robot"},
            WARNING,
            "ROS_STATIC_PEERS is set, and ROS_LOCALHOST_ONLY=1 puts it out of force",
        ),
        (
            {"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF", "ROS_STATIC_PEERS": "robot"},
            WARNING,
            "ROS_STATIC_PEERS is set, and the discovery range OFF uses none",
        ),
        (
            {"RMW_IMPLEMENTATION": "rmw_zenoh_cpp"},
            PROBLEM,
            "programs started here use Zenoh, which neither roslet nor any DDS hears",
        ),
        (
            {"FASTDDS_BUILTIN_TRANSPORTS": "SHM"},
            PROBLEM,
            "programs started here that use Fast DDS do not speak UDP over IPv4",
        ),
    ],
)
def test_an_environment_that_contradicts_itself_is_named_with_a_remedy(
    variables: dict[str, str], level: str, text: str
) -> None:
    findings = environment2(variables)
    assert found(findings) == [(level, text)]
    assert all(one.remedy for one in findings if one.level == level)


def test_an_ordinary_environment_of_ros_2_is_no_finding() -> None:
    assert found(environment2({})) == []
    assert found(environment2({"ROS_DOMAIN_ID": "5", "RMW_IMPLEMENTATION": "rmw_fastrtps_cpp"})) == []


def test_the_environment_of_ros_1_must_name_this_host() -> None:
    assert found(environment1({"ROS_IP": "127.0.0.1"})) == []
    ((level, text),) = found(environment1({"ROS_IP": "192.0.2.7"}))  # TEST-NET-1 of RFC 5737
    assert level == PROBLEM
    assert text == "nodes started here say 192.0.2.7, which is 192.0.2.7: no address of this host"
    both = found(environment1({"ROS_IP": "127.0.0.1", "ROS_HOSTNAME": "127.0.0.1"}))
    assert both == [(WARNING, "ROS_IP and ROS_HOSTNAME are both set; ROS_HOSTNAME counts")]


def test_ports_in_use_are_counted_and_a_noisy_domain_is_named() -> None:
    domain = 20 + os.getpid() % 80
    before = _ports(domain)[0].text
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("", locator.metatraffic_unicast_port(domain, 40)))
        findings = _ports(domain)
    assert findings[0].text != before
    assert [one.level for one in findings[1:]] == [WARNING]
    assert "beyond number 31" in findings[1].text
    assert "use a domain up to 101" in [one.remedy for one in _ports(102)]
    assert len(_ports(101)) == 1


def test_an_interface_that_is_not_there_does_not_hear_itself() -> None:
    assert hears_itself(9999, "192.0.2.7").startswith("cannot join 239.255.0.1: ")


def test_a_domain_that_is_none_is_a_problem_with_exit_code_1(
    run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", "999")
    outcome = run("doctor", "--network", "ros2://", "--json")
    assert outcome.code == 1
    assert json.loads(outcome.out)[-1]["text"] == "ROS_DOMAIN_ID: a domain id is 0 to 232, not '999'"


def test_nodes_that_go_together_are_no_finding_and_those_that_do_not_are(run: Run) -> None:
    with roslet.Node("one", network=NETWORK) as node:
        node.log.quiet = True
        node.publisher("good", "std_msgs/msg/String")
        node.subscribe("good", "std_msgs/msg/String", print)
        outcome = run("doctor", "--network", NETWORK, "--for", "0.1")
        assert outcome.code == 0, outcome.out
        assert "topics: all go together" in outcome.out
        node.publisher("bad", "std_msgs/msg/String")
        node.subscribe("bad", "std_msgs/msg/String", print, qos=LATE)
        node.publisher("torn", "std_msgs/msg/String")
        node.subscribe("torn", "std_msgs/msg/Int8", print)
        outcome = run("doctor", "--network", NETWORK, "--for", "0.1", "--json")
    problems = {row["about"]: row for row in json.loads(outcome.out) if row["level"] == "problem"}
    assert outcome.code == 1
    assert problems["topic /bad"]["text"] == "/one hears nothing of /one: QoS durability"
    assert problems["topic /torn"]["text"] == (
        "it has several types: std_msgs/msg/Int8 of /one; std_msgs/msg/String of /one"
    )
    assert all(row["remedy"] for row in problems.values())


LATE = roslet.QoS(durability="transient_local")


# ROS 1


def test_a_master_that_is_not_there_is_a_problem(run: Run) -> None:
    outcome = run("doctor", "--network", "ros1://127.0.0.1:1")
    assert outcome.code == 1
    assert "cannot reach the master at http://127.0.0.1:1" in outcome.out
    assert "-> start one" in outcome.out


def test_nodes_that_answer_are_fine_and_one_that_is_gone_is_a_problem(run: Run, master: MasterServer) -> None:
    with roslet.Node("robot", network=f"ros1://127.0.0.1:{master.port}") as node:
        node.service("enable", "std_srvs/SetBool", lambda request: None)
        node.start()
        outcome = run("doctor", "--json")
        assert outcome.code == 0, outcome.out
        rows = {row["about"]: row for row in json.loads(outcome.out)}
        assert rows["node /robot"]["level"] == "ok"
        # Under another name: a master asks a node to shut down when its name is registered at another address.
        gone = "http://127.0.0.1:1/"
        with ServerProxy(f"http://127.0.0.1:{master.port}/") as proxy:
            assert proxy.registerPublisher("/departed", "/gone", "std_msgs/String", gone)[0] == 1  # type: ignore[index]
            assert proxy.registerService("/departed", "/lost", "rosrpc://127.0.0.1:1", gone)[0] == 1  # type: ignore[index]
        outcome = run("doctor", "--json")
    assert outcome.code == 1
    problems = [row["text"] for row in json.loads(outcome.out) if row["level"] == "problem"]
    assert len(problems) == 2
    assert problems[0].startswith("it does not answer at http://127.0.0.1:1/")
    assert problems[1].startswith("cannot reach the server of /lost")
