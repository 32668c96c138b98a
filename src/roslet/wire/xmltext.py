"""The text of XML 1.0 documents: escapes, the characters that are allowed, the encodings that are read.

Runs on MicroPython. Used by `xmlrpc`, which describes the reasons of the ProtocolErrors raised here.
"""

from roslet.errors import ProtocolError

# Section 2.2: no document may hold these, not even as character references.
_CONTROL = bytes([code for code in range(32) if code not in (9, 10, 13)])

# MicroPython has no bytes.translate, with which CPython finds a control character in one pass.
_TRANSLATE = hasattr(b"", "translate")

_ENTITIES = {"lt": "<", "gt": ">", "amp": "&", "apos": "'", "quot": '"'}


def find_control(data: bytes) -> int:
    """The code of a control character in `data` that no document may hold, or -1."""
    if _TRANSLATE and len(data.translate(None, _CONTROL)) == len(data):
        return -1
    for code in _CONTROL:
        if code in data:
            return code
    return -1


def printable(text: str) -> str:
    """`text` with a question mark for every character that no document may hold."""
    return "".join([char if is_allowed(ord(char)) else "?" for char in text])


def is_allowed(code: int) -> bool:
    """Whether a document may hold the character (section 2.2)."""
    if code < 32:
        return code in (9, 10, 13)
    return code < 0xD800 or 0xE000 <= code < 0xFFFE or 0x10000 <= code <= 0x10FFFF


def escape(text: str) -> str:
    """`text` as the content of an element."""
    if "&" in text:
        text = text.replace("&", "&amp;")
    if "<" in text:
        text = text.replace("<", "&lt;")
    if ">" in text:
        text = text.replace(">", "&gt;")
    return text


def unescape(text: str) -> str:
    """`text` with its entities and character references replaced. Raises ProtocolError for any other."""
    parts = text.split("&")
    out = [parts[0]]
    for part in parts[1:]:
        name, found, rest = part.partition(";")
        char = _ENTITIES.get(name)
        if char is None:
            char = _referred(name)
        if not char or not found:
            raise ProtocolError("bad-entity", "&%s" % part[:12])
        out.append(char)
        out.append(rest)
    return "".join(out)


def _referred(name: str) -> str:
    """The character of `#233` or `#xe9`; empty where there is none."""
    hexadecimal = name[1:2] == "x"
    digits = name[2:] if hexadecimal else name[1:]
    if name[:1] != "#" or not 0 < len(digits) <= 8:
        return ""
    for digit in digits:
        if digit not in ("0123456789abcdefABCDEF" if hexadecimal else "0123456789"):
            return ""
    code = int(digits, 16 if hexadecimal else 10)
    return chr(code) if is_allowed(code) else ""


def to_utf8(data: bytes, declaration: bytes) -> bytes:
    """A document as UTF-8, given its XML declaration in lower case. Only UTF-8 and Latin-1 are read."""
    at = declaration.find(b"encoding")
    name = b"utf-8"
    if at >= 0:
        name = declaration[at + 8 :].strip(b" \t\r\n=\"'").split(b'"')[0].split(b"'")[0]
    if name in (b"utf-8", b"utf8", b"us-ascii"):
        try:
            data.decode()
        except UnicodeError:
            raise ProtocolError("bad-encoding", "the document is not UTF-8") from None
        return data
    if name in (b"iso-8859-1", b"latin-1", b"latin1"):
        return "".join([chr(byte) for byte in data]).encode()
    raise ProtocolError("bad-encoding", "encoding %r" % name[:40])
