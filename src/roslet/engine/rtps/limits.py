"""What a peer may make us hold, in one place."""

from roslet.record import Record


class Limits(Record):
    """Every bound of a participant. What exceeds one is dropped and counted under the name of the bound.

    participants   remote participants known at once: some times the largest graphs we tested
    endpoints      remote endpoints known of one participant: a ROS node has about 20
    held_samples   samples that a reader keeps of one writer while an earlier one is missing
    held_bytes     octets of those
    assemblies     samples of one writer that are put together from fragments at once
    sample_bytes   largest sample taken from fragments
    assembly_bytes octets of all samples that are being put together, over all writers
    events         events that wait for `next_event`; samples beyond are dropped
    """

    _fields = (
        "participants",
        "endpoints",
        "held_samples",
        "held_bytes",
        "assemblies",
        "sample_bytes",
        "assembly_bytes",
        "events",
    )
    __slots__ = _fields

    def __init__(
        self,
        participants: int = 512,
        endpoints: int = 1024,
        held_samples: int = 1024,
        held_bytes: int = 64 << 20,
        assemblies: int = 8,
        sample_bytes: int = 64 << 20,
        assembly_bytes: int = 256 << 20,
        events: int = 65536,
    ) -> None:
        self.participants = participants
        self.endpoints = endpoints
        self.held_samples = held_samples
        self.held_bytes = held_bytes
        self.assemblies = assemblies
        self.sample_bytes = sample_bytes
        self.assembly_bytes = assembly_bytes
        self.events = events
