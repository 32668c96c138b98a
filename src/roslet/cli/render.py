"""Messages as plain data, and plain data as YAML text."""

from __future__ import annotations

import math
from struct import pack, unpack
from typing import TYPE_CHECKING, Any

from roslet.cli.options import USAGE, CommandError

if TYPE_CHECKING:
    from collections.abc import Iterator


class Style:
    """What of a message to show.

    no_arrays   say of each array how long it is, instead of showing it
    no_strings  the same of each string
    most        show so many elements of an array at most; None for all
    """

    def __init__(self, no_arrays: bool = False, no_strings: bool = False, most: int | None = None) -> None:
        self.no_arrays = no_arrays
        self.no_strings = no_strings
        self.most = most


def plain(message: Any, style: Style | None = None) -> dict[str, Any]:
    """A message as dicts, lists and scalars, with the definition's field names."""
    style = style or Style()
    return {
        name: _field(getattr(message, entry[0]), entry[1], entry[2], style)
        for (name, _), entry in zip(message._fields_and_types, message._spec, strict=True)
    }


def _field(value: Any, base: Any, kind: int, style: Style) -> Any:
    if kind:
        return _array(value, base, style)
    if not isinstance(base, str):
        return plain(value, style)
    if base == "time" or base == "duration":
        return {"secs": int(value.secs), "nsecs": int(value.nsecs)}
    if base == "float32":
        return shortest32(float(value))
    if style.no_strings and base in ("string", "wstring"):
        return f"<string of {len(value)} characters>"
    return value


def _array(value: Any, base: Any, style: Style) -> Any:
    if style.no_arrays:
        name = base if isinstance(base, str) else base._type
        return f"<array of {len(value)} {name}>"
    cut = style.most is not None and len(value) > style.most
    shown = value[: style.most] if cut else value
    if isinstance(base, str) and hasattr(shown, "tolist"):
        items = shown.tolist()
    elif isinstance(shown, (bytes, bytearray)) or (
        isinstance(base, str) and base not in ("time", "duration", "string", "wstring")
    ):
        items = list(shown)
    else:
        items = [_field(item, base, 0, style) for item in shown]
    if base == "float32":
        items = [shortest32(item) for item in items]
    if cut:
        items.append(f"<and {len(value) - len(shown)} more>")
    return items


def shortest32(value: float) -> float:
    """The float with the fewest digits that is the same single-precision number: 0.1, not 0.10000000149011612."""
    if not math.isfinite(value):
        return value
    try:
        bits = pack("<f", value)
    except OverflowError:
        return value
    exact: float = unpack("<f", bits)[0]
    for digits in (6, 7, 8):
        short = float("%.*g" % (digits, exact))
        try:
            if pack("<f", short) == bits:
                return short
        except OverflowError:
            continue
    return float(f"{exact:.9g}")


def select(message: Any, path: str, style: Style | None = None) -> Any:
    """The plain value at `path`: `pose.position.x`, `ranges[3]`, `points[0:2].x`.

    After a slice the rest of the path is taken of each element. Raises CommandError where there is no such value.
    """
    return _select(message, type(message), 0, steps(path), path, style or Style())


def steps(path: str) -> list[str | int | slice]:
    """The steps of a path. Raises CommandError."""
    found: list[str | int | slice] = []
    for part in path.strip("./").replace("/", ".").split("."):
        name, *brackets = part.split("[")
        if name:
            found.append(name)
        try:
            for bracket in brackets:
                if not bracket.endswith("]"):
                    raise ValueError
                ends = bracket[:-1].split(":")
                numbers = [int(end) if end.strip() else None for end in ends]
                if len(ends) == 1 and numbers[0] is not None:
                    found.append(numbers[0])
                elif len(ends) in (2, 3):
                    found.append(slice(*numbers))
                else:
                    raise ValueError
        except ValueError:
            raise CommandError(
                f"{path!r} is no path; write pose.position.x, ranges[3] or points[0:2].x", USAGE
            ) from None
    return found


