"""TCPROS connections as machines: a subscription's, a publication's, a service's two ends, and the one that has just come in
and has not said yet what it wants.

Every machine here has the same face towards the shell (see `Machine`). Source: ROS 1 TCPROS. Runs on MicroPython.
"""

from struct import pack, unpack_from

from roslet.engine.ros1.framing import FrameReceiver, Paused
from roslet.engine.ros1.queue import SendQueue
from roslet.errors import HandshakeRefused, ProtocolError, RosletError, ServiceFailed
from roslet.names import MAX_NAME
from roslet.wire.tcpros import MAX_FRAME, MAX_HEADER, emit_header, parse_header, require

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any, Protocol

    from roslet.engine.ros1.engine import Engine
    from roslet.engine.ros1.graph import Publication, ServiceOffer, Subscription

    class Channel(Protocol):
        """What a shell hangs on a machine; machines only carry it."""

        description: str


CONNECTING = 0
HANDSHAKE = 1
OPEN = 2
CLOSED = 3

# Seconds a peer has for its connection and its header; then the connection is given up.
HANDSHAKE_TIMEOUT = 10.0
# Bytes of replies to one client that wait to be sent before its next request is looked at.
MAX_REPLIES = 1 << 20
# Bytes that are read at once of a header, and of what a subscriber sends against the rules.
ROOM = 4096
# Characters of what a peer said that are told back or logged.
MAX_ECHO = 200


def shorten(text: str) -> str:
    """What a peer said, for an error message or a log line."""
    return text if len(text) <= MAX_ECHO else text[:MAX_ECHO] + "..."


def check_caller(callerid: str) -> None:
    """Raises ProtocolError bad-callerid for a name that could not be logged or told on. Nothing proves that it is the
    caller's own."""
    if len(callerid) > MAX_NAME or [char for char in callerid if char < " " or char == "\x7f"]:
        raise ProtocolError("bad-callerid", "%d characters, or control characters" % len(callerid))


class Machine:
    """What the shell drives. It connects to `address` (None: the connection was accepted), reads into `writable()` and
    says `received(count, now)`, sends what `data_to_send()` gives, closes when `closing` is true, and calls
    `handle_deadline(now)` at `deadline()`. `user` says that what arrives runs user code.
    """

    address: "tuple[str, int] | None" = None
    closing = False
    user = False
    state = CONNECTING
    reason = ""
    channel: "Channel | None" = None

    def __init__(self, engine: "Engine") -> None:
        self.engine = engine
        self._outgoing: list[bytes] = []
        self._input = bytearray()
        self._room = bytearray(engine.room)
        self._deadline: float | None = None

    def connected(self, now: float) -> None:
        """The connection to `address` stands."""

    def lost(self, reason: str, now: float) -> None:
        """The connection is gone, or was never made; `reason` is a short text."""
        self.state = CLOSED
        self.closing = True
        self.reason = self.reason or reason

    def writable(self) -> memoryview:
        return memoryview(self._room)

    def received(self, count: int, now: float) -> None:
        self.receive_data(memoryview(self._room)[:count], now)

    def receive_data(self, data: "bytes | memoryview", now: float) -> None:
        """The same for shells that hold the bytes already."""
        raise NotImplementedError

    def data_to_send(self) -> bytes:
        if not self._outgoing:
            return b""
        data = b"".join(self._outgoing)
        self._outgoing = []
        return data

    def deadline(self) -> "float | None":
        return self._deadline

    def handle_deadline(self, now: float) -> None:
        if self._deadline is not None and now >= self._deadline:
            self._deadline = None
            self.engine.count("handshake-timeout")
            self.fail("no connection header in time", now)

    def fail(self, reason: str, now: float) -> None:
        """Close for a reason of our own."""
        self.reason = self.reason or reason
        self.closing = True

    def take_over(self, outgoing: bytes, rest: bytes) -> None:
        """Begin where another machine left off: what it had yet to send, and what it had received and not used."""
        if outgoing:
            self._outgoing.insert(0, outgoing)
        self._input.extend(rest)

    def take_rest(self) -> bytes:
        """What came behind the header. Where `user` is true the shell feeds it when user code may run."""
        rest = bytes(self._input)
        self._input = bytearray()
        return rest

    @property
    def replies(self) -> bool:
        """Whether there is something to send."""
        return bool(self._outgoing)

    def _take_header(self, data: "bytes | memoryview", now: float) -> "dict[str, str] | None":
        """Gather the peer's header; None until it is whole. What follows it stays in `_input`."""
        self._input.extend(data)
        if len(self._input) < 4:
            return None
        size = unpack_from("<I", self._input, 0)[0]
        if size > MAX_HEADER:
            raise ProtocolError("header-too-large", "%d bytes; at most %d are accepted" % (size, MAX_HEADER))
        if len(self._input) < 4 + size:
            return None
        fields = parse_header(bytes(self._input[4 : 4 + size]))
        self._input = bytearray(self._input[4 + size :])
        self._deadline = None
        return fields


