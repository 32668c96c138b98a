"""What a node has in the graph: publications, subscriptions, services. Each holds its links. Runs on MicroPython."""

from roslet.engine.ros1.links import OPEN, PublisherLink, ServiceServerLink, SubscriberLink, shorten
from roslet.errors import InvalidName, ProtocolError
from roslet.names import parse_host_port
from roslet.wire.tcpros import MAX_FRAME

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from roslet.engine.ros1.engine import Engine
    from roslet.engine.ros1.udp import UdpReceiver, UdpSender

    # Takes a message: a view, where it starts and ends there, and the link it came by.
    Sink = Callable[[memoryview, int, int, SubscriberLink | UdpReceiver], None]
    Handler = Callable[[memoryview, int, int, ServiceServerLink], bytes | None]

# Seconds before a publisher that did not answer is asked again; doubled at each failure up to the second.
RETRY_FIRST = 0.1
RETRY_LAST = 3.0
ASKED_AGAIN = -1.0
# Publishers of one topic that we connect to. /tf or /diagnostics of a large robot has a few dozen.
MAX_PUBLISHERS = 1000


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
        self.lock: Any = None  # the shell's: guards `links` and their queues where there are threads
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

    def check(self, fields: "dict[str, str]") -> None:
        """Raises ProtocolError md5sum-mismatch or type-mismatch where a subscriber with this header may not have the
        topic; the text is for both sides to read."""
        md5sum = fields.get("md5sum", "*")
        caller = shorten(fields.get("callerid", "(unnamed)"))
        wanted = shorten(fields.get("type", "*"))
        if md5sum not in ("*", self.md5sum):
            raise ProtocolError(
                "md5sum-mismatch",
                "topic %s: the subscriber %s expects %s with md5sum %s, this publisher has %s with md5sum %s"
                % (self.topic, caller, wanted, shorten(md5sum), self.type, self.md5sum),
            )
        if wanted not in ("*", self.type):
            raise ProtocolError(
                "type-mismatch",
                "topic %s: the subscriber %s expects type %s, this publisher has %s"
                % (self.topic, caller, wanted, self.type),
            )

    def opened(self, link: "PublisherLink | UdpSender") -> None:
        """The link can carry messages from now on. Called with `lock` held, where there is one."""
        if isinstance(link, PublisherLink):
            self.links = self.links + (link,)  # noqa: RUF005 - MicroPython has no (*a, b)
        else:
            self.senders = self.senders + (link,)  # noqa: RUF005
        if self.on_link is not None:
            self.on_link(link, True)

    def link_lost(self, link: "PublisherLink", now: float) -> None:
        if link in self.links:
            self.links = tuple([other for other in self.links if other is not link])
            # Another thread may be about to send from the queue, so it is counted and left alone.
            given_up = len(link.queue)
            if given_up:
                self.engine.count("queued-for-lost-subscriber", given_up)
            self.dropped += link.queue.dropped + given_up
            if self.on_link is not None:
                self.on_link(link, False)

    def sender_lost(self, sender: "UdpSender") -> None:
        """A UDPROS subscriber is gone."""
        if sender in self.senders:
            self.senders = tuple([other for other in self.senders if other is not sender])
            if self.on_link is not None:
                self.on_link(sender, False)

    def close(self) -> None:
        """Close every link once what it has queued is out."""
        for link in self.links:
            link.closing = True
            self.engine.touch(link)
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
        sink: "Sink",
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
        self.on_link: Callable[[SubscriberLink | UdpReceiver, bool], None] | None = None
        self._recheck: float | None = None  # when links that the master no longer names are dropped
        self._retry: dict[str, tuple[float, float]] = {}  # uri -> (when, the pause after that)
        self._asking: dict[str, UdpReceiver | None] = {}  # uri -> what awaits datagrams, if we offered that
        self.closed = False

    def header(self, name: str) -> "dict[str, str]":
        return {
            "callerid": name,
            "md5sum": self.md5sum,
            "message_definition": self.definition,
            "tcp_nodelay": "1",
            "topic": self.topic,
            "type": self.type,
        }

    def update(self, uris: "list[str]", now: float) -> None:
        """The whole list of publishers, as the master says it: connects to new ones, drops links to those that are gone.

        A master that has been restarted names only those that have registered again by then; until
        `engine.grace_until` links to others are kept, and looked at again at that time.
        """
        if self.closed:
            return
        known = self._usable(uris)
        self.publishers = tuple(known)
        if now < self.engine.grace_until:
            self._recheck = self.engine.grace_until
        else:
            self._drop_unnamed()
        for uri in list(self._retry):
            if uri not in known:
                del self._retry[uri]
        for uri in known:
            if uri not in self.links and uri not in self._asking:
                self._ask(uri, now)

    def seek_nobody(self) -> None:
        """Keep the links that there are, and ask no publisher for another."""
        self.publishers = ()
        self._recheck = None
        self._retry.clear()

    def _usable(self, uris: "list[str]") -> "dict[str, int]":
        known: dict[str, int] = {}
        for uri in uris:
            if uri == self.engine.uri and not self.background:
                continue  # within a node messages need no connection
            try:
                parse_host_port(uri)
            except InvalidName:
                self.engine.count("bad-publisher-uri")
                continue
            if len(known) >= MAX_PUBLISHERS:
                self.engine.count("too-many-publishers")
                break
            known[uri] = 1
        return known

    def _drop_unnamed(self) -> None:
        self._recheck = None
        for uri in list(self.links):
            if uri not in self.publishers:
                link = self.links.pop(uri)
                self._end(link)
                self._changed(link, False)

    def _end(self, link: "SubscriberLink | UdpReceiver") -> None:
        if isinstance(link, SubscriberLink):
            link.closing = True
            self.engine.touch(link)
        else:
            link.close()

    def _ask(self, uri: str, now: float) -> None:
        """requestTopic at the publisher's slave API."""
        protocols: list[object] = [["TCPROS"]]
        receiver = None
        if self.transport == "udp":
            # Datagrams are preferred, not demanded: rospy speaks TCPROS only.
            receiver = self.engine.udp_receiver(self, uri)
            if receiver is not None:
                protocols.insert(0, receiver.request())
        self._asking[uri] = receiver

        def answered(value: object, error: "Exception | None", when: float) -> None:
            awaited = self._asking.pop(uri, None)
            if self.closed or uri not in self.publishers:
                refusal = "no longer wanted"
            elif error is not None:
                refusal = str(error)
                self._later(uri, refusal, when)
            else:
                refusal = self._answered(uri, value, awaited, when)
            if awaited is not None and (refusal or self.links.get(uri) is not awaited):
                awaited.close()

        self.engine.call_slave(uri, "requestTopic", [self.engine.name, self.topic, protocols], answered, now)

    def _answered(self, uri: str, value: object, awaited: "UdpReceiver | None", now: float) -> str:
        """Connect as the publisher said; the reason where that cannot be."""
        try:
            self._connect(uri, value, awaited, now)
        except ProtocolError as refused:
            self.engine.count(refused.reason)
            self.engine.note_once(
                refused.reason + self.topic + uri, "%s: the publisher at %s: %s" % (self.topic, uri, refused)
            )
        except InvalidName as refused:
            self.engine.count("bad-publisher-uri")
            self._later(uri, str(refused), now)
            return str(refused)
        else:
            return ""
        self._later(uri, "refused", now, told=True)
        return "refused"

    def _connect(self, uri: str, value: object, awaited: "UdpReceiver | None", now: float) -> None:
        if not isinstance(value, list) or not value:
            raise ProtocolError("no-common-transport", "%s offers no %s" % (uri, self.transport))
        if value[0] == "TCPROS" and len(value) >= 3 and isinstance(value[1], str) and type(value[2]) is int:
            host, port = parse_host_port("rosrpc://%s:%d" % (value[1], value[2]))
            machine = SubscriberLink(self.engine, self, uri, (host, port), now)
            self.engine.open(machine)
            link: SubscriberLink | UdpReceiver = machine
        elif value[0] == "UDPROS" and awaited is not None:
            awaited.accepted(value)
            link = awaited
        else:
            raise ProtocolError("no-common-transport", "%s answers %s" % (uri, shorten(repr(value[:1]))))
        self.links[uri] = link
        if link.state == OPEN:
            self.link_opened(link, now)

    def _later(self, uri: str, reason: str, now: float, told: bool = False) -> None:
        pause = self._retry.get(uri, (0.0, RETRY_FIRST))[1]
        self._retry[uri] = (now + pause, min(2 * pause, RETRY_LAST))
        if pause == 4 * RETRY_FIRST and not told:
            # A publisher that has just closed is told by the master in a moment; a third failure is worth a line.
            self.engine.note("%s: no connection to %s: %s" % (self.topic, uri, reason))

    def deadline(self) -> "float | None":
        soonest = self._recheck
        for when, _ in self._retry.values() if self._retry else ():
            if when != ASKED_AGAIN and (soonest is None or when < soonest):
                soonest = when
        return soonest

    def handle_deadline(self, now: float) -> None:
        if self._recheck is not None and now >= self._recheck:
            self._drop_unnamed()
        for uri, (when, pause) in list(self._retry.items()):
            if when != ASKED_AGAIN and when <= now and uri not in self.links and uri not in self._asking:
                # The entry stays, so that the pause goes on growing until a link opens.
                self._retry[uri] = (ASKED_AGAIN, pause)
                self._ask(uri, now)

    def link_opened(self, link: "SubscriberLink | UdpReceiver", now: float) -> None:
        self._changed(link, True)

    def link_lost(self, link: SubscriberLink, now: float) -> None:
        if self.links.get(link.uri) is not link:
            return
        del self.links[link.uri]
        if link.peer_header and not link.refused:
            self.engine.count("publisher-lost")
        self._changed(link, False)
        if not self.closed and link.uri in self.publishers:
            if not link.refused and (link.messages or now - link.opened_at >= RETRY_LAST):
                self._retry.pop(link.uri, None)  # it has worked: begin with short pauses again
            self._later(link.uri, link.reason, now, link.refused)

    def _changed(self, link: "SubscriberLink | UdpReceiver", opened: bool) -> None:
        if self.on_link is not None:
            self.on_link(link, opened)

    def close(self) -> None:
        """Close every link. Nothing goes to the sink from now on, not even what has been received already."""
        self.closed = True
        self.sink = _ignore
        for link in self.links.values():
            self._end(link)
        self.links = {}


def _ignore(view: memoryview, start: int, end: int, link: object) -> None:
    return


class ServiceOffer:
    """A service of this node. `handler(view, start, end, link)` returns the reply's bytes, None where
    `link.answer` comes later, or raises ServiceFailed."""

    kind = "Service"

    def __init__(
        self,
        engine: "Engine",
        name: str,
        type_name: str,
        md5sum: str,
        types: "tuple[str, str]",
        handler: "Handler",
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
