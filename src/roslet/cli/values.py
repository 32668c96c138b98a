"""Values given as text: YAML where PyYAML is installed, otherwise scalars and JSON; and messages made of them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from roslet.cli.options import USAGE, CommandError
from roslet.errors import InvalidMessage

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from types import ModuleType

    from roslet.wire.message import Message

_NUMBERS = ("int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64")


def yaml_module() -> ModuleType | None:
    """PyYAML, where it is installed (extra `cli`)."""
    from importlib import import_module

    try:
        return import_module("yaml")
    except ImportError:
        return None


def read_value(text: str) -> Any:
    """The value of one command-line argument. Raises CommandError for text that looks like a structure but is none."""
    yaml = yaml_module()
    if yaml is not None:
        from roslet.node.values import load_yaml

        try:
            value = load_yaml(yaml, text)
        except ValueError as error:
            raise CommandError(f"not YAML: {text!r}: {error}", USAGE) from None
        return "" if value is None and not text.strip() else value
    from roslet.node.values import parse_value

    try:
        value = parse_value(text)
    except RecursionError:
        raise CommandError(f"nested too deeply: {text[:40]!r}...", USAGE) from None
    if value == text and (text.strip()[:1] in ("{", "[") or ": " in text):
        raise CommandError(f"not JSON: {text!r} (YAML needs PyYAML: pip install 'roslet[cli]')", USAGE)
    return value


def read_document(text: str, name: str) -> Any:
    """The value that a file holds. Raises CommandError, which names the file."""
    yaml = yaml_module()
    if yaml is not None:
        from roslet.node.values import load_yaml

        try:
            return load_yaml(yaml, text)
        except ValueError as error:
            raise CommandError(f"{name}: {error}") from None
    import json

    try:
        return json.loads(text)
    except RecursionError:
        raise CommandError(f"{name}: nested too deeply") from None
    except ValueError as error:
        raise CommandError(f"{name}: {error}; a YAML file needs PyYAML: pip install 'roslet[cli]'") from None


def build(kind: type[Message], arguments: Sequence[str], now: Callable[[], Any]) -> Message:
    """A message of class `kind` from command-line arguments.

    Each is `field.path:=value`, or YAML: a mapping of fields, or (several, or one that is no mapping) the fields' values in
    their order. `now` for a time, and `auto` for a header, mean the present time, `now()`. Raises CommandError (wrong
    usage), InvalidMessage with the value path.
    """
    message = kind()
    positional: list[str] = []
    assignments: list[tuple[str, str]] = []
    for argument in arguments:
        path, found, value = argument.partition(":=")
        if found and all(part.isidentifier() for part in path.split(".")):
            assignments.append((path, value))
        else:
            positional.append(argument)
    if positional:
        values = [read_value(argument) for argument in positional]
        whole = len(values) == 1 and isinstance(values[0], (dict, list, type(None)))
        if not whole and len(kind._spec) == len(values):
            # A string field takes its argument as it stands: 42 is text there.
            for at, (_attribute, base, single, _size, _bound) in enumerate(kind._spec):
                if base in ("string", "wstring") and not single:
                    values[at] = _text(positional[at], values[at])
        fill(message, values[0] if whole else values, now)
    for path, text in assignments:
        _assign(message, path, text, now)
    return message


def _text(argument: str, value: Any) -> Any:
    return value if isinstance(value, str) else argument


def names(kind: type[Message]) -> list[str]:
    """The fields' names as the definition has them."""
    return [name for name, _ in kind._fields_and_types]


def _assign(message: Message, path: str, text: str, now: Callable[[], Any]) -> None:
    steps = path.split(".")
    target: Any = message
    for at, step in enumerate(steps):
        if not hasattr(target, "_spec"):
            if step not in ("secs", "nsecs") or at != len(steps) - 1 or not hasattr(target, step):
                raise CommandError(f"{'.'.join(steps[:at])} has no field {step}", USAGE)
            setattr(target, step, _converted(read_value(text), "int64", 0, path, now))
            return
        entry = dict(zip(names(type(target)), target._spec, strict=True)).get(step)
        if entry is None:
            where = ".".join(steps[:at]) or type(message)._type
            raise CommandError(f"{where} has no field {step}; it has {_listed(type(target))}", USAGE)
        attribute, base, single, _size, _bound = entry
        if at < len(steps) - 1:
            target = getattr(target, attribute)
        elif base in ("string", "wstring") and not single:
            value = read_value(text) if text[:1] in ("'", '"') else text
            setattr(target, attribute, value if isinstance(value, str) else text)
        else:
            setattr(
                target,
                attribute,
                _converted(read_value(text), base, single, path, now, getattr(target, attribute)),
            )


