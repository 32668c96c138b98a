"""Raw messages to message objects: by the definition that is installed, or else by what the publisher has of it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

from roslet.cli.options import CommandError
from roslet.errors import DefinitionError, RosletError

if TYPE_CHECKING:
    from roslet.node.topics import RawMessage
    from roslet.wire.message import Message


class Reader(ABC):
    """The class for each type and hash is found once."""

    def __init__(self) -> None:
        self._classes: dict[tuple[str, str], type[Message]] = {}

    def read(self, raw: RawMessage) -> Message:
        """Raises CommandError where there is no definition, MalformedMessage."""
        key = (raw.type, raw.md5sum)
        kind = self._classes.get(key)
        if kind is None:
            kind = self._classes[key] = self._find(raw)
        return kind.deserialize(raw.data)

    @abstractmethod
    def _find(self, raw: RawMessage) -> type[Message]: ...


class Ros1Reader(Reader):
    """A publisher sends the definition with its connection header."""

    def _find(self, raw: RawMessage) -> type[Message]:
        from roslet.gen.runtime import message_class, message_class_of

        problem = ""
        try:
            kind = message_class("ros1", raw.type)
            if raw.md5sum in ("*", kind._md5sum):
                return kind
            problem = f"the definition installed here has md5sum {kind._md5sum}, the publisher's {raw.md5sum}"
        except DefinitionError as error:
            problem = str(error)
        if raw.definition.strip() or not problem:
            try:
                return message_class_of(raw.type, raw.definition)
            except RosletError as error:
                problem = f"the definition that its publisher sent is wrong: {error}"
        raise CommandError(f"cannot show {raw.type}: {problem}")
