"""What arguments say of a node's parameters: `-p name:=value` and `--params-file`."""

from __future__ import annotations

from roslet.errors import InvalidName, Unsupported
from roslet.node.values import load_yaml, parse_value

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from roslet.names import ParameterOverride

# Bytes of a parameter file, and levels of what is nested in it: a file that somebody else wrote must not take the memory.
MAX_FILE = 16 << 20
MAX_DEPTH = 64


def overrides_of(rules: list[ParameterOverride], node_name: str, full_name: str) -> dict[str, Any]:
    """The parameters that the rules give to the node; the last one counts.

    Raises OSError where a file cannot be read, InvalidName where it is no parameter file, Unsupported without PyYAML.
    """
    found: dict[str, Any] = {}
    for rule in rules:
        if rule.file:
            for pattern, parameters in read_file(rule.file):
                if concerns(pattern, node_name, full_name):
                    found.update(parameters)
        elif not rule.node or concerns(rule.node, node_name, full_name):
            found[rule.name] = parse_value(rule.value)
    return found


def concerns(pattern: str, node_name: str, full_name: str) -> bool:
    """Whether a rule for `pattern` is for the node: its name, its full name, or a path where `*` is any one part and `**`
    any number of them."""
    if pattern == node_name:
        return True
    return _fits(pattern.strip("/").split("/"), full_name.strip("/").split("/"))


def _fits(pattern: list[str], parts: list[str]) -> bool:
    if not pattern:
        return not parts
    if pattern[0] == "**":
        return any(_fits(pattern[1:], parts[at:]) for at in range(len(parts) + 1))
    return bool(parts) and pattern[0] in ("*", parts[0]) and _fits(pattern[1:], parts[1:])


def read_file(path: str) -> list[tuple[str, dict[str, Any]]]:
    """(pattern of nodes, their parameters by name), in the order of a file. Raises as `overrides_of`."""
    try:
        import yaml  # type: ignore[import-untyped,unused-ignore]
    except ImportError:
        raise Unsupported(
            f"{path}: reading a parameter file takes PyYAML: pip install 'roslet[cli]'"
        ) from None
    with open(path, encoding="utf-8") as file:
        text = file.read(MAX_FILE + 1)
    if len(text) > MAX_FILE:
        raise InvalidName(f"{path}: a parameter file of more than {MAX_FILE} characters")
    try:
        content = load_yaml(yaml, text)
    except ValueError as error:
        raise InvalidName(f"{path}: {error}") from None
    found = []
    for pattern, inner in _sections(content, "", path, 0):
        parameters: dict[str, Any] = {}
        _flatten(inner, "", parameters, path, 0)
        found.append((pattern, parameters))
    return found


def _sections(content: Any, before: str, path: str, depth: int) -> list[tuple[str, dict[str, Any]]]:
    """(pattern of nodes, what is below its `ros__parameters`), in the file's order."""
    if content is None:
        return []
    if not isinstance(content, dict) or depth > MAX_DEPTH:
        raise InvalidName(
            f"{path}: {before or 'the file'}: expected names of nodes with `ros__parameters` below"
        )
    found = []
    for key, inner in content.items():
        if key == "ros__parameters":
            if not isinstance(inner, dict):
                raise InvalidName(f"{path}: {before}: `ros__parameters` holds no parameters")
            found.append((before, inner))
        else:
            found += _sections(
                inner, f"{before}/{str(key).strip('/')}" if before else str(key), path, depth + 1
            )
    return found


def _flatten(content: dict[str, Any], before: str, into: dict[str, Any], path: str, depth: int) -> None:
    if depth > MAX_DEPTH:
        raise InvalidName(f"{path}: {before}: nested more than {MAX_DEPTH} levels")
    for key, value in content.items():
        name = f"{before}.{key}" if before else str(key)
        if isinstance(value, dict):
            _flatten(value, name, into, path, depth + 1)
        else:
            into[name] = value
