"""UDPROS: the two ends of a topic over datagrams. What is lost is lost; it is counted. Runs on MicroPython."""

from struct import unpack_from

from roslet.engine.ros1.links import CLOSED, OPEN
from roslet.errors import ProtocolError
from roslet.wire.tcpros import emit_header, parse_header
from roslet.wire.udpros import DATA0, DATAN, emit, parse

TYPE_CHECKING = False
if TYPE_CHECKING:
    from roslet.engine.ros1.engine import Engine, Publication, Subscription

# What we ask a publisher to stay within: an Ethernet frame's worth, as roscpp asks by default.
DATAGRAM = 1500
# A peer may not make one topic send to more subscribers than this: requestTopic names any address it likes.
MAX_SENDERS = 64


class UdpSender:
    """One UDPROS subscriber of our publication. There is no sign of its end but the master's word, so the sender goes
    when the subscriber's node is asked for and does not answer, or with the publication."""

    state = OPEN
    closing = False

    def __init__(
        self,
        engine: "Engine",
        publication: "Publication",
        fields: "dict[str, str]",
        address: "tuple[str, int]",
        datagram_size: int,
    ) -> None:
        if len(publication.senders) >= MAX_SENDERS:
            engine.count("udp: too-many-subscribers")
            publication.senders = publication.senders[1:]
        self.publication = publication
        self.callerid = fields.get("callerid", "")
        self.address = address
        self.datagram_size = datagram_size
        self.connection_id = engine.next_connection_id()
        self.messages = 0
        self.bytes = 0
        self._message_id = 0

    def header(self) -> bytes:
        return emit_header(self.publication.header())[4:]

    def datagrams(self, frame: memoryview) -> "list[bytes]":
        """The datagrams of one frame. Raises ProtocolError udp-message-too-large."""
        self._message_id = (self._message_id + 1) & 255
        datagrams = emit(self.connection_id, self._message_id, frame, self.datagram_size)
        self.messages += 1
        self.bytes += len(frame)
        return datagrams


class UdpReceiver:
    """Our subscription's datagrams from one publisher. Blocks may come in any order within a message; a message of
    which a block is missing when the next begins is dropped: `udp-incomplete`."""

    transport = "UDPROS"

    def __init__(
        self, engine: "Engine", subscription: "Subscription", uri: str, connection_id: int, host: str
    ) -> None:
        self.engine = engine
        self.subscription = subscription
        self.uri = uri
        self.host = host
        self.connection_id = connection_id
        self.state = OPEN
        self.closing = False
        self.messages = 0
        self.bytes = 0
        self.reason = ""
        self._message_id = -1
        self._blocks = 0
        self._held: dict[int, bytes] = {}
        self._held_bytes = 0

    @staticmethod
    def request(engine: "Engine", subscription: "Subscription") -> "list[object]":
        """The protocol entry for requestTopic. Raises ProtocolError where the shell has no datagram socket."""
        udp = engine.udp
        if udp is None:
            raise ProtocolError("no-udp", "this runtime has no datagram socket")
        header = emit_header(subscription.header(engine.name))[4:]
        return ["UDPROS", header, engine.host, udp.port, DATAGRAM]  # type: ignore[attr-defined]

    @staticmethod
    def accepted(
        engine: "Engine", subscription: "Subscription", uri: str, answer: "list[object]"
    ) -> "UdpReceiver":
        """From the publisher's answer to requestTopic. Raises ProtocolError."""
        if len(answer) != 6:
            raise ProtocolError("udp-answer", "expected 6 items, got %d" % len(answer))
        _, host, _, connection_id, _, header = answer
        if not isinstance(host, str) or not isinstance(connection_id, int):
            raise ProtocolError("udp-answer", "items of a wrong type")
        if isinstance(header, (bytes, bytearray)):
            fields = parse_header(header)
            md5sum = fields.get("md5sum", "*")
            if subscription.md5sum != "*" and md5sum not in ("*", subscription.md5sum):
                raise ProtocolError("md5sum-mismatch", "%s has %s" % (uri, md5sum))
        return UdpReceiver(engine, subscription, uri, connection_id, host)

    @staticmethod
    def dispatch(
        engine: "Engine",
        receivers: "dict[int, UdpReceiver]",
        data: memoryview,
        source: "tuple[str, int]",
        now: float,
    ) -> None:
        """Give one datagram to its connection. Never raises: what is wrong is counted and dropped."""
        try:
            block = parse(data)
        except ProtocolError as error:
            engine.count("udp: " + error.reason)
            return
        receiver = receivers.get(block.connection_id)
        if receiver is None:
            engine.count("udp: unknown-connection")
        elif block.operation == DATA0 or block.operation == DATAN:
            receiver._receive(block.operation, block.message_id, block.block, block.data)

    def _receive(self, operation: int, message_id: int, number: int, data: memoryview) -> None:
        count = self.engine.count
        if message_id != self._message_id:
            if self._held:
                count("udp: udp-incomplete")
            self._held = {}
            self._held_bytes = 0
            self._blocks = 0
            self._message_id = message_id
        if operation == DATA0:
            if number == 0:
                count("udp: no-blocks")
                return
            self._blocks = number
            index = 0
        else:
            index = number
        if index in self._held:
            count("udp: duplicate-block")
            return
        self._held_bytes += len(data)
        if self._held_bytes > self.subscription.max_frame:
            self._held = {}
            self._message_id = -1
            count("udp: frame-too-large")
            return
        self._held[index] = bytes(data)
        if self._blocks and len(self._held) == self._blocks:
            self._complete()

    def _complete(self) -> None:
        parts = []
        for index in range(self._blocks):
            part = self._held.get(index)
            if part is None:
                self.engine.count("udp: block-beyond-count")
                part = b""
            parts.append(part)
        self._held = {}
        self._held_bytes = 0
        self._message_id = -1
        frame = bytearray(b"".join(parts))
        if len(frame) < 4 or unpack_from("<I", frame, 0)[0] != len(frame) - 4:
            self.engine.count("udp: length-mismatch")
            return
        self.messages += 1
        self.bytes += len(frame) - 4
        self.subscription.sink(memoryview(frame), 4, len(frame), self)

    def lost(self, reason: str, now: float) -> None:
        self.state = CLOSED
        self.closing = True