class FrameLink(Machine):
    """A connection that carries frames once both headers have passed."""

    def __init__(
        self, engine: "Engine", maximum: int = MAX_FRAME, prefix: int = 0, copies: bool = False
    ) -> None:
        super().__init__(engine)
        self.frames = FrameReceiver(self._deliver, maximum, prefix, engine.chunk, copies, engine.lends)
        self.messages = 0
        self.bytes = 0
        self.peer_header: dict[str, str] = {}
        self.writable = self._writable  # type: ignore[method-assign]

    def _writable(self) -> memoryview:
        return self.frames.writable() if self.state == OPEN else memoryview(self._room)

    def received(self, count: int, now: float) -> None:
        if self.state == OPEN:
            try:
                self.frames.received(count)
            except Paused:
                return
            except ProtocolError as error:
                self.fault(error, now)
        else:
            self.receive_data(memoryview(self._room)[:count], now)

    def receive_data(self, data: "bytes | memoryview", now: float) -> None:
        try:
            if self.state == OPEN:
                self.frames.feed(data)
                return
            fields = self._take_header(data, now)
            if fields is None:
                return
            self.peer_header = fields
            self.header_received(fields, now)
            if self.state == OPEN:
                # From here on the shell receives into the frame buffer itself, so bind past the state check.
                self.writable = self.frames.writable  # type: ignore[method-assign]
                if not self.user:
                    self.frames.feed(self.take_rest())
        except Paused:
            return
        except ProtocolError as error:
            self.fault(error, now)

    def header_received(self, fields: "dict[str, str]", now: float) -> None:
        raise NotImplementedError

    def fault(self, error: ProtocolError, now: float) -> None:
        """The peer broke the protocol."""
        self.engine.count(error.reason)
        self.fail(str(error), now)

    def _deliver(self, view: memoryview, start: int, end: int) -> None:
        raise NotImplementedError

    def lost(self, reason: str, now: float) -> None:
        if self.state == OPEN and self.frames.pending and not self.closing:
            reason += " within a frame (%d bytes of it had come)" % self.frames.pending
            self.engine.count("frame-truncated")
        super().lost(reason, now)


