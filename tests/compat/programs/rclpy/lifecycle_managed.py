#!/usr/bin/env python3
# A managed node that ends when it was shut down from elsewhere.
import rclpy
from lifecycle_msgs.msg import State
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn


class Managed(LifecycleNode):
    fails = True
    over = False

    def on_configure(self, state):
        print("on_configure", state.label)
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state):
        print("on_activate", state.label, self.fails)
        self.fails = not self.fails
        return TransitionCallbackReturn.SUCCESS if self.fails else TransitionCallbackReturn.FAILURE

    def on_shutdown(self, state):
        print("on_shutdown", state.label)
        self.over = True
        return TransitionCallbackReturn.SUCCESS


rclpy.init()
node = Managed("managed")
while not node.over:
    rclpy.spin_once(node)
for _ in range(20):
    rclpy.spin_once(node, timeout_sec=0.05)
print(State.PRIMARY_STATE_FINALIZED)
node.destroy_node()
rclpy.shutdown()
