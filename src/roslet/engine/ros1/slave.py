"""The slave API: what the master and other nodes may ask of a node. Every call answers `[code, text, value]`.

Source: ROS 1 slave API. Runs on MicroPython.
"""

from roslet.engine.ros1.links import OPEN, check_caller, shorten
from roslet.engine.ros1.udp import MAX_SENDERS, UdpSender
from roslet.errors import ProtocolError
from roslet.wire.tcpros import parse_header

TYPE_CHECKING = False
if TYPE_CHECKING:
    from roslet.engine.ros1.engine import Engine
    from roslet.engine.ros1.graph import Publication
    from roslet.engine.ros1.links import Machine
    from roslet.engine.ros1.rpc import Methods
    from roslet.engine.ros1.udp import UdpReceiver

SUCCESS = 1
FAILURE = 0
ERROR = -1

# The largest datagram that a subscriber may ask for, and the smallest that carries a block.
MAX_DATAGRAM = 65507
MIN_DATAGRAM = 64


class Slave:
    """Answers the slave API for one engine."""

    def __init__(self, engine: "Engine") -> None:
        self.engine = engine
        self.now = 0.0  # when the call that is being answered came
        self.peer = ""  # the address that it came from
        # Each method with the fewest and the most parameters it takes.
        self.methods: Methods = {
            "getBusStats": (self.get_bus_stats, 1, 1),
            "getBusInfo": (self.get_bus_info, 1, 1),
            "getMasterUri": (self.get_master_uri, 1, 1),
            "getName": (self.get_name, 1, 1),
            "shutdown": (self.shutdown, 1, 2),
            "getPid": (self.get_pid, 1, 1),
            "getSubscriptions": (self.get_subscriptions, 1, 1),
            "getPublications": (self.get_publications, 1, 1),
            "paramUpdate": (self.param_update, 3, 3),
            "publisherUpdate": (self.publisher_update, 3, 3),
            "requestTopic": (self.request_topic, 3, 3),
        }

    def get_bus_stats(self, caller: str) -> "list[object]":
        engine = self.engine
        published: list[object] = []
        for publication in engine.publications.values():
            links = [
                [link.connection_id, link.bytes, link.messages, not link.closing]
                for link in publication.links
            ]
            published.append([publication.topic, sum([link.bytes for link in publication.links]), links])
        subscribed: list[object] = []
        for topic, entries in engine.subscriptions.items():
            rows: list[object] = []
            for subscription in entries:
                for link in subscription.links.values():
                    rows.append([link.connection_id, link.bytes, -1, not link.closing])
            subscribed.append([topic, rows])
        calls = sum([link.messages for offer in engine.services.values() for link in offer.links])
        size = sum([link.bytes for offer in engine.services.values() for link in offer.links])
        return [SUCCESS, "bus stats", [published, subscribed, [calls, size, 0]]]

    def get_bus_info(self, caller: str) -> "list[object]":
        rows: list[object] = []
        engine = self.engine
        for publication in engine.publications.values():
            for link in publication.links:
                rows.append(
                    [link.connection_id, link.callerid, "o", "TCPROS", publication.topic, True, _peer(link)]
                )
            for sender in publication.senders:
                rows.append(
                    [
                        sender.connection_id,
                        sender.callerid,
                        "o",
                        "UDPROS",
                        publication.topic,
                        True,
                        str(sender.address),
                    ]
                )
        for topic, entries in engine.subscriptions.items():
            for subscription in entries:
                for uri, incoming in subscription.links.items():
                    rows.append(
                        [
                            incoming.connection_id,
                            uri,
                            "i",
                            incoming.transport,
                            topic,
                            incoming.state == OPEN,
                            _peer(incoming),
                        ]
                    )
        return [SUCCESS, "bus info", rows]

    def get_master_uri(self, caller: str) -> "list[object]":
        return [SUCCESS, "master URI", self.engine.master_uri]

    def get_name(self, caller: str) -> "list[object]":
        return [SUCCESS, "node name", self.engine.name]

    def shutdown(self, caller: str, reason: str = "") -> "list[object]":
        text = "%s asks" % shorten(str(caller))
        if reason:
            text += ": " + shorten(str(reason))
        self.engine.shutdown_requested(text)
        return [SUCCESS, "shutting down", 0]

    def get_pid(self, caller: str) -> "list[object]":
        return [SUCCESS, "process id", self.engine.pid]

    def get_subscriptions(self, caller: str) -> "list[object]":
        rows = [[topic, entries[0].type] for topic, entries in self.engine.subscriptions.items()]
        return [SUCCESS, "subscriptions", rows]

    def get_publications(self, caller: str) -> "list[object]":
        rows = [[publication.topic, publication.type] for publication in self.engine.publications.values()]
        return [SUCCESS, "publications", rows]

    def param_update(self, caller: str, key: str, value: object) -> "list[object]":
        if not isinstance(key, str):
            return [ERROR, "the key must be a string", 0]
        self.engine.parameter_changed(key, value)
        return [SUCCESS, "noted", 0]

    def publisher_update(self, caller: str, topic: str, publishers: "list[object]") -> "list[object]":
        if not isinstance(topic, str) or not isinstance(publishers, (list, tuple)):
            return [ERROR, "expected a topic and a list of URIs", 0]
        if topic not in self.engine.subscriptions:
            self.engine.count("update-of-unknown-topic")
        uris = [uri for uri in publishers if isinstance(uri, str)]
        if len(uris) < len(publishers):
            self.engine.count("bad-publisher-uri", len(publishers) - len(uris))
        for subscription in list(self.engine.subscriptions.get(topic, [])):
            subscription.update(uris, self.now)
        return [SUCCESS, "noted", 0]

    def request_topic(self, caller: str, topic: str, protocols: "list[object]") -> "list[object]":
        engine = self.engine
        publication = engine.publications.get(topic) if isinstance(topic, str) else None
        if publication is None:
            engine.count("unknown-topic")
            return [FAILURE, "%s does not publish %s" % (engine.name, shorten(str(topic))), 0]
        if not isinstance(protocols, (list, tuple)):
            return [ERROR, "expected a list of protocols", 0]
        for protocol in protocols:
            if not isinstance(protocol, (list, tuple)) or not protocol:
                continue
            if protocol[0] == "TCPROS":
                return [SUCCESS, "ready", ["TCPROS", engine.host, engine.tcpros_port]]
            if protocol[0] == "UDPROS" and engine.udp is not None:
                return self._request_udp(publication, list(protocol))
        engine.count("no-common-transport")
        return [FAILURE, "no supported protocol among those offered", []]

    def _request_udp(self, publication: "Publication", protocol: "list[object]") -> "list[object]":
        """Datagrams go to the address that the call came from, whatever host it names: else one small request would
        turn this publisher against anybody."""
        engine = self.engine
        try:
            fields, port, size = _udp_parameters(protocol)
            publication.check(fields)
        except ProtocolError as error:
            engine.count(error.reason)
            return [ERROR if error.reason == "udp-parameters" else FAILURE, str(error), 0]
        callerid = fields.get("callerid", "")
        kept = [
            sender
            for sender in publication.senders
            if (sender.callerid, sender.address) != (callerid, (self.peer, port))
        ]
        if len(kept) >= MAX_SENDERS:
            engine.count("udp-too-many-subscribers")
            return [FAILURE, "%d UDPROS subscribers are served already" % len(kept), 0]
        publication.senders = tuple(kept)  # the same subscriber may ask again; it is served once
        sender = UdpSender(engine, publication, callerid, (self.peer, port), size, self.now)
        publication.opened(sender)
        # roslet and roscpp send from whatever port: what is said here stands for nothing.
        return [
            SUCCESS,
            "ready",
            ["UDPROS", engine.host, engine.tcpros_port, sender.connection_id, size, sender.header()],
        ]


def _udp_parameters(protocol: "list[object]") -> "tuple[dict[str, str], int, int]":
    """Header fields, port and datagram size of a UDPROS offer. Raises ProtocolError udp-parameters or bad-callerid."""
    if len(protocol) != 5:
        raise ProtocolError("udp-parameters", "UDPROS takes a header, host, port and datagram size")
    _, header, host, port, size = protocol
    if (
        not isinstance(header, (bytes, bytearray))
        or not isinstance(host, str)
        or type(port) is not int
        or type(size) is not int
        or not 0 < port < 65536
        or size < MIN_DATAGRAM
    ):
        raise ProtocolError("udp-parameters", "a wrong type, or out of range")
    try:
        fields = parse_header(header)
    except ProtocolError as error:
        raise ProtocolError("udp-parameters", str(error)) from None
    check_caller(fields.get("callerid", ""))
    return fields, port, min(size, MAX_DATAGRAM)


def _peer(link: "Machine | UdpReceiver") -> str:
    channel = link.channel
    return channel.description if channel is not None else ""
