"""`roslet doctor` on ROS 1: the environment, the master, and whether its nodes are where they say."""

from __future__ import annotations

import os
import socket
from typing import TYPE_CHECKING

from roslet.cli.doctor import FINE, INFO, PROBLEM, WARNING, Finding
from roslet.cli.options import CommandError
from roslet.cli.ros1.graph import Ros1Graph
from roslet.errors import (
    CallTimeout,
    Fault,
    InvalidName,
    ProtocolError,
    RemoteError,
    RosletError,
    Unreachable,
)
from roslet.io.interfaces import interfaces
from roslet.names import parse_host_port

if TYPE_CHECKING:
    from collections.abc import Mapping

_VARIABLES = ("ROSLET_NETWORK", "ROS_MASTER_URI", "ROS_IP", "ROS_HOSTNAME", "ROS_NAMESPACE", "ROS_IPV6")


def examine(network: str) -> list[Finding]:
    """Every finding, in the order in which one thing needs the other."""
    found = environment(os.environ)
    with Ros1Graph(network) as graph:
        try:
            graph.master("getUri")
            nodes = graph.nodes()
        except (CommandError, RosletError) as error:
            found.append(
                Finding(
                    "master",
                    PROBLEM,
                    str(error),
                    "start one (`roslet master`, or roscore), or name its host in $ROS_MASTER_URI",
                )
            )
            return found
        found.append(Finding("master", FINE, f"{graph.master_uri} answers and knows {len(nodes)} nodes"))
        for node in nodes:
            found.append(_node(graph, node))
        for service in sorted(graph.services):
            found += _service(graph, service)
    return found


def environment(variables: Mapping[str, str]) -> list[Finding]:
    """What the environment says, and where it contradicts itself or this host."""
    there = [f"{name}={variables[name]}" for name in _VARIABLES if variables.get(name)]
    found = [Finding("environment", INFO, " ".join(there) or "no variable of ROS 1 is set")]
    if variables.get("ROS_IP") and variables.get("ROS_HOSTNAME"):
        found.append(
            Finding(
                "environment",
                WARNING,
                "ROS_IP and ROS_HOSTNAME are both set; ROS_HOSTNAME counts",
                "unset one of them",
            )
        )
    if variables.get("ROS_IPV6") == "on":
        found.append(
            Finding("environment", WARNING, "ROS_IPV6 is on; roslet speaks IPv4 only", "unset ROS_IPV6")
        )
    own = variables.get("ROS_HOSTNAME") or variables.get("ROS_IP") or socket.gethostname()
    where = "ROS_HOSTNAME" if variables.get("ROS_HOSTNAME") else "ROS_IP" if variables.get("ROS_IP") else ""
    addresses = {one.address for one in interfaces()}
    try:
        resolved = _resolve(own)
    except OSError as error:
        found.append(
            Finding(
                "own host",
                PROBLEM,
                f"{own} has no address ({error}); nodes started here would tell it to their peers",
                f"set {where or 'ROS_IP'} to an address of this host: {', '.join(sorted(addresses)) or 'none'}",
            )
        )
        return found
    if resolved & addresses or any(one.startswith("127.") for one in resolved):
        found.append(
            Finding("own host", FINE, f"nodes started here say {own} ({', '.join(sorted(resolved))})")
        )
    else:
        found.append(
            Finding(
                "own host",
                PROBLEM,
                f"nodes started here say {own}, which is {', '.join(sorted(resolved))}: no address of this host",
                f"set {where or 'ROS_IP'} to one of {', '.join(sorted(addresses)) or 'its addresses'}",
            )
        )
    return found


def _resolve(host: str) -> set[str]:
    return {str(row[4][0]) for row in socket.getaddrinfo(host, None, socket.AF_INET, socket.SOCK_STREAM)}


def _reach(uri: str) -> str:
    """What is wrong with the host of a URI; "" where its name has an address."""
    try:
        host, _ = parse_host_port(uri)
        _resolve(host)
    except InvalidName as error:
        return f"{uri} is no URI: {error}"
    except OSError as error:
        return f"its host {host} has no address here ({error})"
    return ""


def _node(graph: Ros1Graph, node: str) -> Finding:
    uri = graph.lookup_node(node)
    about = f"node {node}"
    if uri is None:
        return Finding(about, WARNING, "it has just gone")
    problem = _reach(uri)
    if problem:
        return Finding(
            about,
            PROBLEM,
            problem,
            "add the name to /etc/hosts here, or set ROS_IP where the node is started",
        )
    try:
        graph.node(uri, "getPid")
    except Fault as error:
        return Finding(about, WARNING, f"it does not tell its process: {error.message}")
    except (Unreachable, CallTimeout, RemoteError, ProtocolError) as error:
        return Finding(
            about,
            PROBLEM,
            f"it does not answer at {uri}: {error}",
            "if it has died, its entries go when a node of its name comes (`rosnode cleanup` removes them); if it "
            "runs, look for a firewall, and at ROS_IP where it was started",
        )
    return Finding(about, FINE, f"answers at {uri}")


def _service(graph: Ros1Graph, service: str) -> list[Finding]:
    try:
        graph.probe_service(service)
    except CommandError as error:
        return [
            Finding(
                f"service {service}", PROBLEM, str(error), "start its node again, or end what is left of it"
            )
        ]
    except RosletError:
        return []  # it answers, if with a refusal
    return []
