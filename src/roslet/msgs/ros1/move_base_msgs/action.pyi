# Generated from the definitions of move_base_msgs by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message
from roslet.msgs.ros1.move_base_msgs import msg as _move_base_msgs_msg

class MoveBase(_message.Action):
    Goal = _move_base_msgs_msg.MoveBaseGoal
    Result = _move_base_msgs_msg.MoveBaseResult
    Feedback = _move_base_msgs_msg.MoveBaseFeedback
    Action = _move_base_msgs_msg.MoveBaseAction
    ActionGoal = _move_base_msgs_msg.MoveBaseActionGoal
    ActionResult = _move_base_msgs_msg.MoveBaseActionResult
    ActionFeedback = _move_base_msgs_msg.MoveBaseActionFeedback
