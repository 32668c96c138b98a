#!/usr/bin/env python3
# An action server that rejects some goals, and lets some be cancelled; ends when the last has ended.
import rclpy
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from test_msgs.action import Fibonacci


class Judge(Node):
    def __init__(self):
        super().__init__("judge")
        self.left = 3
        self.group = ReentrantCallbackGroup()
        self.server = ActionServer(
            self,
            Fibonacci,
            "judged",
            self.execute,
            callback_group=self.group,
            goal_callback=self.goal,
            cancel_callback=self.cancel,
        )

    def goal(self, request):
        print("goal", request.order)
        return GoalResponse.REJECT if request.order < 0 else GoalResponse.ACCEPT

    def cancel(self, handle):
        print("cancel", handle.request.order, handle.status)
        return CancelResponse.ACCEPT if handle.request.order >= 10 else CancelResponse.REJECT

    async def execute(self, handle):
        order = handle.request.order
        if order == 20:
            handle.abort()
        else:
            # Until somebody has asked to cancel it, and for the last not even then.
            for _ in range(40):
                if handle.is_cancel_requested:
                    break
                await self.sleep(0.05)
            if handle.is_cancel_requested:
                handle.canceled()
            else:
                handle.succeed()
        print("ended", order, handle.status)
        self.left -= 1
        return Fibonacci.Result(sequence=[order])

    async def sleep(self, seconds):
        over = rclpy.task.Future()
        timer = self.create_timer(seconds, lambda: over.done() or over.set_result(None), self.group)
        await over
        self.destroy_timer(timer)


rclpy.init()
node = Judge()
while node.left:
    rclpy.spin_once(node)
for _ in range(20):
    rclpy.spin_once(node, timeout_sec=0.05)
node.destroy_node()
rclpy.shutdown()
