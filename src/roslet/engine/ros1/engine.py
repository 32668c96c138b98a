"""The ROS 1 node as one machine: its graph entries, its master, its slave API, its connections.

The shell asks `take_connections()` for machines that want a socket, `take_touched()` for those that have something to
send or want to close, feeds what arrives into the machines, calls `pump(now)` after each input, and
`handle_deadline(now)` at `deadline()`. Nothing here knows a socket or a clock. Runs on MicroPython.
"""

from roslet.engine.ros1.framing import CHUNK
from roslet.engine.ros1.graph import Publication, ServiceOffer, Subscription
from roslet.engine.ros1.links import (
    ROOM,
    FrameLink,
    IncomingLink,
    Machine,
    PublisherLink,
    ServiceClientLink,
    ServiceServerLink,
    check_caller,
    shorten,
)
from roslet.engine.ros1.registration import Registrations
from roslet.engine.ros1.rpc import ReplyReceived, RpcClient, RpcServer, answer_calls, unpack_reply
from roslet.engine.ros1.slave import Slave
from roslet.engine.ros1.udp import UdpReceiver
from roslet.errors import Fault, InvalidName, ProtocolError, RosletError, Unreachable
from roslet.names import parse_host_port
from roslet.wire.http import MAX_BODY
from roslet.wire.tcpros import MAX_FRAME, emit_header, require

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Protocol

    from roslet.engine.ros1.graph import Handler, Sink

    Answered = Callable[[object, "Exception | None", float], None]

    class DatagramPort(Protocol):
        """What receives the datagrams of one UDPROS subscription, and sends those of publications."""

        def open(self, receiver: UdpReceiver) -> int:
            """The port on which `receiver` gets datagrams from now on; 0 where none can be had."""

        def close(self, receiver: UdpReceiver) -> None:
            """Stop that. Closing what is not open is allowed."""


# Different reasons that are counted; there are some sixty (see `reasons`).
MAX_REASONS = 200
# Different remarks about peers that are made once each. Beyond it there are none: peers must not fill a log.
MAX_REMARKS = 500
# Seconds for one call of the master or of another node's slave API.
CALL_TIMEOUT = 10.0
# Calls of other nodes' slave APIs at a time, each on a connection of its own. More wait: a list of publishers may be long.
MAX_SLAVE_CALLS = 32


