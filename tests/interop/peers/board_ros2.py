"""The node of the ROS 2 tests on MicroPython; bundled by interop/boards.py. Echoes what comes, serves, calls, has
parameters."""

import roslet

node = roslet.Node("board", network="ros2://")
SetBool = "std_srvs/srv/SetBool"


def echo(type_name, topic):
    back = node.publisher(topic + "_back", type_name)
    node.subscribe(topic, type_name, back.publish)


echo("mros_comm_measure/msg/Coordinate", "coordinate")
echo("std_msgs/msg/String", "text")
image = node.publisher("image", "sensor_msgs/msg/Image")


def want_image(message):
    """As ros2_samples.py has it, 32 KB. Peers would send as much in one datagram, which is more than a board takes."""
    size = 32768
    start = message.data
    period = bytes([(start + k) % 251 for k in range(251)])
    data = (period * (size // 251 + 1))[:size]
    header = roslet.load("").std_msgs.msg.Header(frame_id="frame %d" % start)
    header.stamp.sec, header.stamp.nanosec = 1700000000 + start, 123456789
    image.publish(header=header, height=1, width=size, encoding="mono8", step=size, data=data)


node.subscribe("want_image", "std_msgs/msg/UInt32", want_image)


def set_bool(request):
    return {"success": request.data, "message": "yes" if request.data else "no"}


node.service("set", SetBool, set_bool)
served = node.client("served", SetBool)
right = node.publisher("right", "std_msgs/msg/UInt32")


def ask(message):
    answer = served.call(data=True, timeout=5.0)
    right.publish(data=message.data if answer.success and answer.message == "yes" else 0)


node.subscribe("ask", "std_msgs/msg/UInt32", ask)
node.declare_parameter("speed", 1.5, range=(0.0, 10.0))
node.on_parameter("speed", lambda value: node.log.warning("speed is %s" % value))
beats = node.publisher("beat", "std_msgs/msg/UInt32")
node.timer(0.1, lambda: beats.publish(data=beats.messages))
print("ready")
node.spin()
