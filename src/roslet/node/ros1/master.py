"""What a node asks the ROS 1 master, and other nodes: parameters and the graph."""

from __future__ import annotations

from roslet.engine.ros1 import answers
from roslet.errors import Fault, ParameterNotSet
from roslet.node.graph import CALL_TIMEOUT

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from roslet.engine.ros1.engine import Engine
    from roslet.io.select import Reactor
    from roslet.node.future import Future
    from roslet.node.node import Node


class MasterApi:
    """The part of the ROS 1 network that is questions and answers: see `roslet.node.graph.GraphApi` for what they mean.
    Every method waits for its answer and serves the loop meanwhile."""

    name: str
    reactor: Reactor
    node: Node
    engine: Engine
    _parameter_callbacks: dict[str, list[Callable[[Any], object]]]

    def resolve(self, name: str) -> str:
        raise NotImplementedError

    def update(self) -> None:
        raise NotImplementedError

    # -- parameters

    def get_parameter(self, name: str) -> Any:
        try:
            return self.call_master("getParam", self.resolve(name))
        except Fault:
            raise ParameterNotSet(f"parameter {self.resolve(name)} is not set") from None

    def set_parameter(self, name: str, value: Any) -> None:
        full = self.resolve(name)
        self.call_master("setParam", full, value)
        self._changed_here(full, value)

    def delete_parameter(self, name: str) -> None:
        try:
            full = self.resolve(name)
            self.call_master("deleteParam", full)
        except Fault as error:
            raise ParameterNotSet(error.message) from None
        self._changed_here(full, {})

    def _changed_here(self, full: str, value: Any) -> None:
        """The master tells everybody of a change but the node that made it."""
        with self.reactor.lock:
            if self.engine.watches(full):
                self.engine.parameter_changed(full, value)

    def has_parameter(self, name: str) -> bool:
        return bool(self.call_master("hasParam", self.resolve(name)))

    def search_parameter(self, name: str) -> str | None:
        try:
            return str(self.call_master("searchParam", name))
        except Fault:
            return None

    def parameter_names(self) -> list[str]:
        return answers.parameter_names(self.call_master("getParamNames"))

    def on_parameter(self, name: str, callback: Callable[[Any], object]) -> Any:
        self.node._check_open()
        full = self.resolve(name)
        self._parameter_callbacks.setdefault(full, []).append(callback)
        future = self.node._future(f"parameter {full}")
        with self.reactor.lock:
            self.engine.watch_parameter(full, into(future), self.reactor.now())
            self.update()
        return future.result(CALL_TIMEOUT)

    def off_parameter(self, name: str, callback: Callable[[Any], object]) -> None:
        self.node._check_open()
        full = self.resolve(name)
        with self.reactor.lock:
            callbacks = self._parameter_callbacks.get(full, [])
            if callback not in callbacks:
                return
            callbacks.remove(callback)
            if not callbacks:
                del self._parameter_callbacks[full]
                if full != "/use_sim_time":  # the node itself follows it
                    self.engine.unwatch_parameter(full, self.reactor.now())
                    self.update()

    # -- the graph

    def call_master(self, method: str, *arguments: Any, timeout: float = CALL_TIMEOUT) -> Any:
        return self.call_master_async(method, *arguments).result(timeout)

    def call_master_async(self, method: str, *arguments: Any) -> Future[Any]:
        self.node._check_open()
        future = self.node._future(f"{method} of the master at {self.engine.master_uri}")
        with self.reactor.lock:
            self.engine.call_master(method, [self.name, *arguments], into(future), self.reactor.now())
            self.update()
        return future

    def call_node(self, uri: str, method: str, *arguments: Any, timeout: float = CALL_TIMEOUT) -> Any:
        self.node._check_open()
        future = self.node._future(f"{method} of {uri}")
        with self.reactor.lock:
            self.engine.call_slave(uri, method, [self.name, *arguments], into(future), self.reactor.now())
            self.update()
        return future.result(timeout)

    def system_state(self) -> tuple[dict[str, list[str]], dict[str, list[str]], dict[str, list[str]]]:
        return answers.system_state(self.call_master("getSystemState"))

    def topics(self) -> dict[str, str]:
        return answers.topic_types(self.call_master("getTopicTypes"))

    def nodes(self) -> list[str]:
        return sorted({name for part in self.system_state() for names in part.values() for name in names})

    def services(self) -> list[str]:
        return sorted(self.system_state()[2])

    def topic_type(self, topic: str) -> str | None:
        return self.topics().get(self.resolve(topic))

    def lookup_node(self, name: str) -> str | None:
        try:
            return str(self.call_master("lookupNode", self.resolve(name)))
        except Fault:
            return None

    def lookup_service(self, name: str) -> str | None:
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
