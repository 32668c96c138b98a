"""`rospy.numpy_msg`: message classes whose numeric arrays arrive as numpy arrays. Needs numpy."""

from __future__ import annotations

from typing import Any

import numpy  # noqa: F401 - without numpy this module cannot be imported, as in rospy

from roslet.compat.messages import adapt

_made: dict[type, type] = {}


def numpy_msg(msg_type: Any) -> Any:
    """A class like `msg_type`, for Publisher and Subscriber, whose numeric arrays are numpy arrays."""
    made = _made.get(msg_type)
    if made is None:
        adapt(msg_type)
        made = type(
            "Numpy_" + msg_type.__name__,
            (msg_type,),
            {"__slots__": (), "__module__": msg_type.__module__, "_numpy_of": msg_type},
        )
        _made[msg_type] = made
    return made


__all__ = ["numpy_msg"]
