"""What is wrong with a name, and where: the rules of ROS 2's names in the sentences that rclpy's exceptions have."""

from __future__ import annotations

import re

# Longest names, by rmw: a node's, a namespace's, a topic's (255 less what is put before it on the wire).
MAX_NODE_NAME = 255
MAX_NAMESPACE = 245
MAX_TOPIC = 247

_WORD = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_"
_DIGITS = "0123456789"

Fault = tuple[str, int]


def _byte_index(name: str, index: int) -> int:
    """Where a character is in UTF-8."""
    return len(name[:index].encode())


def _other(name: str, allowed: str) -> int:
    """The index of the first character that is not allowed, -1 where there is none."""
    return next((at for at, char in enumerate(name) if char not in allowed), -1)


def node_name_fault(name: str) -> Fault | None:
    """What is wrong with a node's own name."""
    if not name:
        return "node name must not be empty", 0
    bad = _other(name, _WORD)
    if bad >= 0:
        return "node name must not contain characters other than alphanumerics or '_'", _byte_index(name, bad)
    if name[0] in _DIGITS:
        return "node name must not start with a number", 0
    if len(name) > MAX_NODE_NAME:
        return f"node name length should not exceed '{MAX_NODE_NAME}'", MAX_NODE_NAME - 1
    return None


def _absolute_fault(name: str, what: str, slash: str) -> Fault | None:
    if not name:
        return f"{what} must not be empty", 0
    if name[0] != "/":
        return f"{what} must be absolute, it must lead with a '/'", 0
    if name.endswith("/") and (len(name) > 1 or what == "topic name"):
        return slash, len(name) - 1
    bad = _other(name, _WORD + "/")
    if bad >= 0:
        return (
            f"{what} must not contain characters other than alphanumerics, '_', or '/'",
            _byte_index(name, bad),
        )
    doubled = name.find("//")
    if doubled >= 0:
        return f"{what} must not contain repeated '/'", doubled + 1
    digit = re.search(r"/(?=[0-9])", name)
    if digit is not None:
        return f"{what} must not have a token that starts with a number", digit.end()
    return None


def namespace_fault(name: str) -> Fault | None:
    """What is wrong with a namespace."""
    found = _absolute_fault(name, "namespace", "namespace must not end with a '/', unless only a '/'")
    if found is None and len(name) > MAX_NAMESPACE:
        return "namespace should not exceed 'RMW_NAMESPACE_MAX_NAME_LENGTH'", MAX_NAMESPACE - 1
    return found


def full_topic_fault(name: str) -> Fault | None:
    """What is wrong with a topic's full name."""
    found = _absolute_fault(name, "topic name", "topic name must not end with a '/'")
    if found is None and len(name) > MAX_TOPIC:
        return "topic length should not exceed '255U - 8U'", MAX_TOPIC - 1
    return found


def topic_fault(name: str) -> Fault | None:
    """What is wrong with a topic's name as a program writes it: relative, private, with substitutions."""
    if not name:
        return "topic name must not be empty string", 0
    if name[0] in _DIGITS:
        return "topic name token must not start with a number", 0
    if name.endswith("/"):
        return "topic name must not end with a forward slash", len(name) - 1
    opened = -1
    for at, char in enumerate(name):
        index = _byte_index(name, at)
        if char == "{":
            if opened >= 0:
                return "topic name must not have nested curly braces '{}'", index
            opened = at
        elif char == "}":
            if opened < 0:
                return _UNBALANCED, index
            opened = -1
        elif char == "~":
            if at:
                return "topic name must not have tilde '~' unless it is the first character", index
        elif char == "/":
            if opened >= 0:
                return "substitution name must not contain characters other than alphanumerics or '_'", index
        elif char not in _WORD:
            return (
                "topic name must not contain characters other than alphanumerics, '_', '~', '{', or '}'",
                index,
            )
        elif char in _DIGITS and at:
            if name[at - 1] == "{":
                return "substitution name must not start with a number", index
            if name[at - 1] == "/":
                return "topic name token must not start with a number", index
    if opened >= 0:
        return _UNBALANCED, _byte_index(name, opened)
    if len(name) > 1 and name[0] == "~" and name[1] != "/":
        return "tilde '~' must be followed by a forward slash '/'", 1
    return None


_UNBALANCED = "topic name must not have unmatched (unbalanced) curly braces '{}'"


def expand(topic: str, node: str, namespace: str) -> str:
    """The full name of a topic for a node. Raises ValueError and says which of the three is wrong."""
    for what, name, fault in (
        ("topic name", topic, topic_fault(topic)),
        ("node name", node, node_name_fault(node)),
        ("node namespace", namespace, namespace_fault(namespace)),
    ):
        if fault is not None:
            raise ValueError(f"{what} '{name}' is invalid: {fault[0]}")
    values = {"node": node, "ns": namespace, "namespace": namespace}

    def substitute(found: re.Match[str]) -> str:
        value = values.get(found.group(1))
        if value is None:
            raise ValueError(f"topic name '{topic}' is invalid: unknown substitution: {found.group(0)}")
        return value

    base = "" if namespace == "/" else namespace
    if topic[0] == "~":
        topic = f"{base}/{node}{topic[1:]}"
    full = re.sub(r"\{(\w*)\}", substitute, topic)
    return full if full.startswith("/") else f"{base}/{full}"
