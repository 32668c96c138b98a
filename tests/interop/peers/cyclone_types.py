"""ROS types as CycloneDDS has them, by hand, and the names that ROS 2 gives them in DDS."""

from dataclasses import dataclass

from cyclonedds.idl import IdlStruct
from cyclonedds.idl.annotations import key as is_key
from cyclonedds.idl.types import (
    array,
    bounded_str,
    byte,
    float32,
    float64,
    int8,
    int32,
    int64,
    sequence,
    uint8,
    uint16,
    uint32,
    uint64,
)

TYPES = {}


def ros(name):
    """A dataclass is the ROS type of this name."""

    def register(kind):
        made = dataclass(kind)
        TYPES[name] = made
        return made

    return register


@ros("builtin_interfaces/msg/Time")
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: int32
    nanosec: uint32


@ros("std_msgs/msg/Header")
class Header(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    stamp: Time
    frame_id: str


@ros("std_msgs/msg/String")
class String(IdlStruct, typename="std_msgs::msg::dds_::String_"):
    data: str


@ros("std_msgs/msg/UInt32")
class UInt32(IdlStruct, typename="std_msgs::msg::dds_::UInt32_"):
    data: uint32


@ros("geometry_msgs/msg/Point")
class Point(IdlStruct, typename="geometry_msgs::msg::dds_::Point_"):
    x: float64
    y: float64
    z: float64


@ros("mros_comm_measure/msg/Coordinate")
class Coordinate(IdlStruct, typename="mros_comm_measure::msg::dds_::Coordinate_"):
    x: float32
    y: float32
    z: float32
    time: Time


@ros("geometry_msgs/msg/PointStamped")
class PointStamped(IdlStruct, typename="geometry_msgs::msg::dds_::PointStamped_"):
    header: Header
    point: Point


@ros("sensor_msgs/msg/Image")
class Image(IdlStruct, typename="sensor_msgs::msg::dds_::Image_"):
    header: Header
    height: uint32
    width: uint32
    encoding: str
    is_bigendian: uint8
    step: uint32
    data: sequence[uint8]


@ros("sensor_msgs/msg/PointField")
class PointField(IdlStruct, typename="sensor_msgs::msg::dds_::PointField_"):
    name: str
    offset: uint32
    datatype: uint8
    count: uint32


@ros("sensor_msgs/msg/PointCloud2")
class PointCloud2(IdlStruct, typename="sensor_msgs::msg::dds_::PointCloud2_"):
    header: Header
    height: uint32
    width: uint32
    fields: sequence[PointField]
    is_bigendian: bool
    point_step: uint32
    row_step: uint32
    data: sequence[uint8]
    is_dense: bool


@ros("diagnostic_msgs/msg/KeyValue")
class KeyValue(IdlStruct, typename="diagnostic_msgs::msg::dds_::KeyValue_"):
    key: str
    value: str


@ros("diagnostic_msgs/msg/DiagnosticStatus")
class DiagnosticStatus(IdlStruct, typename="diagnostic_msgs::msg::dds_::DiagnosticStatus_"):
    level: byte
    name: str
    message: str
    hardware_id: str
    values: sequence[KeyValue]


@ros("diagnostic_msgs/msg/DiagnosticArray")
class DiagnosticArray(IdlStruct, typename="diagnostic_msgs::msg::dds_::DiagnosticArray_"):
    header: Header
    status: sequence[DiagnosticStatus]


@ros("geometry_msgs/msg/Vector3")
class Vector3(IdlStruct, typename="geometry_msgs::msg::dds_::Vector3_"):
    x: float64
    y: float64
    z: float64


@ros("geometry_msgs/msg/Quaternion")
class Quaternion(IdlStruct, typename="geometry_msgs::msg::dds_::Quaternion_"):
    x: float64
    y: float64
    z: float64
    w: float64


@ros("geometry_msgs/msg/Transform")
class Transform(IdlStruct, typename="geometry_msgs::msg::dds_::Transform_"):
    translation: Vector3
    rotation: Quaternion


@ros("geometry_msgs/msg/TransformStamped")
class TransformStamped(IdlStruct, typename="geometry_msgs::msg::dds_::TransformStamped_"):
    header: Header
    child_frame_id: str
    transform: Transform


@ros("tf2_msgs/msg/TFMessage")
class TFMessage(IdlStruct, typename="tf2_msgs::msg::dds_::TFMessage_"):
    transforms: sequence[TransformStamped]


@ros("probe_msgs/msg/Part")
class Part(IdlStruct, typename="probe_msgs::msg::dds_::Part_"):
    code: int8
    name: str
    big: int64


@ros("probe_msgs/msg/Probe")
class Probe(IdlStruct, typename="probe_msgs::msg::dds_::Probe_"):
    number: int32
    label: bounded_str[32]
    flags: array[bool, 3]
    parts: sequence[Part, 4]
    after: uint16
    pair: array[Part, 2]
    values: sequence[float64]


@ros("keyed")
class Keyed(IdlStruct, typename="probe_msgs::msg::dds_::Keyed_"):
    name: str
    is_key("name")
    value: int32


# ros_discovery_info, with gids as of Jazzy and as of Humble; who has a hash of its type is no Humble.

HASH = "typehash=RIHS01_91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e;"


@dataclass
class Gid(IdlStruct, typename="rmw_dds_common::msg::dds_::Gid_"):
    data: array[uint8, 16]


@dataclass
class NodeEntities(IdlStruct, typename="rmw_dds_common::msg::dds_::NodeEntitiesInfo_"):
    node_namespace: str
    node_name: str
    readers: sequence[Gid]
    writers: sequence[Gid]


@dataclass
class Participant(IdlStruct, typename="rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_"):
    gid: Gid
    nodes: sequence[NodeEntities]


@dataclass
class OldGid(IdlStruct, typename="rmw_dds_common::msg::dds_::Gid_"):
    data: array[uint8, 24]


@dataclass
class OldNodeEntities(IdlStruct, typename="rmw_dds_common::msg::dds_::NodeEntitiesInfo_"):
    node_namespace: str
    node_name: str
    readers: sequence[OldGid]
    writers: sequence[OldGid]


@dataclass
class OldParticipant(IdlStruct, typename="rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_"):
    gid: OldGid
    nodes: sequence[OldNodeEntities]


GRAPHS = {16: (Gid, NodeEntities, Participant), 24: (OldGid, OldNodeEntities, OldParticipant)}


# Services, with the header of rmw_cyclonedds: who asks, and the number of the request.


@dataclass
class SetBoolRequest(IdlStruct, typename="std_srvs::srv::dds_::SetBool_Request_"):
    client: uint64
    number: int64
    data: bool


@dataclass
class SetBoolResponse(IdlStruct, typename="std_srvs::srv::dds_::SetBool_Response_"):
    client: uint64
    number: int64
    success: bool
    message: str


@dataclass
class TriggerRequest(IdlStruct, typename="std_srvs::srv::dds_::Trigger_Request_"):
    client: uint64
    number: int64
    structure_needs_at_least_one_member: uint8


@dataclass
class TriggerResponse(IdlStruct, typename="std_srvs::srv::dds_::Trigger_Response_"):
    client: uint64
    number: int64
    success: bool
    message: str


@ros("sensor_msgs/msg/RegionOfInterest")
class RegionOfInterest(IdlStruct, typename="sensor_msgs::msg::dds_::RegionOfInterest_"):
    x_offset: uint32 = 0
    y_offset: uint32 = 0
    height: uint32 = 0
    width: uint32 = 0
    do_rectify: bool = False


@ros("sensor_msgs/msg/CameraInfo")
class CameraInfo(IdlStruct, typename="sensor_msgs::msg::dds_::CameraInfo_"):
    header: Header
    height: uint32
    width: uint32
    distortion_model: str
    d: sequence[float64]
    k: array[float64, 9]
    r: array[float64, 9]
    p: array[float64, 12]
    binning_x: uint32
    binning_y: uint32
    roi: RegionOfInterest


@dataclass
class SetCameraInfoRequest(IdlStruct, typename="sensor_msgs::srv::dds_::SetCameraInfo_Request_"):
    client: uint64
    number: int64
    camera_info: CameraInfo


@dataclass
class SetCameraInfoResponse(IdlStruct, typename="sensor_msgs::srv::dds_::SetCameraInfo_Response_"):
    client: uint64
    number: int64
    success: bool
    status_message: str


SERVICES = {
    "std_srvs/srv/SetBool": (SetBoolRequest, SetBoolResponse),
    "std_srvs/srv/Trigger": (TriggerRequest, TriggerResponse),
    "sensor_msgs/srv/SetCameraInfo": (SetCameraInfoRequest, SetCameraInfoResponse),
}


def make(type_name, fields):
    if type_name == "sensor_msgs/msg/CameraInfo":
        zeros = {"k": [0.0] * 9, "r": [0.0] * 9, "p": [0.0] * 12, "roi": RegionOfInterest()}
        plain = {"height": 0, "width": 0, "distortion_model": "", "binning_x": 0, "binning_y": 0}
        fields = {**zeros, **plain, **fields}
    return TYPES[type_name](**fields)
