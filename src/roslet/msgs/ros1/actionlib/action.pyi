# Generated from the definitions of actionlib by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message
from roslet.msgs.ros1.actionlib import msg as _actionlib_msg

class Test(_message.Action):
    Goal = _actionlib_msg.TestGoal
    Result = _actionlib_msg.TestResult
    Feedback = _actionlib_msg.TestFeedback
    Action = _actionlib_msg.TestAction
    ActionGoal = _actionlib_msg.TestActionGoal
    ActionResult = _actionlib_msg.TestActionResult
    ActionFeedback = _actionlib_msg.TestActionFeedback

class TestRequest(_message.Action):
    Goal = _actionlib_msg.TestRequestGoal
    Result = _actionlib_msg.TestRequestResult
    Feedback = _actionlib_msg.TestRequestFeedback
    Action = _actionlib_msg.TestRequestAction
    ActionGoal = _actionlib_msg.TestRequestActionGoal
    ActionResult = _actionlib_msg.TestRequestActionResult
    ActionFeedback = _actionlib_msg.TestRequestActionFeedback

class TwoInts(_message.Action):
    Goal = _actionlib_msg.TwoIntsGoal
    Result = _actionlib_msg.TwoIntsResult
    Feedback = _actionlib_msg.TwoIntsFeedback
    Action = _actionlib_msg.TwoIntsAction
    ActionGoal = _actionlib_msg.TwoIntsActionGoal
    ActionResult = _actionlib_msg.TwoIntsActionResult
    ActionFeedback = _actionlib_msg.TwoIntsActionFeedback
