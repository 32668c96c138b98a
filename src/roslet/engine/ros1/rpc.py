"""XML-RPC over HTTP as two machines without sockets: one accepted connection, and one connection to a peer.

Runs on MicroPython. A runtime shell feeds what it receives, sends what `data_to_send` returns, and re-arms
one timer from `deadline`. Events are facts: `CallReceived`, `ReplyReceived`, `CallFailed`.

What ends a server connection, and is its `close_reason`: a reason of `wire.http`, or

    idle  slow-request  too-many-requests  not-post  peer-closed  connection-close
"""

from roslet.errors import CallTimeout, Fault, InvalidMessage, ProtocolError, RosletError, Unreachable
from roslet.record import Record
from roslet.wire import http, xmlrpc

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any, TypeAlias

    from roslet.wire.http import Buffer

    # A method and the fewest and most parameters it takes.
    Method: TypeAlias = tuple[Callable[..., Any], int, int]
    Methods: TypeAlias = dict[str, Method]

REQUEST_TIMEOUT = 30.0
"""Seconds from the first byte of a request to its last, and from accepting to the first byte. A client that
trickles a request would otherwise hold a descriptor for ever.
"""

IDLE_TIMEOUT = 300.0
"""Seconds that a server keeps a connection without a request. rospy and roscpp keep theirs open between calls
and reconnect silently when it has been closed.
"""

MAX_PIPELINED = 32
"""Requests that a client may send ahead of the answers. No ROS peer sends more than one."""

MAX_UNSENT = 64 * 1024 * 1024
"""Bytes of answers that a shell holds for a client that does not read them; then it ends the connection. The
largest single answer is a whole parameter tree."""

MAX_MULTICALL = 1000
"""Calls in one system.multicall; rosnode and rosparam send a few dozen."""

CALL_TIMEOUT = 15.0
"""Seconds from `call` to its answer, connecting and waiting in the queue included."""

CLIENT_IDLE_TIMEOUT = 30.0
"""Seconds after which a client closes a connection that it no longer uses, as roscpp does."""

MAX_QUEUED_CALLS = 1024
"""Calls that wait for one peer. One is in flight; what waits costs its encoded request."""

FAULT_PARSE = -32700
FAULT_NO_METHOD = -32601
FAULT_INTERNAL = -32603
"""Fault codes: Specification for Fault Code Interoperability (xmlrpc-epi)."""


class CallReceived(Record):
    """A client called `method`; answer with `reply` or `fault` under `call_id`."""

    _fields = ("call_id", "method", "params")
    __slots__ = _fields

    def __init__(self, call_id: int, method: str, params: "list[Any]") -> None:
        self.call_id = call_id
        self.method = method
        self.params = params


class ReplyReceived(Record):
    """The peer answered the call `call_id` with `value`."""

    _fields = ("call_id", "value")
    __slots__ = _fields

    def __init__(self, call_id: int, value: "Any") -> None:
        self.call_id = call_id
        self.value = value


class CallFailed(Record):
    """The call `call_id` has no answer. `error` is Unreachable, CallTimeout, ProtocolError or Fault."""

    _fields = ("call_id", "error")
    __slots__ = _fields

    def __init__(self, call_id: int, error: RosletError) -> None:
        self.call_id = call_id
        self.error = error


