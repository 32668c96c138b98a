#!/usr/bin/env python3
# Services and clients in one process: callbacks, coroutines, many at once, timeouts, ends.
import threading

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.task import Future
from std_srvs.srv import Empty, SetBool, Trigger

rclpy.init()
node = rclpy.create_node("services")
others = MutuallyExclusiveCallbackGroup()
print("absent", node.create_client(Trigger, "nowhere").wait_for_service(timeout_sec=0.2))


def trigger(request, response):
    response.success = True
    response.message = "function"
    return response


async def slow(request, response):
    future = Future()
    # In a group of its own: the default group waits for this callback to end.
    timer = node.create_timer(0.05, lambda: future.set_result("coroutine"), callback_group=others)
    response.message = await future
    response.success = True
    node.destroy_timer(timer)
    return response


node.create_service(Trigger, "function", trigger)
node.create_service(Trigger, "~/coroutine", slow)
node.create_service(
    SetBool, "switch", lambda request, response: SetBool.Response(success=request.data, message="new")
)
node.create_service(Empty, "empty", lambda request, response: response)


def call(kind, name, **values):
    client = node.create_client(kind, name)
    print(client.srv_name, client.service_is_ready() or client.wait_for_service(timeout_sec=5.0))
    future = client.call_async(kind.Request(**values))
    rclpy.spin_until_future_complete(node, future, timeout_sec=5.0)
    print(future.done(), future.result())
    node.destroy_client(client)


call(Trigger, "function")
call(Trigger, "~/coroutine")
call(Trigger, "services/coroutine")
call(SetBool, "switch", data=True)
call(Empty, "empty")

# Many under way, each answer to its own request.
client = node.create_client(SetBool, "switch")
client.wait_for_service()
futures = [client.call_async(SetBool.Request(data=number % 3 == 0)) for number in range(8)]
order = []
for number, future in enumerate(futures):
    future.add_done_callback(lambda future, number=number: order.append(number))
for future in futures:
    rclpy.spin_until_future_complete(node, future)
print([future.result().success for future in futures] == [number % 3 == 0 for number in range(8)])
for _ in range(20):
    rclpy.spin_once(node, timeout_sec=0.05)
print(sorted(order) == list(range(8)))

# An answer that does not come in time.
silent = node.create_service(Trigger, "silent", lambda request, response: response)
other = rclpy.create_node("other")
lonely = other.create_client(Trigger, "silent")
lonely.wait_for_service()
future = lonely.call_async(Trigger.Request())
rclpy.spin_until_future_complete(other, future, timeout_sec=0.2)
print("no answer", future.done(), future.cancelled())
lonely.remove_pending_request(future)
future.cancel()
print("cancelled", future.cancelled(), future.done())

# What is no request.
for wrong in (None, Trigger.Response(), SetBool.Request()):
    try:
        lonely.call_async(wrong)
    except TypeError:
        print("TypeError", type(wrong).__name__)

# A callback of the future, a coroutine that awaits several calls.
executor = SingleThreadedExecutor()
executor.add_node(node)
executor.add_node(other)


async def ask():
    first = await client.call_async(SetBool.Request(data=True))
    second = await lonely.call_async(Trigger.Request())
    return first.success, second.success


task = executor.create_task(ask)
executor.spin_until_future_complete(task)
print("awaited", task.result())
executor.shutdown()

# A synchronous call out of a callback, with threads.
group = ReentrantCallbackGroup()
inner = other.create_client(Trigger, "function", callback_group=group)
done = threading.Event()


def outer(request, response):
    answer = inner.call(Trigger.Request())
    response.success = answer.success
    response.message = f"by {answer.message}"
    return response


other.create_service(Trigger, "outer", outer, callback_group=MutuallyExclusiveCallbackGroup())
executor = MultiThreadedExecutor(num_threads=4)
executor.add_node(node)
executor.add_node(other)
thread = threading.Thread(target=executor.spin)
thread.start()
caller = node.create_client(Trigger, "outer")
caller.wait_for_service()
print("synchronous", caller.call(Trigger.Request(), timeout_sec=5.0))
future = caller.call_async(Trigger.Request())
future.add_done_callback(lambda future: done.set())
print("event", done.wait(5.0), future.result().message)
executor.shutdown()
thread.join(5.0)
print("thread ended", not thread.is_alive())
rclpy.shutdown()
