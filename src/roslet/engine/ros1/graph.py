"""What a node has in the graph: publications, subscriptions, services. Each holds its links. Runs on MicroPython."""

from roslet.engine.ros1.links import PublisherLink, ServiceServerLink, SubscriberLink
from roslet.errors import InvalidName, ProtocolError
from roslet.names import parse_host_port
from roslet.wire.tcpros import MAX_FRAME

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable

    from roslet.engine.ros1.engine import Engine
    from roslet.engine.ros1.udp import UdpReceiver, UdpSender

# Seconds before a publisher that did not answer is asked again; doubled at each failure up to the second.
RETRY_FIRST = 0.1
RETRY_LAST = 3.0
ASKED_AGAIN = -1.0


class Publication:
    """A topic that this node publishes. `links` are its TCPROS subscribers, `senders` its UDPROS ones."""

    kind = "Publisher"

    def __init__(
        self,
        engine: "Engine",
        topic: str,
        type_name: str,
        md5sum: str,
        definition: str,
        latching: bool,
        depth: int,
    ) -> None:
        self.engine = engine
        self.topic = topic
        self.type = type_name
        self.md5sum = md5sum
        self.definition = definition
        self.latching = latching
        self.depth = depth
        self.links: tuple[PublisherLink, ...] = ()
        self.senders: tuple[UdpSender, ...] = ()
        self.on_link: Callable[[PublisherLink | UdpSender, bool], None] | None = None
        self.lock: object | None = None  # the shell's: guards the links' queues where there are threads
        self.dropped = 0

    def header(self) -> "dict[str, str]":
        return {
            "callerid": self.engine.name,
            "latching": "1" if self.latching else "0",
            "md5sum": self.md5sum,
            "message_definition": self.definition,
            "topic": self.topic,
            "type": self.type,
        }

    def accepts(self, fields: "dict[str, str]") -> str:
        """Empty where a subscriber with this header may have the topic, otherwise the sentence that refuses it."""
        md5sum = fields.get("md5sum", "*")
        if md5sum not in ("*", self.md5sum):
            return (
                "Topic %s: the subscriber %s expects %s with md5sum %s, this publisher has %s with md5sum %s"
                % (
                    self.topic,
                    fields.get("callerid", "(unnamed)"),
                    fields.get("type", "(no type)"),
                    md5sum,
                    self.type,
                    self.md5sum,
                )
            )
        if fields.get("type", "*") not in ("*", self.type):
            return "Topic %s has type %s; the subscriber expects %s" % (self.topic, self.type, fields["type"])
        return ""

    def opened(self, link: "PublisherLink | UdpSender") -> None:
        """The link can carry messages from now on."""
        if isinstance(link, PublisherLink):
            self.links = self.links + (link,)
        else:
            self.senders = self.senders + (link,)
        if self.on_link is not None:
            self.on_link(link, True)

    def link_lost(self, link: "PublisherLink", now: float) -> None:
        if link in self.links:
            self.links = tuple([other for other in self.links if other is not link])
            given_up = link.queue.clear()
            if given_up:
                self.dropped += given_up
                self.engine.count("publisher: queued-for-lost-subscriber", given_up)
            self.dropped += link.queue.dropped
            if self.on_link is not None:
                self.on_link(link, False)

    def close(self) -> None:
        for link in self.links:
            link.closing = True
            self.engine.touch(link)
        for sender in self.senders:
            self.engine.close_udp(sender)
        self.senders = ()


