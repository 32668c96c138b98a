"""The graph of a ROS 2 network, as a node that nobody sees has discovered it."""

from __future__ import annotations

import time
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

from roslet.cli.graph import Graph
from roslet.cli.options import UNREACHABLE, CommandError
from roslet.engine.ros2.graph import PUBLISHER
from roslet.engine.rtps.qos import incompatible
from roslet.names import REPLY, REQUEST, TOPIC, join
from roslet.node.node import Node
from roslet.node.ros2.qos import from_dds

if TYPE_CHECKING:
    from roslet.cli.parameters import ParameterStore
    from roslet.engine.ros2.graph import EndpointInfo, NodeInfo
    from roslet.node.ros2.network import Ros2Network
    from roslet.wire.rtps.qos import Qos

# Seconds that discovery has at least: the five announcements at the start are 0.1 s apart, and whoever hears the last only
# answers then.
LEAST = 0.4
# Seconds without a change after which nothing more is expected: a peer's endpoints come within a round trip or two, and what
# is lost on the way is sent again after 0.1 s.
QUIET = 0.2
# Seconds that it has at most: a person waits; and in a graph that goes on changing something always will be missing.
MOST = 1.5
# Seconds between two looks.
LOOK = 0.02


class Looker(Node):
    """A node without log, parameter services and the like: nobody wants to know anything of a command's node."""

    _seen = False


class Ros2Graph(Graph):
    """Made with a node of its own, after discovery had its time. `node` is that node, which no answer contains."""

    dialect = "ros2"
    service_titles = (("nodes", "Servers"), ("clients", "Clients"), ("type_hash", "Hash"))

    def __init__(self, network: str, name: str = "ask") -> None:
        self.node = Looker("_roslet_" + name, network=network, anonymous=True)
        self._seen = -1
        self._endpoints: list[EndpointInfo] = []
        self._by_channel: dict[tuple[str, bool], dict[str, list[EndpointInfo]]] = {}
        with ExitStack() as undone:
            undone.callback(self.node.close)
            self.settle()
            undone.pop_all()

    @property
    def net(self) -> Ros2Network:
        """What the node is on its network."""
        return self.node._network  # type: ignore[return-value]

    def close(self) -> None:
        self.node.close()

    def pause(self, seconds: float) -> None:
        """Let the loop run, without callbacks."""
        self.node.reactor.run_until(lambda: self.node.is_shutdown, seconds, user=False)

    def settle(self) -> None:
        """Wait until discovery has told all that it is going to tell; see the constants."""
        graph = self.net.graph
        begin = quiet_since = time.monotonic()
        revision = graph.revision
        while True:
            self.pause(LOOK)
            now = time.monotonic()
            if graph.revision != revision:
                revision, quiet_since = graph.revision, now
            with self.node.reactor.lock:
                complete = graph.complete()
            settled = complete and now - quiet_since >= QUIET and now - begin >= LEAST
            if settled or now - begin >= MOST:
                return

    # -- what there is

    def endpoints(self) -> list[EndpointInfo]:
        """Every endpoint but those of the command's own node."""
        with self.node.reactor.lock:
            graph = self.net.graph
            if graph.revision != self._seen:
                own = (self.net.base_name, self.net.namespace)
                self._endpoints = [
                    one for one in graph.endpoints(channel=None) if (one.node_name, one.node_namespace) != own
                ]
                self._by_channel.clear()
                self._seen = graph.revision
            return self._endpoints

    def node_infos(self) -> list[NodeInfo]:
        """Every node but the command's own."""
        with self.node.reactor.lock:
            found = [one for one in self.net.graph.nodes() if one.full_name != self.node.name]
        return sorted(found, key=lambda one: (one.full_name, one.participant))

    def of(self, channel: str, writers: bool) -> dict[str, list[EndpointInfo]]:
        """The endpoints of a channel and direction, by topic or service."""
        endpoints = self.endpoints()
        found = self._by_channel.get((channel, writers))
        if found is None:
            found = self._by_channel[channel, writers] = {}
            for one in endpoints:
                if one.channel == channel and (one.kind == PUBLISHER) == writers:
                    found.setdefault(one.name, []).append(one)
        return found

    @property
    def publishers(self) -> dict[str, list[str]]:
        return _nodes_of(self.of(TOPIC, True))

    @property
    def subscribers(self) -> dict[str, list[str]]:
        return _nodes_of(self.of(TOPIC, False))

    @property
    def services(self) -> dict[str, list[str]]:
        return _nodes_of(self.of(REQUEST, False))

    @property
    def types(self) -> dict[str, str]:
        return _types_of([one for one in self.endpoints() if one.channel == TOPIC])

    def nodes(self) -> list[str]:
        return sorted({one.full_name for one in self.node_infos()})

    def hidden(self, name: str) -> bool:
        return "/_" in name

    # -- what commands print

    def endpoints_info(self, topic: str) -> dict[str, list[dict[str, Any]]]:
        parts = {"publishers": True, "subscribers": False}
        return {
            key: [endpoint_data(one) for one in self.of(TOPIC, writers).get(topic, ())]
            for key, writers in parts.items()
        }

    def endpoint_rows(self, endpoints: list[dict[str, Any]], verbose: bool) -> list[tuple[str, ...]]:
        rows: list[tuple[str, ...]] = []
        for one in endpoints:
            if verbose:
                rows.append((one["node"], "type", one["type"]))
                rows.append(("", "hash", one["type_hash"] or "not told"))
                rows.append(("", "gid", one["gid"]))
                rows.append(("", "QoS", qos_text(one["qos"], verbose)))
            else:
                rows.append((one["node"], one["type"], qos_text(one["qos"])))
        return rows

    def service_type(self, name: str) -> str:
        found = _types_of(self.of(REQUEST, False).get(name, []))
        if name not in found:
            raise CommandError(f"there is no service {name}")
        return found[name]

    def service_info(self, name: str) -> dict[str, Any]:
        servers = self.of(REQUEST, False).get(name, [])
        if not servers:
            raise CommandError(f"there is no service {name}")
        from roslet.errors import DefinitionError
        from roslet.gen.runtime import registry
        from roslet.idl import type_hash

        kind = self.service_type(name)
        try:
            known = type_hash(registry("ros2"), kind)
        except DefinitionError:
            known = ""  # it is not installed here; endpoints tell the hashes of request and response alone
        return {
            "type": kind,
            "type_hash": known,
            "nodes": sorted(full_name(one) for one in servers),
            "clients": sorted(full_name(one) for one in self.of(REPLY, False).get(name, ())),
            "qos": qos_data(servers[0].qos),
        }

    def has_service(self, name: str) -> bool:
        return name in self.of(REQUEST, False)

    def node_info(self, name: str) -> tuple[dict[str, Any], str]:
        from roslet.cli.ros2.nodes import describe

        return describe(self, name), ""

    def print_node(self, described: dict[str, Any]) -> None:
        from roslet.cli.ros2.nodes import print_described

        print_described(described)

    def parameters(self) -> ParameterStore:
        from roslet.cli.ros2.parameters import NodeParameters

        return NodeParameters(self)

    def call(self, service: str, kind: str, timeout: float, **fields: Any) -> Any:
        """The response of a service of the standard packages. Raises CommandError where it does not come in time."""
        from roslet.errors import CallTimeout

        client = self.node.client(service, kind)
        try:
            return client.call(timeout=timeout, **fields)
        except CallTimeout:
            raise CommandError(f"{service} does not answer within {timeout:g} s", UNREACHABLE) from None
        finally:
            client.close()


