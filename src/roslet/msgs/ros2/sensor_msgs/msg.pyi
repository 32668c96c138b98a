# Generated from the definitions of sensor_msgs by roslet.gen.stubs. Do not edit.

import typing as _typing
from collections import abc as _abc

from roslet.wire import message as _message
from roslet.wire import time as _time
from roslet.msgs.ros2.builtin_interfaces import msg as _builtin_interfaces_msg
from roslet.msgs.ros2.geometry_msgs import msg as _geometry_msgs_msg
from roslet.msgs.ros2.std_msgs import msg as _std_msgs_msg

class BatteryState(_message.Message):
    POWER_SUPPLY_STATUS_UNKNOWN: _typing.ClassVar[int]
    POWER_SUPPLY_STATUS_CHARGING: _typing.ClassVar[int]
    POWER_SUPPLY_STATUS_DISCHARGING: _typing.ClassVar[int]
    POWER_SUPPLY_STATUS_NOT_CHARGING: _typing.ClassVar[int]
    POWER_SUPPLY_STATUS_FULL: _typing.ClassVar[int]
    POWER_SUPPLY_HEALTH_UNKNOWN: _typing.ClassVar[int]
    POWER_SUPPLY_HEALTH_GOOD: _typing.ClassVar[int]
    POWER_SUPPLY_HEALTH_OVERHEAT: _typing.ClassVar[int]
    POWER_SUPPLY_HEALTH_DEAD: _typing.ClassVar[int]
    POWER_SUPPLY_HEALTH_OVERVOLTAGE: _typing.ClassVar[int]
    POWER_SUPPLY_HEALTH_UNSPEC_FAILURE: _typing.ClassVar[int]
    POWER_SUPPLY_HEALTH_COLD: _typing.ClassVar[int]
    POWER_SUPPLY_HEALTH_WATCHDOG_TIMER_EXPIRE: _typing.ClassVar[int]
    POWER_SUPPLY_HEALTH_SAFETY_TIMER_EXPIRE: _typing.ClassVar[int]
    POWER_SUPPLY_TECHNOLOGY_UNKNOWN: _typing.ClassVar[int]
    POWER_SUPPLY_TECHNOLOGY_NIMH: _typing.ClassVar[int]
    POWER_SUPPLY_TECHNOLOGY_LION: _typing.ClassVar[int]
    POWER_SUPPLY_TECHNOLOGY_LIPO: _typing.ClassVar[int]
    POWER_SUPPLY_TECHNOLOGY_LIFE: _typing.ClassVar[int]
    POWER_SUPPLY_TECHNOLOGY_NICD: _typing.ClassVar[int]
    POWER_SUPPLY_TECHNOLOGY_LIMN: _typing.ClassVar[int]
    POWER_SUPPLY_TECHNOLOGY_TERNARY: _typing.ClassVar[int]
    POWER_SUPPLY_TECHNOLOGY_VRLA: _typing.ClassVar[int]
    header: _std_msgs_msg.Header
    voltage: float
    temperature: float
    current: float
    charge: float
    capacity: float
    design_capacity: float
    percentage: float
    power_supply_status: int
    power_supply_health: int
    power_supply_technology: int
    present: bool
    cell_voltage: _typing.Any
    cell_temperature: _typing.Any
    location: str
    serial_number: str
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        voltage: float = ...,
        temperature: float = ...,
        current: float = ...,
        charge: float = ...,
        capacity: float = ...,
        design_capacity: float = ...,
        percentage: float = ...,
        power_supply_status: int = ...,
        power_supply_health: int = ...,
        power_supply_technology: int = ...,
        present: bool = ...,
        cell_voltage: _typing.Any = ...,
        cell_temperature: _typing.Any = ...,
        location: str = ...,
        serial_number: str = ...,
    ) -> None: ...

class CameraInfo(_message.Message):
    header: _std_msgs_msg.Header
    height: int
    width: int
    distortion_model: str
    d: _typing.Any
    k: _typing.Any
    r: _typing.Any
    p: _typing.Any
    binning_x: int
    binning_y: int
    roi: RegionOfInterest
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        height: int = ...,
        width: int = ...,
        distortion_model: str = ...,
        d: _typing.Any = ...,
        k: _typing.Any = ...,
        r: _typing.Any = ...,
        p: _typing.Any = ...,
        binning_x: int = ...,
        binning_y: int = ...,
        roi: RegionOfInterest | None = ...,
    ) -> None: ...

class ChannelFloat32(_message.Message):
    name: str
    values: _typing.Any
    def __init__(
        self,
        name: str = ...,
        values: _typing.Any = ...,
    ) -> None: ...

class CompressedImage(_message.Message):
    header: _std_msgs_msg.Header
    format: str
    data: _message.Bytes
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        format: str = ...,
        data: _message.Bytes | _abc.Sequence[int] = ...,
    ) -> None: ...

