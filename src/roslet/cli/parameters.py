"""Where parameters are: the contract that `roslet param` asks."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

from roslet.cli.options import CommandError


class NotSet(CommandError):
    """There is no such parameter."""


class ParameterStore(ABC):
    """A parameter is named by a node and a name within it; or, where `node` is "", by one full name.

    All raise CommandError, for a person to read; NotSet where there is no such parameter.
    """

    @abstractmethod
    def names(self, where: str) -> list[tuple[str, str]]:
        """(node, name) of every parameter below a namespace or of a node; on ROS 1 node is "" and the name is full."""

    @abstractmethod
    def get(self, node: str, name: str) -> Any:
        """The value; of a namespace, or a node, all below it as a dict."""

    @abstractmethod
    def set(self, node: str, name: str, value: Any) -> None:
        """Set it."""

    @abstractmethod
    def delete(self, node: str, names: list[str]) -> list[str]:
        """Delete them; those that are not set are returned."""

    @abstractmethod
    def describe(self, node: str, names: list[str]) -> list[dict[str, Any]]:
        """What nodes say of their parameters, as JSON data; of all where there are no names."""

    @abstractmethod
    def dump(self, where: str) -> Any:
        """What a parameter file holds of a namespace or a node."""

    @abstractmethod
    def load(self, value: Any, where: str, file: str) -> None:
        """Set what a parameter file, called `file`, holds."""
