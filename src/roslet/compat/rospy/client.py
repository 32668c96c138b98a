"""`rospy.client`: init_node, spin, parameters, waiting for a message."""

from __future__ import annotations

import sys
import threading
import time
from typing import TYPE_CHECKING, Any

from roslet.compat import master
from roslet.compat.begin import begin_node
from roslet.compat.rospy import core, names
from roslet.compat.rospy.exceptions import ROSException, ROSInitException, ROSInterruptException
from roslet.compat.rospy.msproxy import MasterProxy
from roslet.compat.rospy.topics import Subscriber
from roslet.compat.session import session
from roslet.errors import Fault, InvalidMessage, ParameterNotSet
from roslet.node.log import DEBUG, ERROR, FATAL, INFO, WARN

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

# Seconds between two looks for a shutdown in `spin`, whose waiting a signal interrupts anyway.
LOOK = 0.5
# Seconds between two looks for a shutdown while a message is waited for.
LOOK_MESSAGE = 0.02


class _Unspecified:
    """Stands for a default that was not given."""


_unspecified: Any = _Unspecified()


def myargv(argv: Sequence[str] | None = None) -> list[str]:
    """The command line without remappings and private parameters; sys.argv by default."""
    return [argument for argument in (sys.argv if argv is None else argv) if names.REMAP not in argument]


def init_node(
    name: str,
    argv: Sequence[str] | None = None,
    anonymous: bool = False,
    log_level: int | None = None,
    disable_rostime: bool = False,
    disable_rosout: bool = False,
    disable_signals: bool = False,
    xmlrpc_port: int = 0,
    tcpros_port: int = 0,
) -> None:
    """Make the program's node and register it with the master, for which it waits.

    argv             remappings and the like, with the program's name first; sys.argv by default
    anonymous        append something to the name that no other node has
    log_level        DEBUG, INFO, WARN, ERROR or FATAL
    disable_rostime  use the system's time even where /use_sim_time is true
    disable_rosout   do not publish the log on /rosout
    disable_signals  leave SIGINT and SIGTERM to the program; needed outside the main thread

    Raises ValueError for a name that is none, ROSException for a second call with other arguments, ROSInitException where
    a signal ends the wait for the master, NotImplementedError for `xmlrpc_port` and `tcpros_port`.
    """
    if not name:
        raise ValueError("name must not be empty")
    if names.SEP in name:
        raise ValueError("namespaces are not allowed in node names")
    if xmlrpc_port or tcpros_port:
        raise NotImplementedError("roslet run: xmlrpc_port and tcpros_port cannot be chosen")
    arguments = list(sys.argv if argv is None else argv)
    given = (name, arguments, anonymous, log_level, disable_rostime, disable_signals)
    if session.initialized:
        if session.init_arguments != given:
            raise ROSException(
                f"rospy.init_node() has already been called with different arguments: {session.init_arguments}"
            )
        return
    session.init_arguments = given
    try:
        begin_node(name, arguments, anonymous, log_level, disable_rostime, disable_rosout, disable_signals)
    except KeyboardInterrupt:
        raise ROSInitException("init_node interrupted before it could complete") from None


def spin() -> None:
    """Wait until the node is shut down; callbacks run in their own threads. Raises ROSInitException before init_node."""
    if not session.initialized:
        raise ROSInitException("client code must call rospy.init_node() first")
    try:
        while not session.shutting_down.wait(LOOK):
            pass
    except KeyboardInterrupt:
        core.signal_shutdown("keyboard interrupt")
    session.wait_for_end()


def on_shutdown(h: Callable[[], object]) -> None:
    """Call `h()` when the node ends. Raises TypeError for what cannot be called."""
    core.add_client_shutdown_hook(h)


def get_master(env: dict[str, str] | None = None) -> MasterProxy:
    """The master. With `env`, that of its ROS_MASTER_URI."""
    return MasterProxy(env["ROS_MASTER_URI"] if env and "ROS_MASTER_URI" in env else master.uri())


def get_published_topics(namespace: str = "/") -> list[list[str]]:
    """Every published topic of the namespace as [topic, type]."""
    return [list(pair) for pair in master.call("getPublishedTopics", namespace)]


# -- parameters


