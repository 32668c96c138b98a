"""The values of constants and defaults, as each dialect writes them. Every function raises ValueError with a
sentence that the parser completes with the place."""

from __future__ import annotations

from roslet.idl.spelling import INTEGER_RANGES

TYPE_CHECKING = False
if TYPE_CHECKING:
    from roslet.idl.records import Dialect, FieldType, Value

# No number needs more digits; beyond this Python's own conversion would take quadratic time or refuse.
MAXIMUM_NUMBER_TEXT = 512

_FLOAT32_LIMIT = (
    3.4028235677973366e38  # rounds to infinity from here on (half a step above the greatest float32)
)

_ESCAPES = {
    "\\": "\\",
    "'": "'",
    '"': '"',
    "a": "\a",
    "b": "\b",
    "f": "\f",
    "n": "\n",
    "r": "\r",
    "t": "\t",
    "v": "\v",
}
_HEX_ESCAPES = {"x": 2, "u": 4, "U": 8}


def scalar_value(dialect: Dialect, type: FieldType, text: str) -> Value:  # noqa: A002
    """The value that `text` (stripped) has for one element of `type`, a primitive other than time and
    duration."""
    primitive = type.primitive
    if primitive in INTEGER_RANGES:
        return _integer(dialect, type, text)
    if primitive in ("float32", "float64"):
        return _float(type.spelled, text)
    if primitive == "bool":
        return _bool(dialect, text)
    if dialect == "ros1":
        return text
    value = _unquote(text)
    if type.string_bound is not None and len(value) > type.string_bound:
        raise ValueError(f"{len(value)} characters, {type.spelled} holds at most {type.string_bound}")
    return value


def default_value(type: FieldType, text: str) -> Value:  # noqa: A002
    """The value of a ROS 2 default: a scalar, or for an array type the tuple that `[a, b]` spells."""
    array = type.array
    if type.message is not None:
        raise ValueError(f"a field of type {type} cannot have a default value")
    if array is None:
        return scalar_value("ros2", type, text)
    if text[0] != "[" or text[-1] != "]" or len(text) < 2:
        raise ValueError("the default of an array is written [a, b, ...]")
    inside = text[1:-1].strip()
    strings = type.primitive in ("string", "wstring")
    texts = (
        _split_strings(inside) if strings else [part.strip() for part in inside.split(",")] if inside else []
    )
    if array.size is not None:
        if array.kind == "fixed" and len(texts) != array.size:
            raise ValueError(f"{len(texts)} values for an array of exactly {array.size}")
        if len(texts) > array.size:
            raise ValueError(f"{len(texts)} values for an array of at most {array.size}")
    values: list[Value] = []
    for index, part in enumerate(texts):
        try:
            values.append(scalar_value("ros2", type, part))
        except ValueError as error:
            raise ValueError(f"element {index}: {error}") from None
    return tuple(values)


def _shown(text: str) -> str:
    return repr(text if len(text) <= 40 else text[:37] + "...")


def _integer(dialect: Dialect, type: FieldType, text: str) -> int:  # noqa: A002
    value = None
    if len(text) <= MAXIMUM_NUMBER_TEXT:
        try:
            value = int(text)
        except ValueError:
            # ROS 1 reads decimals only; ROS 2 also 0x, 0o and 0b.
            if dialect == "ros2":
                value = _radix_integer(text)
    if value is None:
        raise ValueError(
            "{} is no {}".format(_shown(text), "decimal integer" if dialect == "ros1" else "integer")
        )
    low, high = INTEGER_RANGES[type.primitive or ""]
    if not low <= value <= high:
        raise ValueError(f"{_shown(text)} does not fit {type.spelled}: {low} to {high}")
    return value


def _radix_integer(text: str) -> int | None:
    try:
        return int(text, 0)
    except ValueError:
        return None


def _float(spelled: str, text: str) -> float:
    try:
        if len(text) > MAXIMUM_NUMBER_TEXT:
            raise ValueError
        value = float(text)
    except ValueError:
        raise ValueError(f"{_shown(text)} is no number") from None
    if spelled == "float32" and _FLOAT32_LIMIT <= abs(value) < float("inf"):
        raise ValueError(f"{_shown(text)} does not fit float32")
    return value


def _bool(dialect: Dialect, text: str) -> bool:
    if dialect == "ros2":
        lower = text.lower()
        if lower in ("true", "1"):
            return True
        if lower in ("false", "0"):
            return False
        raise ValueError(f"{_shown(text)} is no bool: true, false, 1 or 0")
    if text == "True":
        return True
    if text == "False":
        return False
    try:
        if len(text) > MAXIMUM_NUMBER_TEXT:
            raise ValueError
        return int(text, 0) != 0
    except ValueError:
        raise ValueError(f"{_shown(text)} is no bool: True, False or an integer") from None


def _unquote(text: str) -> str:
    """The text without its outer quotes, if it has them, and with its escape sequences replaced."""
    for quote in ('"', "'"):
        if text and text[0] == quote and text[-1] == quote:
            text = text[1:-1]
            at = text.find(quote)
            while at >= 0:
                if at == 0 or text[at - 1] != "\\":
                    raise ValueError(f"a {quote} inside {quote}...{quote} needs a backslash before it")
                at = text.find(quote, at + 1)
            break
    return _unescape(text)


def _unescape(text: str) -> str:
    at = text.find("\\")
    if at < 0:
        return text
    out: list[str] = []
    start = 0
    while 0 <= at < len(text) - 1:
        out.append(text[start:at])
        mark = text[at + 1]
        start = at + 2
        if mark in _ESCAPES:
            out.append(_ESCAPES[mark])
        elif mark in _HEX_ESCAPES:
            digits = text[start : start + _HEX_ESCAPES[mark]]
            start += len(digits)
            out.append(_code_point(digits, 16, _HEX_ESCAPES[mark], "\\" + mark + digits))
        elif mark in "01234567":
            start -= 1
            end = start + 1
            while end < len(text) and end < start + 3 and text[end] in "01234567":
                end += 1
            out.append(_code_point(text[start:end], 8, end - start, "\\" + text[start:end]))
            start = end
        else:
            out.append("\\" + mark)
        at = text.find("\\", start)
    out.append(text[start:])
    return "".join(out)


def _code_point(digits: str, base: int, count: int, shown: str) -> str:
    try:
        if len(digits) != count or not digits.isalnum():
            raise ValueError
        code = int(digits, base)
        if 0xD800 <= code < 0xE000:
            raise ValueError  # half of a surrogate pair: no encoding can carry it
        return chr(code)
    except (ValueError, OverflowError):
        raise ValueError(f"{_shown(shown)} is no character") from None


def _split_strings(text: str) -> list[str]:
    """The elements of an array of strings: quoted (commas allowed inside) or bare, separated by commas."""
    texts: list[str] = []
    at, end = 0, len(text)
    while at < end:
        if text[at] in "\"'":
            close = at + 1
            while close < end and text[close] != text[at]:
                close += 2 if text[close] == "\\" else 1
            if close >= end:
                raise ValueError(f"element {len(texts)}: the quote is not closed")
            texts.append(text[at : close + 1])
            at = close + 1
            while at < end and text[at] == " ":
                at += 1
            if at < end and text[at] != ",":
                raise ValueError(f"element {len(texts) - 1}: expected a comma after the closing quote")
        else:
            comma = text.find(",", at)
            stop = comma if comma >= 0 else end
            bare = text[at:stop].strip()
            if not bare:
                raise ValueError(f"element {len(texts)} is empty")
            texts.append(bare)
            at = stop
        at += 1
        while at < end and text[at] == " ":
            at += 1
    return texts
