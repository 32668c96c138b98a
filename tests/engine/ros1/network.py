"""A network in virtual time for ROS 1 engines: streams between machines, a master, and all that may go wrong.

No sockets, no clock: `Network.run(seconds)` lets time pass from one event to the next. Streams are carried in pieces
of odd sizes, after a delay; a host can crash, vanish without a word, be restarted, or stop reading.
"""

from struct import pack

from roslet.engine.ros1.engine import Engine
from roslet.engine.ros1.links import OPEN, PublisherLink
from roslet.engine.ros1.rpc import RpcClient, RpcServer, answer_calls
from roslet.wire.tcpros import emit_header

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

MASTER = "http://master:11311"


class Network:
    """Time, and who listens where. `delay` is what every piece takes; pieces are at most `piece` bytes, of changing
    size."""

    def __init__(self, delay: float = 0.001, piece: int = 1000, seed: int = 1) -> None:
        self.now = 100.0
        self.delay = delay
        self.piece = piece
        self.random = seed
        self.steps = 0
        self.listeners: dict[tuple[str, int], Callable[[], End]] = {}
        self.vanished: list[str] = []  # hosts from which and to which nothing comes through
        self.hosts: list[Host] = []
        self.ends: list[End] = []
        self._events: list[tuple[float, int, Callable[[], None]]] = []
        self._serial = 0

    def at(self, when: float, function: "Callable[[], None]") -> None:
        self._serial += 1
        self._events.append((when, self._serial, function))

    def cut(self, size: int) -> int:
        """How many bytes of `size` the next piece has."""
        self.random = (self.random * 1103515245 + 12345) & 0x7FFFFFFF
        return min(size, 1 + (self.random >> 8) % self.piece)

    def deadline(self) -> float:
        """When something happens next."""
        soonest = self.now + 1e9
        for event in self._events:
            soonest = min(soonest, event[0])
        for one in self.hosts + self.ends:
            if one.alive:
                when = one.deadline()
                if when is not None:
                    soonest = min(soonest, when)
        return soonest

    def run(self, seconds: float = 0.0, until: "Callable[[], object] | None" = None) -> bool:
        """Let `seconds` pass, or less where `until` comes true before; says whether it did."""
        end = self.now + seconds
        while not (until is not None and until()):
            when = self.deadline()
            if when > end:
                self.now = end
                return until is not None and bool(until())
            self.now = max(self.now, when)
            self._step()
        return True

    def _step(self) -> None:
        self.steps += 1
        if self.steps > 500_000:
            raise AssertionError("the network does not come to rest")
        due = sorted([event for event in self._events if event[0] <= self.now], key=lambda event: event[:2])
        self._events = [event for event in self._events if event[0] > self.now]
        for _, _, function in due:
            function()
        for one in list(self.hosts) + list(self.ends):
            if one.alive:
                when = one.deadline()
                if when is not None and when <= self.now:
                    one.handle_deadline(self.now)
        self.ends = [end for end in self.ends if end.alive or end.sending]

    def connect(self, owner: "Host | SimMaster", machine: "Any", address: "tuple[str, int]") -> "End":
        """A connection from `owner` to `address`, known as a stream once it stands."""
        near = End(self, owner, machine, owner.host)

        def answer() -> None:
            if not near.alive or owner.host in self.vanished or address[0] in self.vanished:
                return  # nothing comes back
            listener = self.listeners.get(address)
            if listener is None:
                near.lost("connection refused")
                return
            far = listener()
            near.peer, far.peer = far, near
            near.connected = far.connected = True
            machine.connected(self.now)
            near.after()

        self.at(self.now + 2 * self.delay, answer)
        return near


