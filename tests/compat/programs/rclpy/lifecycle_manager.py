#!/usr/bin/env python3
# One that manages another node: asks for its state, changes it, hears of its transitions.
import rclpy
from lifecycle_msgs.msg import Transition, TransitionEvent
from lifecycle_msgs.srv import ChangeState, GetAvailableStates, GetAvailableTransitions, GetState

rclpy.init()
node = rclpy.create_node("manager")
events = []
node.create_subscription(
    TransitionEvent,
    "/managed/transition_event",
    lambda event: events.append((event.start_state.label, event.goal_state.label)),
    10,
)


def call(kind, name, request):
    client = node.create_client(kind, "/managed/" + name)
    client.wait_for_service()
    future = client.call_async(request)
    rclpy.spin_until_future_complete(node, future, timeout_sec=10)
    node.destroy_client(client)
    return future.result()


def state():
    found = call(GetState, "get_state", GetState.Request()).current_state
    return found.id, found.label


def change(number=0, label=""):
    request = ChangeState.Request(transition=Transition(id=number, label=label))
    return call(ChangeState, "change_state", request).success


def transitions(name):
    found = call(GetAvailableTransitions, name, GetAvailableTransitions.Request()).available_transitions
    return sorted((one.transition.id, one.transition.label, one.goal_state.label) for one in found)


print(state())
print(
    sorted(
        (one.id, one.label)
        for one in call(
            GetAvailableStates, "get_available_states", GetAvailableStates.Request()
        ).available_states
    )
)
print(transitions("get_available_transitions"), len(transitions("get_transition_graph")))
while node.count_publishers("/managed/transition_event") == 0:
    rclpy.spin_once(node, timeout_sec=0.05)
for _ in range(10):
    rclpy.spin_once(node, timeout_sec=0.05)  # until the other end knows the subscription too
print("configure", change(Transition.TRANSITION_CONFIGURE), state())
print("activate", change(Transition.TRANSITION_ACTIVATE), state())
print("activate", change(label="activate"), state())
print("not now", change(Transition.TRANSITION_CONFIGURE), state())
print("deactivate", change(Transition.TRANSITION_DEACTIVATE), state())
print("shutdown", change(label="shutdown"))
for _ in range(40):
    if len(events) >= 12:
        break
    rclpy.spin_once(node, timeout_sec=0.05)
print(*events, sep="\n")
rclpy.shutdown()