class FluidPressure(_message.Message):
    header: _std_msgs_msg.Header
    fluid_pressure: float
    variance: float
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        fluid_pressure: float = ...,
        variance: float = ...,
    ) -> None: ...

class Illuminance(_message.Message):
    header: _std_msgs_msg.Header
    illuminance: float
    variance: float
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        illuminance: float = ...,
        variance: float = ...,
    ) -> None: ...

class Image(_message.Message):
    header: _std_msgs_msg.Header
    height: int
    width: int
    encoding: str
    is_bigendian: int
    step: int
    data: _message.Bytes
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        height: int = ...,
        width: int = ...,
        encoding: str = ...,
        is_bigendian: int = ...,
        step: int = ...,
        data: _message.Bytes | _abc.Sequence[int] = ...,
    ) -> None: ...

class Imu(_message.Message):
    header: _std_msgs_msg.Header
    orientation: _geometry_msgs_msg.Quaternion
    orientation_covariance: _typing.Any
    angular_velocity: _geometry_msgs_msg.Vector3
    angular_velocity_covariance: _typing.Any
    linear_acceleration: _geometry_msgs_msg.Vector3
    linear_acceleration_covariance: _typing.Any
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        orientation: _geometry_msgs_msg.Quaternion | None = ...,
        orientation_covariance: _typing.Any = ...,
        angular_velocity: _geometry_msgs_msg.Vector3 | None = ...,
        angular_velocity_covariance: _typing.Any = ...,
        linear_acceleration: _geometry_msgs_msg.Vector3 | None = ...,
        linear_acceleration_covariance: _typing.Any = ...,
    ) -> None: ...

class JointState(_message.Message):
    header: _std_msgs_msg.Header
    name: list[str]
    position: _typing.Any
    velocity: _typing.Any
    effort: _typing.Any
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        name: list[str] | None = ...,
        position: _typing.Any = ...,
        velocity: _typing.Any = ...,
        effort: _typing.Any = ...,
    ) -> None: ...

class Joy(_message.Message):
    header: _std_msgs_msg.Header
    axes: _typing.Any
    buttons: _typing.Any
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        axes: _typing.Any = ...,
        buttons: _typing.Any = ...,
    ) -> None: ...

class JoyFeedback(_message.Message):
    TYPE_LED: _typing.ClassVar[int]
    TYPE_RUMBLE: _typing.ClassVar[int]
    TYPE_BUZZER: _typing.ClassVar[int]
    type: int
    id: int
    intensity: float
    def __init__(
        self,
        type: int = ...,
        id: int = ...,
        intensity: float = ...,
    ) -> None: ...

class JoyFeedbackArray(_message.Message):
    array: list[JoyFeedback]
    def __init__(
        self,
        array: list[JoyFeedback] | None = ...,
    ) -> None: ...

class LaserEcho(_message.Message):
    echoes: _typing.Any
    def __init__(
        self,
        echoes: _typing.Any = ...,
    ) -> None: ...

class LaserScan(_message.Message):
    header: _std_msgs_msg.Header
    angle_min: float
    angle_max: float
    angle_increment: float
    time_increment: float
    scan_time: float
    range_min: float
    range_max: float
    ranges: _typing.Any
    intensities: _typing.Any
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        angle_min: float = ...,
        angle_max: float = ...,
        angle_increment: float = ...,
        time_increment: float = ...,
        scan_time: float = ...,
        range_min: float = ...,
        range_max: float = ...,
        ranges: _typing.Any = ...,
        intensities: _typing.Any = ...,
    ) -> None: ...

class MagneticField(_message.Message):
    header: _std_msgs_msg.Header
    magnetic_field: _geometry_msgs_msg.Vector3
    magnetic_field_covariance: _typing.Any
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        magnetic_field: _geometry_msgs_msg.Vector3 | None = ...,
        magnetic_field_covariance: _typing.Any = ...,
    ) -> None: ...

class MultiDOFJointState(_message.Message):
    header: _std_msgs_msg.Header
    joint_names: list[str]
    transforms: list[_geometry_msgs_msg.Transform]
    twist: list[_geometry_msgs_msg.Twist]
    wrench: list[_geometry_msgs_msg.Wrench]
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        joint_names: list[str] | None = ...,
        transforms: list[_geometry_msgs_msg.Transform] | None = ...,
        twist: list[_geometry_msgs_msg.Twist] | None = ...,
        wrench: list[_geometry_msgs_msg.Wrench] | None = ...,
    ) -> None: ...

class MultiEchoLaserScan(_message.Message):
    header: _std_msgs_msg.Header
    angle_min: float
    angle_max: float
    angle_increment: float
    time_increment: float
    scan_time: float
    range_min: float
    range_max: float
    ranges: list[LaserEcho]
    intensities: list[LaserEcho]
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        angle_min: float = ...,
        angle_max: float = ...,
        angle_increment: float = ...,
        time_increment: float = ...,
        scan_time: float = ...,
        range_min: float = ...,
        range_max: float = ...,
        ranges: list[LaserEcho] | None = ...,
        intensities: list[LaserEcho] | None = ...,
    ) -> None: ...

