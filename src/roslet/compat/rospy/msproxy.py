"""`rospy.msproxy`: the master as an object. Its parameters can be used as a dictionary's."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from roslet.compat import master
from roslet.compat.rospy.names import resolve_name
from roslet.compat.session import session
from roslet.errors import Fault

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


class MasterProxy:
    """Every method of the master's API; each returns the whole reply, (code, status, value). `caller_id` is put in."""

    def __init__(self, uri: str) -> None:
        self.target = uri

    def __getattr__(self, name: str) -> Callable[..., Any]:
        if name.startswith("_"):
            raise AttributeError(name)
        return lambda *arguments: master.remote(self.target, name, [session.name, *arguments])

    def __getitem__(self, key: str) -> Any:
        """A parameter. Raises KeyError."""
        try:
            return master.call("getParam", resolve_name(key))
        except Fault:
            raise KeyError(key) from None

    def __setitem__(self, key: str, value: Any) -> None:
        master.call("setParam", resolve_name(key), value)

    def __delitem__(self, key: str) -> None:
        try:
            master.call("deleteParam", resolve_name(key))
        except Fault:
            raise KeyError(key) from None

    def __contains__(self, key: str) -> bool:
        return bool(master.call("hasParam", resolve_name(key)))

    def __iter__(self) -> Iterator[str]:
        return iter(master.call("getParamNames"))

    def search_param(self, key: str) -> str | None:
        """The full name of the nearest parameter `key`, from this node's namespace upwards."""
        try:
            return str(master.call("searchParam", key))
        except Fault:
            return None

    def get(self, key: str, default: Any = None) -> Any:
        try:
            return self[key]
        except KeyError:
            return default


__all__ = ["MasterProxy"]