class End:
    """One machine's end of a stream: what a shell's stream does, without a socket."""

    def __init__(self, network: Network, owner: "Host | SimMaster", machine: "Any", host: str) -> None:
        self.network = network
        self.owner = owner
        self.machine = machine
        self.host = host
        self.peer: End | None = None
        self.alive = True
        self.connected = False
        self.reading = True  # false: the reader is stuck, and what is sent to it waits at the sender
        self.description = "simulated"
        self.sending: list[bytes] = []
        self._moving = False
        self._unread: list[bytes] = []
        self._ended = False
        machine.channel = self
        network.ends.append(self)

    def deadline(self) -> "float | None":
        return self.machine.deadline()  # type: ignore[no-any-return]

    def handle_deadline(self, now: float) -> None:
        self.machine.handle_deadline(now)
        self.after()

    @property
    def closing(self) -> bool:
        machine = self.machine
        return bool(machine.wants_close if hasattr(machine, "wants_close") else machine.closing)

    def after(self) -> None:
        """What a shell does after each input."""
        if self.alive:
            self.owner.after(self)
        self.flush()
        self.owner.update()

    def flush(self) -> None:
        if not self.alive:
            return
        if not self.connected:
            if self.closing or not getattr(self.machine, "wants_connection", True):
                self.lost("given up")
            return
        data = self.machine.data_to_send()
        if data:
            self.send(data)
        queue = getattr(self.machine, "queue", None)
        while queue is not None and len(queue) and self.peer is not None and self.peer.reading:
            ready = b"".join([bytes(part) for part in queue.peek()])
            queue.sent(len(ready))
            self.send(ready)
        if self.closing and not (queue is not None and len(queue)):
            self.close()

    def send(self, data: bytes) -> None:
        self.sending.append(data)
        self._move()

    def _move(self) -> None:
        if self._moving or not self.sending:
            return
        data = self.sending.pop(0)
        count = self.network.cut(len(data))
        if count < len(data):
            self.sending.insert(0, data[count:])
        self._moving = True

        def arrive() -> None:
            self._moving = False
            peer = self.peer
            if peer is not None and not self._silenced(peer):
                peer.arrived(data[:count])
                self._move()

        self.network.at(self.network.now + self.network.delay, arrive)

    def _silenced(self, peer: "End") -> bool:
        vanished = self.network.vanished
        return self.host in vanished or peer.host in vanished

    def arrived(self, data: bytes) -> None:
        if not self.alive:
            return
        machine = self.machine
        if not data:
            self.lost("closed by the peer")
            return
        if hasattr(machine, "writable"):
            at = 0
            while at < len(data) and self.alive:
                machine = self.machine  # another may have taken over
                room = machine.writable()
                count = min(len(room), len(data) - at)
                room[:count] = data[at : at + count]
                at += count
                machine.received(count, self.network.now)
                self.after()
        else:
            machine.receive_data(data, self.network.now)
            self.after()

    def close(self) -> None:
        """Close, and let the other end know behind all that was sent before."""
        if self.alive:
            self.alive = False
            self.send(b"")
            self._tell("closed")

    def crash(self) -> None:
        """The process is killed: what is on its way still arrives, nothing more is sent but the end."""
        if self.alive:
            self.alive = False
            self.sending = []
            self.send(b"")

    def lost(self, reason: str) -> None:
        if self.alive:
            self.alive = False
            self.sending = []
            self._tell(reason)
            self.send(b"")

    def _tell(self, reason: str) -> None:
        lost = getattr(self.machine, "lost", None) or getattr(self.machine, "connection_lost", None)
        if lost is not None:
            lost(reason, self.network.now)
        self.owner.after(self)
        self.owner.update()