class RpcServer:
    """One accepted connection. Calls are handed out one at a time, in order; the next after the answer.

    Holds at most one request being received (`max_body`), MAX_PIPELINED complete ones, and the answers not
    yet taken by `data_to_send`. A shell that holds more than `max_unsent` bytes of answers ends the
    connection.
    """

    max_unsent = MAX_UNSENT

    def __init__(
        self,
        now: float,
        max_body: int = http.MAX_BODY,
        request_timeout: float = REQUEST_TIMEOUT,
        idle_timeout: float = IDLE_TIMEOUT,
    ) -> None:
        self.close_reason = ""
        self._request_timeout = request_timeout
        self._idle_timeout = idle_timeout
        self._parser = http.RequestParser(http.MAX_HEADER, max_body)
        self._requests: list[http.Request] = []
        self._output: list[bytes] = []
        self._event: CallReceived | None = None
        self._current = 0  # the call that waits for its answer, or 0
        self._keep_alive = True
        self._next_id = 1
        self._ended = False
        self._deadline: float | None = now + request_timeout
        self._request_began = False
        self._refused: list[str] = []

    @property
    def closing(self) -> bool:
        """True when the connection is to be closed, once what `data_to_send` returns has been sent."""
        return bool(self.close_reason)

    def receive_data(self, data: "Buffer", now: float) -> None:
        """Take bytes from the client. Never raises for what the client sent."""
        if self.close_reason or self._ended or not data:
            return
        requests = self._parser.feed(data)
        if self._parser.take_continue():
            self._output.append(http.emit_continue())
        self._requests.extend(requests)
        self._advance()
        self._arm(now, bool(requests))

    def receive_end(self, now: float) -> None:
        """The client sends no more. Calls that it made are still answered; then `closing` becomes true."""
        self._ended = True
        self._advance()
        self._arm(now, False)

    def next_event(self) -> "CallReceived | None":
        """The call to answer next, or None."""
        event = self._event
        self._event = None
        return event

    def reply(self, call_id: int, value: "Any", now: float = 0.0) -> None:
        """Answer a call. An answer to a call that is no longer open is dropped.

        Raises InvalidMessage for a value that cannot be sent; the client then gets a fault.
        """
        try:
            body = xmlrpc.emit_response(value)
        except InvalidMessage as error:
            self.fault(call_id, FAULT_INTERNAL, "the answer cannot be sent: %s" % error, now)
            raise
        self._answer(call_id, body, now)

    def fault(self, call_id: int, code: int, message: str, now: float = 0.0) -> None:
        """Answer a call with a fault. An answer to a call that is no longer open is dropped."""
        self._answer(call_id, xmlrpc.emit_fault(code, message), now)

    @property
    def unfinished(self) -> bool:
        """Whether a request has come in part, and nothing was wrong with it so far but its end."""
        return self.close_reason in ("", "peer-closed") and not self._parser.idle

    def take_refused(self) -> "list[str]":
        """Why requests that have come since the last look were refused, one reason each."""
        refused = self._refused
        if refused:
            self._refused = []
        return refused

    def data_to_send(self) -> bytes:
        """What is to be sent now; each byte is returned once."""
        if not self._output:
            return b""
        data = self._output[0] if len(self._output) == 1 else b"".join(self._output)
        self._output = []
        return data

    def deadline(self) -> "float | None":
        """When `handle_deadline` is to be called, or None while a call waits for its answer."""
        return None if self.close_reason or self._current else self._deadline

    def handle_deadline(self, now: float) -> None:
        """End the connection where its time is over."""
        deadline = self.deadline()
        if deadline is None or now < deadline:
            return
        if self._parser.idle:
            self._close("idle")
        else:
            self._refuse(408, "slow-request")

    def _answer(self, call_id: int, body: bytes, now: float) -> None:
        if not self._current or call_id != self._current or self.close_reason:
            return
        self._current = 0
        self._event = None
        self._output.append(http.emit_response(body, self._keep_alive))
        if not self._keep_alive:
            self._close("connection-close")
            return
        self._advance()
        if self._deadline is not None and now > 0.0:
            self._arm(now, True)

    def _advance(self) -> None:
        """Go on to the next request, where no call waits for an answer."""
        while self._requests and not self._current and not self.close_reason:
            self._begin(self._requests.pop(0))
        if self.close_reason:
            return
        if len(self._requests) > MAX_PIPELINED:
            self._refuse(503, "too-many-requests")
        elif not self._current and self._parser.error is not None:
            reason = self._parser.error.reason
            self._refuse(http.STATUS_OF_REASON.get(reason, 400), reason)
        elif self._ended and not self._current:
            self._close("peer-closed")

    def _begin(self, request: "http.Request") -> None:
        self._keep_alive = request.keep_alive
        if request.method != "POST":
            self._refuse(405, "not-post")
            return
        self._current = self._next_id
        self._next_id += 1
        try:
            method, params = xmlrpc.parse_call(request.body)
        except ProtocolError as error:
            # The framing is intact, so only this call failed.
            self._refused.append(error.reason)
            self._output.append(
                http.emit_response(
                    xmlrpc.emit_fault(FAULT_PARSE, "no XML-RPC call: %s" % error), self._keep_alive
                )
            )
            self._current = 0
            if not self._keep_alive:
                self._close("connection-close")
            return
        self._event = CallReceived(self._current, method, params)

    def _refuse(self, status: int, reason: str) -> None:
        self._refused.append(reason)
        self._output.append(http.emit_error(status))
        self._close(reason)

    def _close(self, reason: str) -> None:
        self.close_reason = reason
        self._requests = []
        self._event = None
        self._current = 0

    def _arm(self, now: float, completed: bool) -> None:
        if self._parser.idle:
            self._request_began = False
            self._deadline = now + self._idle_timeout
        elif completed or not self._request_began:
            self._request_began = True
            self._deadline = now + self._request_timeout


