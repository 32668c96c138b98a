"""What others may make a host hold, in one place."""

from roslet.record import Record


class Limits(Record):
    """Every bound of a host. What exceeds one is dropped and counted under the name of the bound.

    neighbours     hardware addresses that are known or asked for; the one that was heard of longest ago makes room
    waiting        packets that wait for one hardware address: the fragments of the largest datagram are 45
    assemblies     datagrams that are put together from fragments at once
    fragments      fragments of one datagram: enough for 64 KiB at an Ethernet's MTU
    assembly_bytes octets of all fragments that are held
    endpoints      UDP ports that are open
    datagrams      datagrams that one endpoint holds for its owner
    received_bytes octets of those
    groups         multicast groups that are joined: as many as Linux lets a socket join, over all endpoints
    echoes         echo requests that are not answered yet
    frames         frames that wait for `frames_to_send`
    events         events that wait for `next_event`
    """

    _fields = (
        "neighbours",
        "waiting",
        "assemblies",
        "fragments",
        "assembly_bytes",
        "endpoints",
        "datagrams",
        "received_bytes",
        "groups",
        "echoes",
        "frames",
        "events",
    )
    __slots__ = _fields

    def __init__(
        self,
        neighbours: int = 64,
        waiting: int = 64,
        assemblies: int = 16,
        fragments: int = 64,
        assembly_bytes: int = 1 << 20,
        endpoints: int = 64,
        datagrams: int = 256,
        received_bytes: int = 1 << 20,
        groups: int = 20,
        echoes: int = 64,
        frames: int = 4096,
        events: int = 256,
    ) -> None:
        self.neighbours = neighbours
        self.waiting = waiting
        self.assemblies = assemblies
        self.fragments = fragments
        self.assembly_bytes = assembly_bytes
        self.endpoints = endpoints
        self.datagrams = datagrams
        self.received_bytes = received_bytes
        self.groups = groups
        self.echoes = echoes
        self.frames = frames
        self.events = events
        for name in self._fields:
            if getattr(self, name) < 1:
                raise ValueError("%s must be at least 1" % name)
