# Generated from the definitions of nav_msgs by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message
from roslet.msgs.ros1.nav_msgs import msg as _nav_msgs_msg

class GetMap(_message.Action):
    Goal = _nav_msgs_msg.GetMapGoal
    Result = _nav_msgs_msg.GetMapResult
    Feedback = _nav_msgs_msg.GetMapFeedback
    Action = _nav_msgs_msg.GetMapAction
    ActionGoal = _nav_msgs_msg.GetMapActionGoal
    ActionResult = _nav_msgs_msg.GetMapActionResult
    ActionFeedback = _nav_msgs_msg.GetMapActionFeedback
