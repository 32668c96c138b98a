# Generated from the definitions of trajectory_msgs by roslet.gen.stubs. Do not edit.

import typing as _typing

from roslet.wire import message as _message
from roslet.wire import time as _time
from roslet.msgs.ros2.builtin_interfaces import msg as _builtin_interfaces_msg
from roslet.msgs.ros2.geometry_msgs import msg as _geometry_msgs_msg
from roslet.msgs.ros2.std_msgs import msg as _std_msgs_msg

class JointTrajectory(_message.Message):
    header: _std_msgs_msg.Header
    joint_names: list[str]
    points: list[JointTrajectoryPoint]
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        joint_names: list[str] | None = ...,
        points: list[JointTrajectoryPoint] | None = ...,
    ) -> None: ...

class JointTrajectoryPoint(_message.Message):
    positions: _typing.Any
    velocities: _typing.Any
    accelerations: _typing.Any
    effort: _typing.Any
    time_from_start: _builtin_interfaces_msg.Duration | _time.Duration
    def __init__(
        self,
        positions: _typing.Any = ...,
        velocities: _typing.Any = ...,
        accelerations: _typing.Any = ...,
        effort: _typing.Any = ...,
        time_from_start: _builtin_interfaces_msg.Duration | _time.Duration | None = ...,
    ) -> None: ...

class MultiDOFJointTrajectory(_message.Message):
    header: _std_msgs_msg.Header
    joint_names: list[str]
    points: list[MultiDOFJointTrajectoryPoint]
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        joint_names: list[str] | None = ...,
        points: list[MultiDOFJointTrajectoryPoint] | None = ...,
    ) -> None: ...

class MultiDOFJointTrajectoryPoint(_message.Message):
    transforms: list[_geometry_msgs_msg.Transform]
    velocities: list[_geometry_msgs_msg.Twist]
    accelerations: list[_geometry_msgs_msg.Twist]
    time_from_start: _builtin_interfaces_msg.Duration | _time.Duration
    def __init__(
        self,
        transforms: list[_geometry_msgs_msg.Transform] | None = ...,
        velocities: list[_geometry_msgs_msg.Twist] | None = ...,
        accelerations: list[_geometry_msgs_msg.Twist] | None = ...,
        time_from_start: _builtin_interfaces_msg.Duration | _time.Duration | None = ...,
    ) -> None: ...
