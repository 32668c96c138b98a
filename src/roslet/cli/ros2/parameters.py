"""The parameters of nodes, asked for and set through the services that each node has for its own."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, Any

from roslet.cli.options import CommandError, below, full_name
from roslet.cli.parameters import NotSet, ParameterStore
from roslet.engine.ros2.parameters import (
    BYTE_ARRAY,
    DOUBLE,
    DOUBLE_ARRAY,
    INTEGER,
    INTEGER_ARRAY,
    TYPES,
    Parameter,
)
from roslet.node.ros2.parameter_files import concerns
from roslet.node.ros2.parameters import from_value, to_parameter

if TYPE_CHECKING:
    from roslet.cli.ros2.graph import Ros2Graph

# Seconds that a node has for one answer.
TIMEOUT = 5.0
# What parameter files have between a node's name and its parameters.
KEY = "ros__parameters"


class NodeParameters(ParameterStore):
    """A full name begins with that of the node: /camera/rate is `rate` of /camera, where there is such a node."""

    def __init__(self, graph: Ros2Graph) -> None:
        self._graph = graph

    def _ask(self, node: str, service: str, kind: str, **fields: Any) -> Any:
        graph = self._graph
        name = f"{node}/{service}"
        if not graph.has_service(name):
            there = "has no parameter services" if node in graph.nodes() else "is not there"
            raise CommandError(f"the node {node} {there}")
        return graph.call(name, f"rcl_interfaces/srv/{kind}", TIMEOUT, **fields)

    def _split(self, node: str, name: str) -> tuple[str, str]:
        """(node, name within it; "" for all of it)."""
        if node:
            return full_name(node), name.removeprefix("~/")
        # Names of parameters have dots, which names of the graph have not.
        full = name if name.startswith("/") else "/" + name
        found = ""
        for one in self._graph.nodes():
            if (full == one or full.startswith(one + "/")) and len(one) > len(found):
                found = one
        if not found:
            raise CommandError(f"no node is called as {full} begins; write NODE NAME")
        return found, full[len(found) + 1 :]

    def _nodes(self, where: str) -> list[str]:
        """The node of that name, or else those below the namespace that have parameters."""
        full = full_name(where)
        nodes = self._graph.nodes()
        if full in nodes:
            return [full]
        prefix = below(where)
        return [
            one
            for one in nodes
            if one.startswith(prefix)
            and not self._graph.hidden(one)
            and self._graph.has_service(one + "/list_parameters")
        ]

    def _names_of(self, node: str) -> list[str]:
        answer = self._ask(node, "list_parameters", "ListParameters", prefixes=[], depth=0)
        return sorted(answer.result.names)

    def _values_of(self, node: str, names: list[str]) -> dict[str, Parameter]:
        """Those that are set. A node that lacks one of the names may answer none of them."""
        answer = self._ask(node, "get_parameters", "GetParameters", names=names)
        if len(answer.values) != len(names):
            if len(names) == 1:
                return {}
            return {key: one for name in names for key, one in self._values_of(node, [name]).items()}
        try:
            found = [from_value(name, value) for name, value in zip(names, answer.values, strict=True)]
        except TypeError as error:
            raise CommandError(f"{node}: {error}") from None
        return {one.name: one for one in found if one.value is not None}

    def _all_of(self, node: str) -> dict[str, Any]:
        names = self._names_of(node)
        values = self._values_of(node, names) if names else {}
        return {name: plain(one.value) for name, one in values.items()}

    def names(self, where: str) -> list[tuple[str, str]]:
        return [(node, name) for node in self._nodes(where) for name in self._names_of(node)]

    def get(self, node: str, name: str) -> Any:
        node, name = self._split(node, name)
        if not name:
            return self._all_of(node)
        found = self._values_of(node, [name]).get(name)
        if found is None:
            raise NotSet(f"parameter {name} of {node} is not set")
        return plain(found.value)

    def set(self, node: str, name: str, value: Any) -> None:
        node, name = self._split(node, name)
        values = value if not name and isinstance(value, dict) else {name: value}
        self._set(node, values)

    def _set(self, node: str, values: dict[str, Any], new_only: bool = False) -> None:
        """Each on its own, as `ros2 param load` does: one that is refused keeps no other from being set. With `new_only`
        those that have the value already are left alone: they may be read-only."""
        present = self._values_of(node, list(values)) if values else {}
        made = [_parameter(name, value, present.get(name)) for name, value in values.items()]
        refused = self._change(node, [one for one in made if not new_only or one != present.get(one.name)])
        if refused:
            raise CommandError(f"{node} refuses: {'; '.join(refused)}")

    def _change(self, node: str, parameters: list[Parameter]) -> list[str]:
        """What was refused, and why."""
        if not parameters:
            return []
        answer = self._ask(
            node,
            "set_parameters",
            "SetParameters",
            parameters=[to_parameter(parameter) for parameter in parameters],
        )
        if len(answer.results) != len(parameters):
            raise CommandError(f"{node} answers {len(answer.results)} of {len(parameters)} parameters")
        return [
            _refusal(parameter.name, result.reason)
            for parameter, result in zip(parameters, answer.results, strict=True)
            if not result.successful
        ]

    def delete(self, node: str, names: list[str]) -> list[str]:
        missing = []
        for given in names:
            owner, name = self._split(node, given)
            if name not in self._values_of(owner, [name]):
                missing.append(f"{name} of {owner}")
                continue
            refused = self._change(owner, [Parameter(name)])
            if refused:
                raise CommandError(f"{owner} refuses: {refused[0]}")
        return missing

    def describe(self, node: str, names: list[str]) -> list[dict[str, Any]]:
        node = full_name(node)
        names = names or self._names_of(node)
        answer = self._ask(node, "describe_parameters", "DescribeParameters", names=names)
        if len(answer.descriptors) != len(names):
            raise CommandError(f"{node} does not have all of {', '.join(names)}")
        return [_described(one) for one in answer.descriptors]

    def dump(self, where: str) -> Any:
        nodes = self._nodes(where)
        if not nodes:
            raise CommandError(f"no node with parameters below {full_name(where)}")
        return {node: {KEY: nested(self._all_of(node))} for node in nodes}

    def load(self, value: Any, where: str, file: str) -> None:
        if not isinstance(value, dict):
            raise CommandError(f"{file}: expected names and values, not {type(value).__name__}")
        only = "" if where in ("", "/") else full_name(where)
        sections = list(_sections(value, ""))
        if not sections and only:
            self._set(only, flat(value), new_only=True)
            return
        done = 0
        for node in [only] if only else self._graph.nodes():
            for pattern, parameters in sections:
                if concerns(pattern, node.rpartition("/")[2], node) and (
                    only or not self._graph.hidden(node)
                ):
                    self._set(node, flat(parameters), new_only=True)
                    done += 1
        if not done:
            patterns = ", ".join(pattern for pattern, _ in sections) or f"nobody: there is no {KEY}"
            raise CommandError(f"{file} is for {patterns}; no such node is there")


def _refusal(name: str, reason: str) -> str:
    if reason in ("", name):
        return f"{name}: the node has declared no such parameter" if reason else f"{name}: no reason given"
    return reason if reason.startswith(name) else f"{name}: {reason}"


def _parameter(name: str, value: Any, present: Parameter | None) -> Parameter:
    """The value in the type that the parameter has, where it is the same number."""
    if present is not None:
        if present.type == DOUBLE and isinstance(value, int) and not isinstance(value, bool):
            value = float(value)
        elif present.type == DOUBLE_ARRAY and isinstance(value, list):
            value = [float(one) if type(one) is int else one for one in value]
        elif present.type == BYTE_ARRAY and isinstance(value, list):
            with suppress(TypeError, ValueError):  # what it is then, the node refuses
                value = bytes(value)
        elif value == [] and present.type > BYTE_ARRAY:
            return Parameter(name, value, present.type)
    try:
        return Parameter(name, value)
    except TypeError as error:
        raise CommandError(str(error)) from None


def plain(value: Any) -> Any:
    """A value with what JSON lacks as a list of numbers."""
    return list(value) if isinstance(value, (bytes, bytearray)) else value


def _described(one: Any) -> dict[str, Any]:
    found: dict[str, Any] = {
        "name": one.name,
        "type": TYPES[one.type],
        "description": one.description,
        "constraints": one.additional_constraints,
        "read_only": bool(one.read_only),
        "dynamic_typing": bool(one.dynamic_typing),
    }
    for kind, ranges in ((DOUBLE, one.floating_point_range), (INTEGER, one.integer_range)):
        if len(ranges) and one.type in (kind, DOUBLE_ARRAY if kind == DOUBLE else INTEGER_ARRAY):
            found["range"] = {
                "from": ranges[0].from_value,
                "to": ranges[0].to_value,
                "step": ranges[0].step,
            }
    return found


def nested(values: dict[str, Any]) -> dict[str, Any]:
    """Names with dots as dicts within dicts; where a name is both, it stays as it is."""
    found: dict[str, Any] = {}
    for name, value in sorted(values.items()):
        target = found
        parts = name.split(".")
        for at, part in enumerate(parts[:-1]):
            inner = target.setdefault(part, {})
            if not isinstance(inner, dict):
                parts = [".".join(parts[at:])]
                break
            target = inner
        target[parts[-1]] = value
    return found


def flat(values: dict[str, Any], before: str = "") -> dict[str, Any]:
    """The contrary of `nested`."""
    found: dict[str, Any] = {}
    for key, value in values.items():
        name = f"{before}.{key}" if before else str(key)
        if isinstance(value, dict):
            found.update(flat(value, name))
        else:
            found[name] = value
    return found


def _sections(content: dict[str, Any], before: str) -> Any:
    """(pattern of nodes, parameters) in the order of the file."""
    for key, inner in content.items():
        if key == KEY and isinstance(inner, dict):
            yield before or "/**", inner
        elif isinstance(inner, dict):
            yield from _sections(inner, f"{before.rstrip('/')}/{str(key).strip('/')}")
