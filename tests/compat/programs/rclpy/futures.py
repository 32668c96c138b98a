#!/usr/bin/env python3
# Futures and tasks, with an executor and without.
import warnings

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.task import Future, Task

future = Future()
print(future.done(), future.cancelled(), future.result(), future.exception())
called = []
future.add_done_callback(lambda done: called.append(done.result()))
removed = lambda done: called.append("removed")
future.add_done_callback(removed)
print(future.remove_done_callback(removed), future.remove_done_callback(removed))
future.set_result(7)
print(future.done(), future.result(), called)
future.add_done_callback(lambda done: called.append("late"))
print(called)

failed = Future()
failed.set_exception(ValueError("bad"))
try:
    failed.result()
except ValueError as error:
    print("raised", error, failed.done(), repr(failed.exception()))
try:
    failed.add_done_callback(lambda done: 1 / 0)
except ZeroDivisionError as error:
    print("at once", error)

cancelled = Future()
cancelled.add_done_callback(lambda done: called.append("cancelled"))
cancelled.cancel()
print(cancelled.cancelled(), cancelled.done(), called[-1])

careless = Future()
careless.add_done_callback(lambda done: 1 / 0)
careless.add_done_callback(lambda done: called.append("second"))
with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    careless.set_result(None)
print([str(one.message) for one in caught], called[-1])

rclpy.init()
executor = SingleThreadedExecutor()


def run(function, *args, **kwargs):
    task = executor.create_task(function, *args, **kwargs)
    executor.spin_until_future_complete(task, timeout_sec=5.0)
    return task


print(run(lambda a, b: a + b, 1, b=2).result())


async def waits(other):
    return await other + 1


other = executor.create_future()
task = executor.create_task(waits, other)
executor.spin_once(timeout_sec=0.1)
print(task.done(), task.executing())
other.set_result(41)
executor.spin_until_future_complete(task)
print(task.done(), task.result())


async def chained():
    inner = executor.create_task(waits, other)
    return await inner * 2


chain = executor.create_task(chained)
for _ in range(10):
    executor.spin_once(timeout_sec=0.02)
print(chain.result())


async def fails():
    raise KeyError("inside")


task = executor.create_task(fails)
try:
    executor.spin_until_future_complete(task, timeout_sec=5.0)
except KeyError as error:
    print("out of the spin", error)
print(task.done(), type(task.exception()).__name__)

# A callback of a future that belongs to an executor is run by the executor.
future = executor.create_future()
future.add_done_callback(lambda done: called.append("by the executor"))
future.set_result(None)
print(called[-1])
for _ in range(5):
    executor.spin_once(timeout_sec=0.02)
print(called[-1])

never = executor.create_future()
task = executor.create_task(waits, never)
executor.spin_once(timeout_sec=0.05)
task.cancel()
print(task.cancelled(), task.done())
executor.spin_until_future_complete(never, timeout_sec=0.05)
print(never.done())

# An awaited future that failed.
broken = executor.create_future()
broken.set_exception(ValueError("broken"))


async def catches():
    try:
        await broken
    except ValueError as error:
        return f"caught {error}"


print(run(catches).result())

# A task by itself.
task = Task(lambda value: value * 2, args=[4])
task()
print(task.done(), task.result())
task()
print(task.result())
rclpy.shutdown()
