"""Questions to the master and to nodes, asked without being a node: nothing is registered, nothing listens."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from roslet.cli.options import UNREACHABLE, CommandError
from roslet.errors import CallTimeout, Fault, Unreachable
from roslet.io.blocking import Caller, exchange_headers
from roslet.names import parse_network

if TYPE_CHECKING:
    from types import TracebackType

# Who asks, in the master's log.
CALLER = "/roslet"
# Seconds that the master has for one answer.
MASTER_TIMEOUT = 10.0
# Seconds that a node has: many are asked in a row, and some may be gone.
NODE_TIMEOUT = 3.0


class Graph:
    """The ROS graph of the network that a command was given."""

    def __init__(self, network: str) -> None:
        self.network, self.master_uri = parse_network(network, os.environ.get("ROS_MASTER_URI"))
        self._master = Caller(self.master_uri, MASTER_TIMEOUT)
        self._state: list[dict[str, list[str]]] | None = None
        self._types: dict[str, str] | None = None

    def __enter__(self) -> Graph:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
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
        """Topic to the nodes that publish it."""
        return self._system()[0]

    @property
    def subscribers(self) -> dict[str, list[str]]:
        """Topic to the nodes that subscribe it."""
        return self._system()[1]

    @property
    def services(self) -> dict[str, list[str]]:
        """Service to the nodes that offer it."""
        return self._system()[2]

    def _system(self) -> list[dict[str, list[str]]]:
        if self._state is None:
            answer = self.master("getSystemState")
            self._state = [{str(name): sorted(map(str, who)) for name, who in part} for part in answer]
        return self._state

    @property
    def types(self) -> dict[str, str]:
        """Topic to its type; "*" where nobody has said."""
        if self._types is None:
            self._types = {str(topic): str(kind) for topic, kind in self.master("getTopicTypes")}
        return self._types

    def topics(self) -> list[str]:
        """Every topic that is published or subscribed, sorted."""
        return sorted({*self.publishers, *self.subscribers})

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
