# Generated from the definitions of geometry_msgs by roslet.gen.stubs. Do not edit.

import typing as _typing

from roslet.wire import message as _message
from roslet.msgs.ros2.std_msgs import msg as _std_msgs_msg

class Accel(_message.Message):
    linear: Vector3
    angular: Vector3
    def __init__(
        self,
        linear: Vector3 | None = ...,
        angular: Vector3 | None = ...,
    ) -> None: ...

class AccelStamped(_message.Message):
    header: _std_msgs_msg.Header
    accel: Accel
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        accel: Accel | None = ...,
    ) -> None: ...

class AccelWithCovariance(_message.Message):
    accel: Accel
    covariance: _typing.Any
    def __init__(
        self,
        accel: Accel | None = ...,
        covariance: _typing.Any = ...,
    ) -> None: ...

class AccelWithCovarianceStamped(_message.Message):
    header: _std_msgs_msg.Header
    accel: AccelWithCovariance
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        accel: AccelWithCovariance | None = ...,
    ) -> None: ...

class Inertia(_message.Message):
    m: float
    com: Vector3
    ixx: float
    ixy: float
    ixz: float
    iyy: float
    iyz: float
    izz: float
    def __init__(
        self,
        m: float = ...,
        com: Vector3 | None = ...,
        ixx: float = ...,
        ixy: float = ...,
        ixz: float = ...,
        iyy: float = ...,
        iyz: float = ...,
        izz: float = ...,
    ) -> None: ...

class InertiaStamped(_message.Message):
    header: _std_msgs_msg.Header
    inertia: Inertia
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        inertia: Inertia | None = ...,
    ) -> None: ...

class Point(_message.Message):
    x: float
    y: float
    z: float
    def __init__(
        self,
        x: float = ...,
        y: float = ...,
        z: float = ...,
    ) -> None: ...

class Point32(_message.Message):
    x: float
    y: float
    z: float
    def __init__(
        self,
        x: float = ...,
        y: float = ...,
        z: float = ...,
    ) -> None: ...

class PointStamped(_message.Message):
    header: _std_msgs_msg.Header
    point: Point
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        point: Point | None = ...,
    ) -> None: ...

class Polygon(_message.Message):
    points: list[Point32]
    def __init__(
        self,
        points: list[Point32] | None = ...,
    ) -> None: ...

class PolygonInstance(_message.Message):
    polygon: Polygon
    id: int
    def __init__(
        self,
        polygon: Polygon | None = ...,
        id: int = ...,
    ) -> None: ...

class PolygonInstanceStamped(_message.Message):
    header: _std_msgs_msg.Header
    polygon: PolygonInstance
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        polygon: PolygonInstance | None = ...,
    ) -> None: ...

class PolygonStamped(_message.Message):
    header: _std_msgs_msg.Header
    polygon: Polygon
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        polygon: Polygon | None = ...,
    ) -> None: ...

class Pose(_message.Message):
    position: Point
    orientation: Quaternion
    def __init__(
        self,
        position: Point | None = ...,
        orientation: Quaternion | None = ...,
    ) -> None: ...

class Pose2D(_message.Message):
    x: float
    y: float
    theta: float
    def __init__(
        self,
        x: float = ...,
        y: float = ...,
        theta: float = ...,
    ) -> None: ...

class PoseArray(_message.Message):
    header: _std_msgs_msg.Header
    poses: list[Pose]
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        poses: list[Pose] | None = ...,
    ) -> None: ...

class PoseStamped(_message.Message):
    header: _std_msgs_msg.Header
    pose: Pose
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        pose: Pose | None = ...,
    ) -> None: ...

class PoseWithCovariance(_message.Message):
    pose: Pose
    covariance: _typing.Any
    def __init__(
        self,
        pose: Pose | None = ...,
        covariance: _typing.Any = ...,
    ) -> None: ...

class PoseWithCovarianceStamped(_message.Message):
    header: _std_msgs_msg.Header
    pose: PoseWithCovariance
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        pose: PoseWithCovariance | None = ...,
    ) -> None: ...

class Quaternion(_message.Message):
    x: float
    y: float
    z: float
    w: float
    def __init__(
        self,
        x: float = ...,
        y: float = ...,
        z: float = ...,
        w: float = ...,
    ) -> None: ...

class QuaternionStamped(_message.Message):
    header: _std_msgs_msg.Header
    quaternion: Quaternion
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        quaternion: Quaternion | None = ...,
    ) -> None: ...

class Transform(_message.Message):
    translation: Vector3
    rotation: Quaternion
    def __init__(
        self,
        translation: Vector3 | None = ...,
        rotation: Quaternion | None = ...,
    ) -> None: ...

class TransformStamped(_message.Message):
    header: _std_msgs_msg.Header
    child_frame_id: str
    transform: Transform
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        child_frame_id: str = ...,
        transform: Transform | None = ...,
    ) -> None: ...

class Twist(_message.Message):
    linear: Vector3
    angular: Vector3
    def __init__(
        self,
        linear: Vector3 | None = ...,
        angular: Vector3 | None = ...,
    ) -> None: ...

class TwistStamped(_message.Message):
    header: _std_msgs_msg.Header
    twist: Twist
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        twist: Twist | None = ...,
    ) -> None: ...

class TwistWithCovariance(_message.Message):
    twist: Twist
    covariance: _typing.Any
    def __init__(
        self,
        twist: Twist | None = ...,
        covariance: _typing.Any = ...,
    ) -> None: ...

class TwistWithCovarianceStamped(_message.Message):
    header: _std_msgs_msg.Header
    twist: TwistWithCovariance
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        twist: TwistWithCovariance | None = ...,
    ) -> None: ...

class Vector3(_message.Message):
    x: float
    y: float
    z: float
    def __init__(
        self,
        x: float = ...,
        y: float = ...,
        z: float = ...,
    ) -> None: ...

class Vector3Stamped(_message.Message):
    header: _std_msgs_msg.Header
    vector: Vector3
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        vector: Vector3 | None = ...,
    ) -> None: ...

class VelocityStamped(_message.Message):
    header: _std_msgs_msg.Header
    body_frame_id: str
    reference_frame_id: str
    velocity: Twist
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        body_frame_id: str = ...,
        reference_frame_id: str = ...,
        velocity: Twist | None = ...,
    ) -> None: ...

class Wrench(_message.Message):
    force: Vector3
    torque: Vector3
    def __init__(
        self,
        force: Vector3 | None = ...,
        torque: Vector3 | None = ...,
    ) -> None: ...

class WrenchStamped(_message.Message):
    header: _std_msgs_msg.Header
    wrench: Wrench
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        wrench: Wrench | None = ...,
    ) -> None: ...
