"""`rclpy.node`: the node."""

from __future__ import annotations

import weakref
from typing import TYPE_CHECKING, Any

from roslet.compat.interfaces import message_class
from roslet.compat.rclpy._best import fitting
from roslet.compat.rclpy._entity import Entity
from roslet.compat.rclpy._graph import GraphOfNode
from roslet.compat.rclpy._names import expand
from roslet.compat.rclpy._network import Inner, logger_name, merged
from roslet.compat.rclpy._parameters import NodeParameters, ParametersOfNode
from roslet.compat.rclpy.callback_groups import (
    CallbackGroup,
    MutuallyExclusiveCallbackGroup,
    ReentrantCallbackGroup,
)
from roslet.compat.rclpy.client import Client
from roslet.compat.rclpy.clock import Clock, ROSClock
from roslet.compat.rclpy.constants import S_TO_NS
from roslet.compat.rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from roslet.compat.rclpy.exceptions import InvalidHandle, NotInitializedException, RCLError
from roslet.compat.rclpy.guard_condition import GuardCondition
from roslet.compat.rclpy.impl import rcutils_logger
from roslet.compat.rclpy.logging import get_logger
from roslet.compat.rclpy.parameter import PARAMETER_SEPARATOR_STRING, Parameter
from roslet.compat.rclpy.publisher import Publisher
from roslet.compat.rclpy.qos import (
    QoSProfile,
    qos_profile_parameter_events,
    qos_profile_rosout_default,
    qos_profile_services_default,
)
from roslet.compat.rclpy.qos_overriding_options import QoSOverridingOptions, declare_qos_parameters
from roslet.compat.rclpy.service import Requests, Service
from roslet.compat.rclpy.subscription import Subscription
from roslet.compat.rclpy.time_source import TimeSource
from roslet.compat.rclpy.timer import Rate, Timer
from roslet.compat.rclpy.type_support import (
    check_is_valid_msg_type,
    check_is_valid_srv_type,
)
from roslet.compat.rclpy.utilities import get_default_context
from roslet.compat.rclpy.validate_namespace import validate_namespace
from roslet.compat.rclpy.validate_node_name import validate_node_name
from roslet.compat.rclpy.validate_topic_name import validate_topic_name
from roslet.errors import InvalidName, NodeClosed
from roslet.names import REQUEST, TOPIC, resolve_ros2
from roslet.node.ros2 import descriptions
from roslet.wire.tcpros import MAX_FRAME

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence
    from types import TracebackType

    from typing_extensions import Self

    from roslet.compat.rclpy.context import Context
    from roslet.compat.rclpy.executors import Executor
    from roslet.compat.rclpy.impl.rcutils_logger import RcutilsLogger

HIDDEN_NODE_PREFIX = "_"
_DESCRIBE = "start_type_description_service"


