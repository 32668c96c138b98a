"""What a node in gates knows of its peers, and of itself: the layout of its two memories of 32-bit words.

`PeerMap`, written by the receiving side alone:

    participants      16 words each    who it is, where it is, its lease
    builtin proxies   8 words each     four a participant: how far we are with its discovery endpoints
    user proxies      8 words each     endpoints of peers that match ours
    scratch                            the participant or endpoint that is being received

`OwnMap`, written by the sending side alone: our GUID prefix, address and ports, counters, topics and types, and the samples
that may have to be sent again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from amaranth.hdl import Cat, Const, Value

from roslet.wire.rtps import locator

# A participant
PREFIX, LEASE, META_IP, META_PORT, USER_IP, USER_PORT, LEFT = 0, 3, 4, 5, 6, 7, 8
PARTICIPANT = 16

# A proxy. Of a peer's writer: the next number that is wanted, and the last that there is; of a peer's reader: all before
# ACKED are there, ASK_FROM to ASK_TO are asked for, none if ASK_FROM is later, and what is before START is not for it.
KEY, INFO, IP, PORT = 0, 1, 2, 3
NEXT_LO, NEXT_HI, LAST = 4, 5, 6
ACKED, ASK_FROM, ASK_TO, START = 4, 5, 6, 7
PROXY = 8

# Builtin proxies of a participant, by what the peer has
PUBLICATIONS_READER, SUBSCRIPTIONS_READER, PUBLICATIONS_WRITER, SUBSCRIPTIONS_WRITER = range(4)
BUILTINS = 4

# Scratch: a participant's words, then those below
SCRATCH_ZERO, SCRATCH_SOURCE, SCRATCH_KEY, SCRATCH_ENTITY = 8, 9, 12, 15
SCRATCH_LAST = SCRATCH_KEY  # of our writer, where no key is needed
SCRATCH = 16

# Bits of INFO
INFO_SLOT, INFO_LOCAL = 0, 8  # a byte each
INFO_WRITER, INFO_RELIABLE = 16, 17

# Bits of USER_PORT and PORT, beside the port: the group is as good; of USER_PORT, it is in our subnet
PORT_GROUP, PORT_NEAR = 16, 17

LEASE_BITS = 17
"""Of a lease's seconds: of one of 18 hours and more there are kept the highest of these, set, and those below. What is LEFT
has one bit more: it is less than nothing."""
MAX_PEERS = 128
"""Their numbers have eight bits, with one to spare."""
EVERYTHING = 0x7FFFFFFF
"""As ASK_TO: whatever there is."""
MAX_HISTORY = 1 << 15
"""Messages that a writer keeps, at most."""


def _bits(count: int) -> int:
    return max(1, (count - 1).bit_length())


def aligned(sizes: Sequence[int]) -> tuple[list[int], int]:
    """Where parts of these sizes, powers of two, begin, each aligned to its size; and where they end."""
    order = sorted(range(len(sizes)), key=lambda n: -sizes[n])
    starts, at = [0] * len(sizes), 0
    for n in order:
        starts[n] = at
        at += sizes[n]
    return starts, at


class PeerMap:
    """Where things lie for so many participants, and so many endpoints of theirs that match ours."""

    def __init__(self, participants: int = 8, endpoints: int = 16) -> None:
        for what, count in (("participants", participants), ("endpoints", endpoints)):
            if not 1 <= count <= MAX_PEERS:
                raise ValueError(f"a node knows 1 to {MAX_PEERS} {what}, not {count}")
        self.participants, self.endpoints = participants, endpoints
        self.slot_bits, self.endpoint_bits = _bits(participants), _bits(endpoints)
        sizes = (
            PARTICIPANT << self.slot_bits,
            BUILTINS * PROXY << self.slot_bits,
            PROXY << self.endpoint_bits,
            SCRATCH,
        )
        (self._participants, self._builtins, self._endpoints, self._scratch), self.depth = aligned(sizes)
        self.address_bits = _bits(self.depth)
        self.index_bits = max(2 + self.slot_bits, self.endpoint_bits)
        self.proxy_bits = self.index_bits + 1
        """Proxies are numbered: builtin ones `4 * slot + kind`, users' ones with the highest bit set."""

    def _at(self, base: int, low: Value) -> Value:
        """`base` plus what is below its alignment."""
        rest = self.address_bits - len(low)
        return Cat(low, Const(base >> len(low), rest)) if rest > 0 else low[: self.address_bits]

    def participant(self, slot: Value, word: int | Value) -> Value:
        """A word of a participant."""
        return self._at(self._participants, Cat(_number(word, 4), _number(slot, self.slot_bits)))

    def builtin(self, slot: Value, kind: int | Value, word: int | Value) -> Value:
        """A word of a builtin proxy."""
        return self._at(
            self._builtins, Cat(_number(word, 3), _number(kind, 2), _number(slot, self.slot_bits))
        )

    def endpoint(self, number: Value, word: int | Value) -> Value:
        """A word of a user proxy."""
        return self._at(self._endpoints, Cat(_number(word, 3), _number(number, self.endpoint_bits)))

    def scratch(self, word: int | Value) -> Value:
        """A word of what is being received."""
        return self._at(self._scratch, _number(word, 4))


