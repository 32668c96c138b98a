"""What the node sends, as templates: words that are written as they are, and references to what is known at run time.

The literal words are what the software codec emits; where it was given a placeholder, a reference stands.
"""

from __future__ import annotations

import enum
from collections.abc import Mapping, Sequence

from amaranth.lib.data import StructLayout

from roslet.gateware.rtps import tables
from roslet.gateware.rtps.parameters import GROUP
from roslet.gateware.rtps.tables import Local, OwnMap
from roslet.wire.fields import Field
from roslet.wire.rtps import (
    ack_nack,
    data,
    gap,
    guid,
    header,
    heartbeat,
    inline_qos,
    locator,
    parameter_list,
    participant_data,
    submessage,
)
from roslet.wire.rtps.endpoint_data import EndpointData
from roslet.wire.rtps.info_dst import FIELDS as INFO_DST_FIELDS
from roslet.wire.rtps.qos import (
    BEST_EFFORT,
    DEFAULT_BLOCKING,
    KEEP_LAST,
    RELIABLE,
    TRANSIENT_LOCAL,
    VOLATILE,
    Qos,
)
from roslet.wire.rtps.submessage import FLAG_E

WORD_BITS = 36
CDR_LE = 0x0100
"""The encapsulation header of our messages, as a word has it."""


class Op(enum.IntEnum):
    """What a word of a template is, and its argument, the other 32 bits.

    From OWN on it is a word of a memory, and from WRITER on the argument is `DO`: which word, and what to do with it. The
    bit below the highest says which memory; what END reads nobody takes.
    """

    LITERAL = 0  # the argument
    ENTITY = 1  # the argument with the number of our endpoint in its third octet
    LENGTH = 2  # the argument with the octets of the message added in its upper half
    PADDING = 3  # the argument with the message's padding in its fourth octet
    BITMAP = 4  # the argument with what is missing in its highest bits
    OWN = 8  # the word at that address of our own memory
    WRITER = 9  # of our writer
    SIZE = 10  # how many words the message has, and its padding
    MESSAGE = 11  # the words of the user's message
    PARTICIPANT = 12  # of the participant it goes to
    PROXY = 13  # of the proxy it goes to
    END = 15  # nothing


DO = StructLayout(
    {
        "word": 4,
        "quiet": 1,  # it is not written
        # What is added to it first: to the lower word of a number something small, and then to the higher one what is
        # carried; there must be a word between them.
        "minus_age": 1,
        "minus_oldest": 1,
        "one": 1,
        "carry": 1,
        "borrow": 1,  # what is borrowed from the higher word of the number that is asked for
        # Who takes it
        "store": 1,  # our writer, as the same word of its
        "last": 1,
        "oldest": 1,
        "info": 1,
        "port": 1,
        "start": 1,
        "acked": 1,
        "ask_from": 1,
        "ask_to": 1,
        "place": 1,  # it is the number of the message: where that is kept
        "size": 1,
        # It is the last: what comes is that of AFTERWARDS, and what was written is a datagram.
        "end": 1,
        "then": 4,
        "send": 1,
    }
)

Item = tuple[Op, int]
Value = int | bytes | Item | list[Item]


def _words(octets: bytes, references: Mapping[int, Item] | None = None) -> list[Item]:
    """The words of octets; those that are placeholders become references."""
    if len(octets) % 4:
        raise ValueError(f"{len(octets)} octets are no words")
    words = [int.from_bytes(octets[n : n + 4], "little") for n in range(0, len(octets), 4)]
    return [(references or {}).get(word, (Op.LITERAL, word)) for word in words]