class SubscriberLink(FrameLink):
    """Our subscription's connection to one publisher. Each frame goes to the subscription's sink at once."""

    user = False
    replies = False  # after the handshake a subscriber sends nothing
    transport = "TCPROS"

    def __init__(
        self, engine: "Engine", subscription: "Subscription", uri: str, address: "tuple[str, int]", now: float
    ) -> None:
        super().__init__(engine, subscription.max_frame, copies=subscription.copies)
        self.subscription = subscription
        self.uri = uri
        self.address = address
        self.connection_id = engine.next_connection_id()
        self.opened_at = now
        self.refused = False  # whether we, or the publisher, found something wrong with the other
        self._deadline = now + HANDSHAKE_TIMEOUT

    def connected(self, now: float) -> None:
        self.state = HANDSHAKE
        self._outgoing.append(emit_header(self.subscription.header(self.engine.name)))

    def header_received(self, fields: "dict[str, str]", now: float) -> None:
        if "error" in fields:
            raise ProtocolError("refused-by-peer", fields["error"])
        require(fields, ("md5sum", "type"))
        ours = self.subscription
        if ours.md5sum != "*" and fields["md5sum"] not in ("*", ours.md5sum):
            raise ProtocolError(
                "md5sum-mismatch",
                "%s: the publisher sends %s with md5sum %s, we expect %s with %s"
                % (ours.topic, shorten(fields["type"]), shorten(fields["md5sum"]), ours.type, ours.md5sum),
            )
        self.state = OPEN
        self.opened_at = now
        self.user = not ours.background
        ours.link_opened(self, now)

    def _deliver(self, view: memoryview, start: int, end: int) -> None:
        self.messages += 1
        self.bytes += end - start
        self.subscription.sink(view, start, end, self)

    def fault(self, error: ProtocolError, now: float) -> None:
        self.refused = True
        text = "%s: the publisher at %s: %s" % (self.subscription.topic, self.uri, shorten(error.message))
        self.engine.note_once(error.reason + self.subscription.topic + self.uri, text)
        super().fault(error, now)

    def lost(self, reason: str, now: float) -> None:
        if self.state == HANDSHAKE and not self.closing:
            self.engine.count("closed-before-header")
        super().lost(reason, now)
        self.subscription.link_lost(self, now)


class PublisherLink(FrameLink):
    """One subscriber of our publication. What it sends after its header is dropped: `data-from-subscriber`."""

    if TYPE_CHECKING:
        channel: Any  # the shell's, through which publishing threads send

    def __init__(
        self, engine: "Engine", publication: "Publication", fields: "dict[str, str]", depth: int
    ) -> None:
        super().__init__(engine)
        self.publication = publication
        self.peer_header = fields
        self.callerid = fields.get("callerid", "")
        self.connection_id = engine.next_connection_id()
        self.queue = SendQueue(depth)
        self.state = OPEN

    def receive_data(self, data: "bytes | memoryview", now: float) -> None:
        if data:
            self.engine.count("data-from-subscriber")

    def received(self, count: int, now: float) -> None:
        self.engine.count("data-from-subscriber")

    def take_rest(self) -> bytes:
        if self._input:
            self.engine.count("data-from-subscriber")
        return super().take_rest()

    def _writable(self) -> memoryview:
        return memoryview(self._room)

    def lost(self, reason: str, now: float) -> None:
        super().lost(reason, now)
        self.publication.link_lost(self, now)


class ServiceServerLink(FrameLink):
    """One client of our service. Requests are answered in their order; `user`, because a handler is user code.

    A client that sends requests and does not take the replies is not read from once MAX_REPLIES bytes of them wait:
    then `paused` is true, and the shell calls `go_on` when they are out.
    """

    paused = False

    def __init__(self, engine: "Engine", offer: "ServiceOffer", fields: "dict[str, str]") -> None:
        super().__init__(engine)
        self.offer = offer
        self.peer_header = fields
        self.callerid = fields.get("callerid", "")
        self.persistent = fields.get("persistent", "0") in ("1", "true", "True")
        self.connection_id = engine.next_connection_id()
        self.state = OPEN
        self.user = True
        self._replies = 0  # bytes since the shell last took some

    def _deliver(self, view: memoryview, start: int, end: int) -> None:
        if self.closing:
            self.engine.count("request-after-the-last")
            return
        self.messages += 1
        self.bytes += end - start
        try:
            body = self.offer.handler(view, start, end, self)
            done = True
        except ServiceFailed as error:
            body = str(error).encode("utf-8")
            done = False
        if body is None:
            return  # whoever serves it calls `answer`
        self.answer(done, body)
        if self._replies >= MAX_REPLIES and not self.closing:
            self.paused = True
            raise Paused

    def answer(self, done: bool, body: bytes) -> None:
        """Reply to the oldest request without one: the response, or the text of a failure. The shell must be told
        (`engine.touch`) where this is not called from within the handler."""
        self._outgoing.append((b"\x01" if done else b"\x00") + pack("<I", len(body)))
        self._outgoing.append(body)
        self._replies += len(body) + 5
        if not self.persistent:
            self.closing = True

    def data_to_send(self) -> bytes:
        self._replies = 0
        return super().data_to_send()

    def go_on(self, now: float) -> None:
        """The replies are out: look at the requests that have come meanwhile."""
        self.paused = False
        try:
            self.frames.received(0)
        except Paused:
            return
        except ProtocolError as error:
            self.fault(error, now)

    def lost(self, reason: str, now: float) -> None:
        super().lost(reason, now)
        self.offer.link_lost(self)


