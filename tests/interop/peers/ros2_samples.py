"""The I-th message of each ROS 2 type as plain data, for every peer; it knows none of them.

`sample(TYPE, I, SIZE)` is a dict of field values, nested, with the type under "_type"; `number(TYPE, MESSAGE)` says which
one a message is, so that losses and repetitions show. Enough of it for rclpy, cyclonedds and roslet alike.
"""

import time

EPOCH = 1_700_000_000


def _stamp(i):
    return {"_type": "builtin_interfaces/msg/Time", "sec": EPOCH + i, "nanosec": 123456789}


def _header(i):
    return {"_type": "std_msgs/msg/Header", "stamp": _stamp(i), "frame_id": "frame %d" % i}


def _ramp(start, size):
    period = bytes((start + k) % 251 for k in range(251))
    return (period * (size // 251 + 1))[:size]


def _string(i, size):
    """At least as many octets as I has digits; size -1 is not ASCII."""
    text = "%d " % i
    if size < 0:
        return {"data": text + "žluťoučký 日本 🐢"}
    return {"data": (text + "abcdefghijklmnopqrstuvwxyz" * (size // 26 + 1))[: max(size, len(text) - 1)]}


def _point_stamped(i, size):
    point = {"_type": "geometry_msgs/msg/Point", "x": i + 0.5, "y": -2.0 * i, "z": 1e300}
    return {"header": _header(i), "point": point}


def _image(i, size):
    geometry = {"height": 1, "width": size, "encoding": "mono8", "is_bigendian": 0, "step": size}
    return {"header": _header(i), **geometry, "data": _ramp(i, size)}


def _point_cloud(i, size):
    fields = [
        {"_type": "sensor_msgs/msg/PointField", "name": name, "offset": 4 * k, "datatype": 7, "count": 1}
        for k, name in enumerate(("x", "y", "z", "intensity"))
    ]
    return {
        "header": _header(i),
        "height": 1,
        "width": size,
        "fields": fields,
        "is_bigendian": False,
        "point_step": 16,
        "row_step": 16 * size,
        "data": _ramp(i, 16 * size),
        "is_dense": True,
    }


def _diagnostics(i, size):
    def pair(k):
        return {"_type": "diagnostic_msgs/msg/KeyValue", "key": "k" * (k % 7), "value": "%d" % k}

    def status(k):
        return {
            "_type": "diagnostic_msgs/msg/DiagnosticStatus",
            "level": bytearray([k % 4]),  # a `byte`, not an array of octets
            "name": "name %d" % k,
            "message": "m" * (k % 5),
            "hardware_id": "",
            "values": [pair(j) for j in range(k % 6)],
        }

    return {"header": _header(i), "status": [status(i + k) for k in range(size)]}


def _transforms(i, size):
    def transform(k):
        turn = {"_type": "geometry_msgs/msg/Quaternion", "x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
        shift = {"_type": "geometry_msgs/msg/Vector3", "x": k + 0.25, "y": -1.0, "z": 0.0}
        return {
            "_type": "geometry_msgs/msg/TransformStamped",
            "header": _header(i),
            "child_frame_id": "c" * (k % 9),
            "transform": {"_type": "geometry_msgs/msg/Transform", "translation": shift, "rotation": turn},
        }

    return {"transforms": [transform(k) for k in range(size)]}


def _probe(i, size):
    def part(k):
        return {"_type": "probe_msgs/msg/Part", "code": -k % 128, "name": "p" * k, "big": -(2**62) + k}

    return {
        "number": i,
        "label": "probe %d" % i,
        "flags": [True, False, i % 2 == 0],
        "parts": [part(k) for k in range(min(size, 4))],
        "after": 65535 - i,
        "pair": [part(3), part(5)],
        "values": [k + 0.125 for k in range(size)],
    }


_SAMPLES = {
    "std_msgs/msg/String": _string,
    "std_msgs/msg/UInt32": lambda i, size: {"data": i},
    "geometry_msgs/msg/PointStamped": _point_stamped,
    "mros_comm_measure/msg/Coordinate": lambda i, size: {
        "x": i + 0.5,
        "y": -2.0 * i,
        "z": 0.25,
        "time": _stamp(i),
    },
    "sensor_msgs/msg/Image": _image,
    "sensor_msgs/msg/PointCloud2": _point_cloud,
    "diagnostic_msgs/msg/DiagnosticArray": _diagnostics,
    "tf2_msgs/msg/TFMessage": _transforms,
    "probe_msgs/msg/Probe": _probe,
}


def sample(type_name, i, size):
    return {**_SAMPLES[type_name](i, size), "_type": type_name}


def number(type_name, message):
    """Which of the samples a message says that it is."""
    if type_name == "std_msgs/msg/String":
        return int(message.data.split(" ")[0])
    if type_name == "std_msgs/msg/UInt32":
        return message.data
    if type_name == "probe_msgs/msg/Probe":
        return message.number
    if type_name == "mros_comm_measure/msg/Coordinate":
        return message.time.sec - EPOCH
    stamped = message.transforms[0] if type_name == "tf2_msgs/msg/TFMessage" else message
    return stamped.header.stamp.sec - EPOCH


def build(value, make, octets, octet=bytes):
    """The message of a sample: `make(TYPE, FIELDS)` makes one, `octets(BYTES)` what stands for an array of bytes,
    `octet` for one `byte`."""
    if isinstance(value, list):
        return [build(one, make, octets, octet) for one in value]
    if isinstance(value, bytes):
        return octets(value)
    if isinstance(value, bytearray):
        return octet(value)
    if not isinstance(value, dict):
        return value
    if "_type" not in value:
        return {name: build(one, make, octets, octet) for name, one in value.items()}
    fields = {name: build(one, make, octets, octet) for name, one in value.items() if name != "_type"}
    return make(value["_type"], fields)


def differences(value, message, path=""):
    """Where a message is not what the sample says; empty when it is."""
    if isinstance(value, dict):
        found = []
        for name, field in value.items():
            if name != "_type":
                found += differences(field, getattr(message, name), path + "." + name if path else name)
        return found
    if isinstance(value, list):
        if len(message) != len(value):
            return ["%s: %d elements, expected %d" % (path, len(message), len(value))]
        found = []
        for k, (one, other) in enumerate(zip(value, message, strict=True)):
            found += differences(one, other, "%s[%d]" % (path, k))
        return found
    if isinstance(value, (bytes, bytearray)):
        same = bytes([message] if isinstance(message, int) else message) == value
        return [] if same else ["%s: other bytes" % path]
    return [] if message == value else ["%s: %r, expected %r" % (path, message, value)]


class Inbox:
    """What a subscription has heard: the numbers of the messages, and where one was not as expected. `nap`: seconds that it
    takes for each."""

    def __init__(self, type_name, size, nap=0.0):
        self.nap = nap
        self.type_name = type_name
        self.size = size
        self.numbers = []
        self.wrong = []

    def __call__(self, message):
        try:
            i = number(self.type_name, message)
            if len(self.wrong) < 5:
                self.wrong += differences(sample(self.type_name, i, self.size), message)[:2]
        except Exception as error:
            self.wrong.append(repr(error))
            return
        self.numbers.append(i)
        if self.nap:
            time.sleep(self.nap)

    def told(self):
        return [list(self.numbers), self.wrong]


# -- services: what a handler answers, and what a caller expects, as (request fields, response fields)


def request(type_name, i, size):
    if type_name == "std_srvs/srv/SetBool":
        return {"data": i % 2 == 0}
    if type_name == "std_srvs/srv/Trigger":
        return {}
    header = {"_type": "std_msgs/msg/Header", "stamp": _stamp(i), "frame_id": "%d" % i}
    info = {
        "_type": "sensor_msgs/msg/CameraInfo",
        "header": header,
        "d": [float(k) for k in range(size // 8)],
    }
    return {"camera_info": info}


def response(type_name, asked):
    """What a server answers to a request: the number in it comes back, and as many octets as came."""
    if type_name == "std_srvs/srv/SetBool":
        return {"success": asked.data, "message": "yes" if asked.data else "no"}
    if type_name == "std_srvs/srv/Trigger":
        return {"success": True, "message": "pulled"}
    info = asked.camera_info
    right = all(value == k for k, value in enumerate(info.d))
    return {"success": right, "status_message": info.header.frame_id + " " + "x" * (8 * len(info.d))}


def expected(type_name, i, size):
    if type_name == "std_srvs/srv/SetBool":
        return {"success": i % 2 == 0, "message": "no" if i % 2 else "yes"}
    if type_name == "std_srvs/srv/Trigger":
        return {"success": True, "message": "pulled"}
    return {"success": True, "status_message": "%d " % i + "x" * (size // 8 * 8)}


QOS = {
    "reliability": "reliable",
    "durability": "volatile",
    "history": "keep_last",
    "depth": 10,
    "deadline": None,
    "lifespan": None,
    "liveliness": "automatic",
    "lease": None,
}
"""What a peer's QoS is where a command says nothing; seconds, None for endless."""
