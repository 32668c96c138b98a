# Generated from the definitions of actionlib by roslet.gen.stubs. Do not edit.

import typing as _typing

from roslet.wire import message as _message
from roslet.wire import time as _time
from roslet.msgs.ros1.actionlib_msgs import msg as _actionlib_msgs_msg
from roslet.msgs.ros1.std_msgs import msg as _std_msgs_msg

class TestAction(_message.Message):
    action_goal: TestActionGoal
    action_result: TestActionResult
    action_feedback: TestActionFeedback
    def __init__(
        self,
        action_goal: TestActionGoal | None = ...,
        action_result: TestActionResult | None = ...,
        action_feedback: TestActionFeedback | None = ...,
    ) -> None: ...

class TestActionFeedback(_message.Message):
    header: _std_msgs_msg.Header
    status: _actionlib_msgs_msg.GoalStatus
    feedback: TestFeedback
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        status: _actionlib_msgs_msg.GoalStatus | None = ...,
        feedback: TestFeedback | None = ...,
    ) -> None: ...

class TestActionGoal(_message.Message):
    header: _std_msgs_msg.Header
    goal_id: _actionlib_msgs_msg.GoalID
    goal: TestGoal
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        goal_id: _actionlib_msgs_msg.GoalID | None = ...,
        goal: TestGoal | None = ...,
    ) -> None: ...

class TestActionResult(_message.Message):
    header: _std_msgs_msg.Header
    status: _actionlib_msgs_msg.GoalStatus
    result: TestResult
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        status: _actionlib_msgs_msg.GoalStatus | None = ...,
        result: TestResult | None = ...,
    ) -> None: ...

class TestFeedback(_message.Message):
    feedback: int
    def __init__(
        self,
        feedback: int = ...,
    ) -> None: ...

class TestGoal(_message.Message):
    goal: int
    def __init__(
        self,
        goal: int = ...,
    ) -> None: ...

class TestRequestAction(_message.Message):
    action_goal: TestRequestActionGoal
    action_result: TestRequestActionResult
    action_feedback: TestRequestActionFeedback
    def __init__(
        self,
        action_goal: TestRequestActionGoal | None = ...,
        action_result: TestRequestActionResult | None = ...,
        action_feedback: TestRequestActionFeedback | None = ...,
    ) -> None: ...

class TestRequestActionFeedback(_message.Message):
    header: _std_msgs_msg.Header
    status: _actionlib_msgs_msg.GoalStatus
    feedback: TestRequestFeedback
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        status: _actionlib_msgs_msg.GoalStatus | None = ...,
        feedback: TestRequestFeedback | None = ...,
    ) -> None: ...

class TestRequestActionGoal(_message.Message):
    header: _std_msgs_msg.Header
    goal_id: _actionlib_msgs_msg.GoalID
    goal: TestRequestGoal
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        goal_id: _actionlib_msgs_msg.GoalID | None = ...,
        goal: TestRequestGoal | None = ...,
    ) -> None: ...

class TestRequestActionResult(_message.Message):
    header: _std_msgs_msg.Header
    status: _actionlib_msgs_msg.GoalStatus
    result: TestRequestResult
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        status: _actionlib_msgs_msg.GoalStatus | None = ...,
        result: TestRequestResult | None = ...,
    ) -> None: ...

class TestRequestFeedback(_message.Message):
    def __init__(self) -> None: ...

class TestRequestGoal(_message.Message):
    TERMINATE_SUCCESS: _typing.ClassVar[int]
    TERMINATE_ABORTED: _typing.ClassVar[int]
    TERMINATE_REJECTED: _typing.ClassVar[int]
    TERMINATE_LOSE: _typing.ClassVar[int]
    TERMINATE_DROP: _typing.ClassVar[int]
    TERMINATE_EXCEPTION: _typing.ClassVar[int]
    terminate_status: int
    ignore_cancel: bool
    result_text: str
    the_result: int
    is_simple_client: bool
    delay_accept: _time.Duration
    delay_terminate: _time.Duration
    pause_status: _time.Duration
    def __init__(
        self,
        terminate_status: int = ...,
        ignore_cancel: bool = ...,
        result_text: str = ...,
        the_result: int = ...,
        is_simple_client: bool = ...,
        delay_accept: _time.Duration | None = ...,
        delay_terminate: _time.Duration | None = ...,
        pause_status: _time.Duration | None = ...,
    ) -> None: ...

class TestRequestResult(_message.Message):
    the_result: int
    is_simple_server: bool
    def __init__(
        self,
        the_result: int = ...,
        is_simple_server: bool = ...,
    ) -> None: ...

class TestResult(_message.Message):
    result: int
    def __init__(
        self,
        result: int = ...,
    ) -> None: ...

class TwoIntsAction(_message.Message):
    action_goal: TwoIntsActionGoal
    action_result: TwoIntsActionResult
    action_feedback: TwoIntsActionFeedback
    def __init__(
        self,
        action_goal: TwoIntsActionGoal | None = ...,
        action_result: TwoIntsActionResult | None = ...,
        action_feedback: TwoIntsActionFeedback | None = ...,
    ) -> None: ...

class TwoIntsActionFeedback(_message.Message):
    header: _std_msgs_msg.Header
    status: _actionlib_msgs_msg.GoalStatus
    feedback: TwoIntsFeedback
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        status: _actionlib_msgs_msg.GoalStatus | None = ...,
        feedback: TwoIntsFeedback | None = ...,
    ) -> None: ...

class TwoIntsActionGoal(_message.Message):
    header: _std_msgs_msg.Header
    goal_id: _actionlib_msgs_msg.GoalID
    goal: TwoIntsGoal
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        goal_id: _actionlib_msgs_msg.GoalID | None = ...,
        goal: TwoIntsGoal | None = ...,
    ) -> None: ...

class TwoIntsActionResult(_message.Message):
    header: _std_msgs_msg.Header
    status: _actionlib_msgs_msg.GoalStatus
    result: TwoIntsResult
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        status: _actionlib_msgs_msg.GoalStatus | None = ...,
        result: TwoIntsResult | None = ...,
    ) -> None: ...

class TwoIntsFeedback(_message.Message):
    def __init__(self) -> None: ...

class TwoIntsGoal(_message.Message):
    a: int
    b: int
    def __init__(
        self,
        a: int = ...,
        b: int = ...,
    ) -> None: ...

class TwoIntsResult(_message.Message):
    sum: int
    def __init__(
        self,
        sum: int = ...,
    ) -> None: ...