class _Call:
    """One call that has no answer yet."""

    __slots__ = ("call_id", "expires", "method", "request", "retried")

    def __init__(self, call_id: int, method: str, request: bytes, expires: float) -> None:
        self.call_id = call_id
        self.method = method
        self.request = request
        self.expires = expires
        self.retried = False


_ABSENT = 0  # no connection
_READY = 1  # connected, no call in flight
_BUSY = 2  # a call is in flight
_ENDING = 3  # the shell is to close the connection


class RpcClient:
    """Calls to one peer, in order, over one connection at a time.

    The shell opens a TCP connection to (`host`, `port`) while `wants_connection` is true and tells the
    outcome by `connected` or `connection_lost`. While `wants_close` is true it closes the socket and calls
    `connection_lost`. Every call ends in exactly one event. A server may close after each answer (rospy's
    HTTP/1.0) or keep the connection (roscpp); a kept connection that turns out to be closed is replaced once,
    silently.
    """

    def __init__(
        self,
        host: str,
        port: int,
        path: str = "/",
        timeout: float = CALL_TIMEOUT,
        idle_timeout: float = CLIENT_IDLE_TIMEOUT,
        max_body: int = http.MAX_BODY,
    ) -> None:
        self.host = host
        self.port = port
        self._path = path or "/"
        self._authority = "%s:%d" % ("[%s]" % host if ":" in host else host, port)
        self._timeout = timeout
        self._idle_timeout = idle_timeout
        self._max_body = max_body
        self._state = _ABSENT
        self._queue: list[_Call] = []
        self._flight: _Call | None = None
        self._events: list[ReplyReceived | CallFailed] = []
        self._output = b""
        self._parser = http.ResponseParser(http.MAX_HEADER, max_body)
        self._served = 0  # answers that this connection brought
        self._heard = False  # whether anything of the current answer has come
        self._idle_until = 0.0
        self._next_id = 1

    @property
    def wants_connection(self) -> bool:
        """True while calls wait and there is no connection. Stays true while the shell connects."""
        return self._state == _ABSENT and bool(self._queue)

    @property
    def wants_close(self) -> bool:
        """True when the shell is to close the socket and to say so by `connection_lost`."""
        return self._state == _ENDING

    @property
    def pending(self) -> int:
        """Calls that have no answer yet."""
        return len(self._queue) + (1 if self._flight is not None else 0)

    def call(
        self, method: str, params: "list[Any] | tuple[Any, ...]", now: float, timeout: "float | None" = None
    ) -> int:
        """Queue a call and return its id. It fails with CallTimeout after `timeout` seconds.

        Raises InvalidMessage for a value that cannot be sent, Unreachable where MAX_QUEUED_CALLS wait
        already.
        """
        if len(self._queue) >= MAX_QUEUED_CALLS:
            raise Unreachable("%s: %d calls wait already" % (self._authority, len(self._queue)))
        request = http.emit_request(self._authority, self._path, xmlrpc.emit_call(method, params))
        call_id = self._next_id
        self._next_id += 1
        expires = now + (self._timeout if timeout is None else timeout)
        self._queue.append(_Call(call_id, method, request, expires))
        self._send_next()
        return call_id

    def connected(self, now: float) -> None:
        """The connection is there."""
        if self._state != _ABSENT:
            return
        self._state = _READY
        self._served = 0
        self._idle_until = now + self._idle_timeout
        self._parser = http.ResponseParser(http.MAX_HEADER, self._max_body)
        self._send_next()

    def connection_lost(self, reason: str, now: float) -> None:
        """There is no connection: it could not be made, was closed by either side, or broke.

        `reason` is for people. Calls that wait stay queued, unless the connection could not be made.
        """
        state = self._state
        if state == _BUSY:
            # The close may be what ends the answer.
            self._take_responses(self._parser.end(), now)
        self._state = _ABSENT
        self._output = b""
        if state == _ABSENT:
            waiting = self._queue
            self._queue = []
            for call in waiting:
                self._failed(call, Unreachable("%s: %s" % (self._authority, reason or "no connection")))
            return
        call_in_flight = self._flight
        self._flight = None
        if call_in_flight is None:
            return
        if self._served and not self._heard and not call_in_flight.retried:
            # The server closed the kept connection before it saw this call (RFC 9112 section 9.3.1).
            call_in_flight.retried = True
            self._queue.insert(0, call_in_flight)
            return
        self._failed(
            call_in_flight, Unreachable("%s: %s" % (self._authority, reason or "closed without an answer"))
        )

    def receive_data(self, data: "Buffer", now: float) -> None:
        """Take bytes from the server. Never raises for what the server sent."""
        if self._state == _READY and data:
            self._state = _ENDING  # an answer to nothing: the stream is out of step
        if self._state != _BUSY or not data:
            return
        self._heard = True
        self._take_responses(self._parser.feed(data), now)
        error = self._parser.error
        if error is not None and self._flight is not None:
            self._failed(self._flight, error)
            self._flight = None
            self._state = _ENDING

    def next_event(self) -> "ReplyReceived | CallFailed | None":
        """The oldest event that was not taken yet, or None."""
        return self._events.pop(0) if self._events else None

    def data_to_send(self) -> bytes:
        """What is to be sent now; each byte is returned once."""
        data = self._output
        self._output = b""
        return data

    def deadline(self) -> "float | None":
        """When `handle_deadline` is to be called, or None."""
        deadline = self._idle_until if self._state == _READY else None
        if self._flight is not None:
            deadline = self._flight.expires
        for call in self._queue:
            if deadline is None or call.expires < deadline:
                deadline = call.expires
        return deadline

    def handle_deadline(self, now: float) -> None:
        """End calls whose time is over, and a connection that was not used for `idle_timeout`."""
        flight = self._flight
        if flight is not None and now >= flight.expires:
            self._flight = None
            self._state = _ENDING
            self._output = b""
            self._failed(flight, self._timed_out(flight))
        waiting = []
        for call in self._queue:
            if now >= call.expires:
                self._failed(call, self._timed_out(call))
            else:
                waiting.append(call)
        self._queue = waiting
        if self._state == _READY and now >= self._idle_until:
            self._state = _ENDING

    def close(self, now: float) -> None:
        """Fail all calls with Unreachable; `wants_close` tells whether there is a socket to close."""
        calls = self._queue
        if self._flight is not None:
            calls.insert(0, self._flight)
        self._queue = []
        self._flight = None
        for call in calls:
            self._failed(call, Unreachable("%s: the connection was closed here" % self._authority))
        if self._state != _ABSENT:
            self._state = _ENDING

    def _timed_out(self, call: _Call) -> CallTimeout:
        return CallTimeout("%s: no answer to %s in time" % (self._authority, call.method))

    def _failed(self, call: _Call, error: RosletError) -> None:
        self._events.append(CallFailed(call.call_id, error))

    def _send_next(self) -> None:
        if self._state != _READY or not self._queue:
            return
        self._flight = self._queue.pop(0)
        self._state = _BUSY
        self._heard = False
        self._output += self._flight.request

    def _take_responses(self, responses: "list[http.Response]", now: float) -> None:
        for response in responses:
            call = self._flight
            if call is None:
                self._state = _ENDING  # more answers than calls
                return
            self._flight = None
            self._events.append(self._outcome(call, response))
            self._served += 1
            self._heard = False
            if not response.keep_alive:
                self._state = _ENDING
                return
            self._state = _READY
        if responses:
            self._idle_until = now + self._idle_timeout
            if not self._parser.idle:
                self._state = _ENDING  # something follows that answers nothing
            self._send_next()

    def _outcome(self, call: _Call, response: "http.Response") -> "ReplyReceived | CallFailed":
        if response.status != 200:
            text = "%s answered %d %s" % (self._authority, response.status, response.reason[:80])
            return CallFailed(call.call_id, ProtocolError("http-status", text))
        try:
            return ReplyReceived(call.call_id, xmlrpc.parse_response(response.body))
        except (ProtocolError, Fault) as error:
            return CallFailed(call.call_id, error)


