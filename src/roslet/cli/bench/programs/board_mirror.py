"""The mirror of `roslet bench` on MicroPython: says what it read of each message, and publishes it again. The network is
$ROSLET_NETWORK; the types, which the bundle has to hold, are $BENCH_MIRROR. A float is told by its octets: MicroPython's
texts of floats are not exact."""

import json
import os
import struct

import roslet


def tell(value, found):
    """Every value in a value, in order."""
    if isinstance(value, float):
        found.append({"float": struct.pack(">d", value).hex()})
    elif isinstance(value, (bool, int, str)):
        found.append(value)
    elif hasattr(value, "secs") and not hasattr(value, "_spec"):
        found.extend((value.secs, value.nsecs))
    elif hasattr(value, "_spec"):
        for field in value._spec:
            tell(getattr(value, field[0]), found)
    else:
        for at in range(len(value)):
            tell(value[at], found)
    return found


def mirror(number, name):
    back = node.publisher("back_%d" % number, name)

    def heard(message):
        print(json.dumps({"type": number, "values": tell(message, [])}))
        back.publish(message)

    node.subscribe("there_%d" % number, name, heard)


node = roslet.Node("bench_mirror", network=os.getenv("ROSLET_NETWORK"))
for number, name in enumerate(json.loads(os.getenv("BENCH_MIRROR"))):
    mirror(number, name)
print(json.dumps({"ready": True}))
node.spin()
