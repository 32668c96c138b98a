"""HTTP/1.0 and HTTP/1.1 messages, as far as XML-RPC between ROS nodes uses them (RFC 9112, RFC 9110).

Runs on MicroPython. The two parsers are machines without sockets: `feed` takes bytes as they come and returns
the messages that are complete. What they hold is bounded by `max_header` and `max_body`; what a peer does
wrong ends the stream, and `error` then holds a `ProtocolError` whose reason is one of

    header-too-large  body-too-large  bad-start-line  bad-header  bad-content-length  bad-chunk
    unsupported-encoding  unsupported-version  truncated

Real peers that shaped this file: xmlrpcpp (roscpp) writes `Content-length:` and says nothing about keeping
the connection; Python's http.server answers as HTTP/1.0 or 1.1 and capitalises otherwise; curl asks `Expect:
100-continue` before a large body. Lines may end with LF alone.
"""

from roslet.errors import ProtocolError

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    Buffer: TypeAlias = bytes | bytearray | memoryview

MAX_HEADER = 16384
"""Bytes of start line and header fields; ROS peers send under 300, browsers and proxies up to some 8 KiB."""

MAX_BODY = 16 * 1024 * 1024
"""Bytes of one body. The largest ROS body is a robot_description or a parameter tree, a few MiB."""

MAX_CHUNK_LINE = 256
"""Bytes of one chunk-size line with its extensions, which nobody sends."""

REASONS = {
    100: "Continue",
    200: "OK",
    400: "Bad Request",
    405: "Method Not Allowed",
    408: "Request Timeout",
    411: "Length Required",
    413: "Content Too Large",
    415: "Unsupported Media Type",
    431: "Request Header Fields Too Large",
    500: "Internal Server Error",
    501: "Not Implemented",
    503: "Service Unavailable",
    505: "HTTP Version Not Supported",
}
"""Reason phrases of the statuses that this project sends (RFC 9110 section 15)."""

STATUS_OF_REASON = {
    "header-too-large": 431,
    "body-too-large": 413,
    "unsupported-encoding": 501,
    "unsupported-version": 505,
}
"""The status that tells a client why its stream was ended; 400 for all other reasons."""

_START = 0  # waiting for the end of the header
_BODY = 1  # waiting for a body of known length
_CHUNK_SIZE = 2  # waiting for a chunk-size line
_CHUNK_DATA = 3  # waiting for a chunk and its line end
_TRAILER = 4  # waiting for the empty line after the last chunk
_UNTIL_CLOSE = 5  # the body ends with the connection
_FAILED = 6


class Request:
    """One complete request. `headers` maps lower-case names to stripped values."""

    __slots__ = ("body", "headers", "keep_alive", "method", "path")

    def __init__(self, method: str, path: str, headers: "dict[str, str]", keep_alive: bool) -> None:
        self.method = method
        self.path = path
        self.headers = headers
        self.keep_alive = keep_alive
        self.body = b""


class Response:
    """One complete response. `headers` maps lower-case names to stripped values."""

    __slots__ = ("body", "headers", "keep_alive", "reason", "status")

    def __init__(self, status: int, reason: str, headers: "dict[str, str]", keep_alive: bool) -> None:
        self.status = status
        self.reason = reason
        self.headers = headers
        self.keep_alive = keep_alive
        self.body = b""


