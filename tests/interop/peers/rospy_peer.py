"""The rospy peer, on messages that Debian's genpy generated: obeys the lines that roscpp_peer.cpp obeys.

Run by /usr/bin/python3 with the generated packages on PYTHONPATH.
"""

import sys
import threading

import genpy
import roslib.message
import rospy
import samples
from peer_msgs.srv import Scale, ScaleResponse

published = {}
subscribed = {}
services = {}
clients = {}
output = threading.Lock()


def tell(*parts):
    with output:
        print(*parts, flush=True)


def make(name):
    if name == "time":
        return genpy.Time()
    if name == "duration":
        return genpy.Duration()
    return roslib.message.get_message_class(name)()


def advertise(type_name, topic, latch, *_):
    kind = roslib.message.get_message_class(type_name)
    published[topic] = rospy.Publisher(topic, kind, latch=latch == "1", queue_size=200), type_name
    tell("advertised", topic)


def publish(topic, i, size, *_):
    publisher, type_name = published[topic]
    publisher.publish(samples.build(samples.sample(type_name, int(i), int(size)), make))
    tell("published", topic, i)


def subscribe(type_name, topic, size, *_):
    count = []

    def on_message(message):
        i = len(count)
        count.append(i)
        found = samples.differences(samples.sample(type_name, i, int(size)), message)
        tell("got", topic, i, "differs " + "; ".join(found[:3]) if found else "ok")

    kind = roslib.message.get_message_class(type_name)
    subscribed[topic] = rospy.Subscriber(topic, kind, on_message, tcp_nodelay=True)
    tell("subscribed", topic)


def serve(name):
    def on_scale(request):
        if request.factor == 0:
            raise rospy.ServiceException("factor is zero")
        response = ScaleResponse(points=request.points, text=f"scaled {len(request.points)}")
        for point in response.points:
            point.x *= request.factor
            point.y *= request.factor
            point.z *= request.factor
        return response

    services[name] = rospy.Service(name, Scale, on_scale)
    tell("serving", name)


def call(name, count, factor, persistent):
    if name not in clients or persistent == "0":
        clients[name] = rospy.ServiceProxy(name, Scale, persistent=persistent == "1")
    request = samples.fill(Scale._request_class(), samples.scale_request(int(count), float(factor)), make)
    try:
        response = clients[name](request)
    except rospy.ServiceException as error:
        tell("called", name, "failed", str(error))
        return
    found = samples.differences(samples.scale_response(int(count), float(factor)), response)
    tell("called", name, "differs " + "; ".join(found[:3]) if found else "ok")


VALUES = {
    "int": int,
    "double": float,
    "bool": lambda text: text == "1",
    "string": str,
    "doubles": lambda text: [1.5, -2.25, 1e300],
    "ints": lambda text: {"one": 1, "two": 2},
}

TEXTS = {
    "int": str,
    "double": lambda value: f"{value:.17g}",
    "bool": lambda value: str(int(value)),
    "string": str,
    "doubles": lambda value: "".join(f"{each:.17g};" for each in value),
    "ints": lambda value: "".join(f"{key}={each};" for key, each in sorted(value.items())),
}


def set_parameter(name, kind, *words):
    rospy.set_param(name, VALUES[kind](" ".join(words)))
    tell("set", name)


def get_parameter(name, kind):
    try:
        tell("value", name, kind, TEXTS[kind](rospy.get_param(name)))
    except KeyError:
        tell("missing", name)


def unadvertise(topic):
    published.pop(topic)[0].unregister()
    tell("unadvertised", topic)


def unsubscribe(topic):
    subscribed.pop(topic).unregister()
    tell("unsubscribed", topic)


COMMANDS = {
    "advertise": advertise,
    "publish": publish,
    "subscribe": subscribe,
    "serve": serve,
    "call": call,
    "set": set_parameter,
    "get": get_parameter,
    "unadvertise": unadvertise,
    "unsubscribe": unsubscribe,
    "subscribers": lambda topic: tell("subscribers", topic, published[topic][0].get_num_connections()),
    "publishers": lambda topic: tell("publishers", topic, subscribed[topic].get_num_connections()),
}


def main():
    rospy.init_node("rospy_peer", disable_signals=True)
    tell("ready", rospy.get_name())
    for line in sys.stdin:
        command, *words = line.split()
        if command == "quit":
            break
        COMMANDS[command](*words)
    rospy.signal_shutdown("told to quit")


main()