class Subscription:
    """A topic that this node subscribes. `sink(view, start, end, link)` gets each message's bytes."""

    kind = "Subscriber"

    def __init__(
        self,
        engine: "Engine",
        topic: str,
        type_name: str,
        md5sum: str,
        definition: str,
        sink: "Callable[[memoryview, int, int, object], None]",
        max_frame: int = MAX_FRAME,
        transport: str = "tcp",
        copies: bool = False,
        background: bool = False,
    ) -> None:
        self.engine = engine
        self.topic = topic
        self.type = type_name
        self.md5sum = md5sum
        self.definition = definition
        self.sink = sink
        self.max_frame = max_frame
        self.transport = transport
        self.copies = copies  # each small message in a buffer of its own
        self.background = background  # the sink is no user code: serve it though nobody spins
        self.links: dict[str, SubscriberLink | UdpReceiver] = {}
        self.publishers: tuple[str, ...] = ()
        self.on_link: Callable[[object, bool], None] | None = None
        self._retry: dict[str, tuple[float, float]] = {}  # uri -> (when, the pause after that)
        self._asking: dict[str, int] = {}
        self.closed = False

    def header(self, name: str) -> "dict[str, str]":
        fields = {
            "callerid": name,
            "md5sum": self.md5sum,
            "message_definition": self.definition,
            "tcp_nodelay": "1",
            "topic": self.topic,
            "type": self.type,
        }
        return fields

    def update(self, uris: "list[str]", now: float) -> None:
        """The whole list of publishers, as the master says it."""
        if self.closed:
            return
        self.publishers = tuple(uris)
        for uri in list(self.links):
            if uri not in uris:
                link = self.links.pop(uri)
                link.closing = True
                self.engine.touch(link)
                self._changed(link, False)
        for uri in list(self._retry):
            if uri not in uris:
                del self._retry[uri]
        for uri in uris:
            if uri != self.engine.uri and uri not in self.links and uri not in self._asking:
                self._ask(uri, now)

    def _ask(self, uri: str, now: float) -> None:
        """requestTopic at the publisher's slave API."""
        self._asking[uri] = 1
        protocols: list[object] = [["TCPROS"]]
        if self.transport == "udp":
            # Datagrams are preferred, not demanded: rospy speaks TCPROS only.
            protocols.insert(0, self.engine.udp_request(self))

        def answered(value: object, error: "Exception | None", when: float) -> None:
            self._asking.pop(uri, None)
            if self.closed or uri not in self.publishers:
                return
            if error is not None:
                self._later(uri, str(error), when)
                return
            try:
                self._connect(uri, value, when)
            except (ProtocolError, InvalidName) as refused:
                self.engine.count("subscriber: publisher-refused")
                self._later(uri, str(refused), when)

        self.engine.call_slave(uri, "requestTopic", [self.engine.name, self.topic, protocols], answered, now)

    def _connect(self, uri: str, value: object, now: float) -> None:
        if not isinstance(value, list) or not value:
            raise ProtocolError("no-common-transport", "%s offers no %s" % (uri, self.transport))
        if (
            value[0] == "TCPROS"
            and len(value) >= 3
            and isinstance(value[1], str)
            and isinstance(value[2], int)
        ):
            host, port = parse_host_port("rosrpc://%s:%d" % (value[1], value[2]))
            link: SubscriberLink | UdpReceiver = SubscriberLink(self.engine, self, uri, (host, port), now)
            self.engine.open(link)
        elif value[0] == "UDPROS" and self.transport == "udp":
            link = self.engine.udp_accepted(self, uri, value, now)
        else:
            raise ProtocolError("no-common-transport", "%s answers %r" % (uri, value[:1]))
        self.links[uri] = link

    def _later(self, uri: str, reason: str, now: float) -> None:
        pause = self._retry.get(uri, (0.0, RETRY_FIRST))[1]
        self._retry[uri] = (now + pause, min(2 * pause, RETRY_LAST))
        if pause == 4 * RETRY_FIRST:
            # A publisher that has just closed is told by the master in a moment; a third failure is worth a line.
            self.engine.note("%s: no connection to %s: %s" % (self.topic, uri, reason))

    def deadline(self) -> "float | None":
        soonest = None
        for when, _ in self._retry.values():
            if when != ASKED_AGAIN and (soonest is None or when < soonest):
                soonest = when
        return soonest

    def handle_deadline(self, now: float) -> None:
        for uri, (when, pause) in list(self._retry.items()):
            if when != ASKED_AGAIN and when <= now and uri not in self.links and uri not in self._asking:
                # The entry stays, so that the pause goes on growing until a link opens.
                self._retry[uri] = (ASKED_AGAIN, pause)
                self._ask(uri, now)

    def link_opened(self, link: object, now: float) -> None:
        uri = getattr(link, "uri", "")
        self._retry.pop(uri, None)
        self._changed(link, True)

    def link_lost(self, link: SubscriberLink, now: float) -> None:
        if self.links.get(link.uri) is not link:
            return
        del self.links[link.uri]
        if link.messages or link.reason:
            self.engine.count("subscriber: link-lost")
        self._changed(link, False)
        if not self.closed and link.uri in self.publishers:
            self._later(link.uri, link.reason, now)

    def _changed(self, link: object, opened: bool) -> None:
        if self.on_link is not None:
            self.on_link(link, opened)

    def close(self) -> None:
        self.closed = True
        for link in list(self.links.values()):
            link.closing = True
            self.engine.touch(link)
        self.links = {}


class ServiceOffer:
    """A service of this node. `handler(view, start, end, link)` returns the reply's bytes or raises ServiceFailed."""

    kind = "Service"

    def __init__(
        self,
        engine: "Engine",
        name: str,
        type_name: str,
        md5sum: str,
        types: "tuple[str, str]",
        handler: "Callable[[memoryview, int, int, ServiceServerLink], bytes]",
    ) -> None:
        self.engine = engine
        self.topic = name
        self.type = type_name
        self.md5sum = md5sum
        self.types = types
        self.handler = handler
        self.links: list[ServiceServerLink] = []

    def header(self) -> "dict[str, str]":
        return {
            "callerid": self.engine.name,
            "md5sum": self.md5sum,
            "request_type": self.types[0],
            "response_type": self.types[1],
            "service": self.topic,
            "type": self.type,
        }

    def link_lost(self, link: ServiceServerLink) -> None:
        if link in self.links:
            self.links.remove(link)

    def close(self) -> None:
        for link in list(self.links):
            link.closing = True
            self.engine.touch(link)