def get_param(param_name: str, default: Any = _unspecified) -> Any:
    """A parameter, or a dictionary of all below a namespace. Raises KeyError where there is none and no default."""
    try:
        return master.call("getParam", names.resolve_name(param_name))
    except Fault:
        if default is _unspecified:
            raise KeyError(param_name) from None
        return default


def get_param_cached(param_name: str, default: Any = _unspecified) -> Any:
    """The same, asking the master only once: it tells of changes from then on. Before init_node it asks every time."""
    node = session.node
    if node is None:
        return get_param(param_name, default)
    name = names.resolve_name(param_name)
    known = node._ros1("rospy").engine.parameters.get(name, _unspecified)
    if known is _unspecified:
        known = node.on_parameter(name, _ignore)
    # An empty dictionary is how the master says that there is none.
    if known == {} and isinstance(known, dict):
        if default is _unspecified:
            raise KeyError(param_name)
        return default
    return known


def _ignore(value: object) -> None:
    """The cache is kept by the node."""


def get_param_names() -> list[str]:
    """The full names of all parameters."""
    return [str(name) for name in master.call("getParamNames")]


def set_param(param_name: str, param_value: Any) -> None:
    """Set a parameter; a dictionary sets a namespace. Raises TypeError for a value that the master cannot hold,
    OverflowError for an integer of more than 32 bits."""
    _check_integers(param_value)
    name = names.resolve_name(param_name)
    try:
        master.call("setParam", name, param_value)
    except InvalidMessage as error:
        raise TypeError(str(error)) from None
    _refresh(name)


def _check_integers(value: Any) -> None:
    if isinstance(value, int) and not -(1 << 31) <= value < 1 << 31:
        raise OverflowError("int exceeds XML-RPC limits")
    if isinstance(value, dict):
        for inner in value.values():
            _check_integers(inner)
    elif isinstance(value, (list, tuple)):
        for inner in value:
            _check_integers(inner)


def _refresh(name: str) -> None:
    """Bring the cache up to date: the master does not tell us of what we change ourselves."""
    node = session.node
    if node is None:
        return
    for key in list(node._ros1("rospy").engine.parameters):
        if (key + "/").startswith(name + "/") or (name + "/").startswith(key + "/"):
            node._ros1("rospy").engine.parameters[key] = get_param(key, {})


def search_param(param_name: str) -> str | None:
    """The full name of the nearest parameter of the name, from this node's namespace upwards; None if there is none."""
    try:
        found = master.call("searchParam", param_name)
    except Fault:
        return None
    return str(found) if found else None


def delete_param(param_name: str) -> None:
    """Raises KeyError where there is no such parameter."""
    try:
        master.call("deleteParam", names.resolve_name(param_name))
    except (Fault, ParameterNotSet):
        raise KeyError(param_name) from None
    _refresh(names.resolve_name(param_name))


def has_param(param_name: str) -> bool:
    return bool(master.call("hasParam", names.resolve_name(param_name)))


# -- waiting


def wait_for_message(topic: str, topic_type: Any, timeout: Any = None) -> Any:
    """The next message of a topic.

    Raises ROSException after `timeout` (seconds, or a Duration), ROSInterruptException on shutdown.
    """
    if hasattr(timeout, "to_sec"):
        timeout = timeout.to_sec()
    heard: list[Any] = []
    ready = threading.Event()

    def callback(message: Any) -> None:
        heard.append(message)
        ready.set()

    subscriber = Subscriber(topic, topic_type, callback)
    try:
        end = None if timeout is None else time.monotonic() + timeout
        while not session.shutting_down.is_set() and not heard:
            left = LOOK_MESSAGE if end is None else min(LOOK_MESSAGE, end - time.monotonic())
            if left <= 0:
                raise ROSException(
                    f"timeout exceeded while waiting for message on topic {subscriber.resolved_name}"
                )
            ready.wait(left)
    finally:
        subscriber.unregister()
    if session.shutting_down.is_set() and not heard:
        raise ROSInterruptException("rospy shutdown")
    return heard[0]


__all__ = [
    "DEBUG",
    "ERROR",
    "FATAL",
    "INFO",
    "WARN",
    "delete_param",
    "get_master",
    "get_param",
    "get_param_cached",
    "get_param_names",
    "get_published_topics",
    "has_param",
    "init_node",
    "myargv",
    "on_shutdown",
    "search_param",
    "set_param",
    "spin",
    "wait_for_message",
]
