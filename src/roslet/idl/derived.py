"""The interfaces that services and actions imply: ROS 1's seven action messages, ROS 2's events and action
services."""

from __future__ import annotations

from roslet.idl.records import Action, Array, Field, FieldType, Message, Service, TypeName
from roslet.idl.spelling import PRIMITIVES

TYPE_CHECKING = False
if TYPE_CHECKING:
    from roslet.idl.records import Dialect


def _nested(package: str, kind: str, name: str, array: Array | None = None) -> FieldType:
    full = TypeName(package, kind, name)  # type: ignore[arg-type]
    return FieldType(None, full, package + "/" + name, None, array)


def _fields(*pairs: tuple[str, FieldType]) -> tuple[Field, ...]:
    return tuple([Field(name, type_) for name, type_ in pairs])


_UUID = _nested("unique_identifier_msgs", "msg", "UUID")
_TIME = _nested("builtin_interfaces", "msg", "Time")


def ros2_event(service: TypeName, file: str) -> Message:
    """The service event message of REP-2012: `info`, and at most one request and one response."""
    package, kind, name = service.package, service.kind, service.name
    one = Array("bounded", 1)
    fields = _fields(
        ("info", _nested("service_msgs", "msg", "ServiceEventInfo")),
        ("request", _nested(package, kind, name + "_Request", one)),
        ("response", _nested(package, kind, name + "_Response", one)),
    )
    return Message(TypeName(package, kind, name + "_Event"), "ros2", fields, (), "", file)


def ros2_action(
    name: TypeName, goal: Message, result: Message, feedback: Message, text: str, file: str
) -> Action:
    """The action with what the design article on actions derives: two services and the feedback message."""
    package = name.package
    primitives = PRIMITIVES["ros2"]

    def message(suffix: str, *pairs: tuple[str, FieldType]) -> Message:
        return Message(TypeName(package, "action", name.name + suffix), "ros2", _fields(*pairs), (), "", file)

    def part(suffix: str) -> FieldType:
        return _nested(package, "action", name.name + suffix)

    def service(suffix: str, request: Message, response: Message) -> Service:
        full = TypeName(package, "action", name.name + suffix)
        return Service(full, "ros2", request, response, ros2_event(full, file), "", file)

    send_goal = service(
        "_SendGoal",
        message("_SendGoal_Request", ("goal_id", _UUID), ("goal", part("_Goal"))),
        message("_SendGoal_Response", ("accepted", primitives["bool"]), ("stamp", _TIME)),
    )
    get_result = service(
        "_GetResult",
        message("_GetResult_Request", ("goal_id", _UUID)),
        message("_GetResult_Response", ("status", primitives["int8"]), ("result", part("_Result"))),
    )
    feedback_message = message("_FeedbackMessage", ("goal_id", _UUID), ("feedback", part("_Feedback")))
    messages = (goal, result, feedback, feedback_message)
    return Action(name, "ros2", goal, result, feedback, (send_goal, get_result), messages, text, file)


def ros1_action(
    name: TypeName, goal: Message, result: Message, feedback: Message, text: str, file: str
) -> Action:
    """The action with the seven messages that actionlib speaks; the derived ones' text is ours, as no file
    holds it."""
    package = name.package
    dialect: Dialect = "ros1"

    def message(suffix: str, *lines: tuple[str, str, FieldType]) -> Message:
        body = "".join([f"{spelled} {field_name}\n" for spelled, field_name, _ in lines])
        fields = _fields(*[(field_name, type_) for _, field_name, type_ in lines])
        return Message(TypeName(package, "msg", name.name + suffix), dialect, fields, (), body, file)

    def own(suffix: str) -> FieldType:
        return FieldType(None, TypeName(package, "msg", name.name + suffix), name.name + suffix)

    def stamped(suffix: str, status: tuple[str, str], part_suffix: str, part: str) -> Message:
        header = FieldType(None, TypeName("std_msgs", "msg", "Header"), "Header")
        status_type = FieldType(
            None, TypeName("actionlib_msgs", "msg", status[0]), "actionlib_msgs/" + status[0]
        )
        return message(
            suffix,
            ("Header", "header", header),
            ("actionlib_msgs/" + status[0], status[1], status_type),
            (name.name + part_suffix, part, own(part_suffix)),
        )

    action = message(
        "Action",
        (name.name + "ActionGoal", "action_goal", own("ActionGoal")),
        (name.name + "ActionResult", "action_result", own("ActionResult")),
        (name.name + "ActionFeedback", "action_feedback", own("ActionFeedback")),
    )
    messages = (
        action,
        stamped("ActionGoal", ("GoalID", "goal_id"), "Goal", "goal"),
        stamped("ActionResult", ("GoalStatus", "status"), "Result", "result"),
        stamped("ActionFeedback", ("GoalStatus", "status"), "Feedback", "feedback"),
        goal,
        result,
        feedback,
    )
    return Action(name, dialect, goal, result, feedback, (), messages, text, file)
