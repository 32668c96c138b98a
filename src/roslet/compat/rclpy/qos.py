"""`rclpy.qos`: profiles, policies, presets, and whether two profiles fit."""

from __future__ import annotations

import warnings
from enum import Enum, IntEnum
from typing import TYPE_CHECKING, Any, TypeVar

from roslet.compat.rclpy.duration import Duration, Infinite
from roslet.node.qos import QoS

if TYPE_CHECKING:
    from collections.abc import Callable

    from typing_extensions import Self

# What rmw means by "the best that fits the other side", for a duration.
_BEST = Duration(nanoseconds=2**63 - 2)
DeadlineBestAvailable = _BEST
LivelinessLeaseDurationeBestAvailable = _BEST  # rclpy's own spelling

# The depth of a profile that keeps everything; rmw's default.
_DEPTH = 10


class InvalidQoSProfileException(Exception):
    """A profile says too little."""

    def __init__(self, message: str) -> None:
        super().__init__(message)


class QoSPolicyKind(IntEnum):
    """The policies, as events name them."""

    INVALID = 1 << 0
    DURABILITY = 1 << 1
    DEADLINE = 1 << 2
    LIVELINESS = 1 << 3
    RELIABILITY = 1 << 4
    HISTORY = 1 << 5
    LIFESPAN = 1 << 6
    DEPTH = 1 << 7
    LIVELINESS_LEASE_DURATION = 1 << 8
    AVOID_ROS_NAMESPACE_CONVENTIONS = 1 << 9


def qos_policy_name_from_kind(policy_kind: QoSPolicyKind | int) -> str:
    """The name of a policy."""
    return QoSPolicyKind(policy_kind).name


class QoSPolicyEnum(IntEnum):
    """The base of the policies' values, each with a name in small letters, as parameters and the command have it."""

    @classmethod
    def short_keys(cls) -> list[str]:
        """The names of all values."""
        return [member.name.lower() for member in cls]

    @classmethod
    def get_from_short_key(cls, name: str) -> int:
        """The number of a value. Raises KeyError."""
        return cls[name.upper()].value

    @property
    def short_key(self) -> str:
        """The name of this value."""
        return self.name.lower()

    def __str__(self) -> str:
        return str(self.value)

    def __format__(self, format_spec: str) -> str:
        return format(int(self), format_spec)


class HistoryPolicy(QoSPolicyEnum):
    """What is kept for a slow reader."""

    SYSTEM_DEFAULT = 0
    KEEP_LAST = 1
    KEEP_ALL = 2
    UNKNOWN = 3


class ReliabilityPolicy(QoSPolicyEnum):
    """Whether what is lost is sent again."""

    SYSTEM_DEFAULT = 0
    RELIABLE = 1
    BEST_EFFORT = 2
    UNKNOWN = 3
    BEST_AVAILABLE = 4


class DurabilityPolicy(QoSPolicyEnum):
    """Whether who comes late gets what was sent."""

    SYSTEM_DEFAULT = 0
    TRANSIENT_LOCAL = 1
    VOLATILE = 2
    UNKNOWN = 3
    BEST_AVAILABLE = 4


class LivelinessPolicy(QoSPolicyEnum):
    """Who says that a publisher is alive."""

    SYSTEM_DEFAULT = 0
    AUTOMATIC = 1
    MANUAL_BY_TOPIC = 3
    UNKNOWN = 4
    BEST_AVAILABLE = 5


QoSHistoryPolicy = HistoryPolicy
QoSReliabilityPolicy = ReliabilityPolicy
QoSDurabilityPolicy = DurabilityPolicy
QoSLivelinessPolicy = LivelinessPolicy

_Kind = TypeVar("_Kind", bound=QoSPolicyEnum)


