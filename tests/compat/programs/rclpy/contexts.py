#!/usr/bin/env python3
# init and shutdown, contexts of one's own, and what happens after the end.
import threading

import rclpy
from rclpy.context import Context
from rclpy.exceptions import NotInitializedException
from rclpy.executors import SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions
from rclpy.signals import get_current_signal_handlers_options as handlers
from std_msgs.msg import String


def show(name, function):
    try:
        print(name, function())
    except Exception as error:
        print(name, "raised", type(error).__name__, error)


print("before", rclpy.ok(), handlers().name)
show("shutdown", rclpy.shutdown)
show("try_shutdown", rclpy.try_shutdown)
show("node", lambda: rclpy.create_node("node"))
rclpy.init(args=[])
print("within", rclpy.ok(), handlers().name)
show("init again", rclpy.init)
ended = []
rclpy.get_default_context().on_shutdown(lambda: ended.append("default"))
show("no callback", lambda: rclpy.get_default_context().on_shutdown(5))
print(rclpy.get_default_context().get_domain_id())
node = rclpy.create_node("node")
rclpy.shutdown()
print("after", rclpy.ok(), ended, handlers().name)
show("shutdown again", rclpy.shutdown)
rclpy.try_shutdown()
show("spin_once", lambda: rclpy.spin_once(node, timeout_sec=0.1))

# Once more, in a with statement.
with rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO) as given:
    print(type(given).__name__, given.context.ok(), rclpy.ok(), handlers().name)
    node = rclpy.create_node("again")
    print(node.context is rclpy.get_default_context(), node.get_name())
print(rclpy.ok(), given.context.ok())

# A context of one's own, beside the default one.
mine = Context()
print(mine.ok())
show("without init", lambda: mine.get_domain_id())
rclpy.init(context=mine, domain_id=7, args=[])
print(mine.ok(), rclpy.ok(), mine.get_domain_id(), handlers().name)
node = rclpy.create_node("mine", context=mine)
executor = SingleThreadedExecutor(context=mine)
executor.add_node(node)
heard = []
node.create_subscription(String, "topic", lambda message: heard.append(message.data), 10)
publisher = node.create_publisher(String, "topic", 10)
while publisher.get_subscription_count() == 0:
    executor.spin_once(timeout_sec=0.05)
publisher.publish(String(data="in a domain of its own"))
while not heard:
    executor.spin_once(timeout_sec=0.1)
print(heard)
rclpy.shutdown(context=mine)
print(mine.ok())
show("init again", lambda: mine.init())
mine.try_shutdown()
mine.on_shutdown(lambda: print("called at once"))
with Context() as context:
    print("deprecated", context.ok())
show("domain", lambda: Context().init(domain_id=-1))
show("unknown", lambda: Context().init(args=["--ros-args", "--nonsense"]))
try:
    Context().init(args=["--ros-args", "-r", "nonsense"])
except Exception as error:  # its text is a parser's
    print("bad remapping", type(error).__name__)

# Two contexts in two domains do not see each other.
contexts = [Context(), Context()]
for number, context in enumerate(contexts):
    context.init(args=[], domain_id=number + 10)
nodes = [rclpy.create_node(f"node_{number}", context=context) for number, context in enumerate(contexts)]
print([node.get_node_names() for node in nodes])
for context in contexts:
    context.shutdown()
