"""`rospy.impl.tcpros_service`: Service, ServiceProxy, wait_for_service."""

from __future__ import annotations

import time
import traceback
from typing import TYPE_CHECKING, Any

from roslet.compat import master
from roslet.compat.callbacks import Worker
from roslet.compat.messages import SerializationError, adapt, tidy
from roslet.compat.rospy import core, names
from roslet.compat.rospy.exceptions import ROSException, ROSInterruptException
from roslet.compat.rospy.msg import args_kwds_to_message
from roslet.compat.rospy.service import ServiceException
from roslet.compat.session import session
from roslet.errors import Fault, InvalidMessage, MalformedMessage, RosletError, ServiceFailed, Unreachable
from roslet.names import parse_host_port
from roslet.wire.message import Message

if TYPE_CHECKING:
    from collections.abc import Callable

    from roslet.engine.ros1.graph import ServiceOffer
    from roslet.node import Node
    from roslet.node.ros1.services import Ros1Client

DEFAULT_BUFF_SIZE = 65536
# Seconds between two looks for a service, or for a shutdown while a call is under way.
LOOK_AGAIN = 0.05

_offered: dict[str, Service] = {}


class Service:
    """Offers a service. Each connection is served in a thread of its own.

    `handler(request)` returns a response, its fields in a list or tuple, some of them in a dict, or its only field's value.
    What it raises goes to the caller. `error_handler(error, type, traceback)` hears of it instead of the log.
    """

    def __init__(
        self,
        name: str,
        service_class: Any,
        handler: Callable[[Any], Any],
        buff_size: int = DEFAULT_BUFF_SIZE,
        error_handler: Callable[[Any, Any, Any], object] | None = None,
    ) -> None:
        adapt(service_class)
        self.resolved_name = names.resolve_name(name)
        self.service_class = self.type = service_class
        self.request_class = service_class._request_class
        self.response_class = service_class._response_class
        self.handler = handler
        self.name = self.resolved_name
        self.uri = ""
        self._error_handler = error_handler
        self._entry: ServiceOffer | None = None
        self._node: Node | None = None
        self._workers: dict[Any, Worker] = {}
        with session.lock:
            if self.resolved_name in _offered:
                raise ServiceException(f"service [{self.resolved_name}] already registered")
            _offered[self.resolved_name] = self
        session.when_initialized(self._attach)

    def _attach(self, node: Node) -> None:
        if _offered.get(self.resolved_name) is not self or session.shutting_down.is_set():
            return
        self._node = node
        self.uri = node._ros1("rospy").engine.service_uri
        network = node._ros1("rospy")
        self._entry = network.offer(self, self._receive)
        network.settle()

    # In the loop's thread: the reply comes later.

    def _receive(self, view: memoryview, start: int, end: int, link: Any) -> None:
        worker = self._workers.get(link)
        if worker is None:
            for other in [other for other in self._workers if other.closing]:
                self._workers.pop(other).close()
            worker = self._workers[link] = Worker(f"service {self.resolved_name}", self._serve)
        worker.put((bytearray(view[start:end]), link))

    # In the connection's thread.

    def _serve(self, item: tuple[bytearray, Any]) -> None:
        data, link = item
        done, body = self._reply(data, link)
        node = self._node
        if node is None:
            return
        with node.reactor.lock:
            link.answer(done, body)
            network = node._ros1("rospy")
            network.engine.touch(link)
            network.update()
        node.reactor.wake()
        if not link.persistent:
            worker = self._workers.pop(link, None)
            if worker is not None:
                worker.close()

    def _reply(self, data: bytearray, link: Any) -> tuple[bool, bytes]:
        try:
            request = self.request_class.deserialize_from(memoryview(data), 0, len(data))
            tidy(self.request_class, request)
        except MalformedMessage as error:
            return False, f"error processing request: {error}".encode()
        request._connection_header = link.peer_header
        try:
            response = convert_return_to_response(self.handler(request), self.response_class)
            return True, response.serialize()
        except ServiceException as error:
            return False, f"service cannot process request: {error}".encode()
        except Exception as error:
            if self._error_handler is not None:
                self._error_handler(error, type(error), error.__traceback__)
            else:
                core.logerr("Error processing request: %s\n%s" % (error, traceback.format_exc()))
            return False, f"error processing request: {error}".encode()

    def shutdown(self, reason: str = "") -> None:
        """Offer the service no longer. Doing it twice is allowed."""
        if _offered.get(self.resolved_name) is self:
            del _offered[self.resolved_name]
        entry, self._entry = self._entry, None
        if entry is not None and self._node is not None:
            self._node._ros1("rospy").withdraw(entry)

    def spin(self) -> None:
        """Wait until the node is shut down; a Ctrl-C ends the service."""
        try:
            while not session.shutting_down.is_set():
                time.sleep(LOOK_AGAIN)
        except KeyboardInterrupt:
            self.shutdown("keyboard interrupt")


