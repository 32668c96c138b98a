"""The parameter tree of the ROS 1 Parameter Server: dictionaries inside dictionaries, addressed by `/a/b/c`.

All keys given to this module are global (they begin with a slash); doubled and trailing slashes mean nothing.
"""

from __future__ import annotations

from typing import Any

from roslet.wire import xmlrpc

Value = Any  # what XML-RPC carries

# A reply wraps a value in one array, system.multicall in two more, and one is spare; a tree deeper than this
# could be stored but not be read again.
MAX_DEPTH = xmlrpc.MAX_DEPTH - 4


class ParameterTree:
    """The parameters. Reading returns the tree's own objects: encode or copy them before the next change."""

    def __init__(self) -> None:
        self._root: dict[str, Value] = {}

    def get(self, key: str) -> Value:
        """The value, or the dictionary of all below `key`. Raises KeyError."""
        value: Value = self._root
        for step in steps(key):
            if not isinstance(value, dict):
                raise KeyError(key)
            value = value[step]
        return value

    def has(self, key: str) -> bool:
        """Whether there is a value or a namespace `key`."""
        try:
            self.get(key)
        except KeyError:
            return False
        return True

    def set(self, key: str, value: Value) -> None:
        """Put `value` at `key`; a dictionary replaces the whole namespace, a value in the way of `key` is
        lost.

        Raises ValueError for the root where `value` is no dictionary, and for a tree deeper than MAX_DEPTH.
        """
        path = steps(key)
        if len(path) + _depth(value) > MAX_DEPTH:
            raise ValueError(f"parameters nested more than {MAX_DEPTH} deep")
        if not path:
            if not isinstance(value, dict):
                raise ValueError("the root of the parameter tree must be a dictionary")
            self._root = value
            return
        namespace = self._root
        for step in path[:-1]:
            inner = namespace.get(step)
            if not isinstance(inner, dict):
                inner = namespace[step] = {}
            namespace = inner
        namespace[path[-1]] = value

    def delete(self, key: str) -> None:
        """Remove the value or namespace `key`. Raises KeyError where it is not there, and for the root."""
        path = steps(key)
        if not path:
            raise KeyError(key)
        namespace = self.get("/" + "/".join(path[:-1]))
        if not isinstance(namespace, dict):
            raise KeyError(key)
        del namespace[path[-1]]

    def search(self, namespace: str, key: str) -> str | None:
        """The nearest full name of `key` for somebody called `namespace`, looking upwards; None where there
        is none.

        Only the first step of `key` is looked for, so the name returned need not exist. Raises ValueError for
        an empty or private key and for a namespace that is not global.
        """
        if not key or key.startswith("~"):
            raise ValueError(f"cannot search for {key!r}")
        if not namespace.startswith("/"):
            raise ValueError(f"the namespace {namespace!r} is not global")
        if key.startswith("/"):
            return key if self.has(key) else None
        wanted = steps(key)
        if not wanted:
            raise ValueError(f"cannot search for {key!r}")
        around = steps(namespace)
        while True:
            prefix = "".join("/" + step for step in around)
            if self.has(f"{prefix}/{wanted[0]}"):
                return f"{prefix}/{key}"
            if not around:
                return None
            around.pop()

    def names(self) -> list[str]:
        """The full names of all values; an empty dictionary has none."""
        found: list[str] = []
        _collect("/", self._root, found)
        return found


def steps(key: str) -> list[str]:
    """The names on the way to `key`; none for the root."""
    return [step for step in key.split("/") if step]


def subscription_key(key: str) -> str:
    """How subscriptions to `key` are kept and updates of it are named: with a slash at the end."""
    return "/" + "".join(step + "/" for step in steps(key))


def changes(
    subscribed: list[str], key: str, value: Value, deleted: bool = False
) -> list[tuple[str, str, Value]]:
    """What the subscribers of the keys `subscribed` are to be told after `key` was set to `value` or deleted.

    Each entry is (the subscribed key, the key that the update names, its value). A subscriber of `key` or of
    a namespace around it is told the key that changed; one of a key inside it is told its own new value. The
    empty dictionary means that the key is gone.
    """
    changed = subscription_key(key)
    told = {} if deleted else value
    found: list[tuple[str, str, Value]] = []
    for name in subscribed:
        if changed.startswith(name):
            found.append((name, changed, copied(told)))
        elif name.startswith(changed):
            inner = told
            for step in steps(name[len(changed) :]):
                inner = inner.get(step, {}) if isinstance(inner, dict) else {}
            found.append((name, name, copied(inner)))
    return found


def copied(value: Value) -> Value:
    """A copy that later changes of the tree do not reach."""
    if isinstance(value, dict):
        return {key: copied(item) for key, item in value.items()}
    return value


def _depth(value: Value) -> int:
    if isinstance(value, dict):
        return 1 + max(map(_depth, value.values()), default=0)
    if isinstance(value, (list, tuple)):
        return 1 + max(map(_depth, value), default=0)
    return 0


def _collect(prefix: str, namespace: dict[str, Value], found: list[str]) -> None:
    for key, value in namespace.items():
        if isinstance(value, dict):
            _collect(f"{prefix}{key}/", value, found)
        else:
            found.append(prefix + key)
