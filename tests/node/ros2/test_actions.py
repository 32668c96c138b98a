"""Actions between nodes on ROS 2."""

from __future__ import annotations

import threading
import time
from typing import Any

import pytest

import roslet
from nodes import serve, wait_until
from ros2_nodes import Ros2Nodes
from roslet.engine.ros2.actions import InvalidTransition
from roslet.errors import InvalidMessage
from roslet.node.ros2.actions import GoalRejected, ServerGoal

FIBONACCI = "example_interfaces/action/Fibonacci"


def fibonacci(goal: ServerGoal) -> dict[str, Any] | None:
    """Fails for order 13; ends soon when it is canceled."""
    sequence = [0, 1]
    for _ in range(1, goal.request.order):
        if goal.cancel_requested:
            goal.canceled(sequence=sequence)
            return None
        if goal.request.order == 13:
            raise ValueError("unlucky")
        sequence.append(min(sequence[-1] + sequence[-2], 1 << 30))
        goal.feedback(sequence=sequence)
        time.sleep(0.002)
    return {"sequence": sequence}


def test_a_goal_gives_feedback_and_a_result(make2: Ros2Nodes) -> None:
    server, client = make2("server"), make2("client")
    server.action_server("fibonacci", FIBONACCI, fibonacci)
    told: list[Any] = []
    goal = client.action_client("fibonacci", FIBONACCI).send_goal(order=5, feedback=told.append, timeout=5)
    status, result = goal.result(5)
    assert (status, list(result.sequence)) == ("SUCCEEDED", [0, 1, 1, 2, 3, 5])
    wait_until(lambda: len(told) == 4, "all feedback comes")
    assert list(told[-1].sequence) == [0, 1, 1, 2, 3, 5]
    wait_until(lambda: goal.status == "SUCCEEDED", "the status topic says so")


def test_a_canceled_goal_ends_as_such_with_what_it_has(make2: Ros2Nodes) -> None:
    node = make2("node")
    node.action_server("fibonacci", FIBONACCI, fibonacci)
    goal = node.action_client("fibonacci", FIBONACCI).send_goal(order=5000, timeout=5)
    serve(0.05)
    assert goal.cancel(5)
    status, result = goal.result(5)
    assert status == "CANCELED" and 2 < len(result.sequence) < 5000
    assert not goal.cancel(5)


def test_a_handler_that_raises_aborts_its_goal(make2: Ros2Nodes) -> None:
    node = make2("node")
    node.action_server("fibonacci", FIBONACCI, fibonacci)
    goal = node.action_client("fibonacci", FIBONACCI).send_goal(order=13, timeout=5)
    status, result = goal.result(5)
    assert (status, list(result.sequence)) == ("ABORTED", [])
    assert node.counters["handler-raised"] == 1


def test_a_server_says_which_goals_it_takes_and_which_may_be_canceled(make2: Ros2Nodes) -> None:
    node = make2("node")
    node.action_server(
        "fibonacci",
        FIBONACCI,
        fibonacci,
        on_goal=lambda request: request.order > 0,
        on_cancel=lambda goal: False,
    )
    client = node.action_client("fibonacci", FIBONACCI)
    with pytest.raises(GoalRejected):
        client.send_goal(order=-1, timeout=5)
    goal = client.send_goal(order=20, timeout=5)
    assert not goal.cancel(5)
    assert goal.result(5)[0] == "SUCCEEDED"


def test_goals_are_worked_on_side_by_side(make2: Ros2Nodes) -> None:
    server, client = make2("server"), make2("client")
    together = threading.Barrier(8, timeout=5)

    def meet(goal: ServerGoal) -> dict[str, Any]:
        together.wait()
        return {"sequence": [goal.request.order]}

    server.action_server("meet", FIBONACCI, meet)
    sender = client.action_client("meet", FIBONACCI)
    goals = [sender.send_goal(order=order, timeout=5) for order in range(8)]
    assert [list(goal.result(5)[1].sequence) for goal in goals] == [[order] for order in range(8)]


