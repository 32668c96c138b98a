"""What a participant tells its owner: facts, in the past tense."""

from roslet.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from roslet.wire.rtps.endpoint_data import EndpointData
    from roslet.wire.rtps.participant_data import ParticipantData


class ParticipantDiscovered(Record):
    """A participant announced itself for the first time, or anew with other `data`."""

    _fields = ("data",)
    __slots__ = _fields

    def __init__(self, data: "ParticipantData") -> None:
        self.data = data


class ParticipantLost(Record):
    """A participant departed (`expired` False) or was not heard of within its lease."""

    _fields = ("data", "expired")
    __slots__ = _fields

    def __init__(self, data: "ParticipantData", expired: bool) -> None:
        self.data = data
        self.expired = expired


class EndpointDiscovered(Record):
    """A remote writer or reader was announced, or changed."""

    _fields = ("data",)
    __slots__ = _fields

    def __init__(self, data: "EndpointData") -> None:
        self.data = data


class EndpointLost(Record):
    """A remote writer or reader was withdrawn, or its participant was lost."""

    _fields = ("data",)
    __slots__ = _fields

    def __init__(self, data: "EndpointData") -> None:
        self.data = data


class EndpointMatched(Record):
    """Our endpoint (entity id `local`) and a remote one exchange samples from now on."""

    _fields = ("local", "data")
    __slots__ = _fields

    def __init__(self, local: bytes, data: "EndpointData") -> None:
        self.local = local
        self.data = data


class EndpointUnmatched(Record):
    """They no longer do."""

    _fields = ("local", "data")
    __slots__ = _fields

    def __init__(self, local: bytes, data: "EndpointData") -> None:
        self.local = local
        self.data = data


class QosIncompatible(Record):
    """Topic and type agree, the policies named do not."""

    _fields = ("local", "data", "policies")
    __slots__ = _fields

    def __init__(self, local: bytes, data: "EndpointData", policies: "tuple[str, ...]") -> None:
        self.local = local
        self.data = data
        self.policies = policies


class SampleReceived(Record):
    """A sample for our reader `local`. `payload` may be a view of the datagram: it is good until the next one comes in.
    `flags` tell data from key; `inline_qos` is in the byte order `little`; `time` is the source's, or None."""

    _fields = ("local", "writer", "sequence", "payload", "time", "flags", "inline_qos", "little")
    __slots__ = _fields

    def __init__(
        self,
        local: bytes,
        writer: bytes,
        sequence: int,
        payload: "bytes | bytearray | memoryview",
        time: "int | None",
        flags: int,
        inline_qos: "bytes | memoryview",
        little: bool,
    ) -> None:
        self.local = local
        self.writer = writer
        self.sequence = sequence
        self.payload = payload
        self.time = time
        self.flags = flags
        self.inline_qos = inline_qos
        self.little = little


class SamplesLost(Record):
    """`count` samples of a writer will never reach our reader `local`."""

    _fields = ("local", "writer", "count")
    __slots__ = _fields

    def __init__(self, local: bytes, writer: bytes, count: int) -> None:
        self.local = local
        self.writer = writer
        self.count = count


class SampleRejected(Record):
    """Our reader `local` has no room for another instance: the sample is not acknowledged, its writer will try again."""

    _fields = ("local", "writer", "key")
    __slots__ = _fields

    def __init__(self, local: bytes, writer: bytes, key: bytes) -> None:
        self.local = local
        self.writer = writer
        self.key = key


class InstanceChanged(Record):
    """Instance `key` of a keyed topic is in another `state` (instances.STATES) for our reader `local`, by what `writer` did.

    Told before the sample itself is handed over.
    """

    _fields = ("local", "key", "state", "writer")
    __slots__ = _fields

    def __init__(self, local: bytes, key: bytes, state: int, writer: bytes) -> None:
        self.local = local
        self.key = key
        self.state = state
        self.writer = writer


class WriterReady(Record):
    """Our writer `local`, which was `full`, has room again."""

    _fields = ("local",)
    __slots__ = _fields

    def __init__(self, local: bytes) -> None:
        self.local = local


class LivelinessLost(Record):
    """A matched writer was not asserted within its liveliness lease. Of our own writer (`local` is its entity id, `writer`
    its GUID): it was not asserted by its owner."""

    _fields = ("local", "writer")
    __slots__ = _fields

    def __init__(self, local: bytes, writer: bytes) -> None:
        self.local = local
        self.writer = writer


class LivelinessRegained(Record):
    """A writer whose liveliness was lost has been heard again, or asserted again if it is ours."""

    _fields = ("local", "writer")
    __slots__ = _fields

    def __init__(self, local: bytes, writer: bytes) -> None:
        self.local = local
        self.writer = writer


class DeadlineMissed(Record):
    """Our endpoint `local` did not write, or did not get, a sample within the period of its DEADLINE; of a keyed topic,
    one of instance `key`.

    Told anew each period, from the first sample on.
    """

    _fields = ("local", "key")
    __slots__ = _fields

    def __init__(self, local: bytes, key: bytes = b"") -> None:
        self.local = local
        self.key = key
