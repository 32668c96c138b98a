"""What the node sends, as templates: words that are written as they are, and references to what is known at run time.

The literal words are what the software codec emits; where it was given a placeholder, a reference stands.
"""

from __future__ import annotations

import enum
from collections.abc import Mapping, Sequence

from roslet.gateware.rtps import tables
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
    """What a word of a template is, and its argument, the other 32 bits."""

    LITERAL = 0  # the argument
    OWN = 1  # the word at that address of our own memory
    PARTICIPANT = 2  # that word of the participant it goes to
    PROXY = 3  # that word of the proxy it goes to
    REGISTER = 4  # one of `Register`
    WRITER = 5  # that word of our writer
    ENTITY = 6  # the argument with the number of our endpoint in its third octet
    LENGTH = 7  # the argument with the octets of the message added in its upper half
    PADDING = 8  # the argument with the message's padding in its fourth octet
    BITMAP = 9  # the argument with what is missing in its highest bits
    MESSAGE = 10  # the words of the user's message
    END = 15


REGISTER_BITS = 2


class Register(enum.IntEnum):
    """Values of the sender's: numbers of messages, of each the lower word and the higher one."""

    FIRST = 0
    FIRST_HIGH = 1
    NUMBER = 2
    NUMBER_HIGH = 3


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


PLACEHOLDERS = [0xA5A50000 + n for n in range(6)]
"""Of our GUID prefix, our address, and our two ports: numbers that nothing else is."""
_PREFIX = b"".join(word.to_bytes(4, "little") for word in PLACEHOLDERS[:3])
_IP = PLACEHOLDERS[3].to_bytes(4, "little")


class Rom:
    """The templates of a node with these topics; `start[name]` is where one begins in `words`, `size[name]` its words
    without the message. `lease` in seconds."""

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
        self._header = _words(header.own(_PREFIX), self._references)
        prefix: list[Item] = [(Op.PARTICIPANT, tables.PREFIX + n) for n in range(3)]
        to_one = _submessage(submessage.INFO_DST, 0, _fixed(INFO_DST_FIELDS, {"guidPrefix": prefix}))
        self._directed = [*self._header, *to_one]
        self._participant(domain, lease, enclave)
        for writer, builtin in ((True, "publication"), (False, "subscription")):
            self._discovery(writer, builtin)
        self._user()

    def _add(self, name: str, items: Sequence[Item]) -> None:
        self.start[name], self.size[name] = len(self.words), len(items)
        self.words += [op.value << 32 | argument for op, argument in (*items, (Op.END, 0))]

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
                "writerSN.high": _register(Register.NUMBER_HIGH) if number is None else 0,
                "writerSN.low": _register(Register.NUMBER) if number is None else number,
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
                "firstSN.high": _register(Register.FIRST_HIGH),
                "firstSN.low": _register(Register.FIRST),
                "lastSN.high": (Op.WRITER, tables.WRITER_LAST_HI),
                "lastSN.low": (Op.WRITER, tables.WRITER_LAST),
                "count": (Op.WRITER, tables.WRITER_COUNT),
            },
        )
        return _submessage(submessage.HEARTBEAT, 0, fixed)

    def _acknack(self, ids: tuple[bytes | Item, bytes | Item]) -> list[Item]:
        fixed = _fixed(ack_nack.FIELDS, {"readerId": ids[0], "writerId": ids[1]})
        # A set of 32 numbers from the one that is wanted on, in which those that are missing are marked; maybe none.
        state: list[Item] = [(Op.PROXY, tables.NEXT_HI), (Op.PROXY, tables.NEXT_LO), (Op.LITERAL, 32)]
        state += [(Op.BITMAP, 0), (Op.WRITER, tables.WRITER_COUNT)]
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
        self._add("participant", [*self._header, *self._data(ids, body, number=1)])

    def _discovery(self, writer: bool, builtin: str) -> None:
        name = builtin.upper() + "S"
        theirs = getattr(guid, f"ENTITYID_SEDP_BUILTIN_{name}_READER")
        ours = getattr(guid, f"ENTITYID_SEDP_BUILTIN_{name}_WRITER")
        for n, local in enumerate(self.own.writers if writer else self.own.readers):
            body = self._endpoint(local, n, writer)
            self._add(f"{builtin}{n}", [*self._directed, *self._data((theirs, ours), body)])
        key = _PREFIX + entity_id(0, writer)
        status = inline_qos.InlineQos(key, inline_qos.STATUS_DISPOSED | inline_qos.STATUS_UNREGISTERED).emit()
        which = int.from_bytes(entity_id(0, writer), "little")
        told = status + parameter_list.encapsulate([(parameter_list.PID_ENDPOINT_GUID, key)])
        gone = _words(told, {**self._references, which: (Op.ENTITY, which & ~0xFF0000)})
        self._add(
            f"{builtin}_gone",
            [*self._directed, *self._data((theirs, ours), gone, data.FLAG_Q | data.FLAG_K)],
        )
        self._add(f"{builtin}_heartbeat", [*self._directed, *self._heartbeat((theirs, ours))])
        # Our reader of what peers say of the same kind of endpoint
        reader = getattr(guid, f"ENTITYID_SEDP_BUILTIN_{name}_READER")
        their_writer = getattr(guid, f"ENTITYID_SEDP_BUILTIN_{name}_WRITER")
        self._add(f"{builtin}_acknack", [*self._directed, *self._acknack((reader, their_writer))])

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
        key: Item = (Op.PROXY, tables.KEY)
        writer: Item = (Op.ENTITY, int.from_bytes(entity_id(-1, True), "little"))
        reader: Item = (Op.ENTITY, int.from_bytes(entity_id(-1, False), "little"))
        body: list[Item] = [(Op.PADDING, CDR_LE), (Op.MESSAGE, 0)]
        message = self._data((key, writer), body, length=True)
        beat = self._heartbeat((key, writer))
        to_group = self._data((guid.ENTITYID_UNKNOWN, writer), body, length=True)
        self._add("group_message", [*self._header, *to_group])
        beat_group = self._heartbeat((guid.ENTITYID_UNKNOWN, writer))
        self._add("group_message_heartbeat", [*self._header, *to_group, *beat_group])
        self._add("message", [*self._directed, *message])
        self._add("message_heartbeat", [*self._directed, *message, *beat])
        self._add("heartbeat", [*self._directed, *beat])
        self._add("acknack", [*self._directed, *self._acknack((reader, key))])
        nothing = _fixed(
            gap.FIELDS,
            {
                "readerId": key,
                "writerId": writer,
                "gapStart.high": _register(Register.NUMBER_HIGH),
                "gapStart.low": (Op.PROXY, tables.ASK_FROM),
            },
        )
        base: list[Item] = [_register(Register.FIRST_HIGH), _register(Register.FIRST), (Op.LITERAL, 0)]
        self._add("gap", [*self._directed, *_submessage(submessage.GAP, 0, [*nothing, *base])])


def entity_id(n: int, writer: bool) -> bytes:
    """The entity id of our endpoint n."""
    kind = guid.ENTITYKIND_USER_WRITER_NO_KEY if writer else guid.ENTITYKIND_USER_READER_NO_KEY
    return bytes((0, 0, n + 1, kind))


def _stand_in(room: int, letter: str) -> str:
    """A name that fills a room of so many octets, and whose first word nothing else is."""
    return letter * (room - 1)


def _register(register: Register) -> Item:
    return Op.REGISTER, register.value