class Host:
    """A machine with one node. `port` is the slave API's; TCPROS is the port after it."""

    alive = True

    def __init__(self, network: Network, name: str, host: str, port: int = 5000) -> None:
        self.network = network
        self.host = host
        self.port = port
        self.notes: list[str] = []
        self.engine = Engine(name, MASTER, host, 42)
        self.engine.on_note = self.notes.append
        self.engine.listening(port, port + 1)
        self._opening: list[Any] = []
        network.hosts.append(self)
        network.listeners[(host, port)] = self._accept_rpc
        network.listeners[(host, port + 1)] = self._accept_tcpros

    def _accept_rpc(self) -> End:
        return End(self.network, self, self.engine.accept_rpc(self.network.now), self.host)

    def _accept_tcpros(self) -> End:
        return End(self.network, self, self.engine.accept_tcpros(self.network.now), self.host)

    def after(self, end: End) -> None:
        machine = end.machine
        if machine in self._opening and (end.connected or not end.alive):
            self._opening.remove(machine)
        if not end.alive:
            return
        if isinstance(machine, RpcServer):
            self.engine.rpc_pump(machine, self.network.now, end.peer.host if end.peer is not None else "")
        successor = getattr(machine, "successor", None)
        if successor is not None:
            successor.channel = end
            end.machine = successor
            successor.take_over(machine.data_to_send(), machine.take_rest())
            end.flush()
            if isinstance(successor, PublisherLink):
                successor.publication.opened(successor)
            else:
                successor.frames.feed(successor.take_rest())
        elif getattr(machine, "user", False) and end.connected:
            rest = machine.take_rest()
            if rest:
                machine.frames.feed(rest)

    def update(self) -> None:
        if not self.alive:
            return
        engine = self.engine
        engine.pump(self.network.now)
        for machine in engine.take_connections():
            if machine not in self._opening:
                self._opening.append(machine)
                is_client = isinstance(machine, RpcClient)
                address = (machine.host, machine.port) if is_client else machine.address  # type: ignore[union-attr]
                self.network.connect(self, machine, address)  # type: ignore[arg-type]
        for machine in engine.take_touched():
            end = getattr(machine, "channel", None)
            if end is not None:
                end.flush()

    def deadline(self) -> "float | None":
        return self.engine.deadline()

    def handle_deadline(self, now: float) -> None:
        self.engine.handle_deadline(now)
        self.update()

    def crash(self) -> None:
        """The process is killed; the kernel closes its connections."""
        self.alive = False
        for address in ((self.host, self.port), (self.host, self.port + 1)):
            self.network.listeners.pop(address, None)
        for end in list(self.network.ends):
            if end.owner is self:
                end.crash()

    # -- what a node's user does

    def publisher(self, topic: str, depth: int = 10, md5sum: str = "m", kind: str = "t/T") -> "Any":
        made = self.engine.advertise(topic, kind, md5sum, "text", False, depth, self.network.now)
        self.update()
        return made

    def publish(self, publication: "Any", body: bytes) -> None:
        for link in publication.links:
            link.queue.push(pack("<I", len(body)) + body)
            self.engine.touch(link)
        self.update()

    def subscriber(self, topic: str, md5sum: str = "m", **options: "Any") -> "tuple[Any, list[bytes]]":
        got: list[bytes] = []

        def sink(view: memoryview, start: int, end: int, link: object) -> None:
            got.append(bytes(view[start:end]))

        made = self.engine.subscribe(topic, "t/T", md5sum, "text", sink, self.network.now, **options)
        self.update()
        return made, got

    def service(self, name: str, handler: "Callable[[bytes], bytes]", md5sum: str = "s") -> "Any":
        def serve(view: memoryview, start: int, end: int, link: object) -> bytes:
            return handler(bytes(view[start:end]))

        made = self.engine.offer_service(name, "t/S", md5sum, ("t/SReq", "t/SRes"), serve, self.network.now)
        self.update()
        return made

    def call(
        self, uri: str, name: str, bodies: "list[bytes]", md5sum: str = "s", persistent: bool = True
    ) -> "list[Any]":
        """Call a service once for each body; answers and errors come into the list that is returned."""
        header = {"callerid": self.engine.name, "md5sum": md5sum, "service": name}
        if persistent:
            header["persistent"] = "1"
        link = self.engine.service_link(uri, header, self.network.now)
        results: list[Any] = []
        for body in bodies:
            link.call(body, lambda answer, error: results.append(answer if error is None else error))
        self.update()
        return results

    def ask_master(self, method: str, *arguments: object) -> "list[Any]":
        results: list[Any] = []
        self.engine.call_master(
            method,
            [self.engine.name] + list(arguments),  # noqa: RUF005 - MicroPython
            lambda value, error, now: results.append(value if error is None else error),
            self.network.now,
        )
        self.update()
        return results


