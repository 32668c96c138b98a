# Generated from the definitions of move_base_msgs by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message
from roslet.msgs.ros1.actionlib_msgs import msg as _actionlib_msgs_msg
from roslet.msgs.ros1.geometry_msgs import msg as _geometry_msgs_msg
from roslet.msgs.ros1.std_msgs import msg as _std_msgs_msg

class MoveBaseAction(_message.Message):
    action_goal: MoveBaseActionGoal
    action_result: MoveBaseActionResult
    action_feedback: MoveBaseActionFeedback
    def __init__(
        self,
        action_goal: MoveBaseActionGoal | None = ...,
        action_result: MoveBaseActionResult | None = ...,
        action_feedback: MoveBaseActionFeedback | None = ...,
    ) -> None: ...

class MoveBaseActionFeedback(_message.Message):
    header: _std_msgs_msg.Header
    status: _actionlib_msgs_msg.GoalStatus
    feedback: MoveBaseFeedback
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        status: _actionlib_msgs_msg.GoalStatus | None = ...,
        feedback: MoveBaseFeedback | None = ...,
    ) -> None: ...

class MoveBaseActionGoal(_message.Message):
    header: _std_msgs_msg.Header
    goal_id: _actionlib_msgs_msg.GoalID
    goal: MoveBaseGoal
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        goal_id: _actionlib_msgs_msg.GoalID | None = ...,
        goal: MoveBaseGoal | None = ...,
    ) -> None: ...

class MoveBaseActionResult(_message.Message):
    header: _std_msgs_msg.Header
    status: _actionlib_msgs_msg.GoalStatus
    result: MoveBaseResult
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        status: _actionlib_msgs_msg.GoalStatus | None = ...,
        result: MoveBaseResult | None = ...,
    ) -> None: ...

class MoveBaseFeedback(_message.Message):
    base_position: _geometry_msgs_msg.PoseStamped
    def __init__(
        self,
        base_position: _geometry_msgs_msg.PoseStamped | None = ...,
    ) -> None: ...

class MoveBaseGoal(_message.Message):
    target_pose: _geometry_msgs_msg.PoseStamped
    def __init__(
        self,
        target_pose: _geometry_msgs_msg.PoseStamped | None = ...,
    ) -> None: ...

class MoveBaseResult(_message.Message):
    def __init__(self) -> None: ...

class RecoveryStatus(_message.Message):
    pose_stamped: _geometry_msgs_msg.PoseStamped
    current_recovery_number: int
    total_number_of_recoveries: int
    recovery_behavior_name: str
    def __init__(
        self,
        pose_stamped: _geometry_msgs_msg.PoseStamped | None = ...,
        current_recovery_number: int = ...,
        total_number_of_recoveries: int = ...,
        recovery_behavior_name: str = ...,
    ) -> None: ...