def _listed(kind: type[Message]) -> str:
    return ", ".join(names(kind)) or "no fields"


def fill(message: Message, value: Any, now: Callable[[], Any], path: str = "") -> None:
    """Set a message's fields from a mapping of some of them, or from a list of all. Raises InvalidMessage."""
    spec: Sequence[Any] = message._spec
    fields = names(type(message))
    if value is None:
        return
    if isinstance(value, (list, tuple)):
        if len(value) != len(spec):
            text = f"{len(value)} values for {len(spec)} fields ({_listed(type(message))})"
            raise InvalidMessage(text, path or type(message)._type)
        value = dict(zip(fields, value, strict=True))
    elif not isinstance(value, dict):
        if len(spec) == 1:
            value = {fields[0]: value}
        else:
            raise InvalidMessage(
                f"expected {_listed(type(message))}, got {value!r}", path or type(message)._type
            )
    table = dict(zip(fields, spec, strict=True))
    for name, inner in value.items():
        where = f"{path}.{name}" if path else str(name)
        if name not in table:
            raise InvalidMessage(
                f"no such field in {type(message)._type}; it has {_listed(type(message))}", where
            )
        attribute, base, single, _size, _bound = table[name]
        setattr(message, attribute, _converted(inner, base, single, where, now, getattr(message, attribute)))


def _converted(value: Any, base: Any, kind: int, path: str, now: Callable[[], Any], old: Any = None) -> Any:
    """A value for one field. `kind` 0 is a single value, others are arrays; `old` is what the field holds."""
    if kind:
        if isinstance(value, (str, dict)) or not hasattr(value, "__len__"):
            raise InvalidMessage(f"expected a list, got {value!r}", path)
        if base in _NUMBERS and base[:5] != "float":
            return value
        return [_converted(item, base, 0, f"{path}[{at}]", now) for at, item in enumerate(value)]
    if not isinstance(base, str):
        made: Message = base() if old is None else old
        if value == "now" and base._type == "builtin_interfaces/msg/Time":
            stamp = now()
            value = {"sec": stamp.secs, "nanosec": stamp.nsecs}
        if value == "auto" and base._type in ("std_msgs/Header", "std_msgs/msg/Header"):
            value = {"stamp": "now"}
        fill(made, value, now, path)
        return made
    if base in ("time", "duration"):
        return _time(value, base, path, now)
    if base in ("float32", "float64"):
        if isinstance(value, str):
            # YAML 1.1 reads 1e-3 as text, and JSON spells these two so.
            try:
                return float(value.replace("Infinity", "inf"))
            except ValueError:
                return value
        if isinstance(value, int) and not isinstance(value, bool):
            try:
                return float(value)
            except OverflowError:
                raise InvalidMessage("too large for a float", path) from None
    return value


def _time(value: Any, base: str, path: str, now: Callable[[], Any]) -> Any:
    from roslet.wire.time import Duration, Time

    kind: Any = Time if base == "time" else Duration
    if value == "now" and base == "time":
        return now()
    if isinstance(value, dict):
        known = {"secs": "secs", "nsecs": "nsecs", "sec": "secs", "nanosec": "nsecs", "nsec": "nsecs"}
        wrong = [str(key) for key in value if key not in known]
        if wrong:
            raise InvalidMessage(f"no such field in a {base}; it has secs, nsecs", f"{path}.{wrong[0]}")
        parts = {known[key]: inner for key, inner in value.items()}
        value = [parts.get("secs", 0), parts.get("nsecs", 0)]
    if isinstance(value, (list, tuple)) and len(value) == 2 and all(type(part) is int for part in value):
        made = kind()
        made.set(*value)
        return made
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        try:
            return kind(value)
        except (TypeError, ValueError, OverflowError) as error:
            raise InvalidMessage(str(error), path) from None
    raise InvalidMessage(f"expected {{secs, nsecs}} or seconds, got {value!r}", path)
