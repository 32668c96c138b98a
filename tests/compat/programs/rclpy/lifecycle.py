#!/usr/bin/env python3
# A lifecycle node, by itself and by its services.
import rclpy
from lifecycle_msgs.msg import State, Transition
from lifecycle_msgs.srv import ChangeState, GetAvailableTransitions, GetState
from rclpy.executors import SingleThreadedExecutor
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from std_msgs.msg import String


class Managed(LifecycleNode):
    def on_configure(self, state: LifecycleState):
        print("on_configure", state.state_id, state.label)
        self.publisher = self.create_lifecycle_publisher(String, "topic", 10)
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state):
        print("on_activate", state.label)
        return super().on_activate(state)

    def on_deactivate(self, state):
        print("on_deactivate", state.label)
        return super().on_deactivate(state)

    def on_cleanup(self, state):
        print("on_cleanup", state.label)
        self.destroy_publisher(self.publisher)
        return TransitionCallbackReturn.SUCCESS

    def on_shutdown(self, state):
        print("on_shutdown", state.label)
        return TransitionCallbackReturn.SUCCESS


rclpy.init()
node = Managed("managed")
asker = rclpy.create_node("asker")
executor = SingleThreadedExecutor()
executor.add_node(node)
executor.add_node(asker)


def call(kind, name, request):
    client = asker.create_client(kind, name)
    client.wait_for_service()
    future = client.call_async(request)
    executor.spin_until_future_complete(future, timeout_sec=10)
    return future.result()


print(call(GetState, "/managed/get_state", GetState.Request()).current_state)
ended = node.trigger_configure()
print(ended.name, ended, f"{ended}")
print(node.count_publishers("topic"), "/managed/transition_event" in dict(node.get_topic_names_and_types()))
print(call(GetState, "/managed/get_state", GetState.Request()).current_state)
transitions = call(
    GetAvailableTransitions, "/managed/get_available_transitions", GetAvailableTransitions.Request()
)
print(
    sorted(
        (t.transition.label, t.start_state.label, t.goal_state.label)
        for t in transitions.available_transitions
    )
)
print(node.publisher.is_activated)
request = ChangeState.Request(transition=Transition(id=Transition.TRANSITION_ACTIVATE))
print(call(ChangeState, "/managed/change_state", request).success, node.publisher.is_activated)
print(call(ChangeState, "/managed/change_state", request).success)
print(node.trigger_deactivate().name, node.trigger_cleanup().name, node.trigger_shutdown().name)
print(
    call(GetState, "/managed/get_state", GetState.Request()).current_state.id == State.PRIMARY_STATE_FINALIZED
)
rclpy.shutdown()
