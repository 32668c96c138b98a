# Generated from the definitions of actionlib_tutorials by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message
from roslet.msgs.ros1.actionlib_tutorials import msg as _actionlib_tutorials_msg

class Averaging(_message.Action):
    Goal = _actionlib_tutorials_msg.AveragingGoal
    Result = _actionlib_tutorials_msg.AveragingResult
    Feedback = _actionlib_tutorials_msg.AveragingFeedback
    Action = _actionlib_tutorials_msg.AveragingAction
    ActionGoal = _actionlib_tutorials_msg.AveragingActionGoal
    ActionResult = _actionlib_tutorials_msg.AveragingActionResult
    ActionFeedback = _actionlib_tutorials_msg.AveragingActionFeedback

class Fibonacci(_message.Action):
    Goal = _actionlib_tutorials_msg.FibonacciGoal
    Result = _actionlib_tutorials_msg.FibonacciResult
    Feedback = _actionlib_tutorials_msg.FibonacciFeedback
    Action = _actionlib_tutorials_msg.FibonacciAction
    ActionGoal = _actionlib_tutorials_msg.FibonacciActionGoal
    ActionResult = _actionlib_tutorials_msg.FibonacciActionResult
    ActionFeedback = _actionlib_tutorials_msg.FibonacciActionFeedback
