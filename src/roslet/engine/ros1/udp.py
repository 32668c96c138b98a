"""UDPROS: the two ends of a topic over datagrams. What is lost is lost; it is counted. Runs on MicroPython."""

from struct import unpack_from

from roslet.engine.ros1.links import CLOSED, HANDSHAKE, OPEN
from roslet.errors import Fault, ProtocolError
from roslet.wire.tcpros import emit_header, parse_header
from roslet.wire.udpros import DATA0, DATAN, emit, parse

TYPE_CHECKING = False
if TYPE_CHECKING:
    from roslet.engine.ros1.engine import Engine
    from roslet.engine.ros1.graph import Publication, Subscription
    from roslet.engine.ros1.links import Channel

# What we ask a publisher to stay within: an Ethernet frame's worth, as roscpp asks by default.
DATAGRAM = 1500
# Each costs a copy of every message, and nothing but a call is needed to become one.
MAX_SENDERS = 64
# Seconds between two looks whether a UDPROS subscriber is still there.
CHECK = 10.0
# Looks in a row that may fail before it counts as gone.
PATIENCE = 2


class UdpSender:
    """One UDPROS subscriber of our publication. A datagram tells nothing of its end, so its node is asked every CHECK
    seconds whether it still subscribes: `udp-subscriber-gone`."""

    state = OPEN
    closing = False

    def __init__(
        self,
        engine: "Engine",
        publication: "Publication",
        callerid: str,
        address: "tuple[str, int]",
        datagram_size: int,
        now: float,
    ) -> None:
        self.engine = engine
        self.publication = publication
        self.callerid = callerid
        self.address = address
        self.datagram_size = datagram_size
        self.connection_id = engine.next_connection_id()
        self.messages = 0
        self.bytes = 0
        self._message_id = 0
        self._next: float | None = now + CHECK
        self._failures = 0

    def header(self) -> bytes:
        return emit_header(self.publication.header())[4:]

    def datagrams(self, frame: memoryview) -> "list[bytes]":
        """The datagrams of one frame. Raises ProtocolError udp-message-too-large."""
        self._message_id = (self._message_id + 1) & 255
        datagrams = emit(self.connection_id, self._message_id, frame, self.datagram_size)
        self.messages += 1
        self.bytes += len(frame)
        return datagrams

    def deadline(self) -> "float | None":
        return self._next

    def handle_deadline(self, now: float) -> None:
        if self._next is None or now < self._next:
            return
        self._next = None
        engine = self.engine
        engine.call_master("lookupNode", [engine.name, self.callerid], self._found, now)

    def _found(self, value: object, error: "Exception | None", now: float) -> None:
        if isinstance(error, Fault):
            self._checked(None, error, now)
        elif error is not None or not isinstance(value, str):
            self._next = now + CHECK  # no master says nothing about the subscriber
        else:
            self.engine.call_slave(value, "getSubscriptions", [self.engine.name], self._checked, now)

    def _checked(self, value: object, error: "Exception | None", now: float) -> None:
        topic = self.publication.topic
        rows = value if isinstance(value, list) else []
        if [row for row in rows if isinstance(row, list) and row and row[0] == topic]:
            self._failures = 0
        else:
            self._failures += 1
        if self._failures >= PATIENCE:
            self.engine.count("udp-subscriber-gone")
            self.publication.sender_lost(self)
        else:
            self._next = now + CHECK


