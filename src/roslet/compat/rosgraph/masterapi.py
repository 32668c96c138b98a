"""`rosgraph.masterapi`: the master's API as methods that return values and raise."""

from __future__ import annotations

from typing import Any

from roslet.compat import master
from roslet.errors import Fault, RosletError


class MasterException(Exception):
    """Base: the master could not do what it was asked."""


class MasterFailure(MasterException):
    """The master says that it failed."""


class MasterError(MasterException):
    """The master says that the call was wrong, or does not answer."""


class Master:
    """The master as `caller_id` sees it; $ROS_MASTER_URI by default."""

    def __init__(self, caller_id: str, master_uri: str | None = None) -> None:
        self.caller_id = caller_id
        self.master_uri = master_uri or master.uri()

    def _call(self, method: str, *arguments: Any) -> Any:
        try:
            return master.unpack(master.remote(self.master_uri, method, [self.caller_id, *arguments]))
        except Fault as error:
            raise (MasterFailure if error.code == 0 else MasterError)(error.message) from None
        except RosletError as error:
            raise MasterError(str(error)) from None

    def is_online(self) -> bool:
        try:
            self._call("getPid")
        except MasterException:
            return False
        return True

    def getPid(self) -> int:
        return int(self._call("getPid"))

    def getUri(self) -> str:
        return str(self._call("getUri"))

    def lookupNode(self, node_name: str) -> str:
        return str(self._call("lookupNode", node_name))

    def lookupService(self, service: str) -> str:
        return str(self._call("lookupService", service))

    def getPublishedTopics(self, subgraph: str = "") -> list[list[str]]:
        return list(self._call("getPublishedTopics", subgraph))

    def getTopicTypes(self) -> list[list[str]]:
        return list(self._call("getTopicTypes"))

    def getSystemState(self) -> list[Any]:
        """Three lists: [topic, publishers], [topic, subscribers], [service, providers]."""
        return list(self._call("getSystemState"))

    def getParam(self, key: str) -> Any:
        return self._call("getParam", key)

    def setParam(self, key: str, value: Any) -> Any:
        return self._call("setParam", key, value)

    def hasParam(self, key: str) -> bool:
        return bool(self._call("hasParam", key))

    def deleteParam(self, key: str) -> Any:
        return self._call("deleteParam", key)

    def searchParam(self, key: str) -> str:
        return str(self._call("searchParam", key))

    def getParamNames(self) -> list[str]:
        return [str(name) for name in self._call("getParamNames")]


__all__ = ["Master", "MasterError", "MasterException", "MasterFailure"]
