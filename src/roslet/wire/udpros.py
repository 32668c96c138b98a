"""UDPROS blocks: a message, with its leading length, cut into datagrams.

Source: ROS 1 UDPROS. Each datagram starts with eight bytes, little endian. Runs on MicroPython.

    0  uint32  connection id, chosen by the publisher
    4  uint8   operation: DATA0, DATAN, PING, ERR
    5  uint8   message id, counts messages modulo 256
    6  uint16  block: in DATA0 how many blocks the message has, in DATAN which one this is (from 1)
"""

from struct import pack, unpack_from

from roslet.errors import ProtocolError
from roslet.record import Names, Record

DATA0 = 0
DATAN = 1
PING = 2
ERR = 3
OPERATION = Names("operation", {DATA0: "DATA0", DATAN: "DATAN", PING: "PING", ERR: "ERR"})

SIZE = 8
MAX_BLOCKS = 0xFFFF


class Block(Record):
    """One datagram. `data` is a view on it."""

    _fields = ("connection_id", "operation", "message_id", "block", "data")
    __slots__ = _fields

    def __init__(
        self, connection_id: int, operation: int, message_id: int, block: int, data: memoryview
    ) -> None:
        self._set(connection_id, operation, message_id, block, data)

    if False:  # annotations for type checkers; `_set` assigns
        connection_id: int
        operation: int
        message_id: int
        block: int
        data: memoryview


def parse(datagram: memoryview) -> Block:
    """Raises ProtocolError udp-too-short, udp-unknown-operation."""
    if len(datagram) < SIZE:
        raise ProtocolError("udp-too-short", "%d bytes" % len(datagram))
    connection_id, operation, message_id, block = unpack_from("<IBBH", datagram, 0)
    if operation not in OPERATION.table:
        raise ProtocolError("udp-unknown-operation", "%d" % operation)
    return Block(connection_id, operation, message_id, block, datagram[SIZE:])


def emit(connection_id: int, message_id: int, frame: memoryview, datagram_size: int) -> "list[bytes]":
    """The datagrams of one frame (length and body), each of at most `datagram_size` bytes, which must be more than
    SIZE. Raises ProtocolError udp-message-too-large."""
    room = datagram_size - SIZE
    blocks = max(1, (len(frame) + room - 1) // room)
    if blocks > MAX_BLOCKS:
        raise ProtocolError("udp-message-too-large", "%d bytes need %d blocks" % (len(frame), blocks))
    datagrams = []
    for index in range(blocks):
        head = pack("<IBBH", connection_id, DATAN if index else DATA0, message_id & 255, index or blocks)
        datagrams.append(head + bytes(frame[index * room : (index + 1) * room]))
    return datagrams
