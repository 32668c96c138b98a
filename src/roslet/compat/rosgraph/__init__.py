"""What a program finds as `rosgraph`: names, the master, whether it is there."""

from __future__ import annotations

import os

from roslet.compat.rosgraph.masterapi import Master, MasterError, MasterException, MasterFailure
from roslet.compat.rospy.client import myargv
from roslet.names import DEFAULT_MASTER

ROS_MASTER_URI = "ROS_MASTER_URI"


def get_master_uri(env: dict[str, str] | None = None, argv: list[str] | None = None) -> str:
    """$ROS_MASTER_URI, or `__master:=` of a command line."""
    for argument in argv or []:
        if argument.startswith("__master:="):
            return argument[len("__master:=") :]
    return (os.environ if env is None else env).get(ROS_MASTER_URI) or DEFAULT_MASTER


def is_master_online(master_uri: str | None = None) -> bool:
    """Whether a master answers."""
    return Master("/rosgraph", master_uri).is_online()


__all__ = [
    "Master",
    "MasterError",
    "MasterException",
    "MasterFailure",
    "get_master_uri",
    "is_master_online",
    "myargv",
]