class SimMaster:
    """A master without the finer points: topics, services, flat parameters, names that are unique."""

    alive = True

    def __init__(self, network: Network, host: str = "master", port: int = 11311) -> None:
        self.network = network
        self.host = host
        self.port = port
        self.nodes: dict[str, str] = {}
        self.topics: dict[str, dict[str, list[str]]] = {"Publisher": {}, "Subscriber": {}}
        self.services: dict[str, str] = {}
        self.params: dict[str, Any] = {}
        self.watchers: dict[str, list[str]] = {}
        self.calls: list[str] = []
        self._clients: list[RpcClient] = []
        self.start()

    def start(self) -> None:
        """Listen, knowing nothing."""
        self.alive = True
        self.nodes, self.services, self.params, self.watchers = {}, {}, {}, {}
        self.topics = {"Publisher": {}, "Subscriber": {}}
        self.calls = []
        self.network.listeners[(self.host, self.port)] = lambda: End(
            self.network, self, RpcServer(self.network.now), self.host
        )

    def stop(self) -> None:
        self.alive = False
        self.network.listeners.pop((self.host, self.port), None)
        for end in list(self.network.ends):
            if end.owner is self:
                end.crash()

    def after(self, end: End) -> None:
        machine = end.machine
        if end.alive and isinstance(machine, RpcServer):
            answer_calls(machine, self.methods(), self.network.now)
        elif isinstance(machine, RpcClient) and machine.next_event() is not None:
            machine.close(self.network.now)

    def update(self) -> None:
        return

    def methods(self) -> "dict[str, Any]":
        return {
            "registerPublisher": (self.register_publisher, 4, 4),
            "unregisterPublisher": (self.unregister_publisher, 3, 3),
            "registerSubscriber": (self.register_subscriber, 4, 4),
            "unregisterSubscriber": (self.unregister_subscriber, 3, 3),
            "registerService": (self.register_service, 4, 4),
            "unregisterService": (self.unregister_service, 3, 3),
            "lookupNode": (self.lookup_node, 2, 2),
            "lookupService": (self.lookup_service, 2, 2),
            "setParam": (self.set_param, 3, 3),
            "getParam": (self.get_param, 2, 2),
            "subscribeParam": (self.subscribe_param, 3, 3),
            "unsubscribeParam": (self.unsubscribe_param, 3, 3),
        }

    def tell(self, uri: str, method: str, *arguments: object) -> None:
        host, _, port = uri[7:].rstrip("/").partition(":")
        client = RpcClient(host, int(port))
        client.call(method, ["/master"] + list(arguments), self.network.now)  # noqa: RUF005 - MicroPython
        self.network.connect(self, client, (host, int(port)))

    def _node(self, name: str, uri: str) -> None:
        old = self.nodes.get(name)
        if old is not None and old != uri:
            self.tell(old, "shutdown", "new node registered with same name")
            for table in self.topics.values():
                for uris in table.values():
                    if old in uris:
                        uris.remove(old)
        self.nodes[name] = uri

    def _tell_subscribers(self, topic: str) -> None:
        publishers = list(self.topics["Publisher"].get(topic, []))
        for uri in self.topics["Subscriber"].get(topic, []):
            self.tell(uri, "publisherUpdate", topic, publishers)

    def register_publisher(self, name: str, topic: str, kind: str, uri: str) -> "list[Any]":
        self.calls.append("registerPublisher " + topic)
        self._node(name, uri)
        uris = self.topics["Publisher"].setdefault(topic, [])
        if uri not in uris:
            uris.append(uri)
        self._tell_subscribers(topic)
        return [1, "", list(self.topics["Subscriber"].get(topic, []))]

    def unregister_publisher(self, name: str, topic: str, uri: str) -> "list[Any]":
        self.calls.append("unregisterPublisher " + topic)
        uris = self.topics["Publisher"].get(topic, [])
        if uri not in uris:
            return [1, "", 0]
        uris.remove(uri)
        self._tell_subscribers(topic)
        return [1, "", 1]

    def register_subscriber(self, name: str, topic: str, kind: str, uri: str) -> "list[Any]":
        self.calls.append("registerSubscriber " + topic)
        self._node(name, uri)
        uris = self.topics["Subscriber"].setdefault(topic, [])
        if uri not in uris:
            uris.append(uri)
        return [1, "", list(self.topics["Publisher"].get(topic, []))]

    def unregister_subscriber(self, name: str, topic: str, uri: str) -> "list[Any]":
        self.calls.append("unregisterSubscriber " + topic)
        uris = self.topics["Subscriber"].get(topic, [])
        if uri in uris:
            uris.remove(uri)
        return [1, "", 1]

    def register_service(self, name: str, service: str, where: str, uri: str) -> "list[Any]":
        self.calls.append("registerService " + service)
        self._node(name, uri)
        self.services[service] = where
        return [1, "", 1]

    def unregister_service(self, name: str, service: str, where: str) -> "list[Any]":
        if self.services.get(service) == where:
            del self.services[service]
        return [1, "", 1]

    def lookup_node(self, name: str, wanted: str) -> "list[Any]":
        uri = self.nodes.get(wanted)
        return [1, "", uri] if uri is not None else [-1, "unknown node", ""]

    def lookup_service(self, name: str, service: str) -> "list[Any]":
        where = self.services.get(service)
        return [1, "", where] if where is not None else [-1, "no provider", ""]

    def set_param(self, name: str, key: str, value: object) -> "list[Any]":
        self.params[key] = value
        for watched, uris in self.watchers.items():
            if key == watched or key.startswith(watched + "/"):
                for uri in uris:
                    self.tell(uri, "paramUpdate", key, value)
        return [1, "", 0]

    def get_param(self, name: str, key: str) -> "list[Any]":
        return [1, "", self.params[key]] if key in self.params else [-1, "not set", 0]

    def subscribe_param(self, name: str, uri: str, key: str) -> "list[Any]":
        self._node(name, uri)
        uris = self.watchers.setdefault(key, [])
        if uri not in uris:
            uris.append(uri)
        return [1, "", self.params.get(key, {})]

    def unsubscribe_param(self, name: str, uri: str, key: str) -> "list[Any]":
        uris = self.watchers.get(key, [])
        if uri in uris:
            uris.remove(uri)
        return [1, "", 1]

    def deadline(self) -> "float | None":
        return None

    def handle_deadline(self, now: float) -> None:
        return