class _Parser:
    """What requests and responses have in common: header fields, body framing, bounds.

    Work per `feed` is linear in the bytes given and held: no byte of a header is searched twice, a body byte
    moves at most three times.
    """

    def __init__(self, max_header: int = MAX_HEADER, max_body: int = MAX_BODY) -> None:
        self.max_header = max_header
        self.max_body = max_body
        self.error: ProtocolError | None = None
        self._buffer = bytearray()
        self._position = 0  # the first byte of the buffer that is not consumed
        self._scanned = 0  # how far the buffer was searched for a line end
        self._state = _START
        self._remaining = 0
        self._message: Request | Response | None = None
        self._chunks = bytearray()

    @property
    def idle(self) -> bool:
        """True between messages: nothing of a next one has come."""
        return self._state == _START and not self._buffer

    @property
    def failed(self) -> bool:
        """True after a fault, which `error` names."""
        return self._state == _FAILED

    def _start_line(self, line: str, headers: "dict[str, str]") -> "Request | Response":
        raise NotImplementedError

    def _feed(self, data: "Buffer") -> "list[Request | Response]":
        complete: list[Request | Response] = []
        if self._state == _FAILED:
            return complete
        self._buffer.extend(data)
        try:
            while self._step(complete):
                pass
        except ProtocolError as error:
            self._fail(error)
        if self._position:
            self._buffer = self._buffer[self._position :]
            self._scanned = max(0, self._scanned - self._position)
            self._position = 0
        return complete

    def _fail(self, error: ProtocolError) -> None:
        self.error = error
        self._state = _FAILED
        self._buffer = bytearray()
        self._position = 0
        self._chunks = bytearray()
        self._message = None

    def _step(self, complete: "list[Request | Response]") -> bool:
        """Make one step; False when more bytes are needed."""
        state = self._state
        if state == _START:
            return self._step_header(complete)
        if state == _BODY:
            if len(self._buffer) - self._position < self._remaining:
                return False
            self._finish(self._take(self._remaining), complete)
            return True
        if state == _CHUNK_SIZE:
            return self._step_chunk_size()
        if state == _CHUNK_DATA:
            return self._step_chunk_data()
        if state == _TRAILER:
            return self._step_trailer(complete)
        if state == _UNTIL_CLOSE and len(self._buffer) - self._position > self.max_body:
            raise ProtocolError("body-too-large", "more than %d bytes" % self.max_body)
        return False

    def _take(self, count: int) -> bytes:
        end = self._position + count
        taken = bytes(memoryview(self._buffer)[self._position : end])
        self._position = self._scanned = end
        return taken

    def _finish(self, body: bytes, complete: "list[Request | Response]") -> None:
        message = self._message
        self._message = None
        self._state = _START
        if message is not None:
            message.body = body
            complete.append(message)

    def _line(self, limit: int, reason: str) -> "bytes | None":
        """The next line without its end, or None when it is not complete."""
        end = self._buffer.find(b"\n", self._scanned)
        self._scanned = len(self._buffer)
        length = (end if end >= 0 else self._scanned) - self._position
        if length > limit:
            raise ProtocolError(reason, "line longer than %d bytes" % limit)
        return self._take(length + 1).strip() if end >= 0 else None

    def _header_end(self) -> int:
        """The length of the header with its empty line, or -1. Both CRLF and LF end a line."""
        buffer = self._buffer
        # An empty line is LF LF or LF CR LF, so two bytes of it may already have been searched.
        start = max(self._position, self._scanned - 2)
        limit = min(len(buffer), self._position + self.max_header)
        while True:
            end = buffer.find(b"\n", start, limit)
            if end < 0:
                break
            after = bytes(buffer[end + 1 : min(end + 3, limit)])
            if after[:1] == b"\n":
                return end + 2 - self._position
            if after == b"\r\n":
                return end + 3 - self._position
            start = end + 1
        self._scanned = len(buffer)
        if len(buffer) - self._position >= self.max_header:
            raise ProtocolError("header-too-large", "more than %d bytes" % self.max_header)
        return -1

    def _step_header(self, complete: "list[Request | Response]") -> bool:
        # RFC 9112 section 2.2: empty lines before a request line are ignored.
        buffer = self._buffer
        while self._position < len(buffer) and buffer[self._position] in b"\r\n":
            self._position += 1
        if self._position == len(buffer):
            return False
        end = self._header_end()
        if end < 0:
            return False
        lines = _text(self._take(end)).split("\n")
        headers: dict[str, str] = {}
        for line in lines[1:]:
            line = line.strip()
            if not line:
                continue
            name, colon, value = line.partition(":")
            if not colon or not name or name != name.strip():
                raise ProtocolError("bad-header", "no field name in %r" % line[:60])
            name = name.lower()
            value = value.strip()
            if name == "content-length" and headers.get(name, value) != value:
                raise ProtocolError("bad-content-length", "two different lengths")
            headers[name] = value
        message = self._start_line(lines[0].strip(), headers)
        self._message = message
        self._frame(message, headers, complete)
        return True

    def _frame(
        self, message: "Request | Response", headers: "dict[str, str]", complete: "list[Request | Response]"
    ) -> None:
        """Decide how the body is delimited (RFC 9112 section 6.3)."""
        encoding = headers.get("content-encoding", "identity").lower()
        if encoding != "identity":
            raise ProtocolError("unsupported-encoding", "content-encoding %r" % encoding[:40])
        transfer = headers.get("transfer-encoding", "identity").lower()
        if transfer == "chunked":
            self._chunks = bytearray()
            self._state = _CHUNK_SIZE
            return
        if transfer != "identity":
            raise ProtocolError("unsupported-encoding", "transfer-encoding %r" % transfer[:40])
        length = headers.get("content-length")
        if length is None:
            if isinstance(message, Response) and message.status not in (204, 304):
                message.keep_alive = False
                self._state = _UNTIL_CLOSE
            else:
                self._finish(b"", complete)
            return
        # Twelve digits are far beyond any bound and keep int() cheap.
        self._remaining = _decimal(length.encode(), 12)
        if self._remaining < 0:
            raise ProtocolError("bad-content-length", "%r" % length[:40])
        if self._remaining > self.max_body:
            raise ProtocolError("body-too-large", "%d bytes, at most %d" % (self._remaining, self.max_body))
        self._state = _BODY

    def _step_chunk_size(self) -> bool:
        line = self._line(MAX_CHUNK_LINE, "bad-chunk")
        if line is None:
            return False
        digits = line.split(b";")[0].strip()
        size = _hexadecimal(digits, 8)
        if size < 0:
            raise ProtocolError("bad-chunk", "size %r" % bytes(digits[:20]))
        if size + len(self._chunks) > self.max_body:
            raise ProtocolError("body-too-large", "more than %d bytes" % self.max_body)
        self._remaining = size
        self._state = _CHUNK_DATA if size else _TRAILER
        return True

    def _step_chunk_data(self) -> bool:
        size = self._remaining
        if len(self._buffer) - self._position < size + 2:
            return False
        chunk = self._take(size + 2)
        if chunk[size:] != b"\r\n":
            raise ProtocolError("bad-chunk", "no line end after %d bytes" % size)
        self._chunks.extend(memoryview(chunk)[:size])
        self._state = _CHUNK_SIZE
        return True

    def _step_trailer(self, complete: "list[Request | Response]") -> bool:
        line = self._line(self.max_header, "header-too-large")
        if line is None:
            return False
        if not line:
            body = bytes(self._chunks)
            self._chunks = bytearray()
            self._finish(body, complete)
            return True
        # Trailer fields carry nothing we need; their number is bounded as one header is.
        self._remaining += len(line) + 2
        if self._remaining > self.max_header:
            raise ProtocolError("header-too-large", "trailer of more than %d bytes" % self.max_header)
        return True


