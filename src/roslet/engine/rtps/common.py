"""What all endpoints of a participant share."""

from roslet.engine.rtps.fragments import Budget
from roslet.engine.rtps.schedule import Schedule

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from roslet.engine.rtps.limits import Limits
    from roslet.engine.rtps.outbox import Outbox


def _ignore(event: object) -> None:
    """Events that nobody wants."""


def _anywhere(host: str) -> bool:
    """Where our own addresses are not known, all peers are taken for near."""
    return True


class Common:
    """`header` of our messages; `outbox` of what goes out; `counters` of what was dropped; `deliver` takes events;
    `here` tells whether an address is of this host; `assembling` and `holding` are the octets of samples that are not
    whole, and that came too early."""

    def __init__(
        self,
        header: bytes,
        outbox: "Outbox",
        counters: "dict[str, int]",
        limits: "Limits",
        epoch: int,
        deliver: "Callable[[Any], None]",
    ) -> None:
        self.header = header
        self.outbox = outbox
        self.counters = counters
        self.limits = limits
        self.epoch = epoch
        self.deliver = deliver
        self.here: Callable[[str], bool] = _anywhere
        self.schedule = Schedule()
        self.assembling = Budget(limits.assembly_bytes, limits.peer_bytes)
        self.holding = Budget(limits.all_held_bytes, limits.peer_bytes)

    def quiet(self) -> "Common":
        """The same without events, for the builtin endpoints: nobody waits for theirs."""
        twin = Common(self.header, self.outbox, self.counters, self.limits, self.epoch, _ignore)
        twin.here = self.here
        twin.schedule = self.schedule
        twin.assembling = self.assembling
        twin.holding = self.holding
        return twin

    def count(self, reason: str) -> None:
        """Something was dropped."""
        self.counters[reason] = self.counters.get(reason, 0) + 1
