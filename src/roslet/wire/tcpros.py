"""TCPROS connection headers and length-prefixed frames.

Source: ROS 1 TCPROS. Every integer is an unsigned 32-bit little-endian length. Runs on MicroPython.

    header = length of all fields, then fields;  field = length, then `name=value`
    frame  = length of the body, then the body;  a service reply has one `ok` byte before the frame
"""

from struct import pack, unpack_from

from roslet.errors import ProtocolError

# A header holds a message_definition, some 50 KiB for the longest type in use. Every connection that comes in may
# hold this much before it has said who it is.
MAX_HEADER = 1 << 20
# A frame's body, unless the subscription says otherwise: larger than any image or point cloud in use, and small
# enough that one hostile publisher cannot take the machine's memory.
MAX_FRAME = 256 << 20
# More fields than the two dozen that exist.
MAX_FIELDS = 256


def emit_header(fields: "dict[str, str]") -> bytes:
    """The header with its leading length."""
    parts = []
    for name, value in fields.items():
        text = ("%s=%s" % (name, value)).encode("utf-8")
        parts.append(pack("<I", len(text)))
        parts.append(text)
    body = b"".join(parts)
    return pack("<I", len(body)) + body


def parse_header(data: "bytes | bytearray | memoryview") -> "dict[str, str]":
    """The fields of a header, given without its leading length. Of a name that comes twice the last value counts.

    Raises ProtocolError: header-truncated, header-field-without-equals, header-too-many-fields, header-not-utf-8.
    """
    fields: dict[str, str] = {}
    at = 0
    end = len(data)
    count = 0
    while at < end:
        count += 1
        if count > MAX_FIELDS:
            raise ProtocolError("header-too-many-fields", "more than %d" % MAX_FIELDS)
        if end - at < 4:
            raise ProtocolError(
                "header-truncated", "%d bytes where a length should be, at byte %d" % (end - at, at)
            )
        size = unpack_from("<I", data, at)[0]
        at += 4
        if size > end - at:
            raise ProtocolError(
                "header-truncated", "a field of %d bytes with %d left, at byte %d" % (size, end - at, at)
            )
        try:
            text = str(bytes(data[at : at + size]), "utf-8")
        except UnicodeError:
            raise ProtocolError("header-not-utf-8", "field at byte %d" % at) from None
        name, found, value = text.partition("=")
        if not found or not name:
            raise ProtocolError("header-field-without-equals", "field at byte %d" % at)
        fields[name] = value
        at += size
    return fields


def require(fields: "dict[str, str]", names: "tuple[str, ...]") -> None:
    """Raise ProtocolError header-field-missing where one of the fields is absent."""
    missing = [name for name in names if name not in fields]
    if missing:
        raise ProtocolError("header-field-missing", ", ".join(missing))
