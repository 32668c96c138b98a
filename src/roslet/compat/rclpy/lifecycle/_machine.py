"""The states of a managed node, as lifecycle_msgs numbers them and rcl_lifecycle connects them.

unconfigured --configure--> configuring ----> inactive --activate----> activating ----> active
inactive ----cleanup------> cleaningup -----> unconfigured             active --deactivate--> deactivating --> inactive
any of the three --shutdown--> shuttingdown --> finalized
an error in any transition --> errorprocessing --> unconfigured, or finalized
"""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

(UNCONFIGURED, INACTIVE, ACTIVE, FINALIZED) = (1, 2, 3, 4)
(CONFIGURING, CLEANINGUP, SHUTTINGDOWN, ACTIVATING, DEACTIVATING, ERRORPROCESSING) = (10, 11, 12, 13, 14, 15)
STATES = {
    0: "unknown",
    UNCONFIGURED: "unconfigured",
    INACTIVE: "inactive",
    ACTIVE: "active",
    FINALIZED: "finalized",
    CONFIGURING: "configuring",
    CLEANINGUP: "cleaningup",
    SHUTTINGDOWN: "shuttingdown",
    ACTIVATING: "activating",
    DEACTIVATING: "deactivating",
    ERRORPROCESSING: "errorprocessing",
}


class TransitionCallbackReturn(IntEnum):
    """How a transition ended."""

    SUCCESS = 97
    FAILURE = 98
    ERROR = 99

    def __str__(self) -> str:
        return f"TransitionCallbackReturnType.{self.name}"

    def __format__(self, format_spec: str) -> str:
        return format(str(self), format_spec)

    def to_label(self) -> str:
        """The label of the transition that follows."""
        return "transition_" + self.name.lower()


class Transition(NamedTuple):
    """From one state to another."""

    number: int
    label: str
    start: int
    goal: int


def _ends(
    first: int, state: int, success: int, failure: int, error: int = ERRORPROCESSING
) -> list[Transition]:
    return [
        Transition(first + offset, kind.to_label(), state, goal)
        for offset, (kind, goal) in enumerate(
            zip(TransitionCallbackReturn, (success, failure, error), strict=True)
        )
    ]


TRANSITIONS = [
    Transition(1, "configure", UNCONFIGURED, CONFIGURING),
    *_ends(10, CONFIGURING, INACTIVE, UNCONFIGURED),
    Transition(2, "cleanup", INACTIVE, CLEANINGUP),
    *_ends(20, CLEANINGUP, UNCONFIGURED, INACTIVE),
    Transition(3, "activate", INACTIVE, ACTIVATING),
    *_ends(30, ACTIVATING, ACTIVE, INACTIVE),
    Transition(4, "deactivate", ACTIVE, DEACTIVATING),
    *_ends(40, DEACTIVATING, INACTIVE, ACTIVE),
    Transition(5, "shutdown", UNCONFIGURED, SHUTTINGDOWN),
    Transition(6, "shutdown", INACTIVE, SHUTTINGDOWN),
    Transition(7, "shutdown", ACTIVE, SHUTTINGDOWN),
    *_ends(50, SHUTTINGDOWN, FINALIZED, FINALIZED),
    *_ends(60, ERRORPROCESSING, UNCONFIGURED, FINALIZED, FINALIZED),
]


class Machine:
    """`state` is where the node stands."""

    def __init__(self) -> None:
        self.state = UNCONFIGURED

    def available(self) -> list[Transition]:
        """The transitions out of the present state."""
        return [one for one in TRANSITIONS if one.start == self.state]

    def find(self, which: int | str) -> Transition | None:
        """The transition of this number or label out of the present state, None where there is none."""
        for one in self.available():
            if which in (one.number, one.label):
                return one
        return None


__all__ = ["STATES", "TRANSITIONS", "Machine", "Transition", "TransitionCallbackReturn"]
