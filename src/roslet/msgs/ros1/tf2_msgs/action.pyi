# Generated from the definitions of tf2_msgs by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message
from roslet.msgs.ros1.tf2_msgs import msg as _tf2_msgs_msg

class LookupTransform(_message.Action):
    Goal = _tf2_msgs_msg.LookupTransformGoal
    Result = _tf2_msgs_msg.LookupTransformResult
    Feedback = _tf2_msgs_msg.LookupTransformFeedback
    Action = _tf2_msgs_msg.LookupTransformAction
    ActionGoal = _tf2_msgs_msg.LookupTransformActionGoal
    ActionResult = _tf2_msgs_msg.LookupTransformActionResult
    ActionFeedback = _tf2_msgs_msg.LookupTransformActionFeedback
