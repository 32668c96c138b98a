"""Run by test_without_numpy.py in an interpreter that cannot import numpy; prints what it saw as JSON."""

import json
import sys
from typing import Any


class Blocker:
    def find_spec(self, name: str, path: object = None, target: object = None) -> None:
        if name == "numpy" or name.startswith("numpy."):
            raise ImportError("numpy is blocked")


sys.meta_path.insert(0, Blocker())

import array  # noqa: E402

from roslet.errors import InvalidMessage  # noqa: E402
from roslet.gen import runtime  # noqa: E402

seen: Any = {}
dialect: Any
for dialect in ("ros1", "ros2"):
    kind: Any = runtime.message_class(dialect, "sensor_msgs/JointState")
    made = kind(name=["a"], position=[1.0, 2.0], velocity=array.array("d", [3.0]), effort=(4, 5))
    data = made.serialize()
    back = kind.deserialize(data)
    seen[dialect] = {
        "data": data.hex(),
        "type": type(back.position).__name__,
        "values": [list(back.position), list(back.velocity), list(back.effort)],
        "equal": back == made,
        "again": kind.deserialize(back.serialize()) == made,
        "copy": back.copy() == made,
    }
    imu: Any = runtime.message_class(dialect, "sensor_msgs/Imu")
    seen[dialect]["zeros"] = list(imu().orientation_covariance)
    seen[dialect]["imu"] = imu.deserialize(imu().serialize()) == imu()
    try:
        imu(orientation_covariance=[0.0] * 8).serialize()
    except InvalidMessage as error:
        seen[dialect]["error"] = str(error)
    if dialect == "ros2":
        big = bytearray(kind(position=[1.0, 2.0]).serialize())
        from roslet.wire import cdr

        seen["big"] = list(kind.deserialize(cdr.write(kind(position=[1.0, 2.0]), cdr.CDR_BE)).position)
seen["numpy"] = "numpy" in sys.modules
print(json.dumps(seen))
