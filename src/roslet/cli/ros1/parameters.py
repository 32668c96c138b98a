"""The parameter server."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NoReturn

from roslet.cli.options import CommandError, below, full_name
from roslet.cli.parameters import NotSet, ParameterStore
from roslet.engine.ros1.answers import parameter_names
from roslet.errors import Fault, Unsupported
from roslet.names import join

if TYPE_CHECKING:
    from roslet.cli.ros1.graph import Ros1Graph


class Server(ParameterStore):
    """The master's parameters. A node's are those in the namespace of its name."""

    def __init__(self, graph: Ros1Graph) -> None:
        self._graph = graph

    def _full(self, node: str, name: str) -> str:
        return join(full_name(node), name.lstrip("~/")) if node else full_name(name)

    def names(self, where: str) -> list[tuple[str, str]]:
        namespace = below(where)
        names = parameter_names(self._graph.master("getParamNames"))
        return [("", name) for name in sorted(names) if name.startswith(namespace)]

    def get(self, node: str, name: str) -> Any:
        full = self._full(node, name)
        try:
            return plain(self._graph.master("getParam", full))
        except Fault:
            raise NotSet(f"parameter {full} is not set") from None

    def set(self, node: str, name: str, value: Any) -> None:
        full = self._full(node, name)
        try:
            self._graph.master("setParam", full, value)
        except Fault as error:
            raise CommandError(f"the master does not set {full}: {error.message}") from None

    def delete(self, node: str, names: list[str]) -> list[str]:
        missing = []
        for full in [self._full(node, name) for name in names]:
            try:
                self._graph.master("deleteParam", full)
            except Fault:
                missing.append(full)
        return missing

    def describe(self, node: str, names: list[str]) -> NoReturn:
        raise Unsupported("param describe: parameters of the ROS 1 network have no descriptions")

    def dump(self, where: str) -> Any:
        return self.get("", where)

    def load(self, value: Any, where: str, file: str) -> None:
        namespace = full_name(where)
        if isinstance(value, dict):
            # One by one: setting a namespace as a whole would delete what the file does not name.
            for key, inner in value.items():
                self.set("", namespace.rstrip("/") + "/" + str(key).lstrip("/"), inner)
        elif namespace == "/":
            raise CommandError(f"{file}: expected names and values, not {type(value).__name__}")
        else:
            self.set("", namespace, value)


def plain(value: Any) -> Any:
    """A parameter with what JSON lacks turned into text."""
    if isinstance(value, dict):
        return {str(key): plain(inner) for key, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(inner) for inner in value]
    if isinstance(value, (bytes, bytearray)):
        return value.decode("utf-8", "backslashreplace")
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    return str(value)