def test_without_a_handler_the_goal_is_driven_by_whoever_likes(make2: Ros2Nodes) -> None:
    node = make2("node")
    taken: list[ServerGoal] = []
    node.action_server("fibonacci", FIBONACCI, accepted=taken.append)
    goal = node.action_client("fibonacci", FIBONACCI).send_goal(order=3, timeout=5)
    wait_until(lambda: taken, "it is handed over")
    answer = goal.result_async()
    with pytest.raises(InvalidTransition):
        taken[0].succeed()
    taken[0].execute()
    assert taken[0].status == "EXECUTING" and not answer.done()
    taken[0].abort(sequence=[7])
    wait_until(answer.done, "the result comes")
    assert answer.result(0)[0] == "ABORTED" and list(answer.result(0)[1].sequence) == [7]
    with pytest.raises(InvalidTransition):
        taken[0].succeed()


def test_a_result_is_kept_for_a_while_and_then_forgotten(make2: Ros2Nodes) -> None:
    node = make2("node")
    server = node.action_server("fibonacci", FIBONACCI, fibonacci, result_timeout=0.2)
    client = node.action_client("fibonacci", FIBONACCI)
    goal = client.send_goal(order=2, timeout=5)
    wait_until(lambda: goal.status == "SUCCEEDED", "it ends")
    assert len(server.goals) == 1
    wait_until(lambda: not server.goals, "it is forgotten")
    assert goal.result(5)[0] == "UNKNOWN"


def test_a_call_without_a_server_says_in_time_that_there_is_none(make2: Ros2Nodes) -> None:
    client = make2("node").action_client("nobody", FIBONACCI)
    assert not client.wait(0.05)
    with pytest.raises(roslet.CallTimeout, match="nobody"):
        client.send_goal(order=1, timeout=0.1)


def test_a_displaced_goal_is_forgotten_and_counted(make2: Ros2Nodes) -> None:
    node = make2("node")
    server: Any = node.action_server("fibonacci", FIBONACCI, fibonacci, result_timeout=None)
    server._goals.max_goals = 2
    client = node.action_client("fibonacci", FIBONACCI)
    for _ in range(4):
        assert client.send_goal(order=2, timeout=5).result(5)[0] == "SUCCEEDED"
    assert len(server.goals) == 2
    assert node.counters["result-displaced"] == 2


def test_a_goal_that_ends_while_it_is_asked_whether_it_may_be_canceled_is_not_canceled(
    make2: Ros2Nodes,
) -> None:
    node = make2("node")
    taken: list[ServerGoal] = []

    def end(goal: ServerGoal) -> bool:
        goal.succeed(sequence=[1])
        return True

    node.action_server("fibonacci", FIBONACCI, accepted=taken.append, on_cancel=end)
    goal = node.action_client("fibonacci", FIBONACCI).send_goal(order=2, timeout=5)
    wait_until(lambda: taken, "it is handed over")
    taken[0].execute()
    assert not goal.cancel(5)
    assert goal.result(5)[0] == "SUCCEEDED"


def test_goals_that_are_given_up_or_cannot_be_sent_are_forgotten(make2: Ros2Nodes) -> None:
    client: Any = make2("node").action_client("nobody", FIBONACCI)
    with pytest.raises(roslet.CallTimeout):
        client.send_goal(order=1, timeout=0.05)
    with pytest.raises(InvalidMessage):
        client.send_goal(order=1 << 40, timeout=0.05)
    assert len(client._goals) == 0
    assert all(future.done() for _, future in client._send._waiting)


def test_a_node_that_closes_meanwhile_is_said_to_be_closed(make2: Ros2Nodes) -> None:
    node = make2("node")
    client = node.action_client("nobody", FIBONACCI)
    network: Any = node._network
    goodbye = network.say_goodbye

    def slowly() -> None:
        time.sleep(0.2)
        goodbye()

    network.say_goodbye = slowly
    threading.Timer(0.05, node.close).start()
    with pytest.raises(roslet.NodeClosed):
        client.send_goal(order=1)
