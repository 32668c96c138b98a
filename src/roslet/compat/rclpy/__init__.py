"""rclpy's public names, on roslet. Found as `rclpy` under `roslet run`.

Written from rclpy's API documentation and its behaviour; FEATURES.md says what is not there and where behaviour differs.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from roslet.compat.rclpy.context import Context
from roslet.compat.rclpy.parameter import Parameter
from roslet.compat.rclpy.qos import QoSProfile, qos_profile_rosout_default
from roslet.compat.rclpy.signals import (
    SignalHandlerOptions,
    install_signal_handlers,
    uninstall_signal_handlers,
)
from roslet.compat.rclpy.task import Future
from roslet.compat.rclpy.utilities import (
    get_default_context,
    get_rmw_implementation_identifier,
    ok,
)
from roslet.compat.rclpy.utilities import shutdown as _shutdown
from roslet.compat.rclpy.utilities import try_shutdown as _try_shutdown

if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import TracebackType

    from roslet.compat.rclpy.executors import Executor


class InitContextManager:
    """What `init` returns: in a with statement, the context ends with the block."""

    def __init__(
        self,
        args: Sequence[str] | None,
        context: Context | None,
        domain_id: int | None,
        signal_handler_options: SignalHandlerOptions | None,
    ) -> None:
        default = get_default_context()
        self.context = default if context is None else context
        if signal_handler_options is None:
            mine = self.context is default
            signal_handler_options = SignalHandlerOptions.ALL if mine else SignalHandlerOptions.NO
        self._handles_signals = signal_handler_options != SignalHandlerOptions.NO
        self.context.init(args, domain_id=domain_id)
        if self._handles_signals:
            install_signal_handlers(signal_handler_options)

    def __enter__(self) -> InitContextManager:
        return self

    def __exit__(
        self,
        exc_type: type[BaseException] | None,
        exc_val: BaseException | None,
        exc_tb: TracebackType | None,
    ) -> None:
        context = None if self.context is get_default_context() else self.context
        try_shutdown(context=context, uninstall_handlers=self._handles_signals)


def init(
    *,
    args: Sequence[str] | None = None,
    context: Context | None = None,
    domain_id: int | None = None,
    signal_handler_options: SignalHandlerOptions | None = None,
) -> InitContextManager:
    """Begin: the default context where none is given, with sys.argv where no arguments are. Raises as `Context.init`."""
    return InitContextManager(args, context, domain_id, signal_handler_options)


_global_executor: Executor | None = None


def get_global_executor() -> Executor:
    """The executor of `spin` and its like where none is given."""
    global _global_executor
    if _global_executor is None:
        from roslet.compat.rclpy.executors import SingleThreadedExecutor

        _global_executor = SingleThreadedExecutor()
        get_default_context().on_shutdown(_end_global_executor)
    return _global_executor


def _end_global_executor() -> None:
    global _global_executor
    executor, _global_executor = _global_executor, None
    if executor is not None:
        # Whoever spins it is told by the context; waiting for it here could wait for ourselves.
        executor.shutdown(0)


def shutdown(*, context: Context | None = None, uninstall_handlers: bool | None = None) -> None:
    """End a context, the default one where none is given. Raises RuntimeError where it has not begun."""
    default = context is None or context is get_default_context()
    _shutdown(context=context)
    if uninstall_handlers or (uninstall_handlers is None and default):
        uninstall_signal_handlers()


def try_shutdown(*, context: Context | None = None, uninstall_handlers: bool | None = None) -> None:
    """End a context, the default one where none is given, where it runs."""
    default = context is None or context is get_default_context()
    _try_shutdown(context=context)
    if uninstall_handlers or (uninstall_handlers is None and default):
        uninstall_signal_handlers()


def create_node(
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
) -> Any:
    """A node; the arguments are those of `rclpy.node.Node`."""
    from roslet.compat.rclpy.node import Node

    return Node(
        node_name,
        context=context,
        cli_args=cli_args,
        namespace=namespace,
        use_global_arguments=use_global_arguments,
        enable_rosout=enable_rosout,
        rosout_qos_profile=rosout_qos_profile,
        start_parameter_services=start_parameter_services,
        parameter_overrides=parameter_overrides,
        allow_undeclared_parameters=allow_undeclared_parameters,
        automatically_declare_parameters_from_overrides=automatically_declare_parameters_from_overrides,
        enable_logger_service=enable_logger_service,
    )


def spin_once(node: Any, *, executor: Executor | None = None, timeout_sec: float | None = None) -> None:
    """Run one piece of work of a node; wait for it for at most `timeout_sec` seconds."""
    executor = get_global_executor() if executor is None else executor
    added = executor.add_node(node)
    try:
        executor.spin_once(timeout_sec=timeout_sec)
    finally:
        if added:
            executor.remove_node(node)


def spin(node: Any, executor: Executor | None = None) -> None:
    """Run a node's callbacks until the context ends."""
    executor = get_global_executor() if executor is None else executor
    try:
        executor.add_node(node)
        while executor.context.ok():
            executor.spin_once()
    finally:
        executor.remove_node(node)


def spin_until_future_complete(
    node: Any, future: Future[Any], executor: Executor | None = None, timeout_sec: float | None = None
) -> None:
    """Run a node's callbacks until a future is done, for at most `timeout_sec` seconds."""
    executor = get_global_executor() if executor is None else executor
    added = executor.add_node(node)
    try:
        executor.spin_until_future_complete(future, timeout_sec)
    finally:
        if added:
            executor.remove_node(node)


__all__ = [
    "Context",
    "Future",
    "InitContextManager",
    "Parameter",
    "QoSProfile",
    "SignalHandlerOptions",
    "create_node",
    "get_default_context",
    "get_global_executor",
    "get_rmw_implementation_identifier",
    "init",
    "install_signal_handlers",
    "ok",
    "qos_profile_rosout_default",
    "shutdown",
    "spin",
    "spin_once",
    "spin_until_future_complete",
    "try_shutdown",
    "uninstall_signal_handlers",
]
