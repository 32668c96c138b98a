"""Questions to the master and to nodes, asked without being a node: nothing is registered, nothing listens."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from roslet.cli.graph import Graph
from roslet.cli.options import UNREACHABLE, CommandError
from roslet.engine.ros1 import answers
from roslet.errors import CallTimeout, Fault, Unreachable
from roslet.io.blocking import Caller, exchange_headers
from roslet.names import parse_network

if TYPE_CHECKING:
    from roslet.cli.parameters import ParameterStore

# Who asks, in the master's log.
CALLER = "/roslet"
# Seconds that the master has for one answer.
MASTER_TIMEOUT = 10.0
# Seconds that a node has: many are asked in a row, and some may be gone.
NODE_TIMEOUT = 3.0


class Ros1Graph(Graph):
    """What the master and nodes answer."""

    dialect = "ros1"

    def __init__(self, network: str) -> None:
        _, self.master_uri = parse_network(network, os.environ.get("ROS_MASTER_URI"))
        self._master = Caller(self.master_uri, MASTER_TIMEOUT)
        self._state: list[dict[str, list[str]]] | None = None
        self._types: dict[str, str] | None = None

    def close(self) -> None:
        self._master.close()

    def master(self, method: str, *arguments: Any) -> Any:
        """The value that the master answers. Raises Fault; CommandError where there is no master."""
        try:
            return self._master.call(method, CALLER, *arguments)
        except (Unreachable, CallTimeout) as error:
            reason = str(error).rpartition(self.master_uri.partition("://")[2] + ": ")[2]
            raise CommandError(
                f"cannot reach the master at {self.master_uri} ({reason})", UNREACHABLE
            ) from None

    def node(self, uri: str, method: str, *arguments: Any) -> Any:
        """The value that the node whose slave API is at `uri` answers. Raises Fault, Unreachable, CallTimeout."""
        with Caller(uri, NODE_TIMEOUT) as caller:
            return caller.call(method, CALLER, *arguments)

    @property
    def publishers(self) -> dict[str, list[str]]:
        return self._system()[0]

    @property
    def subscribers(self) -> dict[str, list[str]]:
        return self._system()[1]

    @property
    def services(self) -> dict[str, list[str]]:
        return self._system()[2]

    def _system(self) -> list[dict[str, list[str]]]:
        if self._state is None:
            answer = answers.system_state(self.master("getSystemState"))
            self._state = [{name: sorted(nodes) for name, nodes in part.items()} for part in answer]
        return self._state

    @property
    def types(self) -> dict[str, str]:
        if self._types is None:
            self._types = answers.topic_types(self.master("getTopicTypes"))
        return self._types

    def nodes(self) -> list[str]:
        """Every node that has something registered, sorted."""
        return sorted({node for part in self._system() for nodes in part.values() for node in nodes})

    def lookup_node(self, name: str) -> str | None:
        """The URI of a node's slave API; None where the master knows no such node."""
        try:
            return str(self.master("lookupNode", name))
        except Fault:
            return None

    def lookup_service(self, name: str) -> str | None:
        """The rosrpc:// URI of a service; None where there is none."""
        try:
            return str(self.master("lookupService", name))
        except Fault:
            return None

    def probe_service(self, name: str) -> dict[str, str]:
        """The connection header of the service's server: type, md5sum, callerid, ...

        Raises CommandError where there is no such service, or where its server does not answer.
        """
        uri = self.lookup_service(name)
        if uri is None:
            raise CommandError(f"there is no service {name}")
        fields = {"probe": "1", "md5sum": "*", "callerid": CALLER, "service": name}
        try:
            return {**exchange_headers(uri, fields, NODE_TIMEOUT), "uri": uri}
        except (Unreachable, CallTimeout) as error:
            raise CommandError(f"cannot reach the server of {name}: {error}", UNREACHABLE) from None

    # -- what commands print

    def endpoints_info(self, topic: str) -> dict[str, list[dict[str, Any]]]:
        parts = {"publishers": self.publishers, "subscribers": self.subscribers}
        uris: dict[str, str] = {}
        for part in parts.values():
            for node in part.get(topic, ()):
                if node not in uris:
                    uris[node] = self.lookup_node(node) or ""
        return {
            key: [{"node": node, "uri": uris[node]} for node in part.get(topic, ())]
            for key, part in parts.items()
        }

    def endpoint_rows(self, endpoints: list[dict[str, Any]], verbose: bool) -> list[tuple[str, ...]]:
        return [(one["node"], one["uri"]) for one in endpoints]

    service_titles = (("md5sum", "MD5"), ("nodes", "Node"), ("uri", "URI"))

    def service_type(self, name: str) -> str:
        return self.probe_service(name).get("type", "*")

    def service_info(self, name: str) -> dict[str, Any]:
        fields = self.probe_service(name)
        return {
            "type": fields.get("type", "*"),
            "md5sum": fields.get("md5sum", "*"),
            "nodes": self.services.get(name, []),
            "uri": fields["uri"],
        }

    def has_service(self, name: str) -> bool:
        return self.lookup_service(name) is not None

    def node_info(self, name: str) -> tuple[dict[str, Any], str]:
        from roslet.cli.ros1.nodes import describe

        return describe(self, name)

    def print_node(self, described: dict[str, Any]) -> None:
        from roslet.cli.ros1.nodes import print_described

        print_described(described)

    def parameters(self) -> ParameterStore:
        from roslet.cli.ros1.parameters import Server

        return Server(self)
