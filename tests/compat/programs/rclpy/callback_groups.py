#!/usr/bin/env python3
# Which callbacks run at the same time.
import threading
import time

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor


class Meter:
    """How many callbacks were in it at once."""

    def __init__(self):
        self.lock = threading.Lock()
        self.now = self.most = self.calls = 0
        self.threads = set()

    def __call__(self):
        with self.lock:
            self.now += 1
            self.calls += 1
            self.most = max(self.most, self.now)
            self.threads.add(threading.get_ident())
        time.sleep(0.05)
        with self.lock:
            self.now -= 1


def measure(executor, groups, seconds=0.6):
    node = rclpy.create_node("groups")
    meter = Meter()
    for group in groups(node):
        node.create_timer(0.01, meter, callback_group=group)
    executor.add_node(node)
    thread = threading.Thread(target=executor.spin)
    thread.start()
    time.sleep(seconds)
    executor.shutdown()
    thread.join()
    node.destroy_node()
    return meter


rclpy.init()
exclusive = lambda node: [MutuallyExclusiveCallbackGroup()] * 2
own = lambda node: [MutuallyExclusiveCallbackGroup(), MutuallyExclusiveCallbackGroup()]
reentrant = lambda node: [ReentrantCallbackGroup()]
default = lambda node: [None, None]

meter = measure(SingleThreadedExecutor(), own)
print("one thread", meter.most, len(meter.threads), meter.calls > 3)
meter = measure(MultiThreadedExecutor(4), exclusive)
print("one group", meter.most, meter.calls > 3)
meter = measure(MultiThreadedExecutor(4), own)
print("two groups", meter.most, meter.calls > 6)
meter = measure(MultiThreadedExecutor(4), reentrant)
print("reentrant", 1 < meter.most <= 4, len(meter.threads) > 1)
meter = measure(MultiThreadedExecutor(2), reentrant)
print("two threads", meter.most)
meter = measure(MultiThreadedExecutor(4), default)
print("default group", meter.most)

node = rclpy.create_node("node")
print(type(node.default_callback_group).__name__)
group = ReentrantCallbackGroup()
timer = node.create_timer(1.0, lambda: None, callback_group=group)
print(timer.callback_group is group, group.has_entity(timer), node.default_callback_group.has_entity(timer))
print(group.can_execute(timer), group.beginning_execution(timer))
exclusive = MutuallyExclusiveCallbackGroup()
first = node.create_timer(1.0, lambda: None, callback_group=exclusive)
second = node.create_timer(1.0, lambda: None, callback_group=exclusive)
print(
    exclusive.can_execute(first),
    exclusive.beginning_execution(first),
    exclusive.can_execute(second),
    exclusive.beginning_execution(second),
)
exclusive.ending_execution(first)
print(exclusive.can_execute(second))
rclpy.shutdown()