class Intruder:
    """Somebody who speaks what it likes to a port."""

    host = "evil"
    alive = True

    def __init__(self, network: Network, address: "tuple[str, int]", data: bytes) -> None:
        self.heard = b""
        self.data = data
        self.closing = False
        self.end = network.connect(self, self, address)  # type: ignore[arg-type]

    def connected(self, now: float) -> None:
        return

    def data_to_send(self) -> bytes:
        data, self.data = self.data, b""
        return data

    def receive_data(self, data: bytes, now: float) -> None:
        self.heard += data

    def deadline(self) -> None:
        return None

    def after(self, end: object) -> None:
        return

    def update(self) -> None:
        return


def header_bytes(**fields: str) -> bytes:
    return emit_header(fields)


def world(piece: int = 1000, delay: float = 0.001) -> "tuple[Network, SimMaster, Host, Host]":
    network = Network(delay, piece)
    master = SimMaster(network)
    return network, master, Host(network, "/talker", "alpha"), Host(network, "/listener", "beta")


def linked(
    piece: int = 1000, **options: "Any"
) -> "tuple[Network, SimMaster, Host, Host, Any, Any, list[bytes]]":
    network, master, talker, listener = world(piece)
    publication = talker.publisher("/chatter")
    subscription, got = listener.subscriber("/chatter", **options)
    assert network.run(
        5.0,
        lambda: publication.links and [link for link in subscription.links.values() if link.state == OPEN],
    ), "the subscriber connects"
    return network, master, talker, listener, publication, subscription, got
