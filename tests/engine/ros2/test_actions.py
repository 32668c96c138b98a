"""Goals of actions: the states of the design document, and what rcl_action does with cancel requests, written by hand."""

import pytest

from roslet.engine.ros2 import actions as a
from roslet.engine.ros2.actions import (
    ClientGoals,
    InvalidTransition,
    ServerGoals,
    action_names,
    actions_among,
)
from roslet.names import dds_service_types

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

pytestmark = pytest.mark.micropython


def uuid(number: int) -> bytes:
    return bytes(15) + bytes((number,))


def test_an_action_is_three_services_and_two_topics() -> None:
    names = action_names("/n/fibonacci", "example_interfaces/action/Fibonacci")
    assert names.send_goal == (
        "/n/fibonacci/_action/send_goal",
        "example_interfaces/action/Fibonacci_SendGoal",
    )
    assert names.cancel_goal == ("/n/fibonacci/_action/cancel_goal", "action_msgs/srv/CancelGoal")
    assert names.get_result == (
        "/n/fibonacci/_action/get_result",
        "example_interfaces/action/Fibonacci_GetResult",
    )
    assert names.feedback == (
        "/n/fibonacci/_action/feedback",
        "example_interfaces/action/Fibonacci_FeedbackMessage",
    )
    assert names.status == ("/n/fibonacci/_action/status", "action_msgs/msg/GoalStatusArray")
    assert (
        dds_service_types(names.send_goal[1])[0]
        == "example_interfaces::action::dds_::Fibonacci_SendGoal_Request_"
    )


def test_actions_are_found_among_topics() -> None:
    names = action_names("/f", "p/action/F")
    topics = {
        names.feedback[0]: [names.feedback[1]],
        names.status[0]: [names.status[1]],
        "/_action/feedback": ["x"],
    }
    topics["/g/_action/feedback"] = ["p/msg/Other"]
    assert actions_among(topics) == {"/f": ["p/action/F"]}


def test_a_goal_runs_through_its_states() -> None:
    for path, last in (
        ((a.EXECUTE, a.SUCCEED), a.SUCCEEDED),
        ((a.EXECUTE, a.ABORT), a.ABORTED),
        ((a.EXECUTE, a.CANCEL_GOAL, a.CANCELED_EVENT), a.CANCELED),
        ((a.EXECUTE, a.CANCEL_GOAL, a.SUCCEED), a.SUCCEEDED),
        ((a.EXECUTE, a.CANCEL_GOAL, a.ABORT), a.ABORTED),
        ((a.CANCEL_GOAL, a.CANCELED_EVENT), a.CANCELED),
    ):
        goals = ServerGoals()
        goal = goals.accept(uuid(1), 1)
        for event in path:
            assert goal.active
            assert goals.apply(goal, event, 0.0) == goal.status
        assert goal.status == last
        assert not goal.active
        for event in range(5):
            with pytest.raises(InvalidTransition, match="a goal that is %s" % a.STATES[last]):
                goals.apply(goal, event, 0.0)


def test_what_is_not_in_the_table_cannot_happen() -> None:
    allowed = {(1, 0), (1, 1), (2, 1), (2, 2), (2, 3), (3, 2), (3, 3), (3, 4)}
    assert {pair for pair in a.TRANSITIONS} == allowed  # noqa: C416
    goals = ServerGoals()
    goal = goals.accept(uuid(1), 1)
    with pytest.raises(InvalidTransition, match="SUCCEED cannot happen to a goal that is ACCEPTED"):
        goals.apply(goal, a.SUCCEED, 0.0)
    with pytest.raises(InvalidTransition, match="a goal that is ACCEPTED has no result"):
        goals.finish(goal, "r")


def end(goals: ServerGoals, goal: "Any", result: str, now: float) -> "list[Any]":
    goals.apply(goal, a.EXECUTE, now)
    goals.apply(goal, a.SUCCEED, now)
    return goals.finish(goal, result)


def test_a_result_waits_for_its_requests_and_they_for_it() -> None:
    goals = ServerGoals(result_timeout=10.0)
    goal = goals.accept(uuid(1), 5)
    assert goals.ask_result(uuid(1), "first") is None
    assert goals.ask_result(uuid(2), "other") == (a.UNKNOWN, None)
    assert goals.deadline() is None
    assert end(goals, goal, "done", 100.0) == ["first"]
    assert goals.ask_result(uuid(1), "second") == (a.SUCCEEDED, "done")
    assert goals.statuses() == [(uuid(1), 5, a.SUCCEEDED)]
    assert goals.deadline() == 110.0
    assert goals.handle_deadline(109.9) == []
    assert goals.handle_deadline(110.0) == [goal]
    assert goals.ask_result(uuid(1), "third") == (a.UNKNOWN, None)
    assert goals.statuses() == []
    forever = ServerGoals(result_timeout=None)
    end(forever, forever.accept(uuid(1), 5), "done", 0.0)
    assert forever.deadline() is None


