"""What a ROS 2 program is told after `--ros-args`: remappings, parameters, files of parameters, log levels.

    program x --ros-args -r from:=to -r node:from:=to -p name:=value --params-file f.yaml --log-level [logger:=]level -- y

The words up to `--`, or to the end, are ROS's; those around them the program's.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from roslet.errors import RosletError

if TYPE_CHECKING:
    from collections.abc import Sequence

_REMAP = ("-r", "--remap")
_PARAM = ("-p", "--param")
_WITH_VALUE = (
    *_REMAP,
    *_PARAM,
    *("--params-file", "--log-level", "--log-config-file", "--log-file-name", "-e", "--enclave"),
)
_SWITCHES = tuple(
    f"--{how}-{what}-logs" for how in ("enable", "disable") for what in ("rosout", "stdout", "external-lib")
)

LEVELS = {"unset": 0, "debug": 10, "info": 20, "warn": 30, "error": 40, "fatal": 50}


class UnknownArguments(RosletError):
    """Words after --ros-args that mean nothing; `words` are they."""

    def __init__(self, words: list[str]) -> None:
        super().__init__(str(words))
        self.words = words


class BadArgument(RosletError):
    """A word after --ros-args whose value is missing or wrong."""


class Remapping:
    """`from:=to`, for the nodes called `node` only where that is not empty."""

    __slots__ = ("node", "source", "target")

    def __init__(self, node: str, source: str, target: str) -> None:
        self.node = node
        self.source = source
        self.target = target


class RosArguments:
    """The words, sorted.

    remappings   in their order; the first that fits holds
    parameters   (node, name, value) in their order, the last holds; node is "/**" where it is for all. Values are Python's.
    level        of all loggers, as rcutils numbers it; None where nothing was said
    levels       of single loggers, by name
    enclave      "" where nothing was said
    bare         remappings that stand outside, as in ROS 1: they hold, and ROS 2 warns of them
    rest         the program's own words
    """

    def __init__(self, words: Sequence[str]) -> None:
        self.remappings: list[Remapping] = []
        self.parameters: list[tuple[str, str, Any]] = []
        self.level: int | None = None
        self.levels: dict[str, int] = {}
        self.enclave = ""
        self.bare: list[str] = []
        self.rest: list[str] = []
        unknown: list[str] = []
        inside = False
        left = list(words)
        while left:
            word = left.pop(0)
            if not inside:
                if word == "--ros-args":
                    inside = True
                elif ":=" in word.strip(":="):
                    self.bare.append(word)
                    self.remappings.append(_remapping("", word))
                else:
                    self.rest.append(word)
            elif word == "--":
                inside = False
            elif word in _WITH_VALUE:
                if not left:
                    raise BadArgument(f"{word} needs a value")
                self._take(word, left.pop(0))
            elif word not in _SWITCHES and word != "--ros-args":
                unknown.append(word)
        if unknown:
            raise UnknownArguments(unknown)

    def _take(self, flag: str, value: str) -> None:
        if flag in _REMAP:
            self.remappings.append(_remapping(flag, value))
        elif flag in _PARAM:
            self.parameters.append(_parameter(flag, value))
        elif flag == "--params-file":
            for node, section in read_parameter_file(value).items():
                self.parameters += [(node, name, one) for name, one in section.items()]
        elif flag == "--log-level":
            logger, given, level = value.rpartition(":=")
            number = LEVELS.get(level.lower())
            if number is None:
                raise BadArgument(f"{flag} {value}: no such level")
            if given:
                self.levels[logger] = number
            else:
                self.level = number
        elif flag in ("-e", "--enclave"):
            self.enclave = value

    def node_name(self, name: str) -> str:
        """What a node called `name` is called instead: `__node:=` or `__name:=`."""
        return self._special(("__node", "__name"), name) or name

    def namespace(self, name: str, namespace: str) -> str:
        """The namespace that the node called `name` has instead: `__ns:=`."""
        return self._special(("__ns",), name) or namespace

    def _special(self, keys: tuple[str, ...], name: str) -> str:
        for rule in self.remappings:
            if rule.source in keys and rule.node in ("", name):
                return rule.target
        return ""

    def parameters_of(self, full_name: str) -> dict[str, Any]:
        """What was said of the parameters of a node, whose full name is given."""
        name = full_name.rpartition("/")[2]
        found: dict[str, Any] = {}
        for node, key, value in self.parameters:
            if _fits(node, full_name, name):
                found[key] = value
        return found


def _fits(pattern: str, full_name: str, name: str) -> bool:
    """Whether a section of a file, or the prefix of a parameter, means a node. `*` stands for one part, `**` for any."""
    if pattern in ("/**", full_name):
        return True
    if "*" not in pattern:
        return "/" not in pattern and pattern == name
    parts, names = pattern.strip("/").split("/"), full_name.strip("/").split("/")
    return _parts_fit(parts, names)


def _parts_fit(parts: list[str], names: list[str]) -> bool:
    if not parts:
        return not names
    if parts[0] == "**":
        return any(_parts_fit(parts[1:], names[skip:]) for skip in range(len(names) + 1))
    return bool(names) and parts[0] in ("*", names[0]) and _parts_fit(parts[1:], names[1:])


def _remapping(flag: str, text: str) -> Remapping:
    source, found, target = text.partition(":=")
    if not found or not source or not target:
        raise BadArgument(f"Couldn't parse remap rule: '{flag} {text}'")
    node, colon, rest = source.partition(":")
    if colon and "/" not in node:
        return Remapping(node, rest, target)
    return Remapping("", source, target)


def _parameter(flag: str, text: str) -> tuple[str, str, Any]:
    from roslet.node.values import parse_value

    name, found, value = text.partition(":=")
    node, colon, rest = name.partition(":")
    if colon:
        name = rest
    if not found or not name:
        raise BadArgument(f"Couldn't parse parameter override rule: '{flag} {text}'")
    return (node if colon else "/**"), name, parse_value(value)


def read_parameter_file(path: str) -> dict[str, dict[str, Any]]:
    """The parameters of a file: by the full name of a node, or a pattern of such names, and by their own names, those of
    groups joined by dots. Raises RuntimeError for what is no such file."""
    try:
        import yaml  # type: ignore[import-untyped]
    except ImportError:
        raise RuntimeError(f"cannot read {path}: PyYAML is needed for files of parameters") from None
    with open(path, encoding="utf-8") as file:
        try:
            content = yaml.safe_load(file)
        except yaml.YAMLError as error:
            raise RuntimeError(f"{path}: {error}") from None
    found: dict[str, dict[str, Any]] = {}
    _sections(path, content, "", found)
    return found


def _sections(path: str, content: Any, prefix: str, found: dict[str, dict[str, Any]]) -> None:
    if not isinstance(content, dict):
        raise RuntimeError(f"{path}: expected names of nodes at '{prefix or '/'}'")
    for key, value in content.items():
        if key == "ros__parameters":
            if not isinstance(value, dict):
                raise RuntimeError(f"{path}: ros__parameters of '{prefix or '/'}' has no parameters")
            section = found.setdefault(prefix or "/**", {})
            _flatten(value, "", section)
        else:
            name = str(key)
            joined = name if name.startswith("/") and not prefix else f"{prefix}/{name.strip('/')}"
            _sections(path, value, joined, found)


def _flatten(values: dict[Any, Any], prefix: str, into: dict[str, Any]) -> None:
    for key, value in values.items():
        name = f"{prefix}{key}"
        if isinstance(value, dict):
            _flatten(value, name + ".", into)
        else:
            into[name] = value


def remove_ros_arguments(words: Sequence[str]) -> list[str]:
    """The words that are the program's own. Raises UnknownArguments, BadArgument."""
    return RosArguments(words).rest


__all__ = [
    "BadArgument",
    "Remapping",
    "RosArguments",
    "UnknownArguments",
    "read_parameter_file",
    "remove_ros_arguments",
]
