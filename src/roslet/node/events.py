"""What happens to a publisher or subscription on ROS 2, apart from messages: facts that `on_event` tells.

Matched, Unmatched       a peer that it exchanges messages with has come, or gone
QosIncompatible          a peer of the topic that it does not: policies names why
DeadlineMissed           nothing was published, or came, within the deadline
LivelinessLost           a publisher was silent for longer than its lease
LivelinessRegained       it has been heard again
MessagesLost             messages of a publisher that will never come
"""

from __future__ import annotations


class Event:
    """`peer` is the full name of the other endpoint's node, or what stands for it where it is not known yet; `gid` are
    the 16 octets of that endpoint; both empty where no peer is concerned."""

    __slots__ = ("gid", "peer")

    def __init__(self, peer: str = "", gid: bytes = b"") -> None:
        self.peer = peer
        self.gid = gid

    def __repr__(self) -> str:
        fields = [name for kind in type(self).__mro__ for name in getattr(kind, "__slots__", ())]
        return f"{type(self).__name__}({', '.join(f'{name}={getattr(self, name)!r}' for name in fields)})"


class Matched(Event):
    """Messages flow from now on."""

    __slots__ = ()


class Unmatched(Event):
    """They no longer do."""

    __slots__ = ()


class QosIncompatible(Event):
    """What the publisher offers is less than what the subscription requests, in the policies named."""

    __slots__ = ("policies",)

    def __init__(self, peer: str, gid: bytes, policies: tuple[str, ...]) -> None:
        super().__init__(peer, gid)
        self.policies = policies


class DeadlineMissed(Event):
    """Told anew each period, from the first message on."""

    __slots__ = ()


class LivelinessLost(Event):
    """At a publisher, `peer` is empty: it is itself that did not assert its liveliness."""

    __slots__ = ()


class LivelinessRegained(Event):
    """The publisher has been heard again."""

    __slots__ = ()


class MessagesLost(Event):
    """`count` messages."""

    __slots__ = ("count",)

    def __init__(self, peer: str, gid: bytes, count: int) -> None:
        super().__init__(peer, gid)
        self.count = count