def _select(value: Any, base: Any, kind: int, path: list[Any], whole: str, style: Style) -> Any:
    if not path:
        return _field(value, base, kind, style)
    step, rest = path[0], path[1:]
    if isinstance(step, str):
        if not kind and not isinstance(base, str):
            for (name, _), entry in zip(base._fields_and_types, base._spec, strict=True):
                if name == step:
                    return _select(getattr(value, entry[0]), entry[1], entry[2], rest, whole, style)
            known = ", ".join(name for name, _ in base._fields_and_types)
            raise CommandError(f"{whole}: {base._type} has no field {step}; it has {known or 'none'}")
        if not kind and base in ("time", "duration") and step in ("secs", "nsecs"):
            return _select(getattr(value, step), "uint32", 0, rest, whole, style)
        raise CommandError(f"{whole}: {'an array' if kind else 'a ' + str(base)} has no field {step}")
    if not kind:
        raise CommandError(f"{whole}: [{step}] of something that is no array")
    if isinstance(step, slice):
        if not rest:
            return _field(value[step], base, kind, style)
        return [_select(item, base, 0, rest, whole, style) for item in value[step]]
    try:
        item = value[step]
    except IndexError:
        raise CommandError(f"{whole}: the array has {len(value)} elements") from None
    return _select(item.item() if hasattr(item, "item") else item, base, 0, rest, whole, style)


def yaml_lines(value: Any, indent: str = "") -> Iterator[str]:
    """The lines of `value` as YAML: mappings in block style, lists of scalars in one line."""
    if isinstance(value, dict) and value:
        for key, inner in value.items():
            head = f"{indent}{_key(key)}:"
            if _in_line(inner):
                yield f"{head} {yaml_scalar(inner)}"
            else:
                yield head
                yield from yaml_lines(inner, indent + "  ")
    elif isinstance(value, list) and not _in_line(value):
        for inner in value:
            if _in_line(inner):
                yield f"{indent}- {yaml_scalar(inner)}"
                continue
            lines = yaml_lines(inner, indent + "  ")
            yield f"{indent}- {next(lines).lstrip()}"
            yield from lines
    else:
        yield indent + yaml_scalar(value)


def _in_line(value: Any) -> bool:
    if isinstance(value, dict):
        return not value
    if isinstance(value, list):
        return all(not isinstance(inner, dict) and _in_line(inner) for inner in value)
    return True


def _key(key: Any) -> str:
    text = str(key)
    return text if text.isidentifier() and text.lower() not in _WORDS else quoted(text)


_WORDS = ("true", "false", "yes", "no", "on", "off", "null")


def yaml_scalar(value: Any) -> str:
    """A scalar, an empty mapping or a list of such as YAML in one line. Strings are always quoted."""
    if isinstance(value, str):
        return quoted(value)
    if value is True or value is False:
        return "true" if value else "false"
    if value is None:
        return "null"
    if isinstance(value, float):
        return float_text(value)
    if isinstance(value, list):
        return "[" + ", ".join([yaml_scalar(inner) for inner in value]) + "]"
    return "{}" if isinstance(value, dict) else str(value)


def quoted(text: str) -> str:
    """A string in double quotes, on one line, with the escapes of YAML.

    Bytes that were no UTF-8 are lone surrogates here; they are escaped too.
    """
    if text.isprintable() and '"' not in text and "\\" not in text:
        return f'"{text}"'
    return '"' + "".join([char if _is_plain(char) else _escaped(char) for char in text]) + '"'


def _is_plain(char: str) -> bool:
    return char.isprintable() and char not in '"\\'


def _escaped(char: str) -> str:
    short = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\t": "\\t", "\r": "\\r"}.get(char)
    if short is not None:
        return short
    code = ord(char)
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def float_text(value: float) -> str:
    """A float as YAML 1.1 reads it back: with a point before an exponent."""
    if not math.isfinite(value):
        return ".nan" if math.isnan(value) else ".inf" if value > 0 else "-.inf"
    text = repr(value)
    if "e" in text and "." not in text:
        text = text.replace("e", ".0e")
    return text