def convert_return_to_response(response: Any, response_class: Any) -> Any:
    """What a handler returned, as a response message. Raises ServiceException."""
    if response is None:
        raise ServiceException("service handler returned None")
    if isinstance(response, Message) and response._type == response_class._type:
        return response
    try:
        if isinstance(response, dict):
            return response_class(**response)
        if isinstance(response, (list, tuple)):
            try:
                return response_class(*response)
            except TypeError as error:
                raise ServiceException(f"handler returned wrong number of values: {error}") from None
        return response_class(response)
    except (AttributeError, TypeError) as error:
        raise ServiceException(f"handler returned invalid value: {error}") from None


class ServiceProxy:
    """Calls a service: `proxy(request)`, its fields in order, or some by name; returns the response.

    persistent  keep one connection for all calls
    headers     further fields of the connection header
    """

    def __init__(
        self, name: str, service_class: Any, persistent: bool = False, headers: dict[str, str] | None = None
    ) -> None:
        adapt(service_class)
        self.resolved_name = names.resolve_name(name)
        self.service_class = service_class
        self.request_class = service_class._request_class
        self.response_class = service_class._response_class
        self.persistent = persistent
        self.headers = dict(headers or {})
        self.seq = 0
        self.protocol = None
        self._client: Ros1Client | None = None

    def __call__(self, *args: Any, **kwds: Any) -> Any:
        return self.call(*args, **kwds)

    def call(self, *args: Any, **kwds: Any) -> Any:
        """The response.

        Raises TypeError or AttributeError for arguments that are no request, genpy.SerializationError for values that do
        not fit, ServiceException where there is no such service or the call fails, ROSInterruptException on shutdown.
        """
        request = args_kwds_to_message(self.request_class, args, kwds)
        node = session.node
        if node is None or session.shutting_down.is_set():
            if node is None:
                raise ROSException("ROS node has not been initialized yet. Please call init_node() first")
            raise ServiceException(f"service [{self.resolved_name}] unavailable")
        client = self._connect(node)
        self.seq += 1
        try:
            future = client.call_async(request)
            while not future.done():
                node.reactor.run_until(
                    lambda: future.done() or session.shutting_down.is_set(), None, user=False
                )
                if session.shutting_down.is_set() and not future.done():
                    raise ROSInterruptException("rospy shutdown")
            response = future.result(0)
        except InvalidMessage as error:
            raise SerializationError(str(error)) from None
        except (Fault, Unreachable) as error:
            raise ServiceException(f"service [{self.resolved_name}] unavailable") from error
        except ServiceFailed as error:
            text = str(error)
            if text.startswith("connection lost"):
                raise ServiceException(f"transport error completing service call: {text}") from None
            raise ServiceException(
                f"service [{self.resolved_name}] responded with an error: {text.encode()!r}"
            ) from None
        except MalformedMessage as error:
            raise ServiceException(f"transport error completing service call: {error}") from None
        except RosletError as error:
            raise ServiceException(f"unable to connect to service: {error}") from None
        tidy(self.response_class, response)
        return response

    def _connect(self, node: Node) -> Ros1Client:
        client = self._client
        if client is None or not self.persistent:
            network = node._ros1("rospy")
            client = network.client(self.resolved_name, self.service_class, self.persistent)
            if self.headers:
                plain = client._header
                client._header = lambda: {**plain(), **self.headers}  # type: ignore[method-assign]
            if self.persistent:
                self._client = client
        return client

    def wait_for_service(self, timeout: float | None = None) -> None:
        """As the function of that name."""
        wait_for_service(self.resolved_name, timeout=timeout)

    def close(self) -> None:
        """Close the connection of a persistent proxy; the next call makes a new one."""
        client, self._client = self._client, None
        if client is not None:
            client.close()


def wait_for_service(service: str, timeout: Any = None) -> None:
    """Wait until somebody offers the service and accepts connections.

    Raises ROSException after `timeout` (seconds, or a Duration), ROSInterruptException on shutdown.
    """
    if hasattr(timeout, "to_sec"):
        timeout = timeout.to_sec()
    name = names.resolve_name(service)
    end = None if timeout is None else time.monotonic() + timeout
    told = False
    while not session.shutting_down.is_set():
        if _answers(name):
            return
        if end is not None and time.monotonic() >= end:
            raise ROSException(f"timeout exceeded while waiting for service {name}")
        if not told:
            core.rospydebug("waiting for service [%s]" % name)
            told = True
        session.shutting_down.wait(
            LOOK_AGAIN if end is None else max(0.0, min(LOOK_AGAIN, end - time.monotonic()))
        )
    raise ROSInterruptException("rospy shutdown")


def _answers(name: str) -> bool:
    """Whether the service is registered and its server takes a connection and its probe."""
    try:
        uri = master.call("lookupService", name)
        return master.probe_service(parse_host_port(str(uri)), name)
    except (RosletError, OSError):
        return False


__all__ = [
    "DEFAULT_BUFF_SIZE",
    "Service",
    "ServiceException",
    "ServiceProxy",
    "convert_return_to_response",
    "wait_for_service",
]
