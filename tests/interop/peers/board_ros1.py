"""The node of the ROS 1 tests on MicroPython; bundled by interop/boards.py. Echoes what comes, serves, calls, has
parameters."""

import roslet

node = roslet.Node("board", network="ros1://")
Scale = "peer_msgs/Scale"


def echo(type_name, topic):
    back = node.publisher(topic + "_back", type_name)
    node.subscribe(topic, type_name, back.publish)


echo("mros_comm_measure/Coordinate", "coordinate")
echo("std_msgs/String", "text")
echo("sensor_msgs/Image", "image")
said = node.publisher("said", "std_msgs/String")


def scale(request):
    if request.factor == 0:
        raise ValueError("factor is zero")
    for point in request.points:
        point.x *= request.factor
        point.y *= request.factor
        point.z *= request.factor
    return {"points": request.points, "text": "scaled %d" % len(request.points)}


node.service("scale", Scale, scale)


def ask(message):
    word, _, rest = message.data.partition(" ")
    if word == "call":
        point = {"x": 1.5, "y": -2.0, "z": 4.0}
        points = [roslet.load("").mros_comm_measure.msg.Coordinate(**point)]
        answer = node.client(rest, Scale).call(points=points, factor=2.0, timeout=5.0)
        said.publish(data="%s %s" % (answer.text, answer.points[0].x))
    elif word == "get":
        said.publish(data=str(node.get_parameter(rest)))
    elif word == "watch":
        node.on_parameter(rest, lambda value: said.publish(data="changed %s" % value))
        said.publish(data="watching")
    elif word == "log":
        node.log.warning(rest)


node.subscribe("ask", "std_msgs/String", ask)
node.set_parameter("~mood", "calm")
beats = node.publisher("beat", "std_msgs/UInt32")
node.timer(0.1, lambda: beats.publish(data=beats.messages))
print("ready")
node.spin()