def unpack_reply(reply: "Any") -> "Any":
    """The value of a ROS reply `[code, message, value]`.

    Raises Fault where the code is not 1 (success), ProtocolError("bad-reply") where it is no such triple.
    """
    if not isinstance(reply, (list, tuple)) or len(reply) != 3 or type(reply[0]) is not int:
        raise ProtocolError("bad-reply", "expected [code, message, value], got %s" % repr(reply)[:80])
    if reply[0] != 1:
        raise Fault(reply[0], str(reply[1]))
    return reply[2]


def dispatch(methods: "Methods", method: str, params: "list[Any]") -> "Any":
    """What the call `method(*params)` answers. `methods` maps names to (function, fewest, most parameters).

    A wrong number of parameters is answered by the status triple [-1, message, 0], as ROS nodes do.
    system.multicall and system.listMethods are answered for every table. Raises Fault for a method that is
    not there, and whatever the function raises.
    """
    entry = methods.get(method)
    if entry is None:
        if method == "system.multicall":
            return _multicall(methods, params)
        if method == "system.listMethods":
            names = list(methods)
            names.extend(["system.listMethods", "system.multicall"])
            return sorted(names)
        raise Fault(FAULT_NO_METHOD, "method %s is not supported" % method[:200])
    function, fewest, most = entry
    if not fewest <= len(params) <= most:
        wanted = str(fewest) if fewest == most else "%d to %d" % (fewest, most)
        return [-1, "%s takes %s parameters, got %d" % (method, wanted, len(params)), 0]
    return function(*params)