class RequestParser(_Parser):
    """Bytes of one client connection to requests, in order."""

    def __init__(self, max_header: int = MAX_HEADER, max_body: int = MAX_BODY) -> None:
        super().__init__(max_header, max_body)
        self._expected = False

    def feed(self, data: "Buffer") -> "list[Request]":
        """Take bytes from the client and return the requests they complete, oldest first.

        Never raises for what the client sent: after a fault `error` is set, and what comes later is dropped.
        """
        return self._feed(data)  # type: ignore[return-value]

    def take_continue(self) -> bool:
        """True once, when the client waits for `100 Continue` before it sends the body."""
        expected = self._expected and self._state != _START
        self._expected = False
        return expected

    def _start_line(self, line: str, headers: "dict[str, str]") -> Request:
        words = line.split()
        if len(words) != 3:
            raise ProtocolError("bad-start-line", "%r" % line[:60])
        keep = _keep_alive(words[2], headers)
        self._expected = headers.get("expect", "").lower() == "100-continue"
        return Request(words[0], words[1], headers, keep)


class ResponseParser(_Parser):
    """Bytes of one server connection to responses, in order."""

    def feed(self, data: "Buffer") -> "list[Response]":
        """Take bytes from the server and return the responses they complete, oldest first.

        Never raises for what the server sent: after a fault `error` is set, and what comes later is dropped.
        """
        return self._feed(data)  # type: ignore[return-value]

    def end(self) -> "list[Response]":
        """The server closed the connection: the response that its close completes, if it is one.

        Sets `error` to `truncated` when the close cut a response.
        """
        complete: list[Request | Response] = []
        if self._state == _UNTIL_CLOSE:
            self._finish(self._take(len(self._buffer)), complete)
        elif self._state != _FAILED and not self.idle:
            self._fail(ProtocolError("truncated", "connection closed inside a response"))
        return complete  # type: ignore[return-value]

    def _start_line(self, line: str, headers: "dict[str, str]") -> Response:
        words = line.split(None, 2)
        status = _decimal(words[1].encode(), 3) if len(words) > 1 else -1
        if status < 100:
            raise ProtocolError("bad-start-line", "%r" % line[:60])
        keep = _keep_alive(words[0], headers)
        return Response(status, words[2] if len(words) > 2 else "", headers, keep)

    def _frame(
        self, message: "Request | Response", headers: "dict[str, str]", complete: "list[Request | Response]"
    ) -> None:
        if isinstance(message, Response) and 100 <= message.status < 200:
            self._message = None  # an interim response: the final one follows
            self._state = _START
            return
        super()._frame(message, headers, complete)