class QoSProfile:
    """How messages are kept and carried. A depth is needed, or a history that keeps all: InvalidQoSProfileException.

    A duration of 0 stands for the default, which is no bound.
    """

    __slots__ = (
        "_avoid_ros_namespace_conventions",
        "_deadline",
        "_depth",
        "_durability",
        "_history",
        "_lifespan",
        "_liveliness",
        "_liveliness_lease_duration",
        "_reliability",
    )
    __hash__ = None  # type: ignore[assignment]

    def __init__(
        self,
        history: HistoryPolicy | int | None = None,
        depth: int | None = None,
        reliability: ReliabilityPolicy | int | None = None,
        durability: DurabilityPolicy | int | None = None,
        lifespan: Duration | None = None,
        deadline: Duration | None = None,
        liveliness: LivelinessPolicy | int | None = None,
        liveliness_lease_duration: Duration | None = None,
        avoid_ros_namespace_conventions: bool = False,
    ) -> None:
        if history is None:
            if depth is None:
                raise InvalidQoSProfileException("History and/or depth settings are required.")
            history = HistoryPolicy.KEEP_LAST
        self.history = history
        if depth is None:
            if self.history == HistoryPolicy.KEEP_LAST:
                raise InvalidQoSProfileException("History set to KEEP_LAST without a depth setting.")
            depth = _DEPTH
        elif depth == 0 and self.history == HistoryPolicy.KEEP_LAST:
            warnings.warn(
                "A zero depth with KEEP_LAST doesn't make sense; no data could be stored.", stacklevel=2
            )
        self.depth = depth
        self.reliability = ReliabilityPolicy.RELIABLE if reliability is None else reliability
        self.durability = DurabilityPolicy.VOLATILE if durability is None else durability
        self.lifespan = Duration() if lifespan is None else lifespan
        self.deadline = Duration() if deadline is None else deadline
        self.liveliness = LivelinessPolicy.SYSTEM_DEFAULT if liveliness is None else liveliness
        lease = Duration() if liveliness_lease_duration is None else liveliness_lease_duration
        self.liveliness_lease_duration = lease
        self.avoid_ros_namespace_conventions = avoid_ros_namespace_conventions

    if TYPE_CHECKING:
        history: Any
        depth: Any
        reliability: Any
        durability: Any
        lifespan: Any
        deadline: Any
        liveliness: Any
        liveliness_lease_duration: Any
        avoid_ros_namespace_conventions: Any
        _history: HistoryPolicy
        _depth: int
        _reliability: ReliabilityPolicy
        _durability: DurabilityPolicy
        _lifespan: Duration
        _deadline: Duration
        _liveliness: LivelinessPolicy
        _liveliness_lease_duration: Duration

    def _values(self) -> tuple[tuple[str, Any], ...]:
        return tuple((name, getattr(self, "_" + name)) for name in _FIELDS)

    def __eq__(self, other: object) -> bool:
        return self._values() == other._values() if isinstance(other, QoSProfile) else False

    def __str__(self) -> str:
        return f"QoSProfile({', '.join(f'{name}={value}' for name, value in self._values())})"

    def to_roslet(self) -> QoS:
        """The same for a roslet node: what is left to the system or to the other side is what rmw's default is, and
        BEST_AVAILABLE too, as for services; of topics `_best.fitting` knows better."""
        best_effort = self._reliability == ReliabilityPolicy.BEST_EFFORT
        return QoS(
            max(self._depth, 1),
            "best_effort" if best_effort else "reliable",
            "transient_local" if self._durability == DurabilityPolicy.TRANSIENT_LOCAL else "volatile",
            "keep_all" if self._history == HistoryPolicy.KEEP_ALL else "keep_last",
            deadline=_seconds(self._deadline),
            lifespan=_seconds(self._lifespan),
            liveliness="manual_by_topic"
            if self._liveliness == LivelinessPolicy.MANUAL_BY_TOPIC
            else "automatic",
            liveliness_lease=_seconds(self._liveliness_lease_duration),
        )

    @classmethod
    def from_roslet(cls, qos: QoS) -> Self:
        """What the graph says of an endpoint: every policy has a value of its own."""
        return cls(
            HistoryPolicy[qos.history.upper()],
            qos.depth,
            ReliabilityPolicy[qos.reliability.upper()],
            DurabilityPolicy[qos.durability.upper()],
            _duration(qos.lifespan),
            _duration(qos.deadline),
            LivelinessPolicy[qos.liveliness.upper()],
            _duration(qos.liveliness_lease),
        )


def _seconds(duration: Duration) -> float | None:
    nanoseconds = duration.nanoseconds
    return nanoseconds * 1e-9 if 0 < nanoseconds < _BEST.nanoseconds else None


