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
    all_held_bytes octets as in held_bytes, over all writers
    peer_bytes     of assembly_bytes, and of all_held_bytes, what the writers of one participant may take: a quarter, so
                   that one that is up to no good, or out of its depth, leaves room for the others
    history_bytes  octets of samples that one of our writers keeps for its readers; KEEP_LAST then drops the oldest
    backlog_bytes  octets that one of our KEEP_ALL writers keeps for readers that have yet to acknowledge them
    discovery_bytes, discovery_share   octets of the announcements of remote endpoints, over all participants and of one: an
                   announcement has some 400, but user data of 64 KiB is legal
    instances      instances of a keyed topic that one reader or writer knows at once
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
        "all_held_bytes",
        "peer_bytes",
        "history_bytes",
        "backlog_bytes",
        "instances",
        "discovery_bytes",
        "discovery_share",
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
        all_held_bytes: int = 256 << 20,
        peer_bytes: int = 64 << 20,
        history_bytes: int = 256 << 20,
        backlog_bytes: int = 32 << 20,
        instances: int = 4096,
        discovery_bytes: int = 64 << 20,
        discovery_share: int = 4 << 20,
    ) -> None:
        self.participants = participants
        self.endpoints = endpoints
        self.held_samples = held_samples
        self.held_bytes = held_bytes
        self.assemblies = assemblies
        self.sample_bytes = sample_bytes
        self.assembly_bytes = assembly_bytes
        self.events = events
        self.all_held_bytes = all_held_bytes
        self.peer_bytes = peer_bytes
        self.history_bytes = history_bytes
        self.backlog_bytes = backlog_bytes
        self.instances = instances
        self.discovery_bytes = discovery_bytes
        self.discovery_share = discovery_share
