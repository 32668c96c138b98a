"""What a ROS 1 master decides: the Master API and the Parameter Server API, without sockets.

Source: ROS Master API, ROS Parameter Server API, and the answers of Debian's rosmaster, with which a test
compares these. Every method takes the caller's name first and answers `[code, message, value]`: code 1 is
success, 0 a failure of the master, -1 a fault of the caller. What other nodes have to be told is collected as
`Notification`s.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from roslet.errors import Fault
from roslet.master.params import ParameterTree, changes, subscription_key
from roslet.names import canonical, namespace_of
from roslet.record import Record

if TYPE_CHECKING:
    from roslet.engine.ros1.rpc import Methods

SUCCESS, FAILURE, ERROR = 1, 0, -1

Reply = list[Any]
Node = tuple[str, str]  # a node's name and the URI of its slave API


class Notification(Record):
    """A call that a node is due: `method(*params)` at the slave API `api`.

    `key` names what it is about: of several that wait for one node with equal method and key only the newest
    matters, because each tells the whole state.
    """

    _fields = ("api", "method", "key", "params")
    __slots__ = _fields

    def __init__(self, api: str, method: str, key: str, params: list[Any]) -> None:
        self.api = api
        self.method = method
        self.key = key
        self.params = params


class InvalidArgumentError(Exception):
    """An argument that the method cannot take; the text goes to the caller."""


class _Registrations:
    """Who provides what: topic, service or parameter to nodes, in the order of their registration."""

    def __init__(self) -> None:
        self._nodes: dict[str, list[Node]] = {}
        self._held: dict[str, int] = {}  # how many registrations each node has

    def names(self) -> list[str]:
        return list(self._nodes)

    def nodes(self, name: str) -> list[Node]:
        return list(self._nodes.get(name, ()))

    def apis(self, name: str) -> list[str]:
        return [api for _, api in self._nodes.get(name, ())]

    def state(self) -> list[list[Any]]:
        return [[name, [node for node, _ in nodes]] for name, nodes in self._nodes.items()]

    def add(self, name: str, node: Node) -> None:
        nodes = self._nodes.setdefault(name, [])
        if node not in nodes:
            nodes.append(node)
            self._held[node[0]] = self._held.get(node[0], 0) + 1

    def replace(self, name: str, node: Node) -> None:
        for other in self.nodes(name):
            self.remove(name, other)
        self.add(name, node)

    def remove(self, name: str, node: Node) -> bool:
        nodes = self._nodes.get(name, [])
        if node not in nodes:
            return False
        nodes.remove(node)
        if not nodes:
            del self._nodes[name]
        self._held[node[0]] -= 1
        if not self._held[node[0]]:
            del self._held[node[0]]
        return True

    def remove_caller(self, caller: str) -> list[str]:
        """Forget all that `caller` registered; the names that it was registered for."""
        found = [(name, node) for name, nodes in self._nodes.items() for node in nodes if node[0] == caller]
        for name, node in found:
            self.remove(name, node)
        return [name for name, _ in found]

    def knows(self, caller: str) -> bool:
        return caller in self._held


class Master:
    """The master's state. One call at a time; no call blocks.

    `uri` and `pid` are what getUri and getPid answer. `stopping` becomes true when a client called shutdown.
    """

    def __init__(self, uri: str = "", pid: int = 0) -> None:
        self.uri = uri
        self.pid = pid
        self.stopping = False
        self.parameters = ParameterTree()
        self.publishers = _Registrations()
        self.subscribers = _Registrations()
        self.services = _Registrations()
        self.parameter_subscribers = _Registrations()
        self._registries = (self.publishers, self.subscribers, self.services, self.parameter_subscribers)
        self._service_uris: dict[str, tuple[str, str]] = {}
        self._topic_types: dict[str, str] = {}
        self._apis: dict[str, str] = {}  # a node's name to its slave API
        self._notifications: list[Notification] = []

    # -- calls

    def methods(self) -> Methods:
        """The table for `rpc.dispatch`."""
        return {name: (self._bound(name), 0, 64) for name in API}

    def _bound(self, name: str) -> Callable[..., Reply]:
        return lambda *params: self.call(name, params)

    def call(self, method: str, params: tuple[Any, ...] | list[Any]) -> Reply:
        """The answer to `method(*params)`. Raises Fault for a method that a master does not have."""
        entry = API.get(method)
        if entry is None:
            raise Fault(1, f"method {method[:200]!r} is not supported")
        kinds, otherwise = entry
        if not params:
            return [ERROR, f"{method} needs the caller's name", otherwise]
        if len(params) != len(kinds) + 1:
            return [ERROR, f"{method} takes {len(kinds) + 1} parameters, got {len(params)}", otherwise]
        caller = params[0]
        if not isinstance(caller, str):
            return [ERROR, "caller_id must be a string", otherwise]
        try:
            checked = [CHECKS[kind](value, caller) for kind, value in zip(kinds, params[1:], strict=True)]
            reply: Reply = getattr(self, "_" + method)(caller, *checked)
        except InvalidArgumentError as error:
            return [ERROR, f"{method}: {error}", otherwise]
        except ValueError as error:
            return [FAILURE, f"{method}: {error}", otherwise]
        return reply

    def take_notifications(self) -> list[Notification]:
        """What is to be delivered since the last call, in order for each node."""
        taken = self._notifications
        self._notifications = []
        return taken

    def notification_answered(self, notification: Notification, reply: Any) -> None:
        """A node answered. One that answers paramUpdate with an error no longer wants it; nothing else is
        forgotten.
        """
        if notification.method != "paramUpdate" or not isinstance(reply, (list, tuple)) or not reply:
            return
        if reply[0] == ERROR:
            for node in self.parameter_subscribers.nodes(notification.key):
                if node[1] == notification.api:
                    self.parameter_subscribers.remove(notification.key, node)
                    self._forget_if_idle(node[0])

    # -- nodes

    def _register(self, registry: _Registrations, name: str, caller: str, api: str) -> None:
        known = self._apis.get(caller)
        if known is not None and known != api:
            self._replace_node(caller, known)
        self._apis[caller] = api
        if registry is self.services:
            registry.replace(name, (caller, api))
        else:
            registry.add(name, (caller, api))

    def _replace_node(self, caller: str, api: str) -> None:
        """A node took the name of the node at `api`: that one is told to end, and what it registered is
        dropped.
        """
        reason = f"[{caller}] Reason: new node registered with same name"
        self._notifications.append(Notification(api, "shutdown", "", ["/master", reason]))
        unpublished = self.publishers.remove_caller(caller)
        for registry in self._registries[1:]:
            registry.remove_caller(caller)
        for service in [name for name, (owner, _) in self._service_uris.items() if owner == caller]:
            del self._service_uris[service]
        for topic in unpublished:
            self._tell_subscribers(topic)

    def _unregister(self, registry: _Registrations, name: str, caller: str, api: str) -> Reply:
        if caller not in self._apis:
            return [SUCCESS, f"[{caller}] is not a registered node", 0]
        removed = registry.remove(name, (caller, api))
        self._forget_if_idle(caller)
        if not removed:
            return [SUCCESS, f"[{caller}] is not registered for [{name}] under [{api}]", 0]
        return [SUCCESS, f"Unregistered [{caller}] from [{name}]", 1]

    def _forget_if_idle(self, caller: str) -> None:
        if caller in self._apis and not any(registry.knows(caller) for registry in self._registries):
            del self._apis[caller]

    def _tell_subscribers(self, topic: str) -> None:
        """The whole list of publishers to every subscriber of `topic`."""
        publishers = self.publishers.apis(topic)
        for api in dict.fromkeys(self.subscribers.apis(topic)):
            self._notifications.append(
                Notification(api, "publisherUpdate", topic, ["/master", topic, publishers])
            )

    # -- Master API: topics

    def _registerPublisher(self, caller: str, topic: str, kind: str, api: str) -> Reply:  # noqa: N802
        self._register(self.publishers, topic, caller, api)
        if kind != "*" or topic not in self._topic_types:
            self._topic_types[topic] = kind
        self._tell_subscribers(topic)
        return [SUCCESS, f"Registered [{caller}] as publisher of [{topic}]", self.subscribers.apis(topic)]

    def _unregisterPublisher(self, caller: str, topic: str, api: str) -> Reply:  # noqa: N802
        reply = self._unregister(self.publishers, topic, caller, api)
        if reply[2]:
            self._tell_subscribers(topic)
        return reply

    def _registerSubscriber(self, caller: str, topic: str, kind: str, api: str) -> Reply:  # noqa: N802
        self._register(self.subscribers, topic, caller, api)
        if kind != "*":
            self._topic_types.setdefault(topic, kind)
        return [SUCCESS, f"Subscribed to [{topic}]", self.publishers.apis(topic)]

    def _unregisterSubscriber(self, caller: str, topic: str, api: str) -> Reply:  # noqa: N802
        return self._unregister(self.subscribers, topic, caller, api)

    # -- Master API: services

    def _registerService(self, caller: str, service: str, uri: str, api: str) -> Reply:  # noqa: N802
        self._register(self.services, service, caller, api)
        self._service_uris[service] = (caller, uri)
        return [SUCCESS, f"Registered [{caller}] as provider of [{service}]", 1]

    def _unregisterService(self, caller: str, service: str, uri: str) -> Reply:  # noqa: N802
        if caller not in self._apis:
            return [SUCCESS, f"[{caller}] is not a registered node", 0]
        if self._service_uris.get(service) != (caller, uri):
            self._forget_if_idle(caller)
            return [SUCCESS, f"[{uri}] is not the current service URI of [{service}]", 0]
        del self._service_uris[service]
        self.services.remove(service, (caller, self._apis[caller]))
        self._forget_if_idle(caller)
        return [SUCCESS, f"Unregistered [{caller}] as provider of [{service}]", 1]

    def _lookupService(self, caller: str, service: str) -> Reply:  # noqa: N802
        known = self._service_uris.get(service)
        if known is None:
            return [ERROR, "no provider", ""]
        return [SUCCESS, f"rosrpc URI: [{known[1]}]", known[1]]

    # -- Master API: graph

    def _lookupNode(self, caller: str, name: str) -> Reply:  # noqa: N802
        api = self._apis.get(name)
        return [ERROR, f"unknown node [{name}]", ""] if api is None else [SUCCESS, "node api", api]

    def _getPublishedTopics(self, caller: str, subgraph: str) -> Reply:  # noqa: N802
        if subgraph and not subgraph.endswith("/"):
            subgraph += "/"
        topics = [name for name in self.publishers.names() if name.startswith(subgraph)]
        return [SUCCESS, "current topics", [[name, self._topic_types[name]] for name in topics]]

    def _getTopicTypes(self, caller: str) -> Reply:  # noqa: N802
        return [SUCCESS, "current system state", [[name, kind] for name, kind in self._topic_types.items()]]

    def _getSystemState(self, caller: str) -> Reply:  # noqa: N802
        state = [registry.state() for registry in (self.publishers, self.subscribers, self.services)]
        return [SUCCESS, "current system state", state]

    def _getUri(self, caller: str) -> Reply:  # noqa: N802
        return [SUCCESS, "", self.uri]

    def _getPid(self, caller: str) -> Reply:  # noqa: N802
        return [SUCCESS, "", self.pid]

    def _shutdown(self, caller: str, reason: Any) -> Reply:
        self.stopping = True
        return [SUCCESS, "shutdown", 0]

    # -- Parameter Server API

    def _setParam(self, caller: str, key: str, value: Any) -> Reply:  # noqa: N802
        try:
            self.parameters.set(key, value)
        except ValueError as error:
            raise InvalidArgumentError(str(error)) from None
        self._tell_parameter(key, value, False, caller)
        return [SUCCESS, f"parameter {key} set", 0]

    def _deleteParam(self, caller: str, key: str) -> Reply:  # noqa: N802
        try:
            self.parameters.delete(key)
        except KeyError:
            return [ERROR, f"parameter [{key}] is not set", 0]
        self._tell_parameter(key, {}, True, "")
        return [SUCCESS, f"parameter {key} deleted", 0]

    def _getParam(self, caller: str, key: str) -> Reply:  # noqa: N802
        try:
            return [SUCCESS, f"Parameter [{key}]", self.parameters.get(key)]
        except KeyError:
            return [ERROR, f"Parameter [{key}] is not set", 0]

    def _hasParam(self, caller: str, key: str) -> Reply:  # noqa: N802
        return [SUCCESS, key, self.parameters.has(key)]

    def _getParamNames(self, caller: str) -> Reply:  # noqa: N802
        return [SUCCESS, "Parameter names", self.parameters.names()]

    def _searchParam(self, caller: str, key: str) -> Reply:  # noqa: N802
        found = self.parameters.search(caller, key)
        if found is None:
            return [ERROR, f"Cannot find parameter [{key}] in an upwards search", ""]
        return [SUCCESS, f"Found [{found}]", found]

    def _subscribeParam(self, caller: str, api: str, key: str) -> Reply:  # noqa: N802
        self._register(self.parameter_subscribers, subscription_key(key), caller, api)
        value = self.parameters.get(key) if self.parameters.has(key) else {}
        return [SUCCESS, f"Subscribed to parameter [{key}]", value]

    def _unsubscribeParam(self, caller: str, api: str, key: str) -> Reply:  # noqa: N802
        self._unregister(self.parameter_subscribers, subscription_key(key), caller, api)
        return [SUCCESS, f"Unsubscribe to parameter [{key}]", 1]

    def _tell_parameter(self, key: str, value: Any, deleted: bool, setter: str) -> None:
        """Tell the subscribers what changed; the setter knows its own change."""
        for name, changed, told in changes(self.parameter_subscribers.names(), key, value, deleted):
            for node, api in self.parameter_subscribers.nodes(name):
                if node != setter or changed != subscription_key(key):
                    params = ["/master", changed, told]
                    self._notifications.append(Notification(api, "paramUpdate", changed, params))


# -- arguments: each check returns the value that the method gets, or raises InvalidArgumentError


def resolve(name: str, caller: str) -> str:
    """The global form of `name` for the node `caller`; as lenient as rosmaster."""
    if not name:
        return namespace_of(caller)
    name = canonical(name)
    if name.startswith("/"):
        return name
    if name.startswith("~"):
        return canonical(f"{caller}/{name[1:]}")
    return namespace_of(caller) + name


def _check_node(value: Any, caller: str) -> str:
    if not isinstance(value, str) or not value:
        raise InvalidArgumentError("a name must be a non-empty string")
    if ":" in value or " " in value:
        raise InvalidArgumentError(f"{value!r} is no name")
    return resolve(value, caller)


def _check_name(value: Any, caller: str) -> str:
    if value == "/":
        raise InvalidArgumentError("the global namespace is no topic or service")
    return _check_node(value, caller)


def _check_subgraph(value: Any, caller: str) -> str:
    if not isinstance(value, str):
        raise InvalidArgumentError("a subgraph must be a string")
    return resolve(value, caller) if value else ""


def _check_type(value: Any, caller: str) -> str:
    if not isinstance(value, str) or (value != "*" and value.count("/") != 1):
        raise InvalidArgumentError(f"{value!r} is no type: expected package/Name or *")
    return value


def _check_api(value: Any, caller: str) -> str:
    if not isinstance(value, str) or not value.startswith(("http://", "rosrpc://")):
        raise InvalidArgumentError(f"{value!r} is no http:// or rosrpc:// URI")
    return value


def _check_search(value: Any, caller: str) -> str:
    if not isinstance(value, str) or not value:
        raise InvalidArgumentError("a parameter's key must be a non-empty string")
    return value


def _check_key(value: Any, caller: str) -> str:
    return resolve(_check_search(value, caller), caller)


def _check_value(value: Any, caller: str) -> Any:
    if value is None:
        raise InvalidArgumentError("a parameter's value must not be nil")
    return value


def _check_nothing(value: Any, caller: str) -> Any:
    return value


CHECKS: dict[str, Callable[[Any, str], Any]] = {
    "name": _check_name,
    "node": _check_node,
    "subgraph": _check_subgraph,
    "type": _check_type,
    "api": _check_api,
    "key": _check_key,
    "search": _check_search,
    "value": _check_value,
    "any": _check_nothing,
}

API: dict[str, tuple[tuple[str, ...], Any]] = {
    "registerService": (("name", "api", "api"), 0),
    "unregisterService": (("name", "api"), 0),
    "lookupService": (("name",), ""),
    "registerSubscriber": (("name", "type", "api"), []),
    "unregisterSubscriber": (("name", "api"), 0),
    "registerPublisher": (("name", "type", "api"), []),
    "unregisterPublisher": (("name", "api"), 0),
    "lookupNode": (("node",), ""),
    "getPublishedTopics": (("subgraph",), 0),
    "getTopicTypes": ((), []),
    "getSystemState": ((), [[], [], []]),
    "getUri": ((), ""),
    "getPid": ((), -1),
    "shutdown": (("any",), 0),
    "setParam": (("key", "value"), 0),
    "getParam": (("key",), 0),
    "deleteParam": (("key",), 0),
    "hasParam": (("key",), False),
    "searchParam": (("search",), 0),
    "getParamNames": ((), []),
    "subscribeParam": (("api", "key"), 0),
    "unsubscribeParam": (("api", "key"), 0),
}
"""Each method: the kinds of its parameters after the caller's name, and the value of its answer where it
fails.
"""