def emit_request(host: str, path: str, body: bytes) -> bytes:
    """One POST of `body`, which is XML. `host` is what the peer is called, with its port."""
    head = (
        "POST %s HTTP/1.1\r\nHost: %s\r\nUser-Agent: roslet\r\nContent-Type: text/xml\r\n"
        "Content-Length: %d\r\n\r\n" % (path, host, len(body))
    )
    return head.encode() + body


def emit_response(body: bytes, keep_alive: bool = True) -> bytes:
    """One answer 200 with `body`, which is XML."""
    # xmlrpcpp recognises "Connection: close" only in exactly this spelling.
    head = "HTTP/1.1 200 OK\r\nServer: roslet\r\nContent-Type: text/xml\r\nContent-Length: %d\r\n%s\r\n" % (
        len(body),
        "" if keep_alive else "Connection: close\r\n",
    )
    return head.encode() + body


def emit_error(status: int) -> bytes:
    """One answer without content that says `status` and closes the connection."""
    text = "%d %s" % (status, REASONS.get(status, "Error"))
    allow = "Allow: POST\r\n" if status == 405 else ""
    return (
        "HTTP/1.1 %s\r\nServer: roslet\r\n%sContent-Type: text/plain\r\nContent-Length: %d\r\n"
        "Connection: close\r\n\r\n%s\n" % (text, allow, len(text) + 1, text)
    ).encode()


def emit_continue() -> bytes:
    """The interim answer for which a client with `Expect: 100-continue` waits."""
    return b"HTTP/1.1 100 Continue\r\n\r\n"


def _keep_alive(version: str, headers: "dict[str, str]") -> bool:
    """Whether the connection outlives this message (RFC 9112 section 9.3)."""
    connection = headers.get("connection", "").lower()
    if version == "HTTP/1.1":
        return "close" not in connection
    if version == "HTTP/1.0":
        return "keep-alive" in connection
    if version.startswith("HTTP/"):
        raise ProtocolError("unsupported-version", "%r" % version[:20])
    raise ProtocolError("bad-start-line", "%r is no HTTP version" % version[:20])


def _text(data: bytes) -> str:
    """Header bytes as text. Field values are ASCII in practice; any other byte becomes a question mark."""
    try:
        return data.decode()
    except UnicodeError:
        return bytes([byte if byte < 128 else 63 for byte in data]).decode()


def _decimal(digits: bytes, most: int) -> int:
    """A number of at most `most` decimal digits, or -1."""
    if not 0 < len(digits) <= most:
        return -1
    for byte in digits:
        if not 48 <= byte <= 57:
            return -1
    return int(digits)


def _hexadecimal(digits: bytes, most: int) -> int:
    """A number of at most `most` hexadecimal digits, or -1."""
    if not 0 < len(digits) <= most:
        return -1
    for byte in digits.lower():
        if not (48 <= byte <= 57 or 97 <= byte <= 102):
            return -1
    return int(digits, 16)
