"""Goals of actions: their states, what a server keeps of them, and what a client knows. ROS 2 design, "Actions"; rcl_action.

An action is three services and two topics below `NAME/_action`. This module holds no endpoints: a node makes those, and asks
here what is to be done. Goal ids are 16 octets, stamps int nanoseconds of the Unix epoch.
"""

from roslet.errors import RosletError
from roslet.record import Names, Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

# action_msgs/msg/GoalStatus
UNKNOWN, ACCEPTED, EXECUTING, CANCELING, SUCCEEDED, CANCELED, ABORTED = 0, 1, 2, 3, 4, 5, 6

STATES = Names(
    "state",
    {
        UNKNOWN: "UNKNOWN",
        ACCEPTED: "ACCEPTED",
        EXECUTING: "EXECUTING",
        CANCELING: "CANCELING",
        SUCCEEDED: "SUCCEEDED",
        CANCELED: "CANCELED",
        ABORTED: "ABORTED",
    },
)

EXECUTE, CANCEL_GOAL, SUCCEED, ABORT, CANCELED_EVENT = 0, 1, 2, 3, 4
"""What happens to a goal; the last one says that canceling is done."""

EVENTS = Names(
    "event",
    {
        EXECUTE: "EXECUTE",
        CANCEL_GOAL: "CANCEL_GOAL",
        SUCCEED: "SUCCEED",
        ABORT: "ABORT",
        CANCELED_EVENT: "CANCELED",
    },
)

TRANSITIONS = {
    (ACCEPTED, EXECUTE): EXECUTING,
    (ACCEPTED, CANCEL_GOAL): CANCELING,
    (EXECUTING, CANCEL_GOAL): CANCELING,
    (EXECUTING, SUCCEED): SUCCEEDED,
    (EXECUTING, ABORT): ABORTED,
    (CANCELING, SUCCEED): SUCCEEDED,
    (CANCELING, ABORT): ABORTED,
    (CANCELING, CANCELED_EVENT): CANCELED,
}
"""(state, event) -> state; what is not there cannot happen."""

CANCEL_NONE, CANCEL_REJECTED, CANCEL_UNKNOWN_GOAL, CANCEL_TERMINATED = 0, 1, 2, 3
"""Return codes of action_msgs/srv/CancelGoal."""

# Seconds that a server keeps a result that was reached, as rcl does.
RESULT_TIMEOUT = 10.0
# Goals of one server or client that are not forgotten: clients can send any number, also to rclpy, which has no bound.
MAX_GOALS = 1024
# Requests that wait for the result of one goal.
MAX_WAITING = 64


class InvalidTransition(RosletError):
    """A goal in this state cannot do that."""


class ActionNames(Record):
    """The channels of an action, by name and type: `send_goal`, `cancel_goal`, `get_result` (services), `feedback`, `status`
    (topics), each (full name, ROS type). Status is RELIABLE, TRANSIENT_LOCAL, KEEP_LAST 1; the rest is as any other."""

    _fields = ("send_goal", "cancel_goal", "get_result", "feedback", "status")
    __slots__ = _fields

    def __init__(
        self,
        send_goal: "tuple[str, str]",
        cancel_goal: "tuple[str, str]",
        get_result: "tuple[str, str]",
        feedback: "tuple[str, str]",
        status: "tuple[str, str]",
    ) -> None:
        self.send_goal = send_goal
        self.cancel_goal = cancel_goal
        self.get_result = get_result
        self.feedback = feedback
        self.status = status


def action_names(name: str, type_name: str) -> ActionNames:
    """The channels of action `name` (a full name) of type `package/action/Name`."""
    within = name + "/_action/"
    return ActionNames(
        (within + "send_goal", type_name + "_SendGoal"),
        (within + "cancel_goal", "action_msgs/srv/CancelGoal"),
        (within + "get_result", type_name + "_GetResult"),
        (within + "feedback", type_name + "_FeedbackMessage"),
        (within + "status", "action_msgs/msg/GoalStatusArray"),
    )


def actions_among(topics: "dict[str, list[str]]") -> "dict[str, list[str]]":
    """The actions that topics (name -> types) belong to, and their types: those that have a feedback topic."""
    found = {}
    ending, suffix = "/_action/feedback", "_FeedbackMessage"
    for topic, types in topics.items():
        if topic.endswith(ending) and len(topic) > len(ending):
            own = [one[: -len(suffix)] for one in types if one.endswith(suffix)]
            if own:
                found[topic[: -len(ending)]] = own
    return found


