#!/usr/bin/env python3
# What a message class does without a network.
import array
import copy

import numpy
from builtin_interfaces.msg import Duration, Time
from geometry_msgs.msg import (
    Point,
    Point32,
    PolygonStamped,
    Pose,
    PoseArray,
    PoseWithCovariance,
    Twist,
    Vector3,
)
from nav_msgs.msg import OccupancyGrid
from rcl_interfaces.msg import ParameterType, ParameterValue
from sensor_msgs.msg import CompressedImage, Image, JointState, LaserScan, NavSatFix
from std_msgs.msg import (
    Bool,
    Byte,
    Char,
    ColorRGBA,
    Float32,
    Float64MultiArray,
    Header,
    Int32,
    MultiArrayDimension,
    String,
    UInt64,
)
from std_srvs.srv import SetBool, Trigger
from unique_identifier_msgs.msg import UUID


def show(name, function):
    try:
        print(name, function())
    except Exception as error:
        print(name, "raised", type(error).__name__, str(error).splitlines()[0] if str(error) else "")


print(
    String(),
    String(data="x"),
    Int32(data=-5),
    Bool(data=True),
    Float32(data=0.5),
    Byte(data=b"\x03"),
    Char(data=65),
)
print(Pose())
print(Twist(linear=Vector3(x=1.0)).linear.x, Twist().angular == Vector3())
print(Header(), Time(sec=1, nanosec=2), Duration(sec=-1))
print(Point(x=1.0) == Point(x=1.0), Point(x=1.0) != Point(), Point() == 3)
print(String.get_fields_and_field_types(), Image.get_fields_and_field_types())
print(PoseWithCovariance.get_fields_and_field_types(), PoseArray.get_fields_and_field_types())
print(list(Point.get_fields_and_field_types()), len(Point.SLOT_TYPES), Point.__name__)
message = Point()
message.x = 3.0
print(message.x, message)
show("int for float", lambda: setattr(message, "x", 3))
show("by position", lambda: Point(1.0, 2.0, 3.0))
show("no such field", lambda: Point(x=1.0, colour=1))
show("no such field, unchecked", lambda: Point(x=1.0, colour=1, check_fields=False))
show("no such fields, checked", lambda: Point(x=1.0, size=1, colour=1, check_fields=True))
show("fields, checked", lambda: Point(x=1.0, check_fields=True))
show("new attribute", lambda: setattr(message, "colour", 1))
show("largest", lambda: UInt64(data=2**64 - 1).data)
show("unicode", lambda: String(data="žluťoučký kůň"))

image = Image()
print(type(image.data).__name__, image.data)
image.data = bytes([1, 2, 3])
print(type(image.data).__name__, image.data)
image.data = [1, 2]
print(type(image.data).__name__, image.data)
image.data = numpy.arange(3, dtype=numpy.uint8).tobytes()
print(image.data)
image.data = array.array("B", [9])
print(image.data)
show("large element", lambda: setattr(image, "data", [300]))
show("text elements", lambda: setattr(image, "data", ["a"]))
show("other array", lambda: setattr(image, "data", array.array("f", [1.0])))
scan = LaserScan(ranges=[1.0, 2.5])
print(type(scan.ranges).__name__, scan.ranges, scan.intensities)
scan.ranges.append(3.0)
print(len(scan.ranges))
show("ints for floats", lambda: LaserScan(ranges=[1, 2]).ranges)
show("a number", lambda: LaserScan(ranges=1.0))
grid = OccupancyGrid(data=[0, -1, 100])
print(type(grid.data).__name__, grid.data)
fix = NavSatFix()
print(type(fix.position_covariance).__name__, fix.position_covariance.dtype, fix.position_covariance.shape)
fix.position_covariance = [1.0] * 9
print(fix.position_covariance.sum())
fix.position_covariance = numpy.ones(9)
joints = JointState(name=["a", "b"], position=[0.5])
print(joints.name, joints.position, type(joints.name).__name__)
poses = PoseArray(poses=[Pose(), Pose()])
print(len(poses.poses), type(poses.poses).__name__)
polygon = PolygonStamped()
polygon.polygon.points.append(Point32(x=1.0))
print(polygon)
print(Float64MultiArray(data=[1.5]).layout.dim, MultiArrayDimension(label="l", size=1))
print(UUID(uuid=list(range(16))).uuid, type(UUID().uuid).__name__, UUID().uuid.dtype)
print(
    NavSatFix.COVARIANCE_TYPE_KNOWN,
    ParameterType.PARAMETER_STRING,
    ParameterValue().type,
    CompressedImage().format == "",
)
print(ColorRGBA(r=0.5) == copy.copy(ColorRGBA(r=0.5)), copy.deepcopy(polygon) == polygon)

print(SetBool.Request(data=True), SetBool.Response(), Trigger.Request())
print(SetBool.Request.__name__, SetBool.__name__)
show("a service", lambda: SetBool())
