"""QoS policies as discovery carries them, with the defaults of the specification. RTPS 2.3, 9.6.2.2.2; DDS 1.4, 2.2.3.

Durations are int nanoseconds, INFINITE where endless. Kinds are the numbers of the wire.
"""

from roslet.record import Record
from roslet.wire.rtps import parameter_list as pl
from roslet.wire.rtps import values
from roslet.wire.rtps.times import INFINITE
from roslet.wire.rtps.typed import Parameter

BEST_EFFORT, RELIABLE = 1, 2
VOLATILE, TRANSIENT_LOCAL, TRANSIENT, PERSISTENT = 0, 1, 2, 3
AUTOMATIC, MANUAL_BY_PARTICIPANT, MANUAL_BY_TOPIC = 0, 1, 2
SHARED, EXCLUSIVE = 0, 1
BY_RECEPTION_TIMESTAMP, BY_SOURCE_TIMESTAMP = 0, 1
INSTANCE, TOPIC, GROUP = 0, 1, 2
KEEP_LAST, KEEP_ALL = 0, 1
XCDR1, XML, XCDR2 = 0, 1, 2

DEFAULT_BLOCKING = 100000000
"""max_blocking_time of RELIABILITY, nanoseconds."""


class Qos(Record):
    """`reliability` and `liveliness` are (kind, nanoseconds); `history` (kind, depth); `presentation` (access scope,
    coherent, ordered); `resource_limits` (samples, instances, samples an instance; -1: unlimited);
    `durability_service` as in the specification, or None; the others one value each."""

    _fields = (
        "reliability",
        "durability",
        "history",
        "deadline",
        "latency_budget",
        "liveliness",
        "lifespan",
        "ownership",
        "ownership_strength",
        "destination_order",
        "presentation",
        "partition",
        "representation",
        "resource_limits",
        "transport_priority",
        "time_based_filter",
        "durability_service",
        "user_data",
        "topic_data",
        "group_data",
    )
    __slots__ = _fields

    def __init__(
        self,
        reliability: "tuple[int, int]" = (BEST_EFFORT, DEFAULT_BLOCKING),
        durability: int = VOLATILE,
        history: "tuple[int, int]" = (KEEP_LAST, 1),
        deadline: int = INFINITE,
        latency_budget: int = 0,
        liveliness: "tuple[int, int]" = (AUTOMATIC, INFINITE),
        lifespan: int = INFINITE,
        ownership: int = SHARED,
        ownership_strength: int = 0,
        destination_order: int = BY_RECEPTION_TIMESTAMP,
        presentation: "tuple[int, bool, bool]" = (INSTANCE, False, False),
        partition: "tuple[str, ...]" = (),
        representation: "tuple[int, ...]" = (),
        resource_limits: "tuple[int, int, int]" = (-1, -1, -1),
        transport_priority: int = 0,
        time_based_filter: int = 0,
        durability_service: "tuple[int, int, int, int, int, int] | None" = None,
        user_data: bytes = b"",
        topic_data: bytes = b"",
        group_data: bytes = b"",
    ) -> None:
        self.reliability = reliability
        self.durability = durability
        self.history = history
        self.deadline = deadline
        self.latency_budget = latency_budget
        self.liveliness = liveliness
        self.lifespan = lifespan
        self.ownership = ownership
        self.ownership_strength = ownership_strength
        self.destination_order = destination_order
        self.presentation = presentation
        self.partition = partition
        self.representation = representation
        self.resource_limits = resource_limits
        self.transport_priority = transport_priority
        self.time_based_filter = time_based_filter
        self.durability_service = durability_service
        self.user_data = user_data
        self.topic_data = topic_data
        self.group_data = group_data

    @property
    def reliable(self) -> bool:
        """Whether RELIABILITY is RELIABLE."""
        return self.reliability[0] == RELIABLE


PARAMETERS = (
    Parameter(pl.PID_RELIABILITY, "reliability", values.KIND_AND_DURATION),
    Parameter(pl.PID_DURABILITY, "durability", values.U32),
    Parameter(pl.PID_HISTORY, "history", values.KIND_AND_DEPTH),
    Parameter(pl.PID_DEADLINE, "deadline", values.DURATION),
    Parameter(pl.PID_LATENCY_BUDGET, "latency_budget", values.DURATION),
    Parameter(pl.PID_LIVELINESS, "liveliness", values.KIND_AND_DURATION),
    Parameter(pl.PID_LIFESPAN, "lifespan", values.DURATION),
    Parameter(pl.PID_OWNERSHIP, "ownership", values.U32),
    Parameter(pl.PID_OWNERSHIP_STRENGTH, "ownership_strength", values.I32),
    Parameter(pl.PID_DESTINATION_ORDER, "destination_order", values.U32),
    Parameter(pl.PID_PRESENTATION, "presentation", values.PRESENTATION),
    Parameter(pl.PID_PARTITION, "partition", values.STRINGS),
    Parameter(pl.PID_DATA_REPRESENTATION, "representation", values.SHORTS),
    Parameter(pl.PID_RESOURCE_LIMITS, "resource_limits", values.THREE_LIMITS),
    Parameter(pl.PID_TRANSPORT_PRIORITY, "transport_priority", values.I32),
    Parameter(pl.PID_TIME_BASED_FILTER, "time_based_filter", values.DURATION),
    Parameter(pl.PID_DURABILITY_SERVICE, "durability_service", values.DURABILITY_SERVICE),
    Parameter(pl.PID_USER_DATA, "user_data", values.OCTETS),
    Parameter(pl.PID_TOPIC_DATA, "topic_data", values.OCTETS),
    Parameter(pl.PID_GROUP_DATA, "group_data", values.OCTETS),
)

READER_DEFAULTS = Qos()
"""What absent parameters mean of a DataReader."""
WRITER_DEFAULTS = Qos(reliability=(RELIABLE, DEFAULT_BLOCKING))
"""What absent parameters mean of a DataWriter."""