def _duration(seconds: float | None) -> Duration:
    return Infinite if seconds is None else Duration(nanoseconds=round(seconds * 1e9))


def _checked(kind: type) -> Callable[[Any], Any]:
    def check(value: Any) -> Any:
        if not isinstance(value, kind):
            raise AssertionError(f"expected a {kind.__name__}, not {value!r}")
        return value

    return check


def _field(name: str, convert: Callable[[Any], Any]) -> Any:
    inner = "_" + name
    return property(
        lambda self: getattr(self, inner), lambda self, value: setattr(self, inner, convert(value))
    )


_FIELDS: dict[str, Callable[[Any], Any]] = {
    "history": HistoryPolicy,
    "depth": _checked(int),
    "reliability": ReliabilityPolicy,
    "durability": DurabilityPolicy,
    "lifespan": _checked(Duration),
    "deadline": _checked(Duration),
    "liveliness": LivelinessPolicy,
    "liveliness_lease_duration": _checked(Duration),
    "avoid_ros_namespace_conventions": _checked(bool),
}
for _name, _convert in _FIELDS.items():
    setattr(QoSProfile, _name, _field(_name, _convert))


# -- presets

_RELIABLE = ReliabilityPolicy.RELIABLE
_LOCAL = DurabilityPolicy.TRANSIENT_LOCAL

qos_profile_unknown = QoSProfile(
    HistoryPolicy.UNKNOWN,
    0,
    ReliabilityPolicy.UNKNOWN,
    DurabilityPolicy.UNKNOWN,
    liveliness=LivelinessPolicy.UNKNOWN,
)
qos_profile_default = QoSProfile(depth=10)
qos_profile_system_default = QoSProfile(
    HistoryPolicy.SYSTEM_DEFAULT, 0, ReliabilityPolicy.SYSTEM_DEFAULT, DurabilityPolicy.SYSTEM_DEFAULT
)
qos_profile_sensor_data = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
qos_profile_services_default = QoSProfile(depth=10)
qos_profile_parameters = QoSProfile(depth=1000)
qos_profile_parameter_events = QoSProfile(depth=1000)
qos_profile_action_status_default = QoSProfile(depth=1, durability=_LOCAL)
qos_profile_best_available = QoSProfile(
    depth=10,
    reliability=ReliabilityPolicy.BEST_AVAILABLE,
    durability=DurabilityPolicy.BEST_AVAILABLE,
    deadline=_BEST,
    liveliness=LivelinessPolicy.BEST_AVAILABLE,
    liveliness_lease_duration=_BEST,
)
qos_profile_rosout_default = QoSProfile(depth=1000, durability=_LOCAL, lifespan=Duration(seconds=10))


class QoSPresetProfiles(Enum):
    """The presets by name. Those of equal values are one, as for rclpy."""

    UNKNOWN = qos_profile_unknown
    DEFAULT = qos_profile_default
    SYSTEM_DEFAULT = qos_profile_system_default
    SENSOR_DATA = qos_profile_sensor_data
    SERVICES_DEFAULT = qos_profile_services_default
    PARAMETERS = qos_profile_parameters
    PARAMETER_EVENTS = qos_profile_parameter_events
    ACTION_STATUS_DEFAULT = qos_profile_action_status_default
    BEST_AVAILABLE = qos_profile_best_available
    ROSOUT_DEFAULT = qos_profile_rosout_default

    @classmethod
    def short_keys(cls) -> list[str]:
        """The names of all presets, in small letters."""
        return [name.lower() for name in cls.__members__]

    @classmethod
    def get_from_short_key(cls, name: str) -> QoSProfile:
        """A preset's profile. Raises KeyError."""
        found: QoSProfile = cls[name.upper()].value
        return found


# -- whether two fit


class QoSCompatibility(Enum):
    """Whether a publisher and a subscription fit: yes, perhaps, no."""

    OK = 0
    WARNING = 1
    ERROR = 2