def _multicall(methods: "Methods", params: "list[Any]") -> "list[Any]":
    if len(params) != 1 or not isinstance(params[0], list) or len(params[0]) > MAX_MULTICALL:
        raise Fault(FAULT_PARSE, "system.multicall takes one array of at most %d calls" % MAX_MULTICALL)
    results: list[Any] = []
    for call in params[0]:
        name = call.get("methodName") if isinstance(call, dict) else None
        given = call.get("params", []) if isinstance(call, dict) else None
        if not isinstance(name, str) or not isinstance(given, list) or name == "system.multicall":
            results.append(_fault_struct(FAULT_PARSE, "no methodName and params, or a nested multicall"))
            continue
        try:
            results.append([dispatch(methods, name, given)])
        except Fault as fault:
            results.append(_fault_struct(fault.code, fault.message))
        except Exception as error:  # a failing method fails its own call only
            results.append(_fault_struct(FAULT_INTERNAL, describe(error)))
    return results


def _fault_struct(code: int, message: str) -> "dict[str, Any]":
    return {"faultCode": code, "faultString": message}


def describe(error: Exception) -> str:
    """An exception as one line for a peer."""
    return "%s: %s" % (type(error).__name__, str(error)[:200])


def answer_calls(server: RpcServer, methods: "Methods", now: float) -> int:
    """Answer every call that `server` has received by `dispatch`, and return how many there were.

    What a method raises becomes a fault for its caller: a client must not be able to end the server.
    """
    count = 0
    while True:
        event = server.next_event()
        if event is None:
            return count
        count += 1
        try:
            server.reply(event.call_id, dispatch(methods, event.method, event.params), now)
        except Fault as fault:
            server.fault(event.call_id, fault.code, fault.message, now)
        except Exception as error:
            server.fault(event.call_id, FAULT_INTERNAL, describe(error), now)