def _number(value: int | Value, bits: int) -> Value:
    """So many bits, zeros where the value has less: what is above them must stay in its place."""
    if isinstance(value, int):
        return Const(value, bits)
    return Cat(value[:bits], Const(0, max(0, bits - len(value))))


@dataclass(frozen=True)
class Local:
    """A topic of ours as the tables have it: names of the wire, QoS, and for a writer the words of its longest message and
    how many messages it keeps. The entity id of endpoint n has n + 1 in its third octet.

    `rooms`, where the names are known at run time only: the most octets of the topic's and of its type's, with their NUL."""

    topic: str
    type_name: str
    reliable: bool = False
    transient_local: bool = False
    words: int = 0
    depth: int = 1
    type_hash: str = ""
    rooms: tuple[int, int] | None = None

    def __post_init__(self) -> None:
        if not 1 <= self.depth <= MAX_HISTORY or self.depth & (self.depth - 1):
            raise ValueError(
                f"a writer keeps a power of two of messages, at most {MAX_HISTORY}, not {self.depth}"
            )


# Of our own memory
OWN_PREFIX, OWN_IP, META_PORT_OWN, USER_PORT_OWN, ZERO = 0, 3, 4, 5, 6
GROUP_PORT_OWN, USER_GROUP_PORT_OWN = 7, 8
OWN_WORDS = 16
USER_GROUP_PORT = locator.user_multicast_port(0) - locator.metatraffic_multicast_port(0)
"""How far behind the port of announcements that of messages to the group is. RTPS 2.3, 9.6.1.1."""
# Of a writer: the number of its last message; how many before that are kept, -1 where there is none; and the count of the
# heartbeats that it sends, and of the ACKNACKs of our reader with the same number: each needs one that rises, no more
WRITER_LAST, WRITER_LAST_HI, WRITER_OLDEST, WRITER_COUNT = 0, 1, 2, 3
WRITER = 4
NOTHING = 0xFFFFFFFF
"""As WRITER_OLDEST."""