def qos_check_compatible(
    publisher_qos: QoSProfile, subscription_qos: QoSProfile
) -> tuple[QoSCompatibility, str]:
    """Whether a publisher and a subscription of these profiles fit, and every reason against it."""
    errors = [f"ERROR: {text};" for text in _misfits(publisher_qos, subscription_qos)]
    warned = [f"WARNING: {text};" for text in _doubts(publisher_qos, subscription_qos)]
    if errors:
        return QoSCompatibility.ERROR, "".join(errors)
    return (QoSCompatibility.WARNING, "".join(warned)) if warned else (QoSCompatibility.OK, "")


def _given(duration: Duration) -> int:
    """Nanoseconds; 0 where there is no bound."""
    return duration.nanoseconds if 0 < duration.nanoseconds < _BEST.nanoseconds else 0


def _misfits(offered: QoSProfile, wanted: QoSProfile) -> list[str]:
    found = []
    if offered.reliability == ReliabilityPolicy.BEST_EFFORT and wanted.reliability == _RELIABLE:
        found.append("Best effort publisher and reliable subscription")
    if offered.durability == DurabilityPolicy.VOLATILE and wanted.durability == _LOCAL:
        found.append("Volatile publisher and transient local subscription")
    for what, give, want, less, none in (
        (
            "deadline",
            offered.deadline,
            wanted.deadline,
            "Subscription deadline is less than publisher deadline",
            "Subscription has a deadline, but publisher does not",
        ),
        (
            "lease",
            offered.liveliness_lease_duration,
            wanted.liveliness_lease_duration,
            "Subscription liveliness lease duration is less than publisher",
            "Subscription has a liveliness lease duration, but publisher does not",
        ),
    ):
        if what == "lease":
            kinds = (offered.liveliness, wanted.liveliness)
            if kinds == (LivelinessPolicy.AUTOMATIC, LivelinessPolicy.MANUAL_BY_TOPIC):
                found.append("Publisher's liveliness is automatic and subscription's is manual by topic")
        if _given(want) and not _given(give):
            found.append(none)
        elif _given(want) and _given(want) < _given(give):
            found.append(less)
    return found


def _doubts(offered: QoSProfile, wanted: QoSProfile) -> list[str]:
    found = []
    for name, default, strong, weak, sentences in (
        ("reliability", 0, 1, 2, ("Reliable", "Best effort")),
        ("durability", 0, 1, 2, ("Transient local", "Volatile")),
    ):
        give, want = getattr(offered, name), getattr(wanted, name)
        if give == default == want:
            found.append(f"Publisher {name} is system_default and subscription {name} is system_default")
        elif give == default and want == strong:
            found.append(f"{sentences[0]} subscription, but publisher is system_default")
        elif give == weak and want == default:
            found.append(f"{sentences[1]} publisher, but subscription is system_default")
    give, want = offered.liveliness, wanted.liveliness
    if give == want == LivelinessPolicy.SYSTEM_DEFAULT:
        found.append("Publisher liveliness is system_default and subscription liveliness is system_default")
    elif give == LivelinessPolicy.SYSTEM_DEFAULT and want == LivelinessPolicy.MANUAL_BY_TOPIC:
        found.append("Subscription's liveliness is manual by topic, but publisher's is system_default")
    elif give == LivelinessPolicy.AUTOMATIC and want == LivelinessPolicy.SYSTEM_DEFAULT:
        found.append("Publisher's liveliness is automatic, but subscription's is system_default")
    return found


__all__ = [
    "DeadlineBestAvailable",
    "DurabilityPolicy",
    "HistoryPolicy",
    "InvalidQoSProfileException",
    "LivelinessLeaseDurationeBestAvailable",
    "LivelinessPolicy",
    "QoSCompatibility",
    "QoSDurabilityPolicy",
    "QoSHistoryPolicy",
    "QoSLivelinessPolicy",
    "QoSPolicyEnum",
    "QoSPolicyKind",
    "QoSPresetProfiles",
    "QoSProfile",
    "QoSReliabilityPolicy",
    "ReliabilityPolicy",
    "qos_check_compatible",
    "qos_policy_name_from_kind",
    "qos_profile_action_status_default",
    "qos_profile_best_available",
    "qos_profile_default",
    "qos_profile_parameter_events",
    "qos_profile_parameters",
    "qos_profile_rosout_default",
    "qos_profile_sensor_data",
    "qos_profile_services_default",
    "qos_profile_system_default",
    "qos_profile_unknown",
]