class NavSatFix(_message.Message):
    COVARIANCE_TYPE_UNKNOWN: _typing.ClassVar[int]
    COVARIANCE_TYPE_APPROXIMATED: _typing.ClassVar[int]
    COVARIANCE_TYPE_DIAGONAL_KNOWN: _typing.ClassVar[int]
    COVARIANCE_TYPE_KNOWN: _typing.ClassVar[int]
    header: _std_msgs_msg.Header
    status: NavSatStatus
    latitude: float
    longitude: float
    altitude: float
    position_covariance: _typing.Any
    position_covariance_type: int
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        status: NavSatStatus | None = ...,
        latitude: float = ...,
        longitude: float = ...,
        altitude: float = ...,
        position_covariance: _typing.Any = ...,
        position_covariance_type: int = ...,
    ) -> None: ...

class NavSatStatus(_message.Message):
    STATUS_UNKNOWN: _typing.ClassVar[int]
    STATUS_NO_FIX: _typing.ClassVar[int]
    STATUS_FIX: _typing.ClassVar[int]
    STATUS_SBAS_FIX: _typing.ClassVar[int]
    STATUS_GBAS_FIX: _typing.ClassVar[int]
    SERVICE_UNKNOWN: _typing.ClassVar[int]
    SERVICE_GPS: _typing.ClassVar[int]
    SERVICE_GLONASS: _typing.ClassVar[int]
    SERVICE_COMPASS: _typing.ClassVar[int]
    SERVICE_GALILEO: _typing.ClassVar[int]
    status: int
    service: int
    def __init__(
        self,
        status: int = ...,
        service: int = ...,
    ) -> None: ...

class PointCloud(_message.Message):
    header: _std_msgs_msg.Header
    points: list[_geometry_msgs_msg.Point32]
    channels: list[ChannelFloat32]
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        points: list[_geometry_msgs_msg.Point32] | None = ...,
        channels: list[ChannelFloat32] | None = ...,
    ) -> None: ...

class PointCloud2(_message.Message):
    header: _std_msgs_msg.Header
    height: int
    width: int
    fields: list[PointField]
    is_bigendian: bool
    point_step: int
    row_step: int
    data: _message.Bytes
    is_dense: bool
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        height: int = ...,
        width: int = ...,
        fields: list[PointField] | None = ...,
        is_bigendian: bool = ...,
        point_step: int = ...,
        row_step: int = ...,
        data: _message.Bytes | _abc.Sequence[int] = ...,
        is_dense: bool = ...,
    ) -> None: ...

class PointField(_message.Message):
    INT8: _typing.ClassVar[int]
    UINT8: _typing.ClassVar[int]
    INT16: _typing.ClassVar[int]
    UINT16: _typing.ClassVar[int]
    INT32: _typing.ClassVar[int]
    UINT32: _typing.ClassVar[int]
    FLOAT32: _typing.ClassVar[int]
    FLOAT64: _typing.ClassVar[int]
    name: str
    offset: int
    datatype: int
    count: int
    def __init__(
        self,
        name: str = ...,
        offset: int = ...,
        datatype: int = ...,
        count: int = ...,
    ) -> None: ...

class Range(_message.Message):
    ULTRASOUND: _typing.ClassVar[int]
    INFRARED: _typing.ClassVar[int]
    header: _std_msgs_msg.Header
    radiation_type: int
    field_of_view: float
    min_range: float
    max_range: float
    range: float
    variance: float
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        radiation_type: int = ...,
        field_of_view: float = ...,
        min_range: float = ...,
        max_range: float = ...,
        range: float = ...,
        variance: float = ...,
    ) -> None: ...

class RegionOfInterest(_message.Message):
    x_offset: int
    y_offset: int
    height: int
    width: int
    do_rectify: bool
    def __init__(
        self,
        x_offset: int = ...,
        y_offset: int = ...,
        height: int = ...,
        width: int = ...,
        do_rectify: bool = ...,
    ) -> None: ...

class RelativeHumidity(_message.Message):
    header: _std_msgs_msg.Header
    relative_humidity: float
    variance: float
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        relative_humidity: float = ...,
        variance: float = ...,
    ) -> None: ...

class Temperature(_message.Message):
    header: _std_msgs_msg.Header
    temperature: float
    variance: float
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        temperature: float = ...,
        variance: float = ...,
    ) -> None: ...

class TimeReference(_message.Message):
    header: _std_msgs_msg.Header
    time_ref: _builtin_interfaces_msg.Time | _time.Time
    source: str
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        time_ref: _builtin_interfaces_msg.Time | _time.Time | None = ...,
        source: str = ...,
    ) -> None: ...