class UdpReceiver:
    """Our subscription's datagrams from one publisher, on a port of their own: connection ids are the publisher's choice,
    and two publishers choose alike.

    Blocks may come in any order within a message; a message of which a block is missing when the next begins is
    dropped: `udp-incomplete`. The first datagram decides whom we listen to.
    """

    transport = "UDPROS"
    address = None
    channel: "Channel | None" = None
    port = 0  # ours

    def __init__(self, engine: "Engine", subscription: "Subscription", uri: str) -> None:
        self.engine = engine
        self.subscription = subscription
        self.uri = uri
        self.connection_id = 0
        self.state = HANDSHAKE
        self.closing = False
        self.messages = 0
        self.bytes = 0
        self.reason = ""
        self.peer_header: dict[str, str] = {}
        self._source: tuple[str, int] | None = None
        self._message_id = -1
        self._blocks = 0
        self._held: dict[int, bytes] = {}
        self._held_bytes = 0

    def request(self) -> "list[object]":
        """The protocol entry for requestTopic."""
        engine = self.engine
        header = emit_header(self.subscription.header(engine.name))[4:]
        return ["UDPROS", header, engine.host, self.port, DATAGRAM]

    def accepted(self, answer: "list[object]") -> None:
        """The publisher's answer to requestTopic. Raises ProtocolError udp-answer, md5sum-mismatch."""
        if len(answer) != 6:
            raise ProtocolError("udp-answer", "expected 6 items, got %d" % len(answer))
        _, _, _, connection_id, _, header = answer
        if type(connection_id) is not int:
            raise ProtocolError("udp-answer", "items of a wrong type")
        if isinstance(header, (bytes, bytearray)):
            self.peer_header = parse_header(header)
            ours = self.subscription.md5sum
            md5sum = self.peer_header.get("md5sum", "*")
            if ours != "*" and md5sum not in ("*", ours):
                raise ProtocolError("md5sum-mismatch", "the publisher has %s, we expect %s" % (md5sum, ours))
        self.connection_id = connection_id
        self.state = OPEN

    def close(self) -> None:
        """Give the port back."""
        self.closing = True
        self.state = CLOSED
        self._forget()
        if self.engine.udp is not None:
            self.engine.udp.close(self)

    def receive_datagram(self, data: memoryview, source: "tuple[str, int]", now: float) -> None:
        """A datagram on our port. Never raises: what is wrong is counted and dropped."""
        count = self.engine.count
        try:
            block = parse(data)
        except ProtocolError as error:
            count(error.reason)
            return
        if self.state != OPEN or block.connection_id != self.connection_id & 0xFFFFFFFF:
            count("udp-unknown-connection")
        elif block.operation != DATA0 and block.operation != DATAN:
            count("udp-ignored-operation")
        elif self._source is not None and self._source != source:
            count("udp-foreign-source")
        else:
            self._source = source
            self._receive(block.operation, block.message_id, block.block, block.data)

    def _receive(self, operation: int, message_id: int, number: int, data: memoryview) -> None:
        count = self.engine.count
        if message_id != self._message_id:
            if self._held:
                count("udp-incomplete")
            self._forget()
            self._message_id = message_id
        if operation == DATA0:
            if number == 0:
                count("udp-no-blocks")
                return
            self._blocks = number
            index = 0
        else:
            index = number
        if index in self._held:
            count("udp-duplicate-block")
            return
        self._held_bytes += len(data)
        if self._held_bytes > self.subscription.max_frame + 4:
            self._forget()
            count("frame-too-large")
            return
        self._held[index] = bytes(data)
        if self._blocks and len(self._held) == self._blocks:
            self._complete()

    def _complete(self) -> None:
        parts = []
        for index in range(self._blocks):
            part = self._held.get(index)
            if part is None:
                self.engine.count("udp-block-beyond-count")
                self._forget()
                return
            parts.append(part)
        self._forget()
        frame = bytearray(b"".join(parts))
        if len(frame) < 4 or unpack_from("<I", frame, 0)[0] != len(frame) - 4:
            self.engine.count("udp-length-mismatch")
            return
        self.messages += 1
        self.bytes += len(frame) - 4
        self.subscription.sink(memoryview(frame), 4, len(frame), self)

    def _forget(self) -> None:
        self._held = {}
        self._held_bytes = 0
        self._blocks = 0
        self._message_id = -1
