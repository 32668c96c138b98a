"""Strings as rospy prints them in messages: YAML 1.1 scalars, escaped and folded at 80 columns.

A single string is always double-quoted; a string in a list is plain where YAML allows it, else single-quoted, and
double-quoted where it has characters that need escapes. Source: YAML 1.1, sections 5.7, 7.3, 7.4; judged by genpy.
"""

from __future__ import annotations

import re

WIDTH = 80
DASH = "- "

_ESCAPES = {
    "\0": "\\0",
    "\a": "\\a",
    "\b": "\\b",
    "\t": "\\t",
    "\n": "\\n",
    "\v": "\\v",
    "\f": "\\f",
    "\r": "\\r",
    "\x1b": "\\e",
    '"': '\\"',
    "\\": "\\\\",
    "\x85": "\\N",
    "\xa0": "\\_",
    "\u2028": "\\L",
    "\u2029": "\\P",
}

# What YAML 1.1 reads as something else than a string, so that a string of this look must be quoted.
_OTHER = re.compile(
    r"""(?:
    y|Y|yes|Yes|YES|n|N|no|No|NO|true|True|TRUE|false|False|FALSE|on|On|ON|off|Off|OFF
    |~|null|Null|NULL|=|<<
    |[-+]?0b[01_]+|[-+]?0[0-7_]+|[-+]?(?:0|[1-9][0-9_]*)|[-+]?0x[0-9a-fA-F_]+|[-+]?[1-9][0-9_]*(?::[0-5]?[0-9])+
    |[-+]?[0-9][0-9_]*\.[0-9_]*(?:[eE][-+][0-9]+)?|\.[0-9][0-9_]*(?:[eE][-+][0-9]+)?
    |[-+]?[0-9][0-9_]*(?::[0-5]?[0-9])+\.[0-9_]*|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)
    |[0-9]{4}-[0-9]{2}-[0-9]{2}
    |[0-9]{4}-[0-9]{1,2}-[0-9]{1,2}(?:[Tt]|[ \t]+)[0-9]{1,2}:[0-9]{2}:[0-9]{2}(?:\.[0-9]*)?
     (?:[ \t]*(?:Z|[-+][0-9]{1,2}(?::[0-9]{2})?))?
    )""",
    re.VERBOSE,
)
_BOOL_LIKE = re.compile(r"[yYnN]")
_PRINTABLE = re.compile(r"[ -~]*")
_NEVER_FIRST = "#,[]{}&*!|>'\"%@`"


def double_quoted(text: str, begin: int = 0) -> str:
    """The string between double quotes, with escapes, folded at spaces and at escapes; its first line begins in column
    `begin`."""
    width = WIDTH - begin
    lines: list[str] = []
    line = '"'
    pending = ""  # plain characters since the last escape or line break
    last = len(text) - 1
    for at, char in enumerate(text):
        inside = 0 < at < last
        if " " <= char <= "~" and char not in '"\\':
            if inside and (char == " " or not pending) and len(line) + len(pending) > width:
                lines.append(line + pending + "\\")
                line, pending, width = ("  \\" if char == " " else "  "), "", WIDTH
            pending += char
            continue
        line += pending + _escape(char)
        pending = ""
        if inside and len(line) > width + 1:
            lines.append(line + "\\")
            width = WIDTH
            line = "  \\" if text[at + 1] == " " else "  "
    return "\n".join([*lines, line + pending + '"'])


def _escape(char: str) -> str:
    known = _ESCAPES.get(char)
    if known is not None:
        return known
    code = ord(char)
    if code <= 0xFF:
        return f"\\x{code:02X}"
    return f"\\u{code:04X}" if code <= 0xFFFF else f"\\U{code:08X}"


def plain_or_quoted(text: str) -> str:
    """The string as an element of a list, after its dash."""
    if _PRINTABLE.fullmatch(text):
        if text and _is_plain(text):
            return _fold(text, DASH)[len(DASH) :]
        return _fold(text.replace("'", "''"), DASH + "'")[len(DASH) :] + "'"
    lines_only = "\n" in text and _PRINTABLE.fullmatch(text.replace("\n", ""))
    if lines_only and " \n" not in text and "\n " not in text:
        return _lines(text.replace("'", "''"))
    return double_quoted(text, len(DASH))


def _is_plain(text: str) -> bool:
    if text[0] in " " or text[-1] == " " or text[0] in _NEVER_FIRST:
        return False
    if text[0] in "-?:" and (len(text) == 1 or text[1] == " "):
        return False
    if ": " in text or text[-1] == ":" or " #" in text or text[:3] in ("---", "..."):
        return False
    return _OTHER.fullmatch(text) is None or _BOOL_LIKE.fullmatch(text) is not None


def _lines(text: str) -> str:
    """A string with line breaks between single quotes: each break is one more there."""
    written = ""
    for part in re.split("(\n+)", text):
        if part.startswith("\n"):
            written += part + "\n"
        else:
            written += _fold(part, "  " if written else DASH + "'")
    return written[len(DASH) :] + "'"


def _fold(text: str, line: str) -> str:
    """The text after the first line's beginning, with line breaks in place of single spaces beyond column 80."""
    lines: list[str] = []
    for at, part in enumerate(re.split("(?<=[^ ])( )(?=[^ ])", text)):
        if at % 2 and len(line) > WIDTH:
            lines.append(line)
            line = "  "
        else:
            line += part
    return "\n".join([*lines, line])


__all__ = ["double_quoted", "plain_or_quoted"]