class OwnMap:
    """Where our own things lie: `writers` and `readers` of the user, each with its names."""

    def __init__(self, writers: Sequence[Local], readers: Sequence[Local]) -> None:
        self.writers, self.readers = list(writers), list(readers)
        most = max(1, len(self.writers), len(self.readers))
        rooms = [
            local.rooms or [len(text.encode()) + 1 for text in (local.topic, local.type_name)]
            for local in (*self.writers, *self.readers)
        ]
        longest = max((room for both in rooms for room in both), default=1)
        self.text_bits = _bits(1 + (longest + 3) // 4)
        self.local_bits = _bits(most)
        sizes = (
            OWN_WORDS,
            WRITER << self.local_bits + 1,
            1 << (self.text_bits + self.local_bits + 2),
            *(self.stride(local) * local.depth for local in self.writers),
        )
        starts, self.depth = aligned(sizes)
        self._own, self._writers, self._texts = starts[:3]
        self.samples = starts[3:]
        """Where the samples of each writer begin."""
        self.address_bits = _bits(self.depth)

    def sample(self, writer: int, number: Value) -> Value:
        """Where a writer keeps the message with this number; nothing is in the bits below, where its words are counted."""
        local = self.writers[writer]
        low = Cat(Const(0, self.stride(local).bit_length() - 1), number[: local.depth.bit_length() - 1])
        return Cat(low, Const(self.samples[writer] >> len(low), self.address_bits - len(low)))

    @staticmethod
    def stride(local: Local) -> int:
        """Words of a sample: a power of two, its length and padding first."""
        return 1 << _bits(local.words + 1)

    def own(self, word: int) -> int:
        return self._own + word

    def writer(self, number: Value, word: int | Value, builtin: int | Value = 0) -> Value:
        """A word of a writer: of the user's with that number; or of discovery's, of which 0 tells of our writers and 1 of
        our readers."""
        low = Cat(_number(word, 2), _number(number, self.local_bits), _number(builtin, 1))
        return Cat(low, Const(self._writers >> len(low), self.address_bits - len(low)))

    def writer_address(self, number: int, word: int, builtin: bool = False) -> int:
        return self._writers + (WRITER << self.local_bits) * builtin + WRITER * number + word

    def text(self, reader: Value, is_type: Value, number: Value, word: Value) -> Value:
        """A word of a topic's name, or of its type's."""
        low = Cat(_number(word, self.text_bits), _number(number, self.local_bits), is_type, reader)
        return Cat(low, Const(self._texts >> len(low), self.address_bits - len(low)))

    def text_address(self, reader: bool, is_type: bool, number: int) -> int:
        """Where a name begins: its length in octets with its NUL, then its octets, zeros behind them."""
        spread = self.text_bits + self.local_bits
        return self._texts + (number << self.text_bits) + (is_type << spread) + (reader << (spread + 1))

    def init(
        self, prefix: bytes, ip: bytes, meta_port: int, user_port: int, group_port: int = 0
    ) -> list[int]:
        """What the memory holds at the beginning. `group_port`, of discovery; of messages, the next."""
        words = [0] * self.depth
        for at, octets in ((OWN_PREFIX, prefix), (OWN_IP, ip)):
            for n in range(0, len(octets), 4):
                words[self.own(at) + n // 4] = int.from_bytes(octets[n : n + 4], "little")
        words[self.own(META_PORT_OWN)], words[self.own(USER_PORT_OWN)] = meta_port, user_port
        words[self.own(GROUP_PORT_OWN)], words[self.own(USER_GROUP_PORT_OWN)] = (
            group_port,
            group_port + USER_GROUP_PORT,
        )
        for number in range(len(self.writers)):
            words[self.writer_address(number, WRITER_OLDEST)] = NOTHING
        for reader, locals_ in enumerate((self.writers, self.readers)):
            words[self.writer_address(reader, WRITER_LAST, builtin=True)] = len(locals_)
            words[self.writer_address(reader, WRITER_OLDEST, builtin=True)] = (len(locals_) - 1) & NOTHING
            for number, local in enumerate(locals_):
                for is_type, text in enumerate((local.topic, local.type_name)):
                    octets = text.encode() + b"\0"
                    at = self.text_address(bool(reader), bool(is_type), number)
                    words[at] = len(octets)
                    for n in range(0, len(octets), 4):
                        words[at + 1 + n // 4] = int.from_bytes(octets[n : n + 4], "little")
        return words
