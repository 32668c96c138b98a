"""Quality of service."""

from __future__ import annotations

RELIABILITY = ("reliable", "best_effort")
DURABILITY = ("volatile", "transient_local")
HISTORY = ("keep_last", "keep_all")


class QoS:
    """How a topic's messages are kept and carried.

    depth        most messages kept for one slow subscriber (`keep_last`); the oldest is dropped and counted
    reliability  "reliable", or "best_effort": ROS 1 subscribes it over UDPROS
    durability   "volatile", or "transient_local": a late subscriber gets the last message (ROS 1: latched)
    history      "keep_last", or "keep_all": publishing waits for a slow subscriber instead of dropping

    Raises ValueError for any other value.
    """

    __slots__ = ("depth", "durability", "history", "reliability")

    def __init__(
        self,
        depth: int = 10,
        reliability: str = "reliable",
        durability: str = "volatile",
        history: str = "keep_last",
    ) -> None:
        if not isinstance(depth, int) or depth < 1:
            raise ValueError(f"depth must be an integer of at least 1, not {depth!r}")
        for name, value, allowed in (
            ("reliability", reliability, RELIABILITY),
            ("durability", durability, DURABILITY),
            ("history", history, HISTORY),
        ):
            if value not in allowed:
                raise ValueError(f"{name} must be one of {', '.join(allowed)}, not {value!r}")
        self.depth = depth
        self.reliability = reliability
        self.durability = durability
        self.history = history

    def __repr__(self) -> str:
        return (
            f"QoS(depth={self.depth}, reliability={self.reliability!r}, durability={self.durability!r}, "
            f"history={self.history!r})"
        )

    def __eq__(self, other: object) -> bool:
        return isinstance(other, QoS) and repr(self) == repr(other)

    def __hash__(self) -> int:
        return hash(repr(self))
