#!/usr/bin/env python3
# actionlib, a library of others in plain Python, on top of rospy.
import actionlib
import rospy
from actionlib.msg import TestAction, TestFeedback, TestGoal, TestResult


class Counter:
    def __init__(self):
        self.server = actionlib.SimpleActionServer(
            "count", TestAction, execute_cb=self.execute, auto_start=False
        )
        self.server.start()

    def execute(self, goal):
        for number in range(goal.goal):
            if self.server.is_preempt_requested():
                self.server.set_preempted(TestResult(number), "stopped")
                return
            self.server.publish_feedback(TestFeedback(number))
            rospy.sleep(0.01)
        self.server.set_succeeded(TestResult(goal.goal), "counted")


rospy.init_node("actions", log_level=rospy.FATAL)  # actionlib logs a race of its own now and then
counter = Counter()
client = actionlib.SimpleActionClient("count", TestAction)
print(client.wait_for_server(rospy.Duration(10)))
feedback = []
client.send_goal(TestGoal(5), feedback_cb=lambda message: feedback.append(message.feedback))
print(
    client.wait_for_result(rospy.Duration(10)),
    client.get_result(),
    client.get_state(),
    client.get_goal_status_text(),
)
print(feedback)
client.send_goal(TestGoal(10000))
rospy.sleep(0.3)
client.cancel_goal()
print(client.wait_for_result(rospy.Duration(10)), client.get_state() == actionlib.GoalStatus.PREEMPTED)
print(client.get_result().result < 10000, client.get_goal_status_text())
status = (
    counter.server.action_server.status_timer
)  # otherwise it now and then publishes on a topic that is closed
status.shutdown()
status.join()
rospy.signal_shutdown("its threads end with the node")