class ServerGoal:
    """A goal that a server accepted. `request`, `result` and `owner` are its owner's; `waiting` are requests for the
    result."""

    __slots__ = ("expires", "finished", "owner", "request", "result", "stamp", "status", "uuid", "waiting")

    def __init__(self, uuid: bytes, stamp: int, request: "Any") -> None:
        self.uuid = uuid
        self.stamp = stamp
        self.request = request
        self.owner: Any = None
        self.status = ACCEPTED
        self.result: Any = None
        self.finished = False  # whether `result` is there
        self.waiting: list[Any] = []
        self.expires: float | None = None

    @property
    def active(self) -> bool:
        """Whether it has not ended."""
        return self.status in (ACCEPTED, EXECUTING, CANCELING)


class ServerGoals:
    """The goals of one action server, from acceptance until their results expire.

    result_timeout   seconds that a result is kept, None for ever (until `max_goals` are there)
    counters         what was refused or dropped, by reason; those of a Context where given
    """

    def __init__(
        self,
        result_timeout: "float | None" = RESULT_TIMEOUT,
        max_goals: int = MAX_GOALS,
        counters: "dict[str, int] | None" = None,
    ) -> None:
        self.result_timeout = result_timeout
        self.max_goals = max_goals
        self.counters: dict[str, int] = {} if counters is None else counters
        self._goals: dict[bytes, ServerGoal] = {}
        self._order: list[bytes] = []

    def refusal(self, uuid: bytes) -> str:
        """Why a goal of this id cannot be accepted, whatever its server thinks of it: a reason, which is counted; or ""."""
        if uuid in self._goals:
            return self._count("goal-id-repeated")
        if len(self._goals) >= self.max_goals and not self._finished():
            return self._count("goals-full")
        return ""

    def accept(self, uuid: bytes, stamp: int, request: "Any" = None) -> ServerGoal:
        """A goal that nothing speaks against. Forgets the oldest result where there are too many goals. Raises ValueError
        where `refusal` says something."""
        reason = self.refusal(uuid)
        if reason:
            raise ValueError("the goal cannot be accepted: %s" % reason)
        if len(self._goals) >= self.max_goals:
            self._count("result-displaced")
            self._forget(self._finished()[0])
        goal = self._goals[uuid] = ServerGoal(uuid, stamp, request)
        self._order.append(uuid)
        return goal

    def get(self, uuid: bytes) -> "ServerGoal | None":
        return self._goals.get(uuid)

    def all(self) -> "list[ServerGoal]":
        """Those that are not forgotten, in the order of acceptance."""
        return [self._goals[uuid] for uuid in self._order]

    def statuses(self) -> "list[tuple[bytes, int, int]]":
        """(id, stamp, status) of each goal, in the order of acceptance: what the status topic says."""
        return [(goal.uuid, goal.stamp, goal.status) for goal in self.all()]

    def apply(self, goal: ServerGoal, event: int, now: float) -> int:
        """Let an event happen to a goal; its new status, which the status topic is to say. Raises InvalidTransition."""
        status = TRANSITIONS.get((goal.status, event))
        if status is None:
            raise InvalidTransition(
                "%s cannot happen to a goal that is %s" % (EVENTS[event], STATES[goal.status])
            )
        goal.status = status
        if not goal.active and self.result_timeout is not None:
            goal.expires = now + self.result_timeout
        return status

    def finish(self, goal: ServerGoal, result: "Any") -> "list[Any]":
        """The result of a goal that has ended: the requests that waited for it. Raises InvalidTransition before the end."""
        if goal.active:
            raise InvalidTransition("a goal that is %s has no result" % STATES[goal.status])
        goal.result = result
        goal.finished = True
        waiting = goal.waiting
        goal.waiting = []
        return waiting

    def ask_result(self, uuid: bytes, request: "Any") -> "tuple[int, Any] | None":
        """A request for a result: (status, result) to answer with at once, (UNKNOWN, None) for a goal that is not known or
        no more; None: it waits, and `finish` will give it back."""
        goal = self._goals.get(uuid)
        if goal is None:
            return UNKNOWN, None
        if goal.finished:
            return goal.status, goal.result
        if len(goal.waiting) >= MAX_WAITING:
            self._count("result-requests-full")
            goal.waiting.pop(0)
        goal.waiting.append(request)
        return None

    def cancel(self, uuid: bytes, stamp: int) -> "tuple[int, list[ServerGoal]]":
        """What a cancel request is about: (CANCEL_ code, goals that may be canceled).

        Both zero: all goals. A stamp: all that were accepted until then, and the one of the id. An id alone: that one. Its
        owner asks whoever decides, applies CANCEL_GOAL to those that are to be canceled, and answers with `cancel_code`.
        """
        if any(uuid) and not stamp:
            goal = self._goals.get(uuid)
            if goal is None:
                return CANCEL_UNKNOWN_GOAL, []
            return (CANCEL_NONE, [goal]) if _cancelable(goal) else (CANCEL_TERMINATED, [])
        everything = not stamp
        found = []
        for goal in self.all():
            if _cancelable(goal) and (everything or goal.stamp <= stamp or goal.uuid == uuid):
                found.append(goal)
        return CANCEL_NONE, found

    def deadline(self) -> "float | None":
        """When the next result expires, or None."""
        found: float | None = None
        for goal in self._goals.values():
            if goal.expires is not None and (found is None or goal.expires < found):
                found = goal.expires
        return found

    def handle_deadline(self, now: float) -> "list[ServerGoal]":
        """Forget the goals whose results have expired, and return them; what still waits for one of them gets
        (UNKNOWN, None)."""
        expired = [goal for goal in self._goals.values() if goal.expires is not None and goal.expires <= now]
        for goal in expired:
            self._forget(goal)
        return expired

    def _finished(self) -> "list[ServerGoal]":
        return [goal for goal in self.all() if goal.finished]

    def _forget(self, goal: ServerGoal) -> None:
        del self._goals[goal.uuid]
        self._order.remove(goal.uuid)

    def _count(self, reason: str) -> str:
        self.counters[reason] = self.counters.get(reason, 0) + 1
        return reason


