#!/usr/bin/env python3
# Making, printing, comparing, filling and serialising messages.
import io

import genpy
import roslib.message
import rospy
import std_msgs.msg
from beginner_tutorials.msg import Arrays, Coordinate, Person
from beginner_tutorials.srv import AddTwoInts, AddTwoIntsRequest, AddTwoIntsResponse
from geometry_msgs.msg import Point, PoseStamped, PoseWithCovariance, Quaternion, TwistStamped
from sensor_msgs.msg import Image, JointState, LaserScan
from std_msgs.msg import Bool, Empty, Float32, Header, Int32MultiArray, MultiArrayDimension, String
from std_srvs.srv import Trigger


def show(text):
    try:
        print(text, "=", eval(text))
    except Exception as error:
        print(text, "raised", type(error).__name__)


def there_and_back(message):
    buffer = io.BytesIO()
    message.serialize(buffer)
    other = type(message)()
    returned = other.deserialize(buffer.getvalue())
    assert returned is other
    return other


full = Arrays(
    triple=[1, -2, 3],
    quad=b"\x01\x02\x03\x04",
    octets=[5, 6],
    flags=[True, False],
    numbers=(7, 8),
    pair=[0.5, 1.5],
    words=["", "a b", "ž", "it's: #1", "line\nbreak", "yes", "12"],
    times=[rospy.Time(1, 2)],
    spans=[rospy.Duration(1), rospy.Duration(-1)],
    people=[Person("A", "B", 1, 2)],
    both=[Person(), Person(age=3)],
    letters=b"ab",
    bytes=[-1, 1],
)
for text in """
String('hello'), String(data='hello'), String(), String(None)
String('quotes " and \\\\ and \\n and \\t and é € 😀')
String('long ' * 40)
Point(1, 2, 3), Point(x=1.5), Point()
Point(1, 2)
Point(1, 2, 3, 4)
Point(w=1)
Point(1, y=2)
PoseStamped()
PoseWithCovariance()
Image(data=b'\\x01\\x02\\x03', encoding='mono8')
JointState(name=['a', 'b'], position=[1, 2.5])
LaserScan(ranges=[float('inf'), float('nan'), 1e-7, 1e22])
Empty(), Bool(True), Float32(0.1)
Int32MultiArray(data=[1, 2, 3]), MultiArrayDimension('x', 1, 2)
Arrays()
full
there_and_back(full)
there_and_back(Point(1, 2, 3)) == Point(1, 2, 3), Point() == Point(x=1), Point() != Point(x=1), Point() == 3
{name: type(getattr(there_and_back(full), name)).__name__ for name in Arrays.__slots__}
{name: type(getattr(Arrays(), name)).__name__ for name in Arrays.__slots__}
{name: type(getattr(PoseWithCovariance(), name)).__name__ for name in PoseWithCovariance.__slots__}
there_and_back(PoseWithCovariance()).covariance[:3]
Arrays.LEFT, Arrays.RIGHT, Arrays.NAME
Point._type, Point._md5sum, Point._slot_types, Point.__slots__, Point._has_header, PoseStamped._has_header
Arrays._slot_types
Coordinate._md5sum, Coordinate._full_text
AddTwoInts._type, AddTwoInts._md5sum, AddTwoIntsRequest._type, AddTwoIntsRequest._md5sum, AddTwoIntsResponse(3)
AddTwoInts._request_class is AddTwoIntsRequest, AddTwoInts._response_class is AddTwoIntsResponse
Trigger._request_class.__name__, Trigger._response_class(success=True, message='m')
isinstance(Point(), genpy.Message), isinstance(PoseStamped().header, Header), isinstance(PoseStamped().pose.orientation, Quaternion)
roslib.message.get_message_class('geometry_msgs/Point') is Point, roslib.message.get_message_class('no/Such')
roslib.message.get_service_class('beginner_tutorials/AddTwoInts') is AddTwoInts
std_msgs.msg.String is String, rospy.Header is Header
hash(Point())
Point().nothing
there_and_back(String(3))
there_and_back(Person(age=300))
there_and_back(Person(age='x'))
there_and_back(Arrays(triple=[1, 2]))
there_and_back(Arrays(numbers=['x']))
genpy.message.strify_message([1, 2]), genpy.message.strify_message('text'), genpy.message.strify_message(Point())
rospy.AnyMsg._type, rospy.AnyMsg._md5sum, rospy.AnyMsg()._buff
rospy.AnyMsg(1)
TwistStamped(header=Header(frame_id='map')).header.frame_id
""".strip().splitlines():
    show(text)
point = Point()
genpy.message.fill_message_args(point, [1, 2, 3])
print(point)
genpy.message.fill_message_args(point, [{"y": 5}])
print(point)
pose = PoseStamped()
genpy.message.fill_message_args(
    pose, [{"header": {"stamp": {"secs": 1, "nsecs": 2}, "frame_id": "f"}, "pose": {"position": [1, 2, 3]}}]
)
print(pose)
joints = JointState()
joints.name.append("one")
joints.position += [1.0]
joints.position.append(2)
print(joints.position, joints.name)
