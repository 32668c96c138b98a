"""Quality of service."""

from __future__ import annotations

RELIABILITY = ("reliable", "best_effort")
DURABILITY = ("volatile", "transient_local")
HISTORY = ("keep_last", "keep_all")
LIVELINESS = ("automatic", "manual_by_topic")


class QoS:
    """How a topic's messages are kept and carried.

    depth             most messages kept for one slow subscriber (`keep_last`); the oldest is dropped and counted
    reliability       "reliable", or "best_effort": ROS 1 subscribes it over UDPROS
    durability        "volatile", or "transient_local": a late subscriber gets the last ones (ROS 1: the last one, latched)
    history           "keep_last", or "keep_all": publishing waits for a slow subscriber instead of dropping

    On ROS 2 only; seconds, None where there is no bound:

    deadline          the longest time between two messages
    lifespan          how long a message is good for
    liveliness        "automatic": alive while the node is; "manual_by_topic": while it publishes, or asserts it
    liveliness_lease  how long a publisher may be silent

    Raises ValueError for any other value.
    """

    __slots__ = (
        "deadline",
        "depth",
        "durability",
        "history",
        "lifespan",
        "liveliness",
        "liveliness_lease",
        "reliability",
    )

    def __init__(
        self,
        depth: int = 10,
        reliability: str = "reliable",
        durability: str = "volatile",
        history: str = "keep_last",
        *,
        deadline: float | None = None,
        lifespan: float | None = None,
        liveliness: str = "automatic",
        liveliness_lease: float | None = None,
    ) -> None:
        if not isinstance(depth, int) or depth < 1:
            raise ValueError(f"depth must be an integer of at least 1, not {depth!r}")
        for name, value, allowed in (
            ("reliability", reliability, RELIABILITY),
            ("durability", durability, DURABILITY),
            ("history", history, HISTORY),
            ("liveliness", liveliness, LIVELINESS),
        ):
            if value not in allowed:
                raise ValueError(f"{name} must be one of {', '.join(allowed)}, not {value!r}")
        for name, seconds in (
            ("deadline", deadline),
            ("lifespan", lifespan),
            ("liveliness_lease", liveliness_lease),
        ):
            if seconds is not None and not seconds > 0:
                raise ValueError(f"{name} must be a positive number of seconds or None, not {seconds!r}")
        self.depth = depth
        self.reliability = reliability
        self.durability = durability
        self.history = history
        self.deadline = deadline
        self.lifespan = lifespan
        self.liveliness = liveliness
        self.liveliness_lease = liveliness_lease

    @property
    def of_ros2(self) -> list[str]:
        """The names of the policies set that only ROS 2 has."""
        plain = QoS()
        return [
            name
            for name in ("deadline", "lifespan", "liveliness", "liveliness_lease")
            if getattr(self, name) != getattr(plain, name)
        ]

    def __repr__(self) -> str:
        text = (
            f"QoS(depth={self.depth}, reliability={self.reliability!r}, durability={self.durability!r}, "
            f"history={self.history!r}"
        )
        return text + "".join(f", {name}={getattr(self, name)!r}" for name in self.of_ros2) + ")"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, QoS) and repr(self) == repr(other)

    def __hash__(self) -> int:
        return hash(repr(self))
