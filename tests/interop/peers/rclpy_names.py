"""What rclpy makes of names. Reads one JSON list of cases: {"arguments", "node", "namespace", "names"}.

Writes a list of {"node", "namespace", "topics", "services", "rest"}, where a name that is
refused is null; or {"refused": true}.
"""

import json
import sys

import rclpy
from rclpy.context import Context
from rclpy.utilities import remove_ros_args


def resolved(resolve, names):
    found = []
    for name in names:
        try:
            found.append(resolve(name))
        except Exception:
            found.append(None)
    return found


def main():
    answers = []
    for case in json.load(sys.stdin):
        context = Context()
        try:
            rclpy.init(args=case["arguments"], context=context)
            node = rclpy.create_node(
                case["node"],
                namespace=case["namespace"],
                context=context,
                start_parameter_services=False,
                enable_rosout=False,
            )
        except Exception:
            answers.append({"refused": True})
            continue
        answers.append(
            {
                "node": node.get_name(),
                "namespace": node.get_namespace(),
                "topics": resolved(node.resolve_topic_name, case["names"]),
                "services": resolved(node.resolve_service_name, case["names"]),
                "rest": remove_ros_args(["program", *case["arguments"]])[1:],
            }
        )
        node.destroy_node()
        rclpy.shutdown(context=context)
    json.dump(answers, sys.stdout)


main()
