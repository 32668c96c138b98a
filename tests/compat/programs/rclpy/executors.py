#!/usr/bin/env python3
# Executors: nodes, turns, tasks, guard conditions, ends.
import threading
import time

import rclpy
from rclpy.executors import (
    ExternalShutdownException,
    MultiThreadedExecutor,
    ShutdownException,
    SingleThreadedExecutor,
    TimeoutException,
)

rclpy.init()
node = rclpy.create_node("first")
other = rclpy.create_node("second")
executor = SingleThreadedExecutor()
print(executor.add_node(node), executor.add_node(node), executor.add_node(other))
print(sorted(n.get_name() for n in executor.get_nodes()), node.executor is executor)
executor.remove_node(other)
print([n.get_name() for n in executor.get_nodes()], other.executor is executor)

begin = time.monotonic()
executor.spin_once(timeout_sec=0.1)
print("waited", 0.09 < time.monotonic() - begin < 0.4)
begin = time.monotonic()
executor.spin_once(timeout_sec=0)
print("did not wait", time.monotonic() - begin < 0.1)

guard = node.create_guard_condition(lambda: print("guarded"))
guard.trigger()
executor.spin_once(timeout_sec=1.0)
guard.trigger()
guard.trigger()
executor.spin_once(timeout_sec=1.0)
executor.spin_once(timeout_sec=0.05)
print("guards", len(list(node.guards)), node.destroy_guard_condition(guard), len(list(node.guards)))

# One turn does one piece of work.
ran = []
for number in range(3):
    executor.create_task(ran.append, number)
executor.spin_once(timeout_sec=0.1)
print(len(ran))
executor.spin_once(timeout_sec=0.1)
executor.spin_once(timeout_sec=0.1)
print(ran)

# A task from another thread wakes a turn that waits.
threading.Timer(0.05, lambda: executor.create_task(ran.append, "woken")).start()
begin = time.monotonic()
executor.spin_once(timeout_sec=5.0)
print(ran[-1], time.monotonic() - begin < 2.0)
threading.Timer(0.05, executor.wake).start()
begin = time.monotonic()
executor.spin_once(timeout_sec=0.3)
print("wake does no work", 0.2 < time.monotonic() - begin < 1.0)

future = executor.create_future()
threading.Timer(0.05, lambda: future.set_result("set elsewhere")).start()
executor.spin_until_future_complete(future, timeout_sec=5.0)
print(future.result())
begin = time.monotonic()
executor.spin_until_future_complete(executor.create_future(), timeout_sec=0.1)
print("timed out", 0.09 < time.monotonic() - begin < 0.5)
executor.spin_once_until_future_complete(future, timeout_sec=0.1)

# A callback that raises ends the turn.
timer = node.create_timer(0.01, lambda: 1 / 0)
try:
    executor.spin()
except ZeroDivisionError as error:
    print("raised", error)
timer.destroy()

# A spin that another thread ends.
threading.Timer(0.1, executor.shutdown).start()
executor.spin()
print("spun")
for call in (executor.spin_once, lambda: executor.create_task(print, "no"), lambda: executor.add_node(other)):
    try:
        print("allowed", type(call()).__name__)
    except Exception as error:
        print(type(error).__name__)
print(executor.shutdown())

with MultiThreadedExecutor(num_threads=3) as executor:
    executor.add_node(node)
    seen = []
    timer = node.create_timer(
        0.02, lambda: seen.append(threading.current_thread() is threading.main_thread())
    )
    end = time.monotonic() + 0.3
    while time.monotonic() < end:
        executor.spin_once(timeout_sec=0.1)
    print("elsewhere", seen[0], len(seen) > 5)
    timer.cancel()
    task = executor.create_task(lambda: threading.current_thread() is threading.main_thread())
    executor.spin_until_future_complete(task, timeout_sec=2.0)
    print(task.result())
for wrong in (0, -1):
    try:
        print(MultiThreadedExecutor(wrong)._executor._max_workers > 0)
    except Exception as error:
        print(type(error).__name__)
print(
    issubclass(ExternalShutdownException, Exception),
    issubclass(TimeoutException, Exception),
    issubclass(ShutdownException, Exception),
)

# A node belongs to one executor.
one, two = SingleThreadedExecutor(), SingleThreadedExecutor()
one.add_node(node)
two.add_node(node)
print(node.executor is two, [n.get_name() for n in one.get_nodes()], [n.get_name() for n in two.get_nodes()])
two.shutdown()
one.shutdown()

# Many nodes on one executor, in a thread, while the main thread does something else.
executor = SingleThreadedExecutor()
counts = {}
for number in range(4):
    each = rclpy.create_node(f"node_{number}")
    counts[number] = 0
    each.create_timer(0.02, lambda number=number: counts.update({number: counts[number] + 1}))
    executor.add_node(each)


def spin():
    try:
        executor.spin()
    except ExternalShutdownException:
        print("ended from elsewhere")


thread = threading.Thread(target=spin, daemon=True)
thread.start()
time.sleep(0.3)
rclpy.shutdown()
thread.join(5)
print("all ran", all(count > 4 for count in counts.values()), thread.is_alive())
