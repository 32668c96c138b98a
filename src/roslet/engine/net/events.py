"""What a host tells its owner: facts, in the past tense."""

from roslet.record import Record


class EchoReplied(Record):
    """Our echo request was answered, after `seconds`."""

    _fields = ("address", "sequence", "data", "seconds")
    __slots__ = _fields

    def __init__(self, address: str, sequence: int, data: bytes, seconds: float) -> None:
        self.address = address
        self.sequence = sequence
        self.data = data
        self.seconds = seconds


class EchoLost(Record):
    """Our echo request was not answered in time."""

    _fields = ("address", "sequence")
    __slots__ = _fields

    def __init__(self, address: str, sequence: int) -> None:
        self.address = address
        self.sequence = sequence


class AddressUnanswered(Record):
    """Nobody says to have this address; what waited for it is dropped."""

    _fields = ("address",)
    __slots__ = _fields

    def __init__(self, address: str) -> None:
        self.address = address


class AddressConflicted(Record):
    """Somebody else (`mac`) says to have our address. RFC 5227, 2.4."""

    _fields = ("mac",)
    __slots__ = _fields

    def __init__(self, mac: str) -> None:
        self.mac = mac
