"""`rclpy.waitable`: something of a program's own that an executor runs.

rclpy's wait sets are not here. `is_ready(None)` is asked whenever the executor looks, and it looks when something arrives at
the node, when a timer is due, and when a guard condition of the node is triggered.
"""

from __future__ import annotations

from types import GenericAlias
from typing import TYPE_CHECKING, Any

from roslet.compat.rclpy._entity import Entity

if TYPE_CHECKING:
    from roslet.compat.rclpy.callback_groups import CallbackGroup


class NumberOfEntities:
    """How many entities of each kind a waitable adds to a wait set."""

    _names = (
        "num_subscriptions",
        "num_guard_conditions",
        "num_timers",
        "num_clients",
        "num_services",
        "num_events",
    )

    def __init__(
        self,
        num_subs: int = 0,
        num_gcs: int = 0,
        num_timers: int = 0,
        num_clients: int = 0,
        num_services: int = 0,
        num_events: int = 0,
    ) -> None:
        self.num_subscriptions = num_subs
        self.num_guard_conditions = num_gcs
        self.num_timers = num_timers
        self.num_clients = num_clients
        self.num_services = num_services
        self.num_events = num_events

    def __add__(self, other: NumberOfEntities) -> NumberOfEntities:
        return NumberOfEntities(*(getattr(self, name) + getattr(other, name) for name in self._names))


class Waitable(Entity):
    """The base: give it `is_ready`, `take_data` and `execute`, and add it by `Node.add_waitable`."""

    _polled = True
    # Programs annotate with `Waitable[...]`, and Python evaluates that.
    __class_getitem__: Any = classmethod(GenericAlias)

    def __init__(self, callback_group: CallbackGroup | None) -> None:
        super().__init__(callback_group)
        self._futures: list[Any] = []

    def add_future(self, future: Any) -> None:
        """Nothing more than that it is kept."""
        self._futures.append(future)

    def remove_future(self, future: Any) -> None:
        """It is kept no more."""
        self._futures.remove(future)

    def is_ready(self, wait_set: Any) -> bool:
        """Whether there is data to be taken."""
        raise NotImplementedError("Must be implemented by subclass")

    def take_data(self) -> Any:
        """The data, which `execute` gets."""
        raise NotImplementedError("Must be implemented by subclass")

    async def execute(self, taken_data: Any) -> None:
        """Do something with it."""
        raise NotImplementedError("Must be implemented by subclass")

    def get_num_entities(self) -> NumberOfEntities:
        """How many entities it adds to a wait set."""
        return NumberOfEntities()

    def add_to_wait_set(self, wait_set: Any) -> None:
        """Nothing: there are no wait sets."""

    def _ready(self) -> bool:
        return not self._destroyed and bool(self.is_ready(None))

    def _take(self) -> Any:
        return self.take_data()

    def _run(self, work: Any) -> Any:
        return self.execute(work)


__all__ = ["NumberOfEntities", "Waitable"]
