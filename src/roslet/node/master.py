"""What a node asks the master, and other nodes: parameters and the graph."""

from __future__ import annotations

from roslet.errors import Fault, ParameterNotSet

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from roslet.engine.ros1.engine import Engine
    from roslet.io.select import Reactor
    from roslet.node.future import Future

# Seconds for one question to the master or to another node.
CALL_TIMEOUT = 10.0
_MISSING: Any = object()


class MasterApi:
    """The part of a node that is questions and answers. Every method waits for its answer and serves the loop meanwhile;
    each raises Unreachable or CallTimeout where there is none, NodeClosed after `close()`."""

    name: str
    reactor: Reactor
    _engine: Engine
    _parameter_callbacks: dict[str, list[Callable[[Any], object]]]

    def resolve(self, name: str) -> str:
        """The full name that `name` has here. Raises InvalidName."""
        raise NotImplementedError

    def _check_open(self) -> None:
        raise NotImplementedError

    def _future(self, what: str) -> Future[Any]:
        raise NotImplementedError

    def _update(self) -> None:
        raise NotImplementedError

    # -- parameters

    def get_parameter(self, name: str, default: Any = _MISSING) -> Any:
        """A parameter, or a dict of all below a namespace. Raises ParameterNotSet where there is none and no default."""
        try:
            return self.call_master("getParam", self.resolve(name))
        except Fault:
            if default is _MISSING:
                raise ParameterNotSet(f"parameter {self.resolve(name)} is not set") from None
            return default

    def set_parameter(self, name: str, value: Any) -> None:
        """Set a parameter to bool, int, float, str, bytes, list or dict."""
        full = self.resolve(name)
        self.call_master("setParam", full, value)
        self._changed_here(full, value)

    def delete_parameter(self, name: str) -> None:
        """Raises ParameterNotSet."""
        try:
            full = self.resolve(name)
            self.call_master("deleteParam", full)
        except Fault as error:
            raise ParameterNotSet(error.message) from None
        self._changed_here(full, {})

    def _changed_here(self, full: str, value: Any) -> None:
        """The master tells everybody of a change but the node that made it."""
        with self.reactor.lock:
            if self._engine.watches(full):
                self._engine.parameter_changed(full, value)

    def has_parameter(self, name: str) -> bool:
        """Whether there is a parameter, or a namespace of parameters, of this name."""
        return bool(self.call_master("hasParam", self.resolve(name)))

    def search_parameter(self, name: str) -> str | None:
        """The full name of the nearest parameter `name`, from this node's namespace upwards."""
        try:
            return str(self.call_master("searchParam", name))
        except Fault:
            return None

    def parameter_names(self) -> list[str]:
        """The full names of all parameters of the master."""
        return [str(name) for name in self.call_master("getParamNames")]

    def on_parameter(self, name: str, callback: Callable[[Any], object]) -> Any:
        """Call `callback(value)` inside spin whenever the parameter changes, whoever changed it; returns its present value.

        The value of a namespace is the dict of all below it. {} stands for unset.
        """
        self._check_open()
        full = self.resolve(name)
        self._parameter_callbacks.setdefault(full, []).append(callback)
        future = self._future(f"parameter {full}")
        with self.reactor.lock:
            self._engine.watch_parameter(full, into(future), self.reactor.now())
            self._update()
        return future.result(CALL_TIMEOUT)

    def off_parameter(self, name: str, callback: Callable[[Any], object]) -> None:
        """Undo one `on_parameter` of this callback; without any left, the master is asked to tell no more.

        A change that is already on its way to spin is still told. Nothing happens where the callback was not set.
        """
        self._check_open()
        full = self.resolve(name)
        with self.reactor.lock:
            callbacks = self._parameter_callbacks.get(full, [])
            if callback not in callbacks:
                return
            callbacks.remove(callback)
            if not callbacks:
                del self._parameter_callbacks[full]
                if full != "/use_sim_time":  # the node itself follows it
                    self._engine.unwatch_parameter(full, self.reactor.now())
                    self._update()

    # -- the graph

    def call_master(self, method: str, *arguments: Any, timeout: float = CALL_TIMEOUT) -> Any:
        """Call the master's API; the node's name is put first. Returns the value; raises Fault, Unreachable, CallTimeout."""
        return self.call_master_async(method, *arguments).result(timeout)

    def call_master_async(self, method: str, *arguments: Any) -> Future[Any]:
        """`call_master` without waiting: a Future of the value."""
        self._check_open()
        future = self._future(f"{method} of the master at {self._engine.master_uri}")
        with self.reactor.lock:
            self._engine.call_master(method, [self.name, *arguments], into(future), self.reactor.now())
            self._update()
        return future

    def call_node(self, uri: str, method: str, *arguments: Any, timeout: float = CALL_TIMEOUT) -> Any:
        """Call the slave API of the node at `uri`; this node's name is put first."""
        self._check_open()
        future = self._future(f"{method} of {uri}")
        with self.reactor.lock:
            self._engine.call_slave(uri, method, [self.name, *arguments], into(future), self.reactor.now())
            self._update()
        return future.result(timeout)

    def system_state(self) -> tuple[dict[str, list[str]], dict[str, list[str]], dict[str, list[str]]]:
        """Three dicts: topic -> publishers, topic -> subscribers, service -> providers."""
        state = self.call_master("getSystemState")
        publishers, subscribers, services = (
            {str(n): [str(x) for x in who] for n, who in part} for part in state
        )
        return publishers, subscribers, services

    def topics(self) -> dict[str, str]:
        """Every topic the master knows, with its type."""
        return {str(topic): str(kind) for topic, kind in self.call_master("getTopicTypes")}

    def nodes(self) -> list[str]:
        """Every node that has something registered, sorted."""
        return sorted({name for part in self.system_state() for names in part.values() for name in names})

    def services(self) -> list[str]:
        """Every service the master knows, sorted."""
        return sorted(self.system_state()[2])

    def topic_type(self, topic: str) -> str | None:
        """The type of a topic; None where the master does not know it."""
        return self.topics().get(self.resolve(topic))

    def lookup_node(self, name: str) -> str | None:
        """The URI of a node's slave API; None where the master does not know it."""
        try:
            return str(self.call_master("lookupNode", self.resolve(name)))
        except Fault:
            return None

    def lookup_service(self, name: str) -> str | None:
        """The rosrpc:// URI of a service; None where there is none."""
        try:
            return str(self.call_master("lookupService", self.resolve(name)))
        except Fault:
            return None


def into(future: Future[Any]) -> Callable[[object, Exception | None, float], None]:
    """What hands an answer of the engine to `future`."""

    def done(value: object, error: Exception | None, now: float) -> None:
        if error is None:
            future.set_result(value)
        else:
            future.set_exception(error)

    return done