class ServiceClientLink(FrameLink):
    """Our connection to a service. Calls are answered in their order; `done(body, error)` is called once for each."""

    def __init__(
        self, engine: "Engine", header: "dict[str, str]", address: "tuple[str, int]", now: float
    ) -> None:
        super().__init__(engine, prefix=1)
        self.header = header
        self.address = address
        self.persistent = header.get("persistent") == "1"
        self._waiting: list[Callable[[bytes | None, RosletError | None], None]] = []
        self._requests: list[bytes] = []
        self._deadline = now + HANDSHAKE_TIMEOUT

    def call(self, body: bytes, done: "Callable[[bytes | None, RosletError | None], None]") -> None:
        """Send one request. After the link has closed, `done` is called with an error at once."""
        if self.closing:
            done(None, ServiceFailed(self.reason or "the connection is closed"))
            return
        self._waiting.append(done)
        frame = pack("<I", len(body)) + body
        if self.state == OPEN:
            self._outgoing.append(frame)
        else:
            self._requests.append(frame)

    def connected(self, now: float) -> None:
        self.state = HANDSHAKE
        self._outgoing.append(emit_header(self.header))

    def header_received(self, fields: "dict[str, str]", now: float) -> None:
        if "error" in fields:
            raise ProtocolError("refused-by-peer", fields["error"])
        require(fields, ("md5sum",))
        expected = self.header["md5sum"]
        if expected != "*" and fields["md5sum"] not in ("*", expected):
            raise ProtocolError(
                "md5sum-mismatch", "the service has %s, we expect %s" % (shorten(fields["md5sum"]), expected)
            )
        self.state = OPEN
        self._outgoing.extend(self._requests)
        self._requests = []

    def _deliver(self, view: memoryview, start: int, end: int) -> None:
        if not self._waiting:
            raise ProtocolError("reply-without-call")
        done = self._waiting.pop(0)
        body = bytes(view[start:end])
        if view[start - 5]:
            done(body, None)
        else:
            done(None, ServiceFailed(str(body, "utf-8", "replace")))
        if not self.persistent and not self._waiting:
            self.closing = True

    def fail(self, reason: str, now: float) -> None:
        refused = self.state != OPEN
        super().fail(reason, now)
        self._fail_all(HandshakeRefused(reason) if refused else ServiceFailed(reason))

    def lost(self, reason: str, now: float) -> None:
        super().lost(reason, now)
        self._fail_all(ServiceFailed("connection lost: " + reason))

    def _fail_all(self, error: RosletError) -> None:
        waiting, self._waiting = self._waiting, []
        for done in waiting:
            done(None, error)


class IncomingLink(Machine):
    """A connection that has come in on our TCPROS port. When its header is whole the engine says what it becomes:
    then `successor` is the machine that takes over; the shell feeds it `take_rest()`."""

    state = HANDSHAKE

    def __init__(self, engine: "Engine", now: float) -> None:
        super().__init__(engine)
        self.successor: FrameLink | None = None
        self._deadline = now + HANDSHAKE_TIMEOUT

    def receive_data(self, data: "bytes | memoryview", now: float) -> None:
        if self.closing or self.successor is not None:
            return
        try:
            fields = self._take_header(data, now)
            if fields is None:
                return
            self.successor = self.engine.greet(fields, self._outgoing, now)
            if self.successor is None:
                self.closing = True
        except ProtocolError as error:
            self.engine.count(error.reason)
            self._outgoing.append(emit_header({"error": str(error)}))
            self.fail(str(error), now)

    def lost(self, reason: str, now: float) -> None:
        if self.successor is not None:
            self.successor.lost(reason, now)
        elif not self.closing:
            self.engine.count("closed-before-header")
        super().lost(reason, now)
