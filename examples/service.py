"""Offers a service that adds two integers, or calls it, or both.

    python service.py server &
    python service.py client 2 3
    roslet service call /add_two_ints "{a: 4, b: 5}"

The types are those of each network's own tutorial, so that a client or server of theirs may take one side.
"""

from __future__ import annotations

import argparse
import sys
from typing import Any

import roslet


def add(request: Any) -> dict[str, int]:
    """A handler returns a response, or a dict of its fields."""
    print(f"{request.a} + {request.b}", flush=True)
    return {"sum": request.a + request.b}


def main() -> int:
    parser = argparse.ArgumentParser(description="The service add_two_ints.")
    parser.add_argument("role", choices=("server", "client", "both"), nargs="?", default="both")
    parser.add_argument("a", type=int, nargs="?", default=2)
    parser.add_argument("b", type=int, nargs="?", default=3)
    parser.add_argument(
        "--network", default="ros2://", help="default: ros2://, which needs no master; or ros1://"
    )
    arguments = parser.parse_args()
    package = "rospy_tutorials" if arguments.network.startswith("ros1") else "example_interfaces"
    kind = package + "/AddTwoInts"

    with roslet.Node("adder_" + arguments.role, network=arguments.network) as node:
        if arguments.role != "client":
            node.service("add_two_ints", kind, add)
        if arguments.role == "server":
            node.spin()
            return 0

        client = node.client("add_two_ints", kind)
        if not client.wait(timeout=10.0):
            print("no service add_two_ints", file=sys.stderr)
            return 1
        # Several calls may be under way; a Future can be awaited too. In the role "both" it is spin that serves them.
        calls = [client.call_async(a=arguments.a, b=arguments.b + more) for more in range(3)]
        node.spin_until(lambda: all(call.done() for call in calls), timeout=5.0)
        print("sums", *[call.result(0.0).sum for call in calls], flush=True)
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(0)
