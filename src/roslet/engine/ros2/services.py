"""Servers and clients of a service, in both dialects at once, chosen for each peer.

INLINE   (Fast DDS, Connext, roslet) Who asked, and under which number, is inline QoS PID_RELATED_SAMPLE_IDENTITY, and the
         same again as 0x800f for older peers. A request names the reader of the client's replies, without a number; its
         number is the sample's own. A reply names that reader and that number.
HEADER   (rmw_cyclonedds) 16 octets between encapsulation header and body, in the body's byte order: uint64 client, int64
         number, which the reply repeats. USER_DATA `clientid=` and `serviceid=` tell which reader and writer are of one.

A reply goes to the one reader that waits for it (`Writer.write(to=)`). So one writer serves both dialects: no reader ever
gets what it would misread, and other clients are not bothered. Requests go to all servers, in one sample unless servers of
both dialects are matched; then each server gets a sample of its own.

A reply may be ready before its reader is matched, for discovery goes by another way than the request: it waits, as
the other stacks let it wait.
"""

from roslet.engine.ros2 import user_data
from roslet.engine.rtps.history import HistoryFull
from roslet.errors import ProtocolError, RosletError
from roslet.names import REPLY, REQUEST, dds_service_types, dds_topic
from roslet.record import Record
from roslet.wire.primitives import packer, unpacker
from roslet.wire.rtps import inline_qos
from roslet.wire.rtps.guid import VENDORID_CYCLONE, is_reader
from roslet.wire.rtps.inline_qos import InlineQos

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from roslet.engine.ros2.context import Context
    from roslet.engine.rtps.reader import Sink, WriterProxy
    from roslet.wire.rtps.data import Data
    from roslet.wire.rtps.endpoint_data import EndpointData
    from roslet.wire.rtps.qos import Qos

    View = bytes | bytearray | memoryview

INLINE, HEADER = 0, 1
"""The dialects."""

# Replies of one server that wait for their reader to be matched, and for how many seconds. rmw_fastrtps and rmw_cyclonedds
# wait 0.1 s, but stop meanwhile.
MAX_WAITING = 64
PATIENCE = 1.0
# Octets of those replies.
MAX_WAITING_BYTES = 16 << 20
# Calls of one client that are unanswered.
MAX_CALLS = 4096

_HEADER_SIZE = 16
_PARSE = (unpacker(">Qq"), unpacker("<Qq"))
_EMIT = (packer(">Qq"), packer("<Qq"))
_UNKNOWN = -(1 << 32)  # SEQUENCENUMBER_UNKNOWN


class TooManyCalls(RosletError):
    """A client has as many unanswered calls as it may have."""


class Request(Record):
    """A request: `client` is a GUID (INLINE) or a number (HEADER), `number` what the reply repeats, `writer` the GUID of the
    writer it came from, `time` the source's in nanoseconds or None.

    `payload` begins with its encapsulation header; it may be a view of the datagram, good until the sink returns.
    """

    _fields = ("client", "number", "dialect", "writer", "payload", "time")
    __slots__ = _fields

    def __init__(
        self,
        client: "bytes | int",
        number: int,
        dialect: int,
        writer: bytes,
        payload: "View" = b"",
        time: "int | None" = None,
    ) -> None:
        self.client = client
        self.number = number
        self.dialect = dialect
        self.writer = writer
        self.payload = payload
        self.time = time

    def identity(self) -> "tuple[bytes | int, int]":
        """What tells this request from every other that is not yet answered."""
        return self.client, self.number


def _with_header(payload: "View", client: int, number: int) -> bytes:
    front = bytearray(4 + _HEADER_SIZE)
    front[:4] = payload[:4]
    _EMIT[payload[1] & 1](front, 4, client, number)
    return bytes(front) + bytes(payload[4:])


def _split(payload: "View") -> "tuple[int, int, bytes]":
    """Client, number, and the payload without them. The header is a multiple of every alignment, so the body is good."""
    if len(payload) < 4 + _HEADER_SIZE:
        raise ProtocolError("service-header-truncated", "%d bytes" % len(payload))
    client, number = _PARSE[payload[1] & 1](payload, 4)
    return client, number, bytes(payload[:4]) + bytes(payload[4 + _HEADER_SIZE :])


def _related(value: "Data") -> "tuple[bytes, int] | None":
    """The sample identity in inline QoS. Raises ProtocolError."""
    found = inline_qos.parse(value.inline_qos, value.little)
    return found.related or found.custom_related


def _identity(guid: bytes, number: int) -> bytes:
    return InlineQos(related=(guid, number), custom_related=(guid, number)).emit()


def _unique(guid: bytes) -> str:
    """An id for `clientid=` and `serviceid=`, spelled as rmw_cyclonedds spells its own."""
    return ".".join(["%x" % octet for octet in guid])


