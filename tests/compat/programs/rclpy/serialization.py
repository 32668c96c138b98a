#!/usr/bin/env python3
# Messages as bytes.
from geometry_msgs.msg import PoseWithCovariance
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import Image, PointField
from std_msgs.msg import Header, String, UInt8MultiArray


def show(name, function):
    try:
        print(name, function())
    except Exception as error:
        print(name, "raised", type(error).__name__)


data = serialize_message(String(data="hello"))
print(type(data).__name__, data[:4].hex(), data[4:14].hex())
print(deserialize_message(data, String))
header = Header(frame_id="map")
header.stamp.sec = 5
image = Image(header=header, height=2, width=3, encoding="mono8", step=3, data=bytes(range(6)))
again = deserialize_message(serialize_message(image), Image)
print(again == image, again.data, type(again.data).__name__, again.header.stamp.sec)
pose = PoseWithCovariance()
pose.covariance[7] = 2.5
again = deserialize_message(serialize_message(pose), PoseWithCovariance)
print(again == pose, type(again.covariance).__name__, again.covariance.shape, again.covariance[7])
print(
    deserialize_message(
        serialize_message(PointField(name="x", datatype=PointField.FLOAT32, count=1)), PointField
    )
)
array = UInt8MultiArray(data=[1, 2, 3])
print(deserialize_message(serialize_message(array), UInt8MultiArray) == array)
show("too short", lambda: deserialize_message(data[:6], String))
show("no bytes", lambda: deserialize_message("text", String))
show("no class", lambda: deserialize_message(data, int))
show("no message", lambda: serialize_message(5))