def full_name(one: EndpointInfo) -> str:
    """The node of an endpoint."""
    return join(one.node_namespace, one.node_name)


def _nodes_of(found: dict[str, list[EndpointInfo]]) -> dict[str, list[str]]:
    return {name: sorted(full_name(one) for one in endpoints) for name, endpoints in found.items()}


def _types_of(endpoints: list[EndpointInfo]) -> dict[str, str]:
    found: dict[str, set[str]] = {}
    for one in endpoints:
        found.setdefault(one.name, set()).add(one.type_name)
    return {name: ", ".join(sorted(types)) for name, types in found.items()}


def endpoint_data(one: EndpointInfo) -> dict[str, Any]:
    """An endpoint as JSON data."""
    return {
        "node": full_name(one),
        "type": one.type_name,
        "type_hash": one.type_hash,
        "gid": gid_text(one.gid),
        "qos": qos_data(one.qos),
    }


def gid_text(gid: bytes) -> str:
    """Octets as ROS 2 prints them."""
    return ".".join([f"{octet:02x}" for octet in gid])


def qos_data(qos: Qos) -> dict[str, Any]:
    """The policies that an endpoint announced, as JSON data. Depth and history are not among them: few announce them, and
    they concern nobody else."""
    said = from_dds(qos)
    names = ("reliability", "durability", "deadline", "lifespan", "liveliness", "liveliness_lease")
    return {name: getattr(said, name) for name in names}


def qos_text(qos: dict[str, Any], verbose: bool = False) -> str:
    """The same for a person: what is not as usual, or everything."""
    words = [qos["reliability"], qos["durability"]]
    for name in ("deadline", "lifespan"):
        if qos[name] is not None or verbose:
            words.append(f"{name} {'none' if qos[name] is None else f'{qos[name]:g} s'}")
    if qos["liveliness"] != "automatic" or qos["liveliness_lease"] is not None or verbose:
        lease = qos["liveliness_lease"]
        words.append(f"liveliness {qos['liveliness']} {'' if lease is None else f'{lease:g} s'}".rstrip())
    return ", ".join(words)


def mismatches(endpoints: list[EndpointInfo]) -> list[tuple[EndpointInfo, EndpointInfo, tuple[str, ...]]]:
    """(publisher, subscription, policies) of every pair of one topic, or channel of a service, that does not match."""
    found = []
    writers: dict[tuple[str, str], list[EndpointInfo]] = {}
    for one in endpoints:
        if one.kind == PUBLISHER:
            writers.setdefault((one.channel, one.name), []).append(one)
    for reader in endpoints:
        if reader.kind != PUBLISHER:
            for writer in writers.get((reader.channel, reader.name), ()):
                policies = incompatible(writer.qos, reader.qos)
                if policies:
                    found.append((writer, reader, policies))
    return found