class _Machine:
    """Reader and writer of a server or client. `hashes` are those of request and response, as text."""

    def __init__(
        self,
        context: "Context",
        node: int,
        name: str,
        type_name: str,
        qos: "Qos",
        now: float,
        hashes: "tuple[str, str]",
        sink: "Sink | None",
        serving: bool,
    ) -> None:
        request, response = dds_service_types(type_name)
        asks, answers = dds_topic(REQUEST, name), dds_topic(REPLY, name)
        self.name = name
        self.type_name = type_name
        self._context = context
        self._node = node
        self._id_key = "serviceid" if serving else "clientid"
        context.unique += 1
        serial = context.participant.guid_prefix + context.unique.to_bytes(4, "big")
        mine = user_data.pair(self._id_key, _unique(serial))
        if serving:
            self.reader = context.create_reader(node, asks, request, qos, hashes[0], now, mine, sink)
            self.writer = context.create_writer(node, answers, response, qos, hashes[1], now, mine)
        else:
            # The reader first, so that a server knows whom to answer before it is asked.
            self.reader = context.create_reader(node, answers, response, qos, hashes[1], now, mine, sink)
            self.writer = context.create_writer(node, asks, request, qos, hashes[0], now, mine)

    def _header_spoken(self, guid: bytes) -> bool:
        return self._context.vendor_of(guid) == VENDORID_CYCLONE

    def _count(self, reason: str) -> None:
        counters = self._context.counters
        counters[reason] = counters.get(reason, 0) + 1

    def close(self, now: float) -> None:
        """Withdraw reader and writer."""
        self._context.delete_reader(self._node, self.reader, now)
        self._context.delete_writer(self._node, self.writer, now)


class _Waiting:
    __slots__ = ("payload", "request", "until")

    def __init__(self, request: Request, payload: bytes, until: float) -> None:
        self.request = request
        self.payload = payload
        self.until = until


class ServiceServer(_Machine):
    """A server of service `name` (a full name) of `type_name` (`package/srv/Name`), in a node of a Context.

    Requests come to the `sink` of its reader, or as events of `reader`; each goes to `request`.
    """

    def __init__(
        self,
        context: "Context",
        node: int,
        name: str,
        type_name: str,
        qos: "Qos",
        now: float,
        hashes: "tuple[str, str]" = ("", ""),
        sink: "Sink | None" = None,
    ) -> None:
        self._waiting: list[_Waiting] = []
        self._waiting_bytes = 0
        _Machine.__init__(self, context, node, name, type_name, qos, now, hashes, sink, True)
        context.watch(self.writer.entity_id, self._matched)

    def request(self, proxy: "WriterProxy", value: "Data", time: "int | None" = None) -> "Request | None":
        """The request in a sample of our reader, or None where it is none, which is counted. Of HEADER the payload is a
        copy, otherwise a view of the sample's."""
        writer = proxy.guid
        try:
            related = _related(value)
            if related is not None:
                # A client that names no reader of its own participant is answered by its writer's name.
                own = is_reader(related[0]) and related[0][:12] == writer[:12]
                client = related[0] if own else writer
                return Request(client, value.sequence, INLINE, writer, value.payload, time)
            if self._header_spoken(writer):
                client_number, number, body = _split(value.payload)
                return Request(client_number, number, HEADER, writer, body, time)
        except ProtocolError as error:
            self._count(error.reason)
            return None
        return Request(writer, value.sequence, INLINE, writer, value.payload, time)

    def reply(self, request: Request, payload: "View", now: float) -> bool:
        """Answer a request, with the serialised response. True where it was sent, False where it waits for the client's
        reader, at most PATIENCE seconds, or is dropped, which is counted. Raises HistoryFull."""
        if self._send(request, payload, now):
            return True
        if request.writer not in self.reader.proxies:
            self._count("reply-client-gone")
            return False
        if len(self._waiting) >= MAX_WAITING or self._waiting_bytes + len(payload) > MAX_WAITING_BYTES:
            self._count("replies-waiting-full")
            return False
        self._wait(self._waiting + [_Waiting(request, bytes(payload), now + PATIENCE)])  # noqa: RUF005 - for MicroPython
        return False

    def deadline(self) -> "float | None":
        """When the oldest waiting reply is given up, or None."""
        return self._waiting[0].until if self._waiting else None

    def handle_deadline(self, now: float) -> None:
        """Give up what has waited long enough. The Context calls it."""
        left = [one for one in self._waiting if one.until > now]
        for _ in range(len(self._waiting) - len(left)):
            self._count("reply-reader-unmatched")
        self._wait(left)

    def close(self, now: float) -> None:
        """Withdraw reader and writer; what waits is dropped."""
        self._wait([])
        _Machine.close(self, now)

    def _matched(self, event: "Any", now: float) -> None:
        left = []
        for one in self._waiting:
            try:
                sent = self._send(one.request, one.payload, now)
            except HistoryFull:
                sent = False
            if not sent:
                left.append(one)
        self._wait(left)

    def _wait(self, waiting: "list[_Waiting]") -> None:
        """What waits from now on. Only who waits is looked after by the Context."""
        timed = self._context.timed
        if waiting and not self._waiting:
            timed.append(self)
        elif self._waiting and not waiting:
            timed.remove(self)
        self._waiting = waiting
        self._waiting_bytes = sum([len(one.payload) for one in waiting])

    def _send(self, request: Request, payload: "View", now: float) -> bool:
        readers = self._readers_of(request)
        if not readers:
            return False
        if isinstance(request.client, int):
            payload = _with_header(payload, request.client, request.number)
            extra = b""
        else:
            extra = _identity(request.client, request.number)
        for reader in readers:
            self.writer.write(payload, now, inline_qos=extra, to=reader)
        return True

    def _readers_of(self, request: Request) -> "list[bytes]":
        """The reader that waits for the reply; several where the client does not tell which of its participant's it is."""
        matched = self.writer.proxies
        if isinstance(request.client, bytes) and is_reader(request.client):
            return [request.client] if request.client in matched else []
        there = [one.data for one in matched.values() if one.guid[:12] == request.writer[:12]]
        proxy = self.reader.proxies.get(request.writer)
        client = user_data.value_of(proxy.data.qos.user_data, "clientid") if proxy is not None else None
        if client is not None:
            there = [one for one in there if user_data.value_of(one.qos.user_data, "clientid") == client]
        return [one.guid for one in there]


