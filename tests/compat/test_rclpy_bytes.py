"""What comes as bytes to an rclpy program under `roslet run`: fields of type byte, and samples that are no messages."""

from __future__ import annotations

import pathlib
import textwrap

from compat.rclpy_scenes import roslet
from interop.namespace import Namespace

OCTETS = """
    from rcl_interfaces.msg import ParameterValue

    first = ParameterValue(byte_array_value=[b"\\x01", b"\\xff"])
    then = ParameterValue.deserialize(first.serialize())
    octets = then.byte_array_value
    print(octets, octets == [b"\\x01", b"\\xff"], octets[1], list(octets), len(octets))
    octets.append(b"\\x07")
    octets[0] = b"\\x02"
    octets.extend([b"a", b"b"])
    print(ParameterValue.deserialize(then.serialize()).byte_array_value)
"""

LISTENER = """
    import rclpy
    from std_msgs.msg import String

    rclpy.init()
    node = rclpy.create_node("listener")
    heard = []
    node.create_subscription(String, "topic", lambda message: heard.append(message.data), 10)
    while len(heard) < 2:
        rclpy.spin_once(node)
    print(heard)
    rclpy.shutdown()
"""

TALKER = """
    import time

    import rclpy
    from std_msgs.msg import String

    rclpy.init()
    node = rclpy.create_node("talker")
    publisher = node.create_publisher(String, "topic", 10)
    while publisher.get_subscription_count() == 0:
        time.sleep(0.02)
    publisher.publish(String(data="before"))
    for data in (b"", b"\\x00", b"\\x00\\x01\\x00\\x00", b"\\x00\\x01\\x00\\x00\\xff\\xff\\xff\\x7f", b"\\xff" * 40):
        publisher.publish(data)
    publisher.publish(String(data="after"))
    publisher.wait_for_all_acked()
    rclpy.shutdown()
"""


def run(folder: pathlib.Path, *sources: str) -> list[list[str]]:
    """What programs that are started together print."""
    words, environment = roslet()
    with Namespace(folder) as namespace:
        started = []
        for number, source in enumerate(sources):
            file = folder / f"program_{number}.py"
            file.write_text(textwrap.dedent(source), encoding="utf-8")
            started.append(namespace.start(*words, str(file), name=f"{number}", **environment))
        return [program.finish() for program in started]


def test_octets_are_a_list_of_bytes_that_can_be_changed(tmp_path: pathlib.Path) -> None:
    assert run(tmp_path, OCTETS) == [
        [
            "[b'\\x01', b'\\xff'] True b'\\xff' [b'\\x01', b'\\xff'] 2",
            "[b'\\x02', b'\\xff', b'\\x07', b'a', b'b']",
        ]
    ]


def test_a_sample_that_is_no_message_does_not_end_the_spin(tmp_path: pathlib.Path) -> None:
    assert run(tmp_path, LISTENER, TALKER) == [["['before', 'after']"], []]