def _cancelable(goal: ServerGoal) -> bool:
    return goal.status == ACCEPTED or goal.status == EXECUTING


def cancel_code(code: int, asked: int, canceling: int) -> int:
    """The return code of a cancel response: of `asked` goals, `canceling` are being canceled now."""
    return CANCEL_REJECTED if code == CANCEL_NONE and asked and not canceling else code


class ClientGoal:
    """A goal that a client sent; `accepted` None until the server says; `owner` is its sender's."""

    __slots__ = ("accepted", "owner", "stamp", "status", "uuid")

    def __init__(self, uuid: bytes, owner: "Any") -> None:
        self.uuid = uuid
        self.owner = owner
        self.accepted: bool | None = None
        self.stamp = 0
        self.status = UNKNOWN


class ClientGoals:
    """The goals of one action client, until their results are there or they are forgotten.

    Feedback and status are told to every client: of goals that are not ours they are ignored.
    """

    def __init__(self, max_goals: int = MAX_GOALS) -> None:
        self.max_goals = max_goals
        self._goals: dict[bytes, ClientGoal] = {}

    def __len__(self) -> int:
        return len(self._goals)

    def send(self, uuid: bytes, owner: "Any" = None) -> ClientGoal:
        """A goal that is being sent. Where there are too many, those are forgotten that have ended and whose results
        nobody got. Raises ValueError where the id is in use, or none has ended."""
        if uuid in self._goals:
            raise ValueError("the goal's id is in use")
        if len(self._goals) >= self.max_goals:
            ended = [one for one in self._goals.values() if one.status >= SUCCEEDED]
            if not ended:
                raise ValueError("%d goals have not ended" % len(self._goals))
            for one in ended:
                self.forget(one.uuid)
        goal = self._goals[uuid] = ClientGoal(uuid, owner)
        return goal

    def get(self, uuid: bytes) -> "ClientGoal | None":
        return self._goals.get(uuid)

    def answered(self, uuid: bytes, accepted: bool, stamp: int = 0) -> "ClientGoal | None":
        """The server accepted or rejected a goal; a rejected one is forgotten."""
        goal = self._goals.get(uuid)
        if goal is not None and goal.accepted is None:
            goal.accepted = accepted
            goal.stamp = stamp
            if accepted:
                # The status topic may have been faster.
                goal.status = goal.status or ACCEPTED
            else:
                del self._goals[uuid]
        return goal

    def told(self, statuses: "list[tuple[bytes, int]]") -> "list[ClientGoal]":
        """(id, status) of the status topic: our goals whose status it changed. A goal that has ended stays so."""
        changed = []
        for uuid, status in statuses:
            goal = self._goals.get(uuid)
            if (
                goal is None
                or status == goal.status
                or goal.status >= SUCCEEDED
                or status not in STATES.table
            ):
                continue
            goal.status = status
            changed.append(goal)
        return changed

    def result(self, uuid: bytes, status: int) -> "ClientGoal | None":
        """Its result is there: the goal, which is forgotten."""
        goal = self._goals.pop(uuid, None)
        if goal is not None:
            goal.status = status
        return goal

    def forget(self, uuid: bytes) -> None:
        """A goal that nobody waits for any more; one that is not there is no error."""
        self._goals.pop(uuid, None)