class Engine:
    """One ROS 1 node.

    name        full name of the node
    master_uri  http://host:port
    host        what other machines reach us by
    pid         process id, for getPid
    """

    def __init__(self, name: str, master_uri: str, host: str, pid: int = 0) -> None:
        self.name = name
        self.master_uri = master_uri
        self.host = host
        self.pid = pid
        self.uri = ""
        self.service_uri = ""
        self.tcpros_port = 0
        self.publications: dict[str, Publication] = {}
        self.subscriptions: dict[str, list[Subscription]] = {}
        # The same as lists, which are looked through at each turn; views of dicts would be garbage on MicroPython.
        self._talking: list[Publication] = []
        self._listening: list[Subscription] = []
        self.services: dict[str, ServiceOffer] = {}
        self.registrations = Registrations(self)
        self.slave = Slave(self)
        self.counters: dict[str, int] = {}
        self.parameters: dict[str, object] = {}  # subscribed ones, as the master last told
        self.shutdown_reason: str | None = None
        self.grace_until = 0.0  # until then a publisher that the master does not name may only be late
        self.udp: DatagramPort | None = None  # the shell's
        self.on_note: Callable[[str], None] | None = None
        self.on_parameter: Callable[[str, object], None] | None = None
        self.on_shutdown: Callable[[str], None] | None = None
        self.on_master: Callable[[], None] | None = None  # the master is there (again)
        # What a connection may take, in bytes: at once, for messages that come together; at once, for headers; of a call.
        self.chunk = CHUNK
        self.room = ROOM
        self.max_body = MAX_BODY
        self.lends = False  # whether views that sinks and handlers get are good until they return
        self._ids = 0
        self._new: list[Machine | RpcClient] = []
        self._touched: list[Machine | RpcClient] = []
        host_name, port = parse_host_port(master_uri)
        self._master = RpcClient(host_name, port, timeout=CALL_TIMEOUT)
        self._master_calls: dict[int, Answered] = {}
        self._slave_calls: list[tuple[RpcClient, Answered]] = []
        self._slave_waiting: list[tuple[RpcClient, str, list[object], Answered]] = []
        self._watched: list[str] = []
        self._remarks: dict[str, int] = {}

    def listening(self, rpc_port: int, tcpros_port: int) -> None:
        """Where the shell accepts: the slave API's and the TCPROS port."""
        self.uri = "http://%s:%d/" % (self.host, rpc_port)
        self.service_uri = "rosrpc://%s:%d" % (self.host, tcpros_port)
        self.tcpros_port = tcpros_port

    # -- towards the shell

    def next_connection_id(self) -> int:
        self._ids += 1
        return self._ids

    def open(self, machine: "Machine | RpcClient") -> None:
        """The machine wants a socket."""
        self._new.append(machine)

    def touch(self, machine: "Machine | RpcClient") -> None:
        """The machine has something to send, or wants to close."""
        self._touched.append(machine)

    def take_connections(self) -> "list[Machine | RpcClient] | tuple[()]":
        if not self._new and not self._master.wants_connection:
            return ()
        machines, self._new = self._new, []
        if self._master.wants_connection and self._master not in machines:
            machines.append(self._master)
        return machines

    def take_touched(self) -> "list[Machine | RpcClient] | tuple[()]":
        if not self._touched:
            return ()
        machines, self._touched = self._touched, []
        return machines

    def accept_rpc(self, now: float) -> RpcServer:
        return RpcServer(now, self.max_body)

    def accept_tcpros(self, now: float) -> IncomingLink:
        return IncomingLink(self, now)

    def count(self, reason: str, number: int = 1) -> None:
        """Count a drop or a refusal under its name; `reasons` says what each name means."""
        if reason in self.counters or len(self.counters) < MAX_REASONS:
            self.counters[reason] = self.counters.get(reason, 0) + number

    def note(self, text: str) -> None:
        """Something that a person should read."""
        if self.on_note is not None:
            self.on_note(text)

    def note_once(self, about: str, text: str) -> None:
        """The same about something that a peer may repeat as often as it likes."""
        if about not in self._remarks and len(self._remarks) < MAX_REMARKS:
            self._remarks[about] = 1
            self.note(text)

    def deadline(self) -> "float | None":
        soonest = self.registrations.deadline()
        for subscription in self._listening:
            when = subscription.deadline()
            if when is not None and (soonest is None or when < soonest):
                soonest = when
        for publication in self._talking:
            for sender in publication.senders:
                when = sender.deadline()
                if when is not None and (soonest is None or when < soonest):
                    soonest = when
        return soonest

    def handle_deadline(self, now: float) -> None:
        self.registrations.handle_deadline(now)
        for entries in list(self.subscriptions.values()):
            for subscription in entries:
                subscription.handle_deadline(now)
        for publication in list(self.publications.values()):
            for sender in publication.senders:
                sender.handle_deadline(now)

    # -- calls out

    def call_master(
        self, method: str, arguments: "list[object] | list[str]", done: "Answered", now: float
    ) -> None:
        """Call the master; `done(value, error, now)` is called once, with the third item of its reply.

        Raises InvalidMessage where an argument cannot be sent.
        """
        try:
            call_id = self._master.call(method, list(arguments), now)
        except Unreachable as error:  # too many calls wait already
            done(None, error, now)
            return
        self._master_calls[call_id] = done
        self.touch(self._master)

    def call_slave(
        self, uri: str, method: str, arguments: "list[object]", done: "Answered", now: float
    ) -> None:
        """Call another node's slave API, on a connection of its own. At most MAX_SLAVE_CALLS are under way."""
        try:
            host, port = parse_host_port(uri)
        except InvalidName as error:
            done(None, error, now)
            return
        path = "/" + uri.partition("://")[2].partition("/")[2]
        client = RpcClient(host, port, path, timeout=CALL_TIMEOUT, max_body=self.max_body)
        if len(self._slave_calls) < MAX_SLAVE_CALLS:
            self._begin_call(client, method, arguments, done, now)
        else:
            self._slave_waiting.append((client, method, arguments, done))

    def _begin_call(
        self, client: RpcClient, method: str, arguments: "list[object]", done: "Answered", now: float
    ) -> None:
        client.call(method, arguments, now)
        self._slave_calls.append((client, done))
        self.open(client)

    def pump(self, now: float) -> None:
        """Act on the answers that have come. Call it after any input."""
        client = self._master
        while True:
            event = client.next_event()
            if event is None:
                break
            done = self._master_calls.pop(event.call_id, None)
            if done is not None:
                _hand(event, done, now)
        if self._slave_calls:
            for entry in list(self._slave_calls):
                client, done = entry
                event = client.next_event()
                if event is not None:
                    self._slave_calls.remove(entry)
                    client.close(now)
                    self.touch(client)
                    if self._slave_waiting:
                        waiting, method, arguments, wants = self._slave_waiting.pop(0)
                        self._begin_call(waiting, method, arguments, wants, now)
                    _hand(event, done, now)
                elif client.wants_connection:
                    self.open(client)

    def rpc_pump(self, server: RpcServer, now: float, host: str) -> None:
        """Answer the calls that have come in on one connection, from the address `host`."""
        self.slave.now = now
        self.slave.peer = host
        answer_calls(server, self.slave.methods, now)
        for reason in server.take_refused():
            self.count(reason)

    # -- the node's graph entries

    def advertise(
        self, topic: str, type_name: str, md5sum: str, definition: str, latching: bool, depth: int, now: float
    ) -> Publication:
        """Raises RosletError where this node publishes the topic already."""
        if topic in self.publications:
            raise RosletError("%s already publishes %s" % (self.name, topic))
        publication = Publication(self, topic, type_name, md5sum, definition, latching, depth)
        self.publications[topic] = publication
        self._talking.append(publication)
        self.registrations.add(publication, now)
        return publication

    def unadvertise(self, publication: Publication, now: float) -> None:
        if self.publications.get(publication.topic) is publication:
            del self.publications[publication.topic]
            self._talking.remove(publication)
            self.registrations.remove(publication, now)
            publication.close()

    def subscribe(
        self,
        topic: str,
        type_name: str,
        md5sum: str,
        definition: str,
        sink: "Sink",
        now: float,
        max_frame: int = MAX_FRAME,
        transport: str = "tcp",
        copies: bool = False,
        background: bool = False,
    ) -> Subscription:
        """Several subscriptions of one topic have a connection each; the master hears of the topic once for each."""
        subscription = Subscription(
            self, topic, type_name, md5sum, definition, sink, max_frame, transport, copies, background
        )
        self.subscriptions.setdefault(topic, []).append(subscription)
        self._listening.append(subscription)
        self.registrations.add(subscription, now)
        return subscription

    def unsubscribe(self, subscription: Subscription, now: float) -> None:
        entries = self.subscriptions.get(subscription.topic, [])
        if subscription not in entries:
            return
        entries.remove(subscription)
        self._listening.remove(subscription)
        subscription.close()
        if entries:
            self.registrations.entries.pop(subscription, None)  # the master keeps the topic for the others
        else:
            del self.subscriptions[subscription.topic]
            self.registrations.remove(subscription, now)

    def offer_service(
        self,
        name: str,
        type_name: str,
        md5sum: str,
        types: "tuple[str, str]",
        handler: "Handler",
        now: float,
    ) -> ServiceOffer:
        if name in self.services:
            raise RosletError("%s already offers the service %s" % (self.name, name))
        offer = ServiceOffer(self, name, type_name, md5sum, types, handler)
        self.services[name] = offer
        self.registrations.add(offer, now)
        return offer

    def withdraw_service(self, offer: ServiceOffer, now: float) -> None:
        if self.services.get(offer.topic) is offer:
            del self.services[offer.topic]
            self.registrations.remove(offer, now)
            offer.close()

    def service_link(self, uri: str, header: "dict[str, str]", now: float) -> ServiceClientLink:
        """A connection to the service at `uri` (rosrpc://host:port). Raises InvalidName."""
        link = ServiceClientLink(self, header, parse_host_port(uri), now)
        self.open(link)
        return link

    def watch_parameter(self, key: str, done: "Answered", now: float) -> None:
        """subscribeParam; the value comes to `done`, later changes to `on_parameter` and `parameters`."""
        if key not in self._watched:
            self._watched.append(key)

        def answered(value: object, error: "Exception | None", when: float) -> None:
            if error is None:
                self.parameters[key] = value
            done(value, error, when)

        self.call_master("subscribeParam", [self.name, self.uri, key], answered, now)

    def unwatch_parameter(self, key: str, now: float) -> None:
        """unsubscribeParam; the value that was kept is forgotten."""
        if key in self._watched:
            self._watched.remove(key)
            self.parameters.pop(key, None)
            self.call_master("unsubscribeParam", [self.name, self.uri, key], _ignore, now)

    def master_found(self, now: float) -> None:
        """The master is there again, knowing nothing: watch again what was watched."""
        for key in self._watched:
            self.call_master("subscribeParam", [self.name, self.uri, key], self._rewatched(key), now)
        if self.on_master is not None:
            self.on_master()

    def _rewatched(self, key: str) -> "Answered":
        def answered(value: object, error: "Exception | None", when: float) -> None:
            if error is None and value != {} and value != self.parameters.get(key):
                self.parameter_changed(key, value)

        return answered

    def parameter_changed(self, key: str, value: object) -> None:
        """The parameter `key` is `value` now (`{}`: deleted), as the master tells, or this node, which the master does not
        tell of its own doing. What watches a namespace around it gets the whole namespace."""
        key = key[:-1] if len(key) > 1 and key.endswith("/") else key
        concerned = [watched for watched in self._watched if _is_within(key, watched)]
        if not concerned:
            self.count("parameter-not-subscribed")
        for watched in concerned:
            rest = [part for part in key[len(watched) :].split("/") if part]
            old = self.parameters.get(watched)
            whole = _replaced(old, rest, value)
            self.parameters[watched] = whole
            # Some masters tell the node that made a change as well: it knows already.
            if whole != old and self.on_parameter is not None:
                self.on_parameter(watched, whole)

    def watches(self, key: str) -> bool:
        """Whether a change of the parameter `key` is of interest here."""
        return any(_is_within(key, watched) for watched in self._watched)

    # -- connections in

    def greet(self, fields: "dict[str, str]", outgoing: "list[bytes]", now: float) -> "FrameLink | None":
        """What an incoming connection becomes; our header goes to `outgoing`. Raises ProtocolError to refuse it."""
        require(fields, ("callerid", "md5sum"))
        check_caller(fields["callerid"])
        if "service" in fields:
            return self._greet_client(fields, outgoing)
        require(fields, ("topic",))
        publication = self.publications.get(fields["topic"])
        if publication is None:
            raise ProtocolError(
                "unknown-topic", "%s does not publish %s" % (self.name, shorten(fields["topic"]))
            )
        try:
            publication.check(fields)
        except ProtocolError as refusal:
            self.note_once(publication.topic + fields["callerid"], refusal.message)
            raise
        outgoing.append(emit_header(publication.header()))
        return PublisherLink(self, publication, fields, publication.depth)

    def _greet_client(self, fields: "dict[str, str]", outgoing: "list[bytes]") -> "FrameLink | None":
        offer = self.services.get(fields["service"])
        if offer is None:
            raise ProtocolError(
                "unknown-service", "%s does not offer %s" % (self.name, shorten(fields["service"]))
            )
        if fields["md5sum"] not in ("*", offer.md5sum):
            text = "service %s has md5sum %s, the client expects %s" % (
                offer.topic,
                offer.md5sum,
                shorten(fields["md5sum"]),
            )
            raise ProtocolError("md5sum-mismatch", text)
        outgoing.append(emit_header(offer.header()))
        if fields.get("probe") == "1":
            return None
        link = ServiceServerLink(self, offer, fields)
        offer.links.append(link)
        return link

    # -- UDPROS

    def udp_receiver(self, subscription: Subscription, uri: str) -> "UdpReceiver | None":
        """What could receive datagrams from the publisher at `uri`; None where the shell has no port for it."""
        if self.udp is None:
            return None
        receiver = UdpReceiver(self, subscription, uri)
        receiver.port = self.udp.open(receiver)
        if not receiver.port:
            self.count("udp-no-port")
            return None
        return receiver

    # -- the end

    def begin_close(self, now: float) -> "list[tuple[str, list[object]]]":
        """Seek no publisher any more, and begin no call that waits; what to tell the master, in this order: nothing to one
        that is lost."""
        calls: list[tuple[str, list[object]]] = []
        if not self.registrations.master_lost:
            for entry in self.registrations.entries:
                calls.append(self.registrations.withdrawal(entry))
            for key in self._watched:
                calls.append(("unsubscribeParam", [self.name, self.uri, key]))
        self.registrations.forget()
        for entries in self.subscriptions.values():
            for subscription in entries:
                subscription.seek_nobody()
        self._fail_waiting(now)
        return calls

    def close(self, now: float) -> None:
        """Fail what is under way. The shell has closed the connections."""
        self.registrations.forget()
        self._master.close(now)
        self._fail_waiting(now)
        for client, _ in self._slave_calls:
            client.close(now)
        self.pump(now)

    def _fail_waiting(self, now: float) -> None:
        waiting, self._slave_waiting = self._slave_waiting, []
        for _, _, _, done in waiting:
            done(None, Unreachable("the node was closed"), now)

    def shutdown_requested(self, reason: str) -> None:
        """The master, or a tool, asks this node to end."""
        if self.shutdown_reason is None:
            self.shutdown_reason = reason or "asked to shut down"
            if self.on_shutdown is not None:
                self.on_shutdown(self.shutdown_reason)


def _is_within(key: str, watched: str) -> bool:
    return key == watched or watched == "/" or key.startswith(watched + "/")


def _replaced(tree: object, path: "list[str]", value: object) -> object:
    """A copy of `tree`, a dict of dicts, in which the value at `path` is another; `{}` deletes it."""
    if not path:
        return value
    copy = dict(tree) if isinstance(tree, dict) else {}
    inner = _replaced(copy.get(path[0]), path[1:], value)
    if inner == {}:
        copy.pop(path[0], None)
    else:
        copy[path[0]] = inner
    return copy


def _hand(event: object, done: "Answered", now: float) -> None:
    """Unpack a ROS reply `[code, text, value]` and hand on its value or its error."""
    if not isinstance(event, ReplyReceived):
        done(None, getattr(event, "error", RosletError("call failed")), now)
        return
    try:
        value = unpack_reply(event.value)
    except (Fault, ProtocolError) as error:
        done(None, error, now)
        return
    done(value, None, now)


def _ignore(value: object, error: "Exception | None", now: float) -> None:
    return