def test_goals_and_requests_are_bounded() -> None:
    goals = ServerGoals(max_goals=2)
    first, second = goals.accept(uuid(1), 1), goals.accept(uuid(2), 2)
    assert goals.refusal(uuid(1)) == "goal-id-repeated"
    assert goals.refusal(uuid(3)) == "goals-full"
    with pytest.raises(ValueError, match="goals-full"):
        goals.accept(uuid(3), 3)
    end(goals, second, "r", 0.0)
    goals.accept(uuid(3), 3)
    assert [one for one, _, _ in goals.statuses()] == [uuid(1), uuid(3)]
    for number in range(a.MAX_WAITING + 1):
        goals.ask_result(uuid(1), number)
    assert end(goals, first, "r", 0.0) == list(range(1, a.MAX_WAITING + 1))
    assert goals.counters == {
        "goal-id-repeated": 1,
        "goals-full": 2,
        "result-displaced": 1,
        "result-requests-full": 1,
    }


def test_a_cancel_request_names_one_goal_some_or_all() -> None:
    goals = ServerGoals()
    made = [goals.accept(uuid(number), 10 * number) for number in (1, 2, 3, 4)]
    end(goals, made[3], "r", 0.0)
    nobody = bytes(16)

    def asked(which: bytes, stamp: int) -> "tuple[int, list[int]]":
        code, found = goals.cancel(which, stamp)
        return code, [goal.uuid[15] for goal in found]

    assert asked(nobody, 0) == (a.CANCEL_NONE, [1, 2, 3])
    assert asked(nobody, 20) == (a.CANCEL_NONE, [1, 2])
    assert asked(uuid(3), 10) == (a.CANCEL_NONE, [1, 3])
    assert asked(uuid(2), 0) == (a.CANCEL_NONE, [2])
    assert asked(uuid(4), 0) == (a.CANCEL_TERMINATED, [])
    assert asked(uuid(9), 0) == (a.CANCEL_UNKNOWN_GOAL, [])
    assert asked(uuid(9), 5) == (a.CANCEL_NONE, [])
    goals.apply(made[1], a.CANCEL_GOAL, 0.0)
    assert asked(nobody, 0) == (a.CANCEL_NONE, [1, 3])
    assert asked(uuid(2), 0) == (a.CANCEL_TERMINATED, [])
    assert a.cancel_code(a.CANCEL_NONE, 2, 0) == a.CANCEL_REJECTED
    assert a.cancel_code(a.CANCEL_NONE, 2, 1) == a.CANCEL_NONE
    assert a.cancel_code(a.CANCEL_NONE, 0, 0) == a.CANCEL_NONE
    assert a.cancel_code(a.CANCEL_UNKNOWN_GOAL, 0, 0) == a.CANCEL_UNKNOWN_GOAL


def test_a_client_follows_its_own_goals_only() -> None:
    goals = ClientGoals(max_goals=2)
    first = goals.send(uuid(1), "owner")
    goals.send(uuid(2))
    with pytest.raises(ValueError, match="in use"):
        goals.send(uuid(1))
    with pytest.raises(ValueError, match="2 goals"):
        goals.send(uuid(3))
    assert goals.answered(uuid(9), True) is None
    rejected = goals.answered(uuid(2), False)
    assert rejected is not None
    assert rejected.accepted is False
    assert goals.get(uuid(2)) is None
    assert goals.answered(uuid(1), True, 77) is first
    assert (first.status, first.stamp, first.owner) == (a.ACCEPTED, 77, "owner")
    assert goals.told([(uuid(1), a.EXECUTING), (uuid(9), a.EXECUTING), (uuid(1), a.EXECUTING)]) == [first]
    assert goals.told([(uuid(1), 99)]) == []
    assert goals.told([(uuid(1), a.SUCCEEDED)]) == [first]
    assert goals.told([(uuid(1), a.EXECUTING)]) == []
    assert goals.result(uuid(1), a.SUCCEEDED) is first
    assert goals.result(uuid(1), a.SUCCEEDED) is None
    assert len(goals) == 0
    goals.forget(uuid(1))


def test_a_client_that_asks_for_no_results_may_send_goals_for_ever() -> None:
    goals = ClientGoals(max_goals=2)
    running = goals.send(uuid(0))
    for number in range(1, 9):
        goals.send(uuid(number))
        goals.answered(uuid(number), True)
        goals.told([(uuid(number), a.ABORTED)])
    assert len(goals) == 2
    assert goals.get(uuid(0)) is running


def test_a_status_may_be_there_before_the_answer() -> None:
    goals = ClientGoals()
    goal = goals.send(uuid(1))
    goals.told([(uuid(1), a.EXECUTING)])
    goals.answered(uuid(1), True)
    assert goal.status == a.EXECUTING


def test_goals_whose_results_nobody_asks_for_make_room_when_they_have_ended() -> None:
    goals = ClientGoals(max_goals=2)
    for number in range(1, 6):
        goals.send(uuid(number))
        goals.answered(uuid(number), True)
        goals.told([(uuid(number), a.SUCCEEDED)])
    goals.send(uuid(6))
    with pytest.raises(ValueError, match="2 goals have not ended"):
        goals.answered(uuid(6), True)
        goals.send(uuid(7))
        goals.send(uuid(8))


def test_refusals_are_counted_where_the_owner_counts() -> None:
    counters: dict[str, int] = {}
    goals = ServerGoals(counters=counters)
    goals.accept(uuid(1), 1)
    assert goals.refusal(uuid(1)) == "goal-id-repeated"
    assert counters == {"goal-id-repeated": 1}
