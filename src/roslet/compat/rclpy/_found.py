"""Names that programs find in modules of rclpy that have only imported them: `from rclpy.action.client import GoalStatus`.

Ours import less; what a program asks for is found when it does.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any, TypeVar

from roslet.compat.interfaces import message_class

if TYPE_CHECKING:
    from types import ModuleType

_PREFIX = "roslet.compat.rclpy."

# Module of ours, or interfaces -> the names that are there.
_THERE = {
    "callback_groups": "CallbackGroup",
    "client": "Client",
    "clock": "Clock",
    "clock_type": "ClockType",
    "context": "Context",
    "event_handler": "EventHandler PublisherEventCallbacks SubscriptionEventCallbacks",
    "exceptions": (
        "InvalidHandle InvalidParameterTypeException InvalidParameterValueException "
        "InvalidTopicNameException NoTypeSupportImportedException NodeNameNonExistentError "
        "ParameterAlreadyDeclaredException ParameterImmutableException ParameterNotDeclaredException "
        "ParameterUninitializedException TimerCancelledError"
    ),
    "executors": "Executor await_or_execute",
    "expand_topic_name": "expand_topic_name",
    "guard_condition": "GuardCondition",
    "impl.logging_severity": "LoggingSeverity",
    "impl.rcutils_logger": "RcutilsLogger",
    "logging": "get_logger",
    "logging_service": "LoggingService",
    "node": "Node",
    "parameter": "Parameter",
    "publisher": "Publisher",
    "qos": (
        "QoSDurabilityPolicy QoSHistoryPolicy QoSLivelinessPolicy QoSPresetProfiles QoSProfile "
        "QoSReliabilityPolicy qos_policy_name_from_kind qos_profile_services_default"
    ),
    "qos_overriding_options": "QoSOverridingOptions",
    "service": "Service",
    "subscription": "MessageInfo Subscription",
    "task": "Future Task",
    "timer": "Timer TimerInfo",
    "topic_endpoint_info": "TopicEndpointInfo",
    "type_support": "Action check_for_type_support check_is_valid_srv_type",
    "utilities": "get_default_context timeout_sec_to_nsec",
    "validate_full_topic_name": "validate_full_topic_name",
    "validate_parameter_name": "validate_parameter_name",
    "waitable": "NumberOfEntities Waitable",
    "action_msgs/msg": "GoalInfo GoalStatus GoalStatusArray",
    "action_msgs/srv": "CancelGoal",
    "builtin_interfaces/msg": "Time",
    "rcl_interfaces/msg": (
        "FloatingPointRange IntegerRange ListParametersResult LoggerLevel ParameterDescriptor "
        "ParameterEvent ParameterType ParameterValue SetLoggerLevelsResult SetParametersResult"
    ),
    "rcl_interfaces/srv": (
        "DescribeParameters GetLoggerLevels GetParameterTypes GetParameters ListParameters "
        "SetLoggerLevels SetParameters SetParametersAtomically"
    ),
    "service_msgs/msg": "ServiceEventInfo",
    "unique_identifier_msgs/msg": "UUID",
}
# Those that are called otherwise where they are.
_OTHERWISE = {
    "Msg": ("type_support", "Message"),
    "ParameterMsg": ("rcl_interfaces/msg", "Parameter"),
    "QoSEventHandler": ("event_handler", "EventHandler"),
    "Srv": ("type_support", "Service"),
}
# Type variables, for annotations.
_VARIABLES = {
    "ActionT",
    "AllowableParameterValueT",
    "FeedbackT",
    "GoalT",
    "MsgT",
    "MsgType",
    "ResultT",
    "SrvRequestT",
    "SrvResponseT",
    "SrvT",
    "SrvType",
    "SrvTypeRequest",
    "SrvTypeResponse",
}
# Module -> the names that programs find there too.
_FOUND = {
    "action.client": (
        "Action CancelGoal Clock FeedbackT GoalStatus GoalStatusArray GoalT NumberOfEntities ResultT "
        "Time UUID Waitable await_or_execute check_for_type_support"
    ),
    "action.graph": "Node",
    "action.server": (
        "Action CancelGoal Clock FeedbackT Future GoalInfo GoalStatus GoalT NumberOfEntities ResultT "
        "Task UUID Waitable check_for_type_support"
    ),
    "client": (
        "CallbackGroup Clock Context QoSProfile Srv SrvRequestT SrvResponseT SrvType SrvTypeRequest "
        "SrvTypeResponse"
    ),
    "clock": "Context get_default_context",
    "event_handler": "CallbackGroup NumberOfEntities QoSEventHandler Waitable qos_policy_name_from_kind",
    "executors": (
        "Client Clock ClockType Context GuardCondition InvalidHandle MessageInfo Msg NumberOfEntities "
        "Service Subscription Timer TimerCancelledError TimerInfo Waitable get_default_context "
        "timeout_sec_to_nsec"
    ),
    "guard_condition": "CallbackGroup Context get_default_context",
    "impl.rcutils_logger": "Clock",
    "lifecycle.node": "CallbackGroup MsgT QoSProfile RcutilsLogger Service check_is_valid_srv_type",
    "lifecycle.publisher": "CallbackGroup MsgT MsgType PublisherEventCallbacks QoSProfile",
    "logging_service": (
        "GetLoggerLevels LoggerLevel LoggingSeverity SetLoggerLevels SetLoggerLevelsResult "
        "qos_profile_services_default"
    ),
    "node": (
        "AllowableParameterValueT Context Executor FloatingPointRange IntegerRange "
        "InvalidParameterTypeException InvalidParameterValueException InvalidTopicNameException "
        "ListParameters ListParametersResult LoggingService MessageInfo MsgT MsgType "
        "NodeNameNonExistentError ParameterAlreadyDeclaredException ParameterDescriptor ParameterEvent "
        "ParameterImmutableException ParameterMsg ParameterNotDeclaredException ParameterType "
        "ParameterUninitializedException ParameterValue RcutilsLogger SetParametersResult Srv "
        "SrvRequestT SrvResponseT SrvType SrvTypeRequest SrvTypeResponse TimerInfo TopicEndpointInfo "
        "Waitable expand_topic_name validate_full_topic_name validate_parameter_name"
    ),
    "parameter": "AllowableParameterValueT ParameterMsg ParameterType ParameterValue",
    "parameter_client": (
        "CallbackGroup Client DescribeParameters Future GetParameterTypes GetParameters ListParameters "
        "MessageInfo Node ParameterEvent ParameterMsg QoSOverridingOptions SetParameters "
        "SetParametersAtomically Subscription SubscriptionEventCallbacks"
    ),
    "parameter_event_handler": (
        "CallbackGroup Node Parameter ParameterEvent ParameterMsg QoSOverridingOptions "
        "SubscriptionEventCallbacks"
    ),
    "publisher": "CallbackGroup EventHandler MsgT MsgType PublisherEventCallbacks QoSProfile",
    "qos_event": "CallbackGroup NumberOfEntities QoSEventHandler Waitable get_logger qos_policy_name_from_kind",
    "qos_overriding_options": (
        "Parameter ParameterAlreadyDeclaredException ParameterDescriptor Publisher QoSDurabilityPolicy "
        "QoSHistoryPolicy QoSLivelinessPolicy QoSReliabilityPolicy SetParametersResult Subscription"
    ),
    "serialization": "Msg MsgT",
    "service": (
        "CallbackGroup Clock QoSProfile Srv SrvRequestT SrvResponseT SrvType SrvTypeRequest SrvTypeResponse"
    ),
    "signals": "GuardCondition InvalidHandle",
    "subscription": "CallbackGroup EventHandler MsgT MsgType QoSProfile SubscriptionEventCallbacks",
    "time_source": "ClockType Parameter SetParametersResult",
    "timer": "CallbackGroup Context get_default_context",
    "topic_endpoint_info": "QoSHistoryPolicy QoSPresetProfiles",
    "type_support": (
        "ActionT FeedbackT GoalT Msg MsgT NoTypeSupportImportedException ResultT ServiceEventInfo Srv "
        "SrvRequestT SrvResponseT SrvT Time UUID"
    ),
    "wait_for_message": "MsgT Node timeout_sec_to_nsec",
}
_HOMES = {name: (home, name) for home, names in _THERE.items() for name in names.split()} | _OTHERWISE


def complete(module: ModuleType) -> None:
    """Give a module of `roslet.compat.rclpy` the names that it lacks."""
    names = _FOUND.get(module.__name__.removeprefix(_PREFIX), "").split()
    own = vars(module).get("__getattr__")

    def get(name: str) -> Any:
        if name not in names:
            if own is not None:
                return own(name)
            raise AttributeError(f"module {module.__name__!r} has no attribute {name!r}")
        found = _find(name)
        setattr(module, name, found)
        return found

    if names:
        module.__getattr__ = get  # type: ignore[method-assign]


def _find(name: str) -> Any:
    if name in _VARIABLES:
        return TypeVar(name)
    home, name = _HOMES[name]
    if "/" in home:
        return message_class(f"{home}/{name}")
    return getattr(importlib.import_module(_PREFIX + home), name)


__all__ = ["complete"]