class ServiceClient(_Machine):
    """A client of service `name` (a full name) of `type_name` (`package/srv/Name`), in a node of a Context.

    Replies come to the `sink` of its reader, or as events of `reader`; each goes to `response`.
    """

    def __init__(
        self,
        context: "Context",
        node: int,
        name: str,
        type_name: str,
        qos: "Qos",
        now: float,
        hashes: "tuple[str, str]" = ("", ""),
        sink: "Sink | None" = None,
        max_calls: int = MAX_CALLS,
    ) -> None:
        self._max_calls = max_calls
        self._calls: dict[int, int] = {}  # number of a sample -> the call's, which is its first sample's
        self._open: dict[int, int] = {}  # call -> number of its samples
        _Machine.__init__(self, context, node, name, type_name, qos, now, hashes, sink, False)
        own = self.writer.data.guid
        # For HEADER: what no other client has. The prefix is chance from its fourth octet on.
        self._number = int.from_bytes(own[4:12], "big") ^ int.from_bytes(own[12:], "big")

    def ready(self) -> bool:
        """Whether there is a server both of whose endpoints are matched with ours."""
        replying = self.reader.proxies.values()
        for server in self.writer.proxies.values():
            for one in replying:
                if _of_one_server(server.data, one.data):
                    return True
        return False

    def pending(self) -> int:
        """How many calls are unanswered."""
        return len(self._open)

    def call(self, payload: "View", now: float) -> int:
        """Send the serialised request to every matched server, and return the call's number. Raises TooManyCalls,
        HistoryFull."""
        if len(self._open) >= self._max_calls:
            raise TooManyCalls("%d calls of %s are unanswered" % (len(self._open), self.name))
        writer = self.writer
        call = writer.last + 1
        header = [guid for guid in writer.proxies if self._header_spoken(guid)]
        extra = _identity(self.reader.data.guid, _UNKNOWN)
        if not header:
            numbers = [writer.write(payload, now, inline_qos=extra)]
        elif len(header) == len(writer.proxies):
            numbers = [writer.write(_with_header(payload, self._number, call), now)]
        else:
            headed = _with_header(payload, self._number, call)
            numbers = []
            for guid in list(writer.proxies):
                if guid in header:
                    numbers.append(writer.write(headed, now, to=guid))
                else:
                    numbers.append(writer.write(payload, now, inline_qos=extra, to=guid))
        for number in numbers:
            self._calls[number] = call
        self._open[call] = len(numbers)
        return call

    def response(self, proxy: "WriterProxy", value: "Data") -> "tuple[int, View] | None":
        """(call, payload) of a sample of our reader; None where it is for somebody else, for a call that was answered or
        given up, or nonsense; the latter are counted. The payload is a view of the sample's, or of HEADER a copy."""
        try:
            related = _related(value)
            if related is not None:
                guid, number = related
                if guid != self.reader.data.guid and guid != self.writer.data.guid:
                    return None
                body: View = value.payload
            elif self._header_spoken(proxy.guid):
                client, number, body = _split(value.payload)
                if client != self._number:
                    return None
            else:
                raise ProtocolError("reply-without-identity")
        except ProtocolError as error:
            self._count(error.reason)
            return None
        call = self._calls.get(number)
        if call is None:
            self._count("reply-without-call")
            return None
        self.forget(call)
        return call, body

    def forget(self, call: int) -> None:
        """Give a call up; one that is not there is no error. Its reply will be counted as reply-without-call."""
        for number in range(call, call + self._open.pop(call, 0)):
            del self._calls[number]


def _of_one_server(reader: "EndpointData", writer: "EndpointData") -> bool:
    one = user_data.value_of(reader.qos.user_data, "serviceid")
    other = user_data.value_of(writer.qos.user_data, "serviceid")
    if one is not None and other is not None:
        return one == other
    return reader.guid[:12] == writer.guid[:12]