class Node(ParametersOfNode, GraphOfNode):
    """A node. Subclass it, or make it by `rclpy.create_node`; as a context manager it is destroyed at the end.

    context                       the default one where None
    cli_args                      arguments of this node alone, before those of the program
    namespace                     what relative names are in
    use_global_arguments          whether the program's arguments hold for it
    enable_rosout                 whether its log goes to /rosout, with `rosout_qos_profile`
    start_parameter_services      whether others can ask for and set its parameters
    parameter_overrides           values that win over those of declarations
    allow_undeclared_parameters   whether parameters can be set that are not declared
    automatically_declare_parameters_from_overrides   whether what the overrides name is declared
    enable_logger_service         whether others can ask for and set the levels of its loggers

    Raises NotInitializedException, InvalidNodeNameException, InvalidNamespaceException.
    """

    PARAM_REL_TOL = 1e-6

    def __init__(
        self,
        node_name: str,
        *,
        context: Context | None = None,
        cli_args: Sequence[str] | None = None,
        namespace: str | None = None,
        use_global_arguments: bool = True,
        enable_rosout: bool = True,
        rosout_qos_profile: QoSProfile | int = qos_profile_rosout_default,
        start_parameter_services: bool = True,
        parameter_overrides: Sequence[Parameter] | None = None,
        allow_undeclared_parameters: bool = False,
        automatically_declare_parameters_from_overrides: bool = False,
        enable_logger_service: bool = False,
    ) -> None:
        self._context = get_default_context() if context is None else context
        if not self._context.ok():
            raise NotInitializedException("cannot create node")
        validate_node_name(node_name)
        namespace = namespace or "/"
        namespace = namespace if namespace.startswith("/") else "/" + namespace
        validate_namespace(namespace)
        self._node_destroyed = False
        self._node_executor: weakref.ref[Executor] | None = None
        self._publishers: list[Publisher] = []
        self._node_entity_lists: dict[type, list[Any]] = {
            kind: [] for kind in (Subscription, Client, Service, Timer, GuardCondition, Entity)
        }
        self._node_polled: tuple[Entity, ...] = ()
        self._node_order: dict[Entity, int] = {}
        self._node_active: set[Entity] = set()  # those that have notified and may be ready
        self._node_rates: list[Rate] = []
        self._node_set_callbacks = {}
        self._default_callback_group = MutuallyExclusiveCallbackGroup()
        self._rate_group = ReentrantCallbackGroup()
        self._node_own_group = ReentrantCallbackGroup()
        self._node_validate_qos(rosout_qos_profile)
        try:
            arguments = merged(
                self._context.arguments.ros if use_global_arguments else None, list(cli_args or [])
            )
            self._node_inner = Inner(node_name, namespace, self._context.get_domain_id(), arguments)
        except InvalidName as error:
            raise RCLError(f"failed to create a node: {error}") from None
        self._node_network = self._node_inner.network_of
        self._node_logger_name = logger_name(self._node_network.name)
        self._node_sink: Any = None
        self._context.track_node(self)
        overrides = {
            **self._node_network.arguments_overrides(),
            **{one.name: one.value for one in parameter_overrides or ()},
        }
        self._node_network.parameters = NodeParameters(
            self._node_network, overrides, allow_undeclared_parameters
        )
        self._clock = ROSClock()
        self._node_inner.clock_of = self._clock
        if enable_rosout and self._node_network.arguments.switches.get("rosout-logs", True):
            self._node_log_to_rosout(self._node_validate_qos(rosout_qos_profile))
        events = self.create_publisher(
            message_class("rcl_interfaces/msg/ParameterEvent"),
            "/parameter_events",
            qos_profile_parameter_events,
        )
        self._node_network.parameters._events = events._endpoint
        if automatically_declare_parameters_from_overrides:
            describe = message_class("rcl_interfaces/msg/ParameterDescriptor")
            self.declare_parameters(
                "",
                [(name, value, describe(dynamic_typing=True)) for name, value in overrides.items()],
                ignore_override=True,
            )
        self._time_source = TimeSource(node=self)
        self._time_source.attach_clock(self._clock)
        if start_parameter_services:
            for service in self._node_network.parameters.serve(self._node_own_group):
                self._node_adopt(Entity, service)
        self._node_offer_descriptions()
        if enable_logger_service:
            from roslet.compat.rclpy.logging_service import LoggingService

            self._node_logging_service = LoggingService(self)

    def _node_offer_descriptions(self) -> None:
        if not self.has_parameter(_DESCRIBE):
            describe = message_class("rcl_interfaces/msg/ParameterDescriptor")
            self.declare_parameter(_DESCRIBE, True, describe(read_only=True))
        if self.get_parameter(_DESCRIBE).value:
            endpoint: Any = self._node_network.service(
                self._node_network.own_service("get_type_description"),
                message_class(descriptions.SERVICE),
                descriptions.describe,
            )
            self._node_adopt(Entity, Requests(endpoint, self._node_own_group, None))

    def _node_log_to_rosout(self, qos: QoSProfile) -> None:
        kind = message_class("rcl_interfaces/msg/Log")
        publisher = self._node_network.publisher(self._node_network.resolve("/rosout"), kind, qos.to_roslet())

        def sink(level: int, name: str, text: str, file: str, function: str, line: int, now: int) -> None:
            entry = kind(level=level, name=name, msg=text, file=file, function=function, line=line)
            entry.stamp.sec, entry.stamp.nanosec = divmod(now, S_TO_NS)
            try:
                publisher.publish(entry)
            except NodeClosed:
                return

        self._node_sink = sink
        rcutils_logger.add_sink(self._node_logger_name, sink)

    # -- what it is

    def _node_check(self) -> None:
        if self._node_destroyed:
            raise InvalidHandle()

    def get_name(self) -> str:
        """Its name, without the namespace. Raises InvalidHandle once it is destroyed, as all that follows."""
        self._node_check()
        return self._node_network.base_name

    def get_namespace(self) -> str:
        """Its namespace."""
        self._node_check()
        return self._node_network.namespace

    def get_fully_qualified_name(self) -> str:
        """Namespace and name."""
        self._node_check()
        return self._node_network.name

    def get_logger(self) -> RcutilsLogger:
        """Its logger."""
        return get_logger(self._node_logger_name)

    def get_clock(self) -> Clock:
        """Its clock: the system's time, or that of /clock where the parameter use_sim_time is true."""
        return self._clock

    @property
    def context(self) -> Context:  # type: ignore[override]
        """The context it belongs to."""
        return self._context

    @property
    def default_callback_group(self) -> CallbackGroup:
        """The group of what names none: one callback at a time."""
        return self._default_callback_group

    @property
    def executor(self) -> Executor | None:
        """The executor that runs its callbacks."""
        return None if self._node_executor is None else self._node_executor()

    @executor.setter
    def executor(self, new_executor: Executor | None) -> None:
        current = self.executor
        if current is new_executor:
            return
        if current is not None:
            current.remove_node(self)
        self._node_executor = None if new_executor is None else weakref.ref(new_executor)
        if new_executor is not None:
            new_executor.add_node(self)

    def _wake_executor(self) -> None:
        executor = self.executor
        if executor is not None:
            executor.wake()

    @property
    def publishers(self) -> Iterator[Publisher]:
        """Its publishers; likewise the following."""
        yield from list(self._publishers)

    @property
    def subscriptions(self) -> Iterator[Subscription]:
        yield from list(self._node_entity_lists[Subscription])

    @property
    def clients(self) -> Iterator[Client]:
        yield from list(self._node_entity_lists[Client])

    @property
    def services(self) -> Iterator[Service]:
        yield from list(self._node_entity_lists[Service])

    @property
    def timers(self) -> Iterator[Timer]:
        yield from list(self._node_entity_lists[Timer])

    @property
    def guards(self) -> Iterator[GuardCondition]:
        yield from list(self._node_entity_lists[GuardCondition])

    @property
    def waitables(self) -> Iterator[Entity]:
        yield from list(self._node_entity_lists[Entity])

    # -- what executors run

    def _node_entities(self) -> Iterable[Entity]:
        """Those that may be ready, in the order in which they are to run."""
        active = self._node_active
        if not active:
            return self._node_polled
        found = []
        for entity in list(active):
            # First: what notifies from here on is looked at again.
            active.discard(entity)
            if entity._ready():
                active.add(entity)
                found.append(entity)
        order = self._node_order
        return [*self._node_polled, *sorted(found, key=lambda entity: order.get(entity, 0))]

    def _node_adopt(self, kind: type, entity: Any) -> Any:
        entity._belongs_to(self)
        self._node_entity_lists[kind].append(entity)
        if not entity._polled:
            self._node_active.add(entity)
        self._node_refresh()
        return entity

    def _node_disown(self, kind: type, entity: Any) -> bool:
        if entity not in self._node_entity_lists[kind]:
            return False
        self._node_entity_lists[kind].remove(entity)
        self._node_drop_handlers(entity)
        entity.destroy()
        self._node_refresh()
        return True

    def _node_drop_handlers(self, owner: Any) -> None:
        for handler in getattr(owner, "event_handlers", ()):
            self._node_entity_lists[Entity].remove(handler)

    def _node_refresh(self) -> None:
        order = (Timer, Subscription, GuardCondition, Client, Service, Entity)
        entities = [entity for kind in order for entity in self._node_entity_lists[kind]]
        self._node_polled = tuple(entity for entity in entities if entity._polled)
        self._node_order = {entity: number for number, entity in enumerate(entities)}
        self._wake_executor()

    def add_waitable(self, waitable: Any) -> None:
        """Have the executor ask this waitable too."""
        self._node_adopt(Entity, waitable)

    def remove_waitable(self, waitable: Any) -> None:
        """Ask it no more."""
        self._node_entity_lists[Entity].remove(waitable)
        self._node_refresh()

    # -- names

    def resolve_topic_name(self, topic: str, *, only_expand: bool = False) -> str:
        """A topic's full name here, remappings applied unless `only_expand`."""
        return self._node_resolve(topic, TOPIC, only_expand)

    def resolve_service_name(self, service: str, *, only_expand: bool = False) -> str:
        """A service's full name here."""
        return self._node_resolve(service, REQUEST, only_expand)

    def _node_resolve(self, name: str, kind: str, only_expand: bool = False) -> str:
        self._node_check()
        validate_topic_name(name, is_service=kind == REQUEST)
        network = self._node_network
        try:
            if only_expand:
                return expand(name, network.base_name, network.namespace)
            return resolve_ros2(
                name, network.base_name, network.namespace, network.arguments.remappings, kind
            )
        except (InvalidName, ValueError) as error:
            raise RCLError(f"failed to resolve {name}: {error}") from None

    @staticmethod
    def _node_validate_qos(qos_or_depth: QoSProfile | int) -> QoSProfile:
        if isinstance(qos_or_depth, QoSProfile):
            return qos_or_depth
        if not isinstance(qos_or_depth, int) or isinstance(qos_or_depth, bool):
            raise TypeError(f"expected a QoSProfile or a depth, not {qos_or_depth!r}")
        if qos_or_depth < 0:
            raise ValueError("history depth must be greater than or equal to zero")
        return QoSProfile(depth=qos_or_depth)

    # -- what it makes

    def create_publisher(
        self,
        msg_type: Any,
        topic: str,
        qos_profile: QoSProfile | int,
        *,
        callback_group: CallbackGroup | None = None,
        event_callbacks: PublisherEventCallbacks | None = None,
        qos_overriding_options: QoSOverridingOptions | None = None,
        publisher_class: type[Publisher] = Publisher,
    ) -> Any:
        """A publisher. Raises AttributeError where `msg_type` is no message class, InvalidTopicNameException."""
        qos = self._node_validate_qos(qos_profile)
        check_is_valid_msg_type(msg_type)
        full = self._node_resolve(topic, TOPIC)
        qos = declare_qos_parameters("publisher", self, full, qos, qos_overriding_options)
        endpoint: Any = self._node_network.publisher(
            full, msg_type, fitting(qos, self._node_network, full, True)
        )
        publisher = publisher_class(endpoint, msg_type, topic, qos, self._node_logger_name)
        callbacks = PublisherEventCallbacks() if event_callbacks is None else event_callbacks
        publisher.event_handlers = callbacks.create_event_handlers(
            callback_group or self._default_callback_group, endpoint, full, self._node_logger_name
        )
        for handler in publisher.event_handlers:
            self._node_adopt(Entity, handler)
        self._publishers.append(publisher)
        return publisher

    def create_subscription(
        self,
        msg_type: Any,
        topic: str,
        callback: Callable[..., Any],
        qos_profile: QoSProfile | int,
        *,
        callback_group: CallbackGroup | None = None,
        event_callbacks: SubscriptionEventCallbacks | None = None,
        qos_overriding_options: QoSOverridingOptions | None = None,
        raw: bool = False,
        content_filter_options: Any = None,
    ) -> Subscription:
        """A subscription: `callback(message)`, or `callback(message, info)`; with `raw` the message is its bytes.

        Raises as `create_publisher`, RuntimeError for what is no callback or asks for a content filter.
        """
        qos = self._node_validate_qos(qos_profile)
        check_is_valid_msg_type(msg_type)
        full = self._node_resolve(topic, TOPIC)
        if content_filter_options is not None:
            raise RuntimeError("roslet has no content filters")
        qos = declare_qos_parameters("subscription", self, full, qos, qos_overriding_options)
        group = callback_group or self._default_callback_group
        endpoint: Any = self._node_network.subscription(
            full, msg_type, None, fitting(qos, self._node_network, full, False), MAX_FRAME
        )
        try:
            made = Subscription(endpoint, msg_type, topic, callback, group, qos, raw, self._node_logger_name)
        except RuntimeError:
            endpoint.close()
            raise
        callbacks = SubscriptionEventCallbacks() if event_callbacks is None else event_callbacks
        made.event_handlers = callbacks.create_event_handlers(group, endpoint, full, self._node_logger_name)
        for handler in made.event_handlers:
            self._node_adopt(Entity, handler)
        self._node_adopt(Subscription, made)
        return made

    def create_client(
        self,
        srv_type: Any,
        srv_name: str,
        *,
        qos_profile: QoSProfile = qos_profile_services_default,
        callback_group: CallbackGroup | None = None,
    ) -> Client:
        """A client. Raises AttributeError where `srv_type` is no service class, InvalidServiceNameException."""
        check_is_valid_srv_type(srv_type)
        full = self._node_resolve(srv_name, REQUEST)
        endpoint = self._node_network.client(full, srv_type, qos=qos_profile.to_roslet())
        group = callback_group or self._default_callback_group
        made = Client(endpoint, self._context, srv_type, srv_name, group, qos_profile, self._node_logger_name)
        self._node_adopt(Client, made)
        return made

    def create_service(
        self,
        srv_type: Any,
        srv_name: str,
        callback: Callable[[Any, Any], Any],
        *,
        qos_profile: QoSProfile = qos_profile_services_default,
        callback_group: CallbackGroup | None = None,
    ) -> Service:
        """A service: `callback(request, response)` returns the response. Raises as `create_client`."""
        check_is_valid_srv_type(srv_type)
        full = self._node_resolve(srv_name, REQUEST)
        endpoint: Any = self._node_network.service(
            full, srv_type, lambda request: None, qos_profile.to_roslet()
        )
        group = callback_group or self._default_callback_group
        made = Service(endpoint, srv_type, srv_name, callback, group, qos_profile, self._node_logger_name)
        self._node_adopt(Service, made)
        return made

    def create_timer(
        self,
        timer_period_sec: float,
        callback: Callable[..., Any] | None,
        callback_group: CallbackGroup | None = None,
        clock: Clock | None = None,
        autostart: bool = True,
    ) -> Timer:
        """A timer: `callback()` every `timer_period_sec` seconds of its clock, the node's where None."""
        self._node_check()
        group = callback_group or self._default_callback_group
        made = Timer(
            callback,
            group,
            int(float(timer_period_sec) * S_TO_NS),
            self._clock if clock is None else clock,
            context=self._context,
            autostart=autostart,
        )
        self._node_adopt(Timer, made)
        return made

    def create_guard_condition(
        self, callback: Callable[[], Any] | None, callback_group: CallbackGroup | None = None
    ) -> GuardCondition:
        """A guard condition: `callback()` when it was triggered."""
        self._node_check()
        made = GuardCondition(callback, callback_group or self._default_callback_group, self._context)
        self._node_adopt(GuardCondition, made)
        return made

    def create_rate(self, frequency: float, clock: Clock | None = None) -> Rate:
        """A rate of so many turns a second. Raises ValueError unless it is positive."""
        if frequency <= 0:
            raise ValueError("frequency must be > 0")
        timer = self.create_timer(1.0 / frequency, None, self._rate_group, clock)
        rate = Rate(timer, context=self._context)
        self._node_rates.append(rate)
        return rate

    # -- and destroys

    def destroy_publisher(self, publisher: Publisher) -> bool:
        """Withdraw a publisher of this node; False where it is none (any more). Likewise the following."""
        if publisher not in self._publishers:
            return False
        self._publishers.remove(publisher)
        self._node_drop_handlers(publisher)
        publisher.destroy()
        self._node_refresh()
        return True

    def destroy_subscription(self, subscription: Subscription) -> bool:
        return self._node_disown(Subscription, subscription)

    def destroy_client(self, client: Client) -> bool:
        return self._node_disown(Client, client)

    def destroy_service(self, service: Service) -> bool:
        return self._node_disown(Service, service)

    def destroy_timer(self, timer: Timer) -> bool:
        return self._node_disown(Timer, timer)

    def destroy_guard_condition(self, guard: GuardCondition) -> bool:
        return self._node_disown(GuardCondition, guard)

    def destroy_rate(self, rate: Rate) -> bool:
        if rate not in self._node_rates:
            return False
        self._node_rates.remove(rate)
        self._node_disown(Timer, rate._timer)
        rate.destroy()
        return True

    def destroy_node(self) -> None:
        """Destroy all that is its own; it disappears from the graph. Twice is allowed."""
        self._node_end()

    def _node_end(self) -> None:
        """The same when its context ends, without asking a subclass."""
        if self._node_destroyed:
            return
        if self._node_sink is not None:
            rcutils_logger.remove_sink(self._node_logger_name, self._node_sink)
        self._node_destroyed = True
        self._context.untrack_node(self)
        self._node_network.follow = None
        for rate in self._node_rates:
            rate.destroy()
        for kind, entities in self._node_entity_lists.items():
            self._node_entity_lists[kind] = []
            for entity in entities:
                entity.destroy()
        publishers, self._publishers = self._publishers, []
        # Not before the node within has let out what was published.
        self._node_inner.close()
        for publisher in publishers:
            publisher.destroy()
        self._node_refresh()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        exc_type: type[BaseException] | None,
        exc_val: BaseException | None,
        exc_tb: TracebackType | None,
    ) -> None:
        self.destroy_node()

    def __repr__(self) -> str:
        return f"<{type(self).__module__}.{type(self).__name__} {self._node_network.name}>"


__all__ = [
    "HIDDEN_NODE_PREFIX",
    "PARAMETER_SEPARATOR_STRING",
    "Node",
    "NotInitializedException",
    "Parameter",
]
