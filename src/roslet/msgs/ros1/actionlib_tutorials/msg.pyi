# Generated from the definitions of actionlib_tutorials by roslet.gen.stubs. Do not edit.

import typing as _typing

from roslet.wire import message as _message
from roslet.msgs.ros1.actionlib_msgs import msg as _actionlib_msgs_msg
from roslet.msgs.ros1.std_msgs import msg as _std_msgs_msg

class AveragingAction(_message.Message):
    action_goal: AveragingActionGoal
    action_result: AveragingActionResult
    action_feedback: AveragingActionFeedback
    def __init__(
        self,
        action_goal: AveragingActionGoal | None = ...,
        action_result: AveragingActionResult | None = ...,
        action_feedback: AveragingActionFeedback | None = ...,
    ) -> None: ...

class AveragingActionFeedback(_message.Message):
    header: _std_msgs_msg.Header
    status: _actionlib_msgs_msg.GoalStatus
    feedback: AveragingFeedback
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        status: _actionlib_msgs_msg.GoalStatus | None = ...,
        feedback: AveragingFeedback | None = ...,
    ) -> None: ...

class AveragingActionGoal(_message.Message):
    header: _std_msgs_msg.Header
    goal_id: _actionlib_msgs_msg.GoalID
    goal: AveragingGoal
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        goal_id: _actionlib_msgs_msg.GoalID | None = ...,
        goal: AveragingGoal | None = ...,
    ) -> None: ...

class AveragingActionResult(_message.Message):
    header: _std_msgs_msg.Header
    status: _actionlib_msgs_msg.GoalStatus
    result: AveragingResult
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        status: _actionlib_msgs_msg.GoalStatus | None = ...,
        result: AveragingResult | None = ...,
    ) -> None: ...

class AveragingFeedback(_message.Message):
    sample: int
    data: float
    mean: float
    std_dev: float
    def __init__(
        self,
        sample: int = ...,
        data: float = ...,
        mean: float = ...,
        std_dev: float = ...,
    ) -> None: ...

class AveragingGoal(_message.Message):
    samples: int
    def __init__(
        self,
        samples: int = ...,
    ) -> None: ...

class AveragingResult(_message.Message):
    mean: float
    std_dev: float
    def __init__(
        self,
        mean: float = ...,
        std_dev: float = ...,
    ) -> None: ...

class FibonacciAction(_message.Message):
    action_goal: FibonacciActionGoal
    action_result: FibonacciActionResult
    action_feedback: FibonacciActionFeedback
    def __init__(
        self,
        action_goal: FibonacciActionGoal | None = ...,
        action_result: FibonacciActionResult | None = ...,
        action_feedback: FibonacciActionFeedback | None = ...,
    ) -> None: ...

class FibonacciActionFeedback(_message.Message):
    header: _std_msgs_msg.Header
    status: _actionlib_msgs_msg.GoalStatus
    feedback: FibonacciFeedback
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        status: _actionlib_msgs_msg.GoalStatus | None = ...,
        feedback: FibonacciFeedback | None = ...,
    ) -> None: ...

class FibonacciActionGoal(_message.Message):
    header: _std_msgs_msg.Header
    goal_id: _actionlib_msgs_msg.GoalID
    goal: FibonacciGoal
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        goal_id: _actionlib_msgs_msg.GoalID | None = ...,
        goal: FibonacciGoal | None = ...,
    ) -> None: ...

class FibonacciActionResult(_message.Message):
    header: _std_msgs_msg.Header
    status: _actionlib_msgs_msg.GoalStatus
    result: FibonacciResult
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        status: _actionlib_msgs_msg.GoalStatus | None = ...,
        result: FibonacciResult | None = ...,
    ) -> None: ...

class FibonacciFeedback(_message.Message):
    sequence: _typing.Any
    def __init__(
        self,
        sequence: _typing.Any = ...,
    ) -> None: ...

class FibonacciGoal(_message.Message):
    order: int
    def __init__(
        self,
        order: int = ...,
    ) -> None: ...

class FibonacciResult(_message.Message):
    sequence: _typing.Any
    def __init__(
        self,
        sequence: _typing.Any = ...,
    ) -> None: ...