def _fixed(fields: Sequence[Field], values: Mapping[str, Value]) -> list[Item]:
    """The fixed part that a field table describes, little endian: a value is a number, octets, or a reference."""
    octets = bytearray(fields[-1].offset + fields[-1].bits // 8)
    references: dict[int, list[Item]] = {}
    for field in fields:
        value = values.get(field.name, 0)
        size = field.bits // 8
        if isinstance(value, tuple):
            references[field.offset] = [value]
        elif isinstance(value, list):
            references[field.offset] = value
        else:
            octets[field.offset : field.offset + size] = (
                value if isinstance(value, bytes) else value.to_bytes(size, "little")
            )
    words: list[Item] = []
    while 4 * len(words) < len(octets):
        at = 4 * len(words)
        words += references.get(at) or _words(bytes(octets[at : at + 4]))
    return words


def _submessage(kind: int, flags: int, body: Sequence[Item], length: Item | None = None) -> list[Item]:
    first = kind | (flags | FLAG_E) << 8
    return [length or (Op.LITERAL, first | 4 * len(body) << 16), *body]


def _do(op: Op, word: int = 0, *flags: str) -> Item:
    return op, word | sum(1 << DO[flag].offset for flag in flags)


def _is_written(item: Item) -> bool:
    op, argument = item
    return not (op > Op.OWN and argument >> DO["quiet"].offset & 1)


def _quiet(item: Item, *flags: str) -> Item:
    """The same, not written; and what else is to be done."""
    op, argument = item
    return op, argument | _do(op, 0, "quiet", *flags)[1]


COUNT = _do(Op.WRITER, tables.WRITER_COUNT, "quiet", "one", "store")
NUMBER = _do(Op.WRITER, tables.WRITER_LAST, "minus_age")
FIRST = _do(Op.WRITER, tables.WRITER_LAST, "minus_oldest")
HIGH = _do(Op.WRITER, tables.WRITER_LAST_HI, "carry")
"""One more is sent that is counted. The lower words of the number of the message that is spoken of, and of the oldest for
who is served; and the higher one of that whose lower was looked at before."""

PLACEHOLDERS = [0xA5A50000 + n for n in range(6)]
"""Of our GUID prefix, our address, and our two ports: numbers that nothing else is."""
_PREFIX = b"".join(word.to_bytes(4, "little") for word in PLACEHOLDERS[:3])
_IP = PLACEHOLDERS[3].to_bytes(4, "little")


AFTERWARDS = ("IDLE", "TOLD", "WHO", "WRITER", "READER", "REPEAT", "NEXT", "KEEP", "EACH READER", "TO READER")
"""The states of the sender in which it goes on after a template; of those from PUBLISHING on, one that publishes."""
PUBLISHING = AFTERWARDS.index("KEEP")
ALIGNMENT = 16
"""Templates begin at multiples of it, so that who says where has less to choose from."""


class Rom:
    """The templates of a node with these topics; one begins in `words` at ALIGNMENT * `start[name]`, and its datagram has
    `size[name]` words, with one for the message. `lease` in seconds.

    What is written first is where it goes to, the address and then the port; then comes the datagram. Those that write
    nothing are for what they do.
    """

    def __init__(self, own: OwnMap, domain: int | None, lease: float, enclave: str = "/") -> None:
        self.own = own
        self.words: list[int] = []
        self.start: dict[str, int] = {}
        self.size: dict[str, int] = {}
        self._references = {
            **{PLACEHOLDERS[n]: (Op.OWN, own.own(tables.OWN_PREFIX) + n) for n in range(3)},
            PLACEHOLDERS[3]: (Op.OWN, own.own(tables.OWN_IP)),
            PLACEHOLDERS[4]: (Op.OWN, own.own(tables.META_PORT_OWN)),
            PLACEHOLDERS[5]: (Op.OWN, own.own(tables.USER_PORT_OWN)),
        }
        self._to_participant = [_do(Op.PARTICIPANT, tables.META_IP), _do(Op.PARTICIPANT, tables.META_PORT)]
        self._header = _words(header.own(_PREFIX), self._references)
        prefix = [_do(Op.PARTICIPANT, tables.PREFIX + n) for n in range(3)]
        to_one = _submessage(submessage.INFO_DST, 0, _fixed(INFO_DST_FIELDS, {"guidPrefix": prefix}))
        self._directed = [*self._header, *to_one]
        self._participant(domain, lease, enclave)
        for writer, builtin in ((True, "publication"), (False, "subscription")):
            self._discovery(writer, builtin)
        self._user()
        self._programs()

    def _add(self, name: str, items: Sequence[Item], then: str = "IDLE") -> None:
        """One of a datagram."""
        self._place(name, items, then, "send")
        self.size[name] = sum(map(_is_written, items)) - 2

    def _place(self, name: str, items: Sequence[Item], then: str, *flags: str) -> None:
        *before, (op, argument) = items
        if op <= Op.OWN or op == Op.MESSAGE:
            before, (op, argument) = list(items), _do(Op.END, 0, "quiet")
        last = argument | _do(op, 0, "end", *flags)[1] | AFTERWARDS.index(then) << DO["then"].offset
        self.words += [Op.END.value << 32] * (-len(self.words) % ALIGNMENT)
        self.start[name] = len(self.words) // ALIGNMENT
        self.words += [op.value << 32 | argument for op, argument in (*before, (op, last))]

    def _to_group(self, port: int) -> list[Item]:
        return [(Op.LITERAL, GROUP), (Op.OWN, self.own.own(port))]

    def _data(
        self,
        ids: tuple[bytes | Item, bytes | Item],
        body: Sequence[Item],
        flags: int = data.FLAG_D,
        length: bool = False,
        number: int | None = None,
    ) -> list[Item]:
        fixed = _fixed(
            data.FIELDS,
            {
                "octetsToInlineQos": 16,
                "readerId": ids[0],
                "writerId": ids[1],
                "writerSN.high": HIGH if number is None else 0,
                "writerSN.low": NUMBER if number is None else number,
            },
        )
        items = [*fixed, *body]
        first = submessage.DATA | (flags | FLAG_E) << 8
        known = 4 * sum(op != Op.MESSAGE for op, _ in items)
        return _submessage(
            submessage.DATA, flags, items, (Op.LENGTH, first | known << 16) if length else None
        )

    def _heartbeat(self, ids: tuple[bytes | Item, bytes | Item]) -> list[Item]:
        fixed = _fixed(
            heartbeat.FIELDS,
            {
                "readerId": ids[0],
                "writerId": ids[1],
                "firstSN.high": HIGH,
                "firstSN.low": FIRST,
                "lastSN.high": _do(Op.WRITER, tables.WRITER_LAST_HI),
                "lastSN.low": _do(Op.WRITER, tables.WRITER_LAST),
                "count": _do(Op.WRITER, tables.WRITER_COUNT),
            },
        )
        return [_quiet(FIRST), *_submessage(submessage.HEARTBEAT, 0, fixed)]

    def _acknack(self, ids: tuple[bytes | Item, bytes | Item]) -> list[Item]:
        fixed = _fixed(ack_nack.FIELDS, {"readerId": ids[0], "writerId": ids[1]})
        # A set of 32 numbers from the one that is wanted on, in which those that are missing are marked; maybe none.
        state = [_do(Op.PROXY, tables.NEXT_HI), _do(Op.PROXY, tables.NEXT_LO), (Op.LITERAL, 32)]
        state += [(Op.BITMAP, 0), _do(Op.WRITER, tables.WRITER_COUNT)]
        return _submessage(submessage.ACKNACK, ack_nack.FLAG_F, [*fixed, *state])

    def _participant(self, domain: int | None, lease: float, enclave: str) -> None:
        own = participant_data.own(
            _PREFIX,
            domain_id=domain,
            metatraffic_unicast=(locator.Locator(1, PLACEHOLDERS[4], bytes(12) + _IP),),
            default_unicast=(locator.Locator(1, PLACEHOLDERS[5], bytes(12) + _IP),),
            lease=round(lease * 1e9),
            builtin_endpoints=participant_data.PARTICIPANT_ANNOUNCER
            | participant_data.PARTICIPANT_DETECTOR
            | participant_data.PUBLICATIONS_ANNOUNCER
            | participant_data.PUBLICATIONS_DETECTOR
            | participant_data.SUBSCRIPTIONS_ANNOUNCER
            | participant_data.SUBSCRIPTIONS_DETECTOR,
            user_data=f"enclave={enclave};".encode(),
        )
        ids = guid.ENTITYID_SPDP_BUILTIN_PARTICIPANT_READER, guid.ENTITYID_SPDP_BUILTIN_PARTICIPANT_WRITER
        # It never changes, nor does its number.
        body = _words(own.emit(), self._references)
        announcement = [*self._header, *self._data(ids, body, number=1)]
        self._add("participant", [*self._to_group(tables.GROUP_PORT_OWN), *announcement])
        self._add("greeting", [*self._to_participant, *announcement])

    def _discovery(self, writer: bool, builtin: str) -> None:
        name = builtin.upper() + "S"
        theirs = getattr(guid, f"ENTITYID_SEDP_BUILTIN_{name}_READER")
        ours = getattr(guid, f"ENTITYID_SEDP_BUILTIN_{name}_WRITER")
        directed = [*self._to_participant, *self._directed]
        counted, told = [COUNT, *directed], [_quiet(NUMBER), *directed]
        for n, local in enumerate(self.own.writers if writer else self.own.readers):
            body = self._endpoint(local, n, writer)
            self._add(f"{builtin}{n}", [*told, *self._data((theirs, ours), body)], "NEXT")
        key = _PREFIX + entity_id(0, writer)
        status = inline_qos.InlineQos(key, inline_qos.STATUS_DISPOSED | inline_qos.STATUS_UNREGISTERED).emit()
        which = int.from_bytes(entity_id(0, writer), "little")
        disposed = status + parameter_list.encapsulate([(parameter_list.PID_ENDPOINT_GUID, key)])
        gone = _words(disposed, {**self._references, which: (Op.ENTITY, which & ~0xFF0000)})
        self._add(
            f"{builtin}_gone",
            [*told, *self._data((theirs, ours), gone, data.FLAG_Q | data.FLAG_K)],
            "NEXT",
        )
        self._add(f"{builtin}_heartbeat", [*counted, *self._heartbeat((theirs, ours))])
        # Our reader of what peers say of the same kind of endpoint
        reader = getattr(guid, f"ENTITYID_SEDP_BUILTIN_{name}_READER")
        their_writer = getattr(guid, f"ENTITYID_SEDP_BUILTIN_{name}_WRITER")
        self._add(f"{builtin}_acknack", [*counted, *self._acknack((reader, their_writer))])

    def _endpoint(self, local: Local, n: int, writer: bool) -> list[Item]:
        """With names that are known at run time only, parameters of the greatest size: behind its NUL a name ends in
        zeros."""
        names = (local.topic, local.type_name)
        if local.rooms is not None:
            names = (_stand_in(local.rooms[0], "t"), _stand_in(local.rooms[1], "y"))
        kind = RELIABLE if local.reliable else BEST_EFFORT
        value = EndpointData(
            _PREFIX + entity_id(n, writer),
            *names,
            Qos(
                reliability=(kind, DEFAULT_BLOCKING),
                durability=TRANSIENT_LOCAL if local.transient_local else VOLATILE,
                history=(KEEP_LAST, local.depth),
                user_data=f"typehash={local.type_hash};".encode() if local.type_hash else b"",
            ),
            participant_guid=_PREFIX + guid.ENTITYID_PARTICIPANT,
        )
        items = _words(value.emit(), self._references)
        if local.rooms is not None:
            for is_type, name in enumerate(names):
                first = items.index((Op.LITERAL, int.from_bytes(name[:4].encode(), "little"))) - 1
                at = self.own.text_address(not writer, bool(is_type), n)
                for word in range(1 + (local.rooms[is_type] + 3) // 4):
                    items[first + word] = (Op.OWN, at + word)
        return items

    def _user(self) -> None:
        key = _do(Op.PROXY, tables.KEY)
        writer: Item = (Op.ENTITY, int.from_bytes(entity_id(-1, True), "little"))
        reader: Item = (Op.ENTITY, int.from_bytes(entity_id(-1, False), "little"))
        body: list[Item] = [(Op.PADDING, CDR_LE), (Op.MESSAGE, 0)]
        to_one = [_do(Op.PROXY, tables.IP), _do(Op.PROXY, tables.PORT)]
        to_group = self._to_group(tables.USER_GROUP_PORT_OWN)
        for name, where, directed, ids in (
            ("message", to_one, self._directed, (key, writer)),
            ("group_message", to_group, self._header, (guid.ENTITYID_UNKNOWN, writer)),
        ):
            # Four cycles after the number of the message its size can be looked at, and that is known four later.
            look = _do(Op.SIZE, 0, "quiet", "size")
            message = [*where, *directed[:2], look, *directed[2:], *self._data(ids, body, length=True)]
            number = _quiet(NUMBER, "place")
            self._add(name, [number, *message], "NEXT")
            self._add(f"{name}_heartbeat", [COUNT, number, *message, *self._heartbeat(ids)], "NEXT")
        directed = [*to_one, *self._directed]
        self._add("heartbeat", [COUNT, *directed, *self._heartbeat((key, writer))])
        self._add("acknack", [COUNT, *directed, *self._acknack((reader, key))])
        nothing = _fixed(
            gap.FIELDS,
            {
                "readerId": key,
                "writerId": writer,
                "gapStart.high": _do(Op.WRITER, tables.WRITER_LAST_HI, "borrow"),
                "gapStart.low": _do(Op.PROXY, tables.ASK_FROM),
            },
        )
        base: list[Item] = [HIGH, FIRST, (Op.LITERAL, 0)]
        self._add(
            "gap", [*directed, _quiet(FIRST), *_submessage(submessage.GAP, 0, [*nothing, *base])], "REPEAT"
        )

    def _programs(self) -> None:
        """What is looked at and stored between datagrams."""
        last = _do(Op.WRITER, tables.WRITER_LAST, "quiet", "last")
        oldest = _do(Op.WRITER, tables.WRITER_OLDEST, "quiet", "oldest")
        info = _do(Op.PROXY, tables.INFO, "quiet", "info")
        start = _do(Op.PROXY, tables.START, "quiet", "start")
        # So many as `age` says are told of again.
        self._place("changed", [_do(Op.WRITER, tables.WRITER_LAST, "quiet", "minus_age", "store")], "TOLD")
        self._place("who", [info], "WHO")
        wanted = _do(Op.PROXY, tables.NEXT_LO, "quiet", "ask_from")
        self._place("wanted", [_do(Op.PROXY, tables.LAST, "quiet", "last"), wanted], "WRITER")
        asked = [
            _do(Op.PROXY, getattr(tables, name.upper()), "quiet", name)
            for name in ("acked", "ask_from", "ask_to")
        ]
        self._place("asked", [last, oldest, start, *asked], "READER")
        # A message: where it will be kept; that it is, and one more than before, or as many; and to whom it goes.
        self._place("next", [_do(Op.WRITER, tables.WRITER_LAST, "quiet", "one", "place"), oldest], "KEEP")
        number = _do(Op.WRITER, tables.WRITER_LAST, "quiet", "one", "store", "last")
        kept = [number, _do(Op.WRITER, 0, "quiet"), _quiet(HIGH, "store")]
        self._place("kept", kept, "EACH READER")
        self._place(
            "kept_more", [_do(Op.WRITER, tables.WRITER_OLDEST, "quiet", "one", "store"), *kept], "EACH READER"
        )
        self._place(
            "to_reader", [start, info, oldest, _do(Op.PROXY, tables.PORT, "quiet", "port")], "TO READER"
        )


def entity_id(n: int, writer: bool) -> bytes:
    """The entity id of our endpoint n."""
    kind = guid.ENTITYKIND_USER_WRITER_NO_KEY if writer else guid.ENTITYKIND_USER_READER_NO_KEY
    return bytes((0, 0, n + 1, kind))


def _stand_in(room: int, letter: str) -> str:
    """A name that fills a room of so many octets, and whose first word nothing else is."""
    return letter * (room - 1)
